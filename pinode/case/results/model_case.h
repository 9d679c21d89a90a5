// The identified model as a case.

#ifndef PINODE_CASE_RESULTS_MODEL_CASE_H_
#define PINODE_CASE_RESULTS_MODEL_CASE_H_

#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Writes model.toml and what it names, M.mtx, C.mtx, K.mtx, group_<name>.mtx
// and network_<name>.json, to the folder `folder`, which will later be found at
// `final_folder`. The case counts nothing twice:
//
//   matrices  corrected by the groups that follow nothing,
//   groups    these begin at 0 again, their bounds and prior means moved by
//             what the matrices have taken over, so that a second
//             identification from the same records finds the same structure;
//             groups that follow time or a covariate keep their value,
//   elements, networks and sensors begin at the values found,
//   records   and options are those of the case, from where they are.
[[nodiscard]] bool WriteModelCase(const Case& c, const IdentifiedModel& model,
                                  const std::string& folder,
                                  const std::string& final_folder,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_MODEL_CASE_H_
