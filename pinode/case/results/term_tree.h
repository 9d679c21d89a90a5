// Terms that were found, as a case file writes them.

#ifndef PINODE_CASE_RESULTS_TERM_TREE_H_
#define PINODE_CASE_RESULTS_TERM_TREE_H_

#include <string>
#include <vector>

#include "pinode/case/text/toml_value.h"
#include "pinode/discover/discovery.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/study/damage/change_candidates.h"

namespace pinode {

// The tree of a case of `model` with these candidates as further [[group]] and
// [[library]] (AddCandidates).
TomlValue TreeWithCandidates(TomlValue tree, const StructuralModel& model,
                             const std::vector<ChangeCandidate>& candidates);

// The tree with [[library]] in place of the networks that `equations` speak of,
// and with `substeps` (one a record) where it is not empty
// (MakeDiscoveredProblem); without [discover]: nothing is looked for in what is
// left.
TomlValue TreeWithEquations(TomlValue tree,
                            const std::vector<DiscoveredEquation>& equations,
                            const std::vector<int>& substeps);

// The tree of a case with `dynamics` after a choice among its candidates:
// without the elements and terms of libraries that were left out, by name
// (ModelCandidate), and whatever speaks of them; nothing is left to be chosen.
TomlValue TreeAfterChoice(TomlValue tree, const StructuralDynamics& dynamics,
                          const std::vector<std::string>& left_out);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_TERM_TREE_H_
