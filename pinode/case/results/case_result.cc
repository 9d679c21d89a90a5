#include "pinode/case/results/case_result.h"

#include "pinode/case/results/finite_element_result.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/results/result_files.h"

namespace pinode {

bool WriteCaseResult(const Case& c, const IdentificationSummary& summary,
                     const IdentifiedModel& model, const ResultFolder& folder,
                     std::string* error) {
  const IdentifiedModel complete = CompleteModel(c.problem, model);
  const std::string& path = folder.working_path();
  return WriteModelCase(c, complete, path, folder.final_path(), error) &&
         WriteFiniteElementResult(c, summary, complete, path, error) &&
         WriteTables(c.problem, summary, complete, path, error);
}

}  // namespace pinode
