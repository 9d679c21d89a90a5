// The identified model as a case.

#ifndef PINODE_CASE_RESULTS_MODEL_CASE_H_
#define PINODE_CASE_RESULTS_MODEL_CASE_H_

#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Writes model.toml and the files that it names, M.mtx, C.mtx, K.mtx,
// group_<name>.mtx and network_<name>.json, to the folder `folder`, which will
// later be moved to `final_folder`. The case counts no change twice:
//
//   matrices  corrected by the groups that follow no covariate,
//   groups    these begin at 0 again, with bounds and prior means moved by the
//             corrections of the matrices, so that a second identification
//             from the same records finds the same structure; groups that
//             follow time or a covariate keep their value,
//   elements, networks and sensors begin at the identified values,
//   records   and options are those of the case, from their present places.
[[nodiscard]] bool WriteModelCase(const Case& c, const IdentifiedModel& model,
                                  const std::string& folder,
                                  const std::string& final_folder,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_MODEL_CASE_H_
