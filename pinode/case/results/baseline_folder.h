// Results of healthy records, to compare a new state with.

#ifndef PINODE_CASE_RESULTS_BASELINE_FOLDER_H_
#define PINODE_CASE_RESULTS_BASELINE_FOLDER_H_

#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/study/damage/baseline.h"

namespace pinode {

// Reads the result folder of pinode_update for a healthy record of the
// structure of the case: result.json, covariance.csv and matrices, for the
// groups whose change is asked for (FreeGroups); and, where the case looks for
// other kinds of change, model.toml as a problem that is not fitted yet.
//
// Refused, with *error naming file and group: a folder that is not a result,
// one that is not usable, a group that it lacks or has fixed, one whose matrix
// differs from that of the case (another structure), and other units. Where the
// case renews its basis, M and K of the finite-element model are what has to be
// the same. A model.toml that cannot be read leaves the baseline without its
// records.
[[nodiscard]] bool ReadBaseline(const std::string& folder, const Case& c,
                                Baseline* baseline, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_BASELINE_FOLDER_H_
