#include "pinode/case/results/refit_checkpoint.h"

#include "pinode/case/results/discover_files.h"
#include "pinode/study/problem/checkpoint.h"

namespace pinode {

RefitCheckpoint::RefitCheckpoint(const ResultFolder& folder,
                                 const IdentificationProblem& problem)
    : folder_(folder), problem_hash_(ProblemIdentity(problem)) {}

bool RefitCheckpoint::Read(const std::vector<DiscoveredEquation>& regressed,
                           std::vector<DiscoveredEquation>* resumed,
                           std::string* error) const {
  resumed->clear();
  return folder_.resume_path().empty() ||
         ReadDiscoverCheckpoint(folder_.resume_path(), problem_hash_, regressed,
                                resumed, error);
}

void RefitCheckpoint::Save(const std::vector<DiscoveredEquation>& equations) {
  if (!folder_.writes()) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - written_ < std::chrono::seconds(1)) return;
  written_ = now;
  std::string error;
  if (!Write(equations, &error) && trouble_.empty()) trouble_ = error;
}

bool RefitCheckpoint::Write(const std::vector<DiscoveredEquation>& equations,
                            std::string* error) const {
  return WriteDiscoverCheckpoint(folder_.checkpoint_path(), problem_hash_,
                                 equations, error);
}

}  // namespace pinode
