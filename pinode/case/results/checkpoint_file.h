// A fit that was cut off, on disk.

#ifndef PINODE_CASE_RESULTS_CHECKPOINT_FILE_H_
#define PINODE_CASE_RESULTS_CHECKPOINT_FILE_H_

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_profile.h"
#include "pinode/study/problem/checkpoint.h"

namespace pinode {

// {"schema": "pinode-checkpoint-1", "problem": hash, "iteration", "stage",
//  "cost", "parameters": [...], "sigmas": [[...]], "starts": [[...]],
//  "decays": [...]} and, where profiles of the likelihood are done,
//  "profiles": [{...}], where terms are chosen, "choice": {...}
//  (choice_json.h),
// written atomically; numbers are read back bit for bit.
[[nodiscard]] bool WriteCheckpoint(const std::string& path,
                                   const std::string& problem_hash,
                                   const Checkpoint& checkpoint,
                                   std::string* error);

// Fails, with *checkpoint untouched, on a file that is not a checkpoint of this
// problem (by ProblemIdentity), with or without what its choice has left out.
// Where the basis of a reduction was renewed, the
// starts in it are of a basis near that of the values in it.
[[nodiscard]] bool ReadCheckpoint(const std::string& path,
                                  const IdentificationProblem& problem,
                                  Checkpoint* checkpoint, std::string* error);

// Keeps the file at `path` up to date while a fit runs: call Update in
// IdentificationOptions::callback. Writes at most once in `interval`, and at
// once the first time.
class CheckpointWriter {
 public:
  CheckpointWriter(
      std::string problem_hash, std::string path,
      std::chrono::milliseconds interval = std::chrono::milliseconds(1000));

  // Sets the choice that was made before the fit begins.
  void set_choice(ModelChoice choice) { choice_ = std::move(choice); }
  // Profiles of the fit that this one goes on from: they are not lost if it is
  // cut off before its own.
  void set_profiles(std::vector<ParameterProfile> profiles) {
    profiles_ = std::move(profiles);
  }

  // False, with *error, where the file cannot be written: the fit may go on.
  [[nodiscard]] bool Update(const IdentificationProgress& progress,
                            std::string* error);

 private:
  std::string path_;
  std::string problem_hash_;
  std::chrono::milliseconds interval_;
  ModelChoice choice_;
  std::vector<ParameterProfile> profiles_;
  bool written_ = false;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CHECKPOINT_FILE_H_
