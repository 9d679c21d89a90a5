// Numbers of a record, from files to the model's inputs and channels.

#ifndef PINODE_CASE_SECTIONS_RECORD_DATA_H_
#define PINODE_CASE_SECTIONS_RECORD_DATA_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/case/sections/record_section.h"

namespace pinode {

// Reads all signals of `section` and prepares them, in this order:
//
//   1. columns onto the uniform grid of the record's file,
//   2. model units, sign, scale; mean subtracted on request,
//   3. signals of other files onto that grid,
//   4. resampling,
//   5. ground displacement if the dynamics needs it, by integrating the
//      interpolated ground acceleration twice from rest,
//   6. the window,
//   7. the filter, on measured channels only,
//   8. noise levels given in per cent, of the remaining signal.
//
// `dynamics` determines the inputs. Gains, offsets and delays of the channels
// are not set here. With `simulation`, channels are left NaN. `faults` (may be
// nullptr) receives a sentence for each signal with samples that no working
// sensor gives (record/sample_faults.h), as originally recorded and within the
// window.
[[nodiscard]] bool ReadRecordData(const RecordSection& section,
                                  const UnitSystem& units,
                                  const StructuralDynamics& dynamics,
                                  bool simulation, IdentificationRecord* record,
                                  std::vector<std::string>* faults);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_RECORD_DATA_H_
