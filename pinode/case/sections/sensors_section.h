// gain, offset and delay of [[record.channel]]: sensors that are not ideal.

#ifndef PINODE_CASE_SECTIONS_SENSORS_SECTION_H_
#define PINODE_CASE_SECTIONS_SENSORS_SECTION_H_

#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/sections/record_section.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Fills problem->sensors and the channels' indices into it. `gain.<channel>`
// and `delay.<channel>` belong to the sensor: they are one unknown for all
// records with a channel of that name, and may be given in one of them, or
// alike in several. `offset.<record>.<channel>` drifts and is one per record,
// or, with `shared = true` in it, `offset.<channel>` and the sensor's. A
// hold-out without an offset of its own, which it could not determine, has that
// of the last training record before it, or else of the first. In the file
// offsets have the channel's unit, delays are in seconds; the parameters are in
// the model's units.
[[nodiscard]] bool ReadSensors(const std::vector<RecordSection>& sections,
                               const UnitSystem& units,
                               IdentificationProblem* problem);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_SENSORS_SECTION_H_
