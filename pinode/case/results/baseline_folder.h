// Reading of baseline results, to compare a new state with.

#ifndef PINODE_CASE_RESULTS_BASELINE_FOLDER_H_
#define PINODE_CASE_RESULTS_BASELINE_FOLDER_H_

#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/study/damage/baseline.h"

namespace pinode {

// Reads a result folder of pinode_update as a baseline of the structure of the
// case. It uses result.json, covariance.csv and matrices, for the groups to be
// compared (FreeGroups). If the case searches for other kinds of change, it
// also reads model.toml as a problem that is not fitted yet.
//
// The following are refused, with *error naming file and group:
//
// - a folder that is not a result, or whose result is not usable;
// - a group that the result lacks or has fixed;
// - a group whose matrix differs from that of the case (another structure);
// - other units.
//
// If the case renews its basis, M and K of the finite-element model are
// compared instead. If model.toml cannot be read, the baseline has no records.
[[nodiscard]] bool ReadBaseline(const std::string& folder, const Case& c,
                                Baseline* baseline, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_BASELINE_FOLDER_H_
