// What an identification leaves on disk.

#ifndef PINODE_CASE_RESULT_FILES_H_
#define PINODE_CASE_RESULT_FILES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/case/case_file.h"
#include "pinode/case/result_folder.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

// The time of each sample in the unit of the record's file.
Vector FileTimes(const IdentificationRecord& record);

// Writes to folder.working_path() everything that a result folder holds but the
// report (see pinode/case/README.md): result.json, parameters.csv,
// covariance.csv, history.csv, prediction_<record>.csv, force_<name>.csv,
// initial_states.csv, what goes back to a finite-element program, the model
// case with its matrices and networks, folded matrices where there are any, and
// checkpoint.json. `summary` and `model` are what Identify returned for `c`,
// whatever the outcome.
[[nodiscard]] bool WriteResultFiles(const Case& c,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    const ResultFolder& folder,
                                    std::string* error);

// The text of result.json.
[[nodiscard]] bool FormatResultJson(const Case& c,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    std::string* text, std::string* error);

// What a simulation has to say beside its responses.
struct SimulationSummary {
  struct Record {
    std::string name;
    int num_samples = 0;
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

#endif  // PINODE_CASE_RESULT_FILES_H_
