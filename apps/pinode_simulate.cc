// The response of a case's model to its records' excitations, as sensors would
// show it, with noise if asked for.
//
// Sample run:
//   pinode_simulate --case=data/three_storey/three_storey.toml --output_dir=out

#include <gflags/gflags.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "apps/program.h"
#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/case/case_file.h"
#include "pinode/case/csv_file.h"
#include "pinode/case/result_files.h"
#include "pinode/case/result_folder.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/estimate/score.h"

DEFINE_string(case, "", "case file (TOML); see pinode/case/README.md");
DEFINE_string(output_dir, "",
              "folder for the responses; must not exist without --overwrite");
DEFINE_bool(overwrite, false, "replace an existing output folder");
DEFINE_double(noise_percent, -1.0,
              "noise in per cent of each channel's standard deviation; "
              "negative: as the case says");
DEFINE_int64(seed, -1, "seed of the noise; negative: as the case says");

namespace pinode {
namespace {

// Standard normal numbers that are the same with every standard library.
class Gaussian {
 public:
  explicit Gaussian(uint64_t seed) : random_(seed) {}
  double operator()() {
    // Box-Muller; the second number is not kept.
    // Two statements: compilers may evaluate factors in either order.
    const double radius = std::sqrt(-2.0 * std::log(Uniform()));
    return radius * std::cos(kTwoPi * Uniform());
  }

 private:
  double Uniform() {
    return (static_cast<double>(random_() >> 11) + 0.5) * 0x1.0p-53;
  }
  std::mt19937_64 random_;
};

// The first sample at which a channel (row) is not finite, else the last one.
Eigen::Index FirstNotFinite(const Matrix& channels) {
  Eigen::Index i = 0;
  while (i + 1 < channels.cols() && channels.col(i).allFinite()) ++i;
  return i;
}

}  // namespace
}  // namespace pinode

int main(int argc, char** argv) {
  using namespace pinode;
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_simulate --case=FILE --output_dir=FOLDER\n\n"
                  "Writes the response of the model to each record's "
                  "excitation, response_<record>.csv.",
                  &status)) {
    return status;
  }
  if (FLAGS_case.empty()) return Refuse("--case=FILE is missing; see --help");
  if (FLAGS_output_dir.empty()) {
    return Refuse("--output_dir=FOLDER is missing; see --help");
  }
  if (!std::isfinite(FLAGS_noise_percent)) {
    return Refuse("--noise_percent must be finite");
  }
  std::string error;
  if (!CheckOutputFolder(FLAGS_output_dir, FLAGS_overwrite, false, &error)) {
    return Refuse(error);
  }
  Case c;
  if (!ReadCaseForSimulation(FLAGS_case, &c, &error)) return Refuse(error);
  const double noise =
      FLAGS_noise_percent >= 0.0 ? FLAGS_noise_percent : c.noise_percent;
  SimulationSummary summary;
  summary.case_path = c.path;
  summary.noise_percent = noise;
  summary.seed =
      FLAGS_seed >= 0 ? static_cast<uint64_t>(FLAGS_seed) : c.noise_seed;
  Gaussian gaussian(summary.seed);
  ResultFolder folder;
  if (!folder.Open(FLAGS_output_dir, FLAGS_overwrite, false, &error)) {
    return Refuse(error);
  }

  const ParameterLayout layout(c.problem);
  const Vector parameters = layout.InitialValues();
  int exit_status = kExitDone;
  for (size_t r = 0; r < c.problem.records.size(); ++r) {
    const IdentificationRecord& record = c.problem.records[r];
    const Vector start =
        record.start == IdentificationRecord::Start::kKnown
            ? record.known_start
            : Vector(Vector::Zero(c.problem.dynamics->num_states()));
    if (record.start == IdentificationRecord::Start::kFree) {
      std::printf("record %s: its start is unknown, simulated from rest\n",
                  record.name.c_str());
    }
    RecordScore score;
    ScoreRecord(c.problem, static_cast<int>(r), parameters, start, 0, &score);
    const Vector times = FileTimes(record);
    if (!score.finite) {
      std::fprintf(stderr,
                   "record %s: the response is not finite from t = %g %s on\n",
                   record.name.c_str(), times[FirstNotFinite(score.prediction)],
                   record.description.time_unit.c_str());
      exit_status = kExitNotUsable;
    }
    summary.records.push_back(
        {record.name, record.num_samples(), score.finite});
    std::vector<CsvColumn> columns;
    columns.push_back({"t", times});
    std::printf("record %s: %d samples\n", record.name.c_str(),
                record.num_samples());
    for (size_t i = 0; i < record.channels.size(); ++i) {
      const MeasuredChannel& channel = record.channels[i];
      const std::string& name = channel.observation.name;
      const std::string unit = c.problem.UnitOf(channel);
      Vector values = score.prediction.row(static_cast<int>(i)).transpose() /
                      channel.description.factor;
      const double spread = StandardDeviationOfPresent(values);
      for (double& value : values) value += 0.01 * noise * spread * gaussian();
      std::printf("  %-16s standard deviation %.4g %s, largest %.4g %s\n",
                  name.c_str(), spread, unit.c_str(),
                  values.cwiseAbs().maxCoeff(), unit.c_str());
      columns.push_back({name, std::move(values)});
    }
    if (!WriteCsv(folder.working_path() + "/response_" + record.name + ".csv",
                  columns, &error)) {
      return Refuse(error);
    }
  }
  if (!WriteSimulationSummary(folder.working_path() + "/simulate.json", summary,
                              &error) ||
      !folder.Commit(&error)) {
    return Refuse(error);
  }
  std::printf("Responses: %s\n", folder.final_path().c_str());
  return exit_status;
}
