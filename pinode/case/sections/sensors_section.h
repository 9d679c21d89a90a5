// gain, offset and delay of [[record.channel]]: unknowns of sensors.

#ifndef PINODE_CASE_SECTIONS_SENSORS_SECTION_H_
#define PINODE_CASE_SECTIONS_SENSORS_SECTION_H_

#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/sections/record_section.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Fills problem->sensors and the channels' indices into it.
//
// - `gain.<channel>` and `delay.<channel>` belong to the sensor: they are one
//   unknown for all records with a channel of that name. They may be given in
//   one record, or equal in several.
// - `offset.<record>.<channel>` drifts and is one per record. With
//   `shared = true` it is `offset.<channel>` and belongs to the sensor.
// - A hold-out cannot determine its own offset. Without one, it has that of the
//   last training record before it, or else of the first.
//
// In the file offsets have the channel's unit, delays are in seconds. The
// parameters are in the model's units.
[[nodiscard]] bool ReadSensors(const std::vector<RecordSection>& sections,
                               const UnitSystem& units,
                               IdentificationProblem* problem);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_SENSORS_SECTION_H_
