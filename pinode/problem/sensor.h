// Sensors with unknown gain, offset and delay.

#ifndef PINODE_PROBLEM_SENSOR_H_
#define PINODE_PROBLEM_SENSOR_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Turns values of ideal sensors over consecutive samples into values of the
// record's sensors, gain * y(t - delay) + offset, in place.
//
//   prediction  channels * samples values, channels fastest
//   rows        their derivatives; where with_parameters, the last columns are
//               those of all free parameters (sensors last)
//   valid       set to false where the delayed instant lies outside the
//               samples at hand by more than half a sampling step
//
// Between samples the prediction is a cubic through four neighbours: for
// signals below a tenth of the sampling rate its error is below 0.1 %.
// parameters: the full vector of `layout`.
void ApplySensors(const ParameterLayout& layout, const Vector& parameters,
                  const IdentificationRecord& record, bool with_parameters,
                  Eigen::Ref<Vector> prediction, Eigen::Ref<Matrix> rows,
                  std::vector<bool>* valid);

}  // namespace pinode

#endif  // PINODE_PROBLEM_SENSOR_H_
