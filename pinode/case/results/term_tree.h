// Identified terms as a case file writes them.

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

// Returns the tree of a case of `model` with these candidates as further
// [[group]] and [[library]] (AddCandidates).
TomlValue TreeWithCandidates(TomlValue tree, const StructuralModel& model,
                             const std::vector<ChangeCandidate>& candidates);

// Returns the tree with [[library]] in place of the networks in `equations`,
// and with `substeps` (one per record) if it is not empty
// (MakeDiscoveredProblem). [discover] is removed, because the search is
// complete.
TomlValue TreeWithEquations(TomlValue tree,
                            const std::vector<DiscoveredEquation>& equations,
                            const std::vector<int>& substeps);

// Returns the tree of a case with `dynamics` after a choice among its
// candidates. Elements and terms of libraries that were left out, by name
// (ModelCandidate), are removed with all references to them. No candidates
// remain.
TomlValue TreeAfterChoice(TomlValue tree, const StructuralDynamics& dynamics,
                          const std::vector<std::string>& left_out);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_TERM_TREE_H_
