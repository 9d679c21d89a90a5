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

// Return the time of one sample, and of all samples, in the unit of time of the
// record's file. `sample` counts from 0.
double FileTime(const IdentificationRecord& record, Eigen::Index sample);
Vector FileTimes(const IdentificationRecord& record);

// Writes the results of Identify for `problem` to `folder`, also those of a fit
// that failed. The folder is created if it does not exist.
//
// pinode/case/README.md describes the files:
// - result.json, parameters.csv, covariance.csv, history.csv;
// - prediction_<record>.csv, force_<name>.csv, initial_states.csv;
// - M.mtx, C.mtx, K.mtx, and folded matrices if there are any;
// - network_<name>.json and checkpoint.json.
// WriteCaseResult adds model.toml, which needs the case file. WriteHtmlReport
// adds the report.
//
// Returns false, with *error, if a file cannot be written. Writes no file and
// returns false if the problem is not valid or the summary belongs to another
// problem.
[[nodiscard]] bool WriteResultFiles(const IdentificationProblem& problem,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    const std::string& folder,
                                    std::string* error);

// Writes the same files without matrices and networks, to an existing folder.
// `model` must come from CompleteModel.
[[nodiscard]] bool WriteTables(const IdentificationProblem& problem,
                               const IdentificationSummary& summary,
                               const IdentifiedModel& model,
                               const std::string& folder, std::string* error);

// Returns `model`. If the fit could not begin and left no model, returns the
// problem's initial model.
IdentifiedModel CompleteModel(const IdentificationProblem& problem,
                              const IdentifiedModel& model);

// Formats the text of result.json. Returns false, with *error, as
// WriteResultFiles does.
[[nodiscard]] bool FormatResultJson(const IdentificationProblem& problem,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    std::string* text, std::string* error);

// Summary of a simulation, written with its responses.
struct SimulationSummary {
  // One simulated record.
  struct Record {
    std::string name;
    Eigen::Index num_samples = 0;
    // False if the integration diverged.
    bool finite = false;
  };
  // Path of the case file that was simulated.
  std::string case_path;
  // Added noise in per cent of the standard deviation of each channel, and the
  // seed of its random numbers.
  double noise_percent = 0.0;
  std::uint64_t seed = 0;
  std::vector<Record> records;
  // Harmonic sweep; without points if there was none.
  struct Sweep {
    std::string load;
    double amplitude = 0.0;  // in the model's units
    double from_hz = 0.0;
    double to_hz = 0.0;
    size_t num_points = 0;
    bool finished = false;
  };
  Sweep sweep;
};

// Writes {"schema": "pinode-simulate-1", "case", "noise_percent", "seed",
// "records": [{"name", "samples", "finite"}]} to the file `path`, and "sweep":
// {"load", "amplitude", "from_hz", "to_hz", "points", "finished"} if there was
// one. Returns false, with *error, if the file cannot be written.
[[nodiscard]] bool WriteSimulationSummary(const std::string& path,
                                          const SimulationSummary& summary,
                                          std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_RESULT_FILES_H_
