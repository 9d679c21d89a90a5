// Checkpoints from which a refit of equations continues.

#ifndef PINODE_CASE_RESULTS_REFIT_CHECKPOINT_H_
#define PINODE_CASE_RESULTS_REFIT_CHECKPOINT_H_

#include <chrono>
#include <string>
#include <vector>

#include "pinode/case/results/result_folder.h"
#include "pinode/discover/discovery.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Checkpoint in a folder that this process writes, or follows; otherwise it has
// no effect.
class RefitCheckpoint {
 public:
  // Keeps a reference to `folder`, which must outlive this object; `problem` is
  // that of the networks.
  RefitCheckpoint(const ResultFolder& folder,
                  const IdentificationProblem& problem);

  // Reads the checkpoint if the folder resumes: *resumed is `regressed` with
  // the refit's terms so far, else empty. Returns false, with *error, if the
  // file is no such checkpoint.
  [[nodiscard]] bool Read(const std::vector<DiscoveredEquation>& regressed,
                          std::vector<DiscoveredEquation>* resumed,
                          std::string* error) const;

  // Saves the equations, at most once a second.
  void Save(const std::vector<DiscoveredEquation>& equations);
  // Error of the first Save that failed; else empty.
  const std::string& trouble() const { return trouble_; }

  // Writes the final state of an interrupted refit.
  [[nodiscard]] bool Write(const std::vector<DiscoveredEquation>& equations,
                           std::string* error) const;

 private:
  const ResultFolder& folder_;
  const std::string problem_hash_;
  std::chrono::steady_clock::time_point written_;
  std::string trouble_;
};

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_REFIT_CHECKPOINT_H_
