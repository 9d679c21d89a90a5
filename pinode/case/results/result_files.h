// Result files of an identification.

#ifndef PINODE_CASE_RESULTS_RESULT_FILES_H_
#define PINODE_CASE_RESULTS_RESULT_FILES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Return the times of samples in the unit of the record's file.
double FileTime(const IdentificationRecord& record, Eigen::Index sample);
Vector FileTimes(const IdentificationRecord& record);

// Writes the results of Identify for `problem`, successful or not, to `folder`,
// which is created if it does not exist. The files (see pinode/case/README.md)
// are result.json, parameters.csv, covariance.csv, history.csv,
// prediction_<record>.csv, force_<name>.csv, initial_states.csv, M.mtx, C.mtx,
// K.mtx, network_<name>.json, folded matrices if there are any, and
// checkpoint.json. WriteCaseResult adds model.toml, which needs the case file.
// WriteHtmlReport adds the report. Returns false, with *error, if a file cannot
// be written. The same, before any file is written, if the problem is not valid
// or the summary belongs to another one.
[[nodiscard]] bool WriteResultFiles(const IdentificationProblem& problem,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    const std::string& folder,
                                    std::string* error);

// Writes the same without matrices and networks, to an existing folder. `model`
// is complete.
[[nodiscard]] bool WriteTables(const IdentificationProblem& problem,
                               const IdentificationSummary& summary,
                               const IdentifiedModel& model,
                               const std::string& folder, std::string* error);

// Returns `model`, or the initial model if a fit could not begin and left none.
IdentifiedModel CompleteModel(const IdentificationProblem& problem,
                              const IdentifiedModel& model);

// Formats the text of result.json.
[[nodiscard]] bool FormatResultJson(const IdentificationProblem& problem,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    std::string* text, std::string* error);

// Summary of a simulation, written with its responses.
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
