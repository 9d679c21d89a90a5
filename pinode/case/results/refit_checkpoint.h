// What a refit of equations leaves on its way, to go on from.

#ifndef PINODE_CASE_RESULTS_REFIT_CHECKPOINT_H_
#define PINODE_CASE_RESULTS_REFIT_CHECKPOINT_H_

#include <chrono>
#include <string>
#include <vector>

#include "pinode/case/results/result_folder.h"
#include "pinode/discover/discovery.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Of a folder that this process writes, or follows; elsewhere it does nothing.
class RefitCheckpoint {
 public:
  // `folder` must outlive this object; `problem` is that of the networks.
  RefitCheckpoint(const ResultFolder& folder,
                  const IdentificationProblem& problem);

  // Where the folder resumes: `regressed` with the terms that the refit had
  // come to; else nothing. False, with *error, for what is no such checkpoint.
  [[nodiscard]] bool Read(const std::vector<DiscoveredEquation>& regressed,
                          std::vector<DiscoveredEquation>* resumed,
                          std::string* error) const;

  // At most once a second.
  void Save(const std::vector<DiscoveredEquation>& equations);
  // Why Save could not write, the first time that it could not; else empty.
  const std::string& trouble() const { return trouble_; }

  // What an interrupted refit ends with.
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
