// Result files of the identification of a case.

#ifndef PINODE_CASE_RESULTS_CASE_RESULT_H_
#define PINODE_CASE_RESULTS_CASE_RESULT_H_

#include <string>

#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Writes to folder.working_path() all files of a result folder but the report:
// the files of WriteResultFiles, the model case that continues `c`, and the
// results for a finite-element program. `summary` and `model` are the results
// of Identify for c.problem, successful or not.
[[nodiscard]] bool WriteCaseResult(const Case& c,
                                   const IdentificationSummary& summary,
                                   const IdentifiedModel& model,
                                   const ResultFolder& folder,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CASE_RESULT_H_
