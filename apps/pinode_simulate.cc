// Simulates the sensor values of a case's model under its records' excitations,
// with noise on request, or its periodic responses to a harmonic load.
//
// Sample run:
//   pinode_simulate --case=data/three_storey/three_storey.toml --output_dir=out

#include <gflags/gflags.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "apps/launcher.h"
#include "apps/print.h"
#include "apps/program.h"
#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/case/results/matlab_results.h"
#include "pinode/case/results/result_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/harmonic_sweep.h"
#include "pinode/study/problem/simulation.h"

DEFINE_string(
    case, "",
    "case file (TOML); format: see case_files.md (in the source tree: "
    "pinode/case/README.md)");
DEFINE_string(output_dir, "",
              "folder for the responses; must not exist without --overwrite");
DEFINE_bool(overwrite, false, "replace an existing output folder");
DEFINE_bool(mat, false,
            "also write results.mat for MATLAB and Octave, with all responses");
DEFINE_double(noise_percent, -1.0,
              "noise in per cent of each channel's standard deviation; "
              "negative: as in the case");
DEFINE_int64(seed, -1, "seed of the noise; negative: as in the case");
DEFINE_string(sweep, "",
              "load of the case, such as force_u1 or ground_x: instead of the "
              "records, its harmonic sweep is simulated");
DEFINE_string(sweep_hz, "",
              "first and last frequency of the sweep, such as 0.5:8; the first "
              "may be the larger one");
DEFINE_double(sweep_amplitude, 1.0,
              "amplitude of the sweep's load in the model's units");
DEFINE_int32(sweep_points, 200, "number of points of the sweep");

namespace pinode {
namespace {

bool IsGiven(const char* flag) {
  return !gflags::GetCommandLineFlagInfoOrDie(flag).is_default;
}

// Reads --sweep_hz. Returns false, with *error, if it is no pair of numbers.
bool ParseSweepHz(double* from, double* to, std::string* error) {
  const size_t colon = FLAGS_sweep_hz.find(':');
  if (colon != std::string::npos &&
      ParseDouble(FLAGS_sweep_hz.substr(0, colon), from) &&
      ParseDouble(FLAGS_sweep_hz.substr(colon + 1), to)) {
    return true;
  }
  *error = "--sweep_hz is '" + FLAGS_sweep_hz +
           "', expected first and last frequency in Hz, such as 0.5:8";
  return false;
}

bool CheckFlags(std::string* error) {
  if (FLAGS_case.empty()) {
    *error = "--case=FILE is missing; see --help";
  } else if (FLAGS_output_dir.empty()) {
    *error = "--output_dir=FOLDER is missing; see --help";
  } else if (!std::isfinite(FLAGS_noise_percent)) {
    *error = "--noise_percent must be finite";
  } else if (FLAGS_sweep.empty() &&
             (IsGiven("sweep_hz") || IsGiven("sweep_amplitude") ||
              IsGiven("sweep_points"))) {
    *error =
        "--sweep_hz, --sweep_amplitude and --sweep_points need --sweep, "
        "the name of a load";
  } else if (!FLAGS_sweep.empty() && FLAGS_sweep_hz.empty()) {
    *error = "--sweep needs --sweep_hz, such as --sweep_hz=0.5:8";
  } else if (!FLAGS_sweep.empty() &&
             (IsGiven("noise_percent") || IsGiven("seed"))) {
    *error = "a sweep has no noise; leave out --noise_percent and --seed";
  } else {
    return CheckOutputFolder(FLAGS_output_dir, FLAGS_overwrite, false, error);
  }
  return false;
}

// Returns the sensor values of `record`: times and one column per channel, each
// with noise of `percent` of its standard deviation; negative: of its own
// sigma.
std::vector<CsvColumn> SensorColumns(const IdentificationProblem& problem,
                                     const IdentificationRecord& record,
                                     const Matrix& sensors, double percent,
                                     SensorNoise* noise) {
  std::vector<CsvColumn> columns;
  columns.push_back({"t", FileTimes(record)});
  Print("record %s: %td samples\n", record.name.c_str(), record.num_samples());
  for (size_t i = 0; i < record.channels.size(); ++i) {
    const MeasuredChannel& channel = record.channels[i];
    const std::string& name = channel.observation.name;
    const std::string unit = problem.UnitOf(channel);
    Vector values = sensors.row(static_cast<int>(i)).transpose();
    const double spread = StandardDeviationOfPresent(values);
    noise->AddTo(percent < 0.0 ? OwnNoisePercent(channel, values) : percent,
                 &values);
    Print("  %-16s standard deviation %.4g %s, largest %.4g %s\n", name.c_str(),
          spread, unit.c_str(), values.cwiseAbs().maxCoeff(), unit.c_str());
    columns.push_back({name, std::move(values)});
  }
  return columns;
}

// Simulates record r and writes response_<record>.csv. *finite: true if the
// response is finite.
bool WriteResponse(const IdentificationProblem& problem, size_t r,
                   const Vector& parameters, double percent, SensorNoise* noise,
                   const std::string& folder, bool* finite,
                   std::string* error) {
  const IdentificationRecord& record = problem.records[r];
  const SimulatedResponse response =
      SimulateRecord(problem, static_cast<int>(r), parameters);
  *finite = response.finite;
  if (!response.remark.empty()) {
    Print("record %s: %s\n", record.name.c_str(), response.remark.c_str());
  }
  if (!response.finite) {
    PrintError("record %s: the response is not finite from t = %g %s on",
               record.name.c_str(),
               FileTimes(record)[response.first_not_finite],
               record.description.time_unit.c_str());
  }
  return WriteCsv(
      folder + "/response_" + record.name + ".csv",
      SensorColumns(problem, record, response.sensors, percent, noise), error);
}

// Prints between which frequencies the response is not stable, and how many
// points are not judged.
void PrintStability(const std::vector<SweepPoint>& points) {
  for (size_t i = 0; i < points.size();) {
    if (!points[i].IsUnstable()) {
      ++i;
      continue;
    }
    size_t end = i;
    while (end + 1 < points.size() && points[end + 1].IsUnstable()) ++end;
    const auto [from, to] =
        std::minmax(points[i].frequency_hz, points[end].frequency_hz);
    Print(
        "  not stable from %.4g to %.4g Hz, points %zu to %zu: the structure "
        "leaves this response for another one\n",
        from, to, i + 1, end + 1);
    i = end + 1;
  }
  const auto unknown =
      std::count_if(points.begin(), points.end(), [](const SweepPoint& point) {
        return std::isnan(point.largest_multiplier);
      });
  if (unknown > 0) {
    Print("  %td of %zu points: it is not known if they are stable\n", unknown,
          points.size());
  }
}

// Prints the largest response of each channel, and what is to be known of the
// points.
void PrintSweep(const IdentificationProblem& problem,
                const IdentificationRecord& record,
                const std::vector<SweepPoint>& points) {
  Print("sweep of %s: %zu points\n", FLAGS_sweep.c_str(), points.size());
  for (size_t i = 0; i < record.channels.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const auto largest =
        std::max_element(points.begin(), points.end(),
                         [row](const SweepPoint& a, const SweepPoint& b) {
                           return a.half_range[row] < b.half_range[row];
                         });
    Print("  %-16s largest half range %.4g %s, at %.4g Hz\n",
          record.channels[i].observation.name.c_str(), largest->half_range[row],
          problem.UnitOf(record.channels[i]).c_str(), largest->frequency_hz);
  }
  PrintStability(points);
  constexpr double kUseful = 1e-3;
  const auto useless = std::count_if(
      points.begin(), points.end(),
      [](const SweepPoint& point) { return !(point.neglected < kUseful); });
  if (useless > 0) {
    Print(
        "  %td of %zu points leave out harmonics of more than %g of the "
        "response: do not use them ('neglected' in sweep.csv)\n",
        useless, points.size(), kUseful);
  }
}

// Writes sweep.csv.
bool WriteSweep(const IdentificationRecord& record,
                const std::vector<SweepPoint>& points,
                const std::string& folder, std::string* error) {
  std::vector<CsvColumn> columns;
  const auto add = [&](const std::string& name, auto value) {
    columns.push_back({name, static_cast<Eigen::Index>(points.size()),
                       [&points, value](Eigen::Index row) -> double {
                         return value(points[static_cast<size_t>(row)]);
                       }});
  };
  add("frequency_hz", [](const SweepPoint& p) { return p.frequency_hz; });
  for (size_t i = 0; i < record.channels.size(); ++i) {
    const auto c = static_cast<Eigen::Index>(i);
    const std::string& name = record.channels[i].observation.name;
    add(name, [c](const SweepPoint& p) { return p.half_range[c]; });
    add(name + "_amplitude",
        [c](const SweepPoint& p) { return p.amplitude[c]; });
    add(name + "_phase_deg",
        [c](const SweepPoint& p) { return 360.0 / kTwoPi * p.phase[c]; });
  }
  add("largest_multiplier",
      [](const SweepPoint& p) { return p.largest_multiplier; });
  add("num_harmonics", [](const SweepPoint& p) { return p.num_harmonics; });
  add("neglected", [](const SweepPoint& p) { return p.neglected; });
  return WriteCsv(folder + "/sweep.csv", columns, error);
}

// Runs the sweep instead of the records. Returns the program's exit status.
int RunSweep(const Case& c) {
  std::string error;
  HarmonicLoad load;
  load.input = FLAGS_sweep;
  load.amplitude = FLAGS_sweep_amplitude;
  load.num_points = FLAGS_sweep_points;
  if (!ParseSweepHz(&load.from_hz, &load.to_hz, &error)) return Refuse(error);
  if (c.problem.records.empty()) {
    return Refuse("a sweep needs a record, which names loads and channels");
  }
  std::set<std::string> names = {"frequency_hz", "largest_multiplier",
                                 "num_harmonics", "neglected"};
  for (const MeasuredChannel& channel : c.problem.records[0].channels) {
    const std::string& name = channel.observation.name;
    for (const char* part : {"", "_amplitude", "_phase_deg"}) {
      if (!names.insert(name + part).second) {
        return Refuse("sweep.csv would have two columns '" + name + part +
                      "'; rename channel '" + name + "'");
      }
    }
  }
  std::vector<SweepPoint> points;
  const bool finished =
      SweepRecord(c.problem, 0, ParameterLayout(c.problem).InitialValues(),
                  load, {}, &points, &error);
  if (points.size() < 2) return Refuse(error);
  if (!finished) {
    PrintError("%s; sweep.csv has the points so far", error.c_str());
  }
  const IdentificationRecord& record = c.problem.records[0];
  PrintSweep(c.problem, record, points);

  SimulationSummary summary;
  summary.case_path = c.path;
  summary.sweep = {load.input, load.amplitude, load.from_hz,
                   load.to_hz, points.size(),  finished};
  ResultFolder folder;
  CatchInterrupts();
  if (!folder.Open(FLAGS_output_dir, FLAGS_overwrite, false, &error)) {
    return Refuse(error);
  }
  if (!WriteSweep(record, points, folder.working_path(), &error) ||
      !WriteSimulationSummary(folder.working_path() + "/simulate.json", summary,
                              &error) ||
      (FLAGS_mat && !WriteMatlabResults(folder.working_path(), &error)) ||
      !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }
  Print("Sweep: %s\n", folder.final_path().c_str());
  return finished ? kExitDone : kExitNotUsable;
}

}  // namespace

int RunProgram(int argc, char** argv) {
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_simulate --case=FILE --output_dir=FOLDER\n\n"
                  "Simulates the response to the excitation of each record and "
                  "writes response_<record>.csv. With --sweep=LOAD "
                  "--sweep_hz=FROM:TO it follows the periodic responses to a "
                  "harmonic load, stable or not, and writes sweep.csv.",
                  &status)) {
    return status;
  }
  if (NumLaunchedRanks() > 1) {
    return Refuse("pinode_simulate runs in one process, expected no launcher");
  }

  // 1. All checks of the input, before any work.
  std::string error;
  Case c;
  if (!CheckFlags(&error) || !ReadCaseForSimulation(FLAGS_case, &c, &error)) {
    return Refuse(error);
  }
  if (!FLAGS_sweep.empty()) return RunSweep(c);
  SimulationSummary summary;
  summary.case_path = c.path;
  summary.noise_percent =
      FLAGS_noise_percent >= 0.0 ? FLAGS_noise_percent : c.noise_percent;
  const bool by_sigma = FLAGS_noise_percent < 0.0 && c.noise_is_sigma;
  summary.seed =
      FLAGS_seed >= 0 ? static_cast<uint64_t>(FLAGS_seed) : c.noise_seed;

  // 2. A response for each record.
  ResultFolder folder;
  CatchInterrupts();
  if (!folder.Open(FLAGS_output_dir, FLAGS_overwrite, false, &error)) {
    return Refuse(error);
  }
  SensorNoise noise(summary.seed);
  const Vector parameters = ParameterLayout(c.problem).InitialValues();
  bool all_finite = true;
  for (size_t r = 0; r < c.problem.records.size(); ++r) {
    bool finite = false;
    if (!WriteResponse(c.problem, r, parameters,
                       by_sigma ? -1.0 : summary.noise_percent, &noise,
                       folder.working_path(), &finite, &error)) {
      return CannotWrite(error, folder);
    }
    const IdentificationRecord& record = c.problem.records[r];
    summary.records.push_back({record.name, record.num_samples(), finite});
    all_finite = all_finite && finite;
  }

  // 3. Settings of the simulation.
  if (!WriteSimulationSummary(folder.working_path() + "/simulate.json", summary,
                              &error) ||
      (FLAGS_mat && !WriteMatlabResults(folder.working_path(), &error)) ||
      !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }
  Print("Responses: %s\n", folder.final_path().c_str());
  return all_finite ? kExitDone : kExitNotUsable;
}

}  // namespace pinode
