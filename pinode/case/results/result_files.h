// What an identification leaves on disk.

#ifndef PINODE_CASE_RESULTS_RESULT_FILES_H_
#define PINODE_CASE_RESULTS_RESULT_FILES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// The times of samples in the unit of the record's file.
double FileTime(const IdentificationRecord& record, Eigen::Index sample);
Vector FileTimes(const IdentificationRecord& record);

// Writes to `folder`, which is created where it is not there, what came out of
// Identify for `problem`, whatever the outcome (see pinode/case/README.md for
// each file): result.json, parameters.csv, covariance.csv, history.csv,
// prediction_<record>.csv, force_<name>.csv, initial_states.csv, M.mtx, C.mtx,
// K.mtx, network_<name>.json, folded matrices where there are any, and
// checkpoint.json. model.toml needs the case file of which it is the
// continuation (WriteCaseResult), the report what `report` knows
// (WriteHtmlReport). False, with *error, where the problem is not valid or the
// summary is of another one, before anything is written, and where a file
// cannot be written.
[[nodiscard]] bool WriteResultFiles(const IdentificationProblem& problem,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    const std::string& folder,
                                    std::string* error);

// The same without matrices and networks, to a folder that is there. `model` is
// complete.
[[nodiscard]] bool WriteTables(const IdentificationProblem& problem,
                               const IdentificationSummary& summary,
                               const IdentifiedModel& model,
                               const std::string& folder, std::string* error);

// `model`, or, of a fit that could not begin and left none, the one before it.
IdentifiedModel CompleteModel(const IdentificationProblem& problem,
                              const IdentifiedModel& model);

// The text of result.json.
[[nodiscard]] bool FormatResultJson(const IdentificationProblem& problem,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    std::string* text, std::string* error);

// What a simulation has to say beside its responses.
struct SimulationSummary {
  struct Record {
    std::string name;
    Eigen::Index num_samples = 0;
    bool finite = false;
  };
  std::string case_path;
  double noise_percent = 0.0;  // of each channel's standard deviation
  std::uint64_t seed = 0;      // of the noise
  std::vector<Record> records;
};

// Writes {"schema": "pinode-simulate-1", "case", "noise_percent", "seed",
// "records": [{"name", "samples", "finite"}]}.
[[nodiscard]] bool WriteSimulationSummary(const std::string& path,
                                          const SimulationSummary& summary,
                                          std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_RESULT_FILES_H_
