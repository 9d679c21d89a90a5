// What the identification of a case leaves on disk.

#ifndef PINODE_CASE_RESULTS_CASE_RESULT_H_
#define PINODE_CASE_RESULTS_CASE_RESULT_H_

#include <string>

#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Writes to folder.working_path() everything that a result folder holds but the
// report: the files of WriteResultFiles, the model case that continues `c`, and
// what goes back to a finite-element program. `summary` and `model` are what
// Identify returned for c.problem, whatever the outcome.
[[nodiscard]] bool WriteCaseResult(const Case& c,
                                   const IdentificationSummary& summary,
                                   const IdentifiedModel& model,
                                   const ResultFolder& folder,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CASE_RESULT_H_
