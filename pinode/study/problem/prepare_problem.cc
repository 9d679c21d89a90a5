#include "pinode/study/problem/prepare_problem.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/estimate/start/free_run_start.h"
#include "pinode/study/problem/network_scales.h"
#include "pinode/study/problem/substeps.h"

namespace pinode {
namespace {

// What SetSubsteps changes of a record.
struct Steps {
  int substeps;
  bool chosen;
  std::optional<Integrator> integrator;
  int exponential_steps;
};

bool Prepare(IdentificationProblem* problem, std::string* error) {
  // Without steps no problem is valid, and steps are chosen for valid problems.
  std::vector<size_t> to_choose;
  for (size_t r = 0; r < problem->records.size(); ++r) {
    if (problem->records[r].substeps != 0) continue;
    to_choose.push_back(r);
    problem->records[r].substeps = 1;
  }
  if (!problem->IsValid(error)) return false;
  for (const size_t r : to_choose) problem->records[r].substeps = 0;
  std::vector<SubstepChoice> choices;
  int failed = 0;
  if (SetSubsteps(problem, &choices, &failed, error)) {
    if (HasNetworksToScale(*problem->dynamics)) {
      auto scaled = std::make_shared<StructuralDynamics>(*problem->dynamics);
      ScaleNetworks(*problem, scaled.get());
      problem->dynamics = std::move(scaled);
    }
    FixTrainingStarts(problem);
    return true;
  }
  *error = "record '" + problem->records[static_cast<size_t>(failed)].name +
           "': " + *error;
  return false;
}

}  // namespace

bool PrepareProblem(IdentificationProblem* problem, std::string* error) {
  CHECK(problem != nullptr);
  CHECK(error != nullptr);
  std::vector<Steps> before;
  for (const IdentificationRecord& record : problem->records) {
    before.push_back({record.substeps, record.substeps_chosen,
                      record.integrator, record.exponential_steps});
  }
  if (Prepare(problem, error)) return true;
  for (size_t r = 0; r < before.size(); ++r) {
    problem->records[r].substeps = before[r].substeps;
    problem->records[r].substeps_chosen = before[r].chosen;
    problem->records[r].integrator = before[r].integrator;
    problem->records[r].exponential_steps = before[r].exponential_steps;
  }
  return false;
}

}  // namespace pinode
