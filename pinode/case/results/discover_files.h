// Result files of a discovery.

#ifndef PINODE_CASE_RESULTS_DISCOVER_FILES_H_
#define PINODE_CASE_RESULTS_DISCOVER_FILES_H_

#include <string>
#include <vector>

#include "pinode/study/laws/refit.h"

namespace pinode {

// Returns a library function as LaTeX: "x[u1]^3" as x_{\mathrm{u1}}^{3}.
std::string BasisAsLatex(const std::string& basis);

// Returns one block per equation, coefficients with intervals and units.
std::string EquationsAsText(const Discovery& discovery);
// Returns an align environment.
std::string EquationsAsLatex(const Discovery& discovery);
// {"schema": "pinode-discover-1", "refitted", the keys of verdict_json.h,
//  "message",
//  "step_refinement", "dropped": [...], "added": [...],
//  "rivals": [{"without": [...], "with": [...], "log_odds", "fitted"}],
//  "equations": [{"output", "network", "acts_as", "output_rms", "residual",
//                 "uncertainty", "candidates",
//                 "terms": [{"basis", "coefficient", "lower95", "upper95",
//                            "sigma", "unit", "from_network", "share",
//                            "probability", "inclusion_probability"}],
//                 "pareto": [{"terms", "residual", "bic"}]}]}
// Numbers that are not known are null.
std::string DiscoveryAsJson(const Discovery& discovery);

// Writes discover.json, equations.txt and equations.tex to `folder`.
[[nodiscard]] bool WriteDiscoverFiles(const Discovery& discovery,
                                      const std::string& folder,
                                      std::string* error);

// Writes the state of a running refit atomically: {"schema":
// "pinode-discover-checkpoint-1", "problem": hash, "equations": [{"network",
// "output", "terms": [{"basis", "coefficient"}]}]}.
[[nodiscard]] bool WriteDiscoverCheckpoint(
    const std::string& path, const std::string& problem_hash,
    const std::vector<DiscoveredEquation>& equations, std::string* error);

// Reads a checkpoint. *resumed: `regressed` with the terms of the checkpoint.
// Returns false, with *resumed untouched, for another file, another problem, or
// terms that are not among the candidates.
[[nodiscard]] bool ReadDiscoverCheckpoint(
    const std::string& path, const std::string& problem_hash,
    const std::vector<DiscoveredEquation>& regressed,
    std::vector<DiscoveredEquation>* resumed, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_DISCOVER_FILES_H_
