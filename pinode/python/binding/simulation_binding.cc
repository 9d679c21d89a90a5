#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/case/results/matlab_results.h"
#include "pinode/case/results/result_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/python/binding/watch.h"
#include "pinode/study/problem/harmonic_sweep.h"
#include "pinode/study/problem/simulation.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

// Noise of the sensors: per cent of each channel's standard deviation, or each
// channel's own sigma.
struct NoiseRequest {
  double percent = 0.0;
  bool is_sigma = false;
};

NoiseRequest NoiseOf(const Case& c, double percent, const py::object& noise) {
  if (!noise.is_none() &&
      Cast<std::string>(noise, "noise", "'sigma' or None") != "sigma") {
    throw Error("noise is '" + noise.cast<std::string>() +
                "', expected 'sigma' or None");
  }
  if (!(percent < 1e6)) {
    throw Error("noise_percent must be a finite number");
  }
  if (!noise.is_none() && percent >= 0.0) {
    throw Error("noise and noise_percent are both given, expected one");
  }
  NoiseRequest request;
  request.is_sigma = !noise.is_none() || (percent < 0.0 && c.noise_is_sigma);
  request.percent = percent < 0.0 ? c.noise_percent : percent;
  return request;
}

// Returns `request` for one channel, in per cent of the standard deviation of
// `values`.
double NoisePercent(const NoiseRequest& request, const MeasuredChannel& channel,
                    const Vector& values) {
  if (!request.is_sigma) return request.percent;
  if (!(channel.sigma > 0.0)) {
    throw Error("noise is 'sigma', and channel '" + channel.observation.name +
                "' has none, expected a positive one");
  }
  return OwnNoisePercent(channel, values);
}

std::uint64_t SeedOf(const Case& c, const py::object& seed) {
  return seed.is_none() ? c.noise_seed
                        : Cast<std::uint64_t>(seed, "seed",
                                              "a whole number from 0 to 2^64");
}

// Returns for each record the times, the sensor values, and the states.
py::dict Simulate(const std::shared_ptr<const CaseHandle>& handle,
                  double noise_percent, const py::object& seed,
                  const py::object& noise_kind) {
  const IdentificationProblem& problem = handle->c.problem;
  if (problem.records.empty()) {
    throw Error(
        "the case has no record, expected one with an excitation or a "
        "start");
  }
  const NoiseRequest request = NoiseOf(handle->c, noise_percent, noise_kind);
  SensorNoise noise(SeedOf(handle->c, seed));
  const Vector parameters = ParameterLayout(problem).InitialValues();
  py::dict result;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    const auto simulated = std::make_shared<SimulatedResponse>();
    RunInterruptibly([handle, simulated, parameters, r] {
      *simulated =
          SimulateRecord(handle->c.problem, static_cast<int>(r), parameters);
    });
    const SimulatedResponse& response = *simulated;
    py::dict channels;
    for (size_t i = 0; i < record.channels.size(); ++i) {
      Vector values =
          response.sensors.row(static_cast<Eigen::Index>(i)).transpose();
      noise.AddTo(NoisePercent(request, record.channels[i], values), &values);
      channels[py::str(record.channels[i].observation.name)] =
          FromVector(values);
    }
    py::dict entry;
    entry["time"] = FromVector(FileTimes(record));
    entry["channels"] = std::move(channels);
    entry["states"] = FromMatrix(response.states);
    entry["finite"] = response.finite;
    entry["remark"] = response.remark;
    result[py::str(record.name)] = std::move(entry);
  }
  return result;
}

// Returns the columns of response_<record>.csv for one record, from the result
// of Simulate.
std::vector<CsvColumn> ResponseColumns(const IdentificationRecord& record,
                                       const py::dict& channels) {
  std::vector<CsvColumn> columns;
  columns.push_back({"t", FileTimes(record)});
  for (const MeasuredChannel& channel : record.channels) {
    const py::str name(channel.observation.name);
    const std::string where = "channel '" + channel.observation.name +
                              "' of record '" + record.name + "'";
    if (!channels.contains(name)) {
      throw Error(where + " is not in the simulation, expected it");
    }
    Vector values = ToVector(channels[name], where);
    if (values.size() != record.num_samples()) {
      throw Error(where + " has " + std::to_string(values.size()) +
                  " samples, expected " + std::to_string(record.num_samples()));
    }
    columns.push_back({channel.observation.name, std::move(values)});
  }
  return columns;
}

// Writes the result of Simulate for `handle` with the same noise, as
// pinode_simulate does.
void SaveSimulation(const CaseHandle& handle, const py::dict& records,
                    double noise_percent, const py::object& seed,
                    const py::object& noise_kind, const std::string& path,
                    bool overwrite, bool mat) {
  const Case& c = handle.c;
  SimulationSummary summary;
  summary.case_path = c.path;
  summary.noise_percent = NoiseOf(c, noise_percent, noise_kind).percent;
  summary.seed = SeedOf(c, seed);
  std::vector<std::vector<CsvColumn>> responses;
  for (const IdentificationRecord& record : c.problem.records) {
    const py::str name(record.name);
    if (!records.contains(name)) {
      throw Error("record '" + record.name +
                  "' is not in the simulation, expected it");
    }
    const auto entry = Cast<py::dict>(
        records[name], "record '" + record.name + "'", "a dictionary");
    responses.push_back(ResponseColumns(
        record, Cast<py::dict>(entry["channels"], "channels", "a dictionary")));
    summary.records.push_back(
        {record.name, record.num_samples(),
         Cast<bool>(entry["finite"], "finite", "True or False")});
  }
  ResultFolder folder;
  std::string error;
  bool ok = false;
  {
    py::gil_scoped_release release;
    ok = folder.Open(path, overwrite, /*resume=*/false, &error);
    const std::string& place = folder.working_path();
    for (size_t r = 0; ok && r < responses.size(); ++r) {
      ok = WriteCsv(place + "/response_" + summary.records[r].name + ".csv",
                    responses[r], &error);
    }
    ok = ok &&
         WriteSimulationSummary(place + "/simulate.json", summary, &error) &&
         (!mat || WriteMatlabResults(place, &error)) && folder.Commit(&error);
  }
  Require(ok, error);
}

// Returns arrays over the points of the sweep, and how it ended.
py::dict Sweep(const std::shared_ptr<const CaseHandle>& handle,
               const std::string& load, double from_hz, double to_hz,
               double amplitude, int num_points) {
  const IdentificationProblem& problem = handle->c.problem;
  if (problem.records.empty()) {
    throw Error("a sweep needs a record, which names loads and channels");
  }
  const HarmonicLoad wanted{load, amplitude, from_hz, to_hz, num_points};
  const Vector parameters = ParameterLayout(problem).InitialValues();
  const auto points = std::make_shared<std::vector<SweepPoint>>();
  const auto message = std::make_shared<std::string>();
  const auto finished = std::make_shared<bool>(false);
  const auto ended = std::make_shared<std::atomic<bool>>(false);
  try {
    RunInterruptibly(
        [handle, wanted, parameters, points, message, finished, ended] {
          *finished = SweepRecord(
              handle->c.problem, 0, parameters, wanted,
              [ended](double) { return !*ended; }, points.get(), message.get());
        });
  } catch (...) {
    // The work goes on in the background until it sees this.
    *ended = true;
    throw;
  }
  if (points->size() < 2) throw Error(*message);
  const auto column = [&points](const auto& value) {
    Vector result(static_cast<Eigen::Index>(points->size()));
    for (size_t i = 0; i < points->size(); ++i) {
      result[static_cast<Eigen::Index>(i)] = value((*points)[i]);
    }
    return FromVector(result);
  };
  py::dict channels;
  const IdentificationRecord& record = problem.records[0];
  for (size_t i = 0; i < record.channels.size(); ++i) {
    const auto c = static_cast<Eigen::Index>(i);
    py::dict channel;
    channel["half_range"] =
        column([c](const SweepPoint& p) { return p.half_range[c]; });
    channel["amplitude"] =
        column([c](const SweepPoint& p) { return p.amplitude[c]; });
    channel["phase"] = column([c](const SweepPoint& p) { return p.phase[c]; });
    channels[py::str(record.channels[i].observation.name)] = std::move(channel);
  }
  py::dict result;
  result["frequency_hz"] =
      column([](const SweepPoint& p) { return p.frequency_hz; });
  result["channels"] = std::move(channels);
  result["largest_multiplier"] =
      column([](const SweepPoint& p) { return p.largest_multiplier; });
  result["num_harmonics"] =
      column([](const SweepPoint& p) { return p.num_harmonics; });
  result["neglected"] = column([](const SweepPoint& p) { return p.neglected; });
  result["finished"] = *finished;
  result["remark"] = *message;
  return result;
}

}  // namespace

void BindSimulation(py::module_* module) {
  module->def("simulate", &Simulate, py::arg("case"),
              py::arg("noise_percent") = -1.0, py::arg("seed") = py::none(),
              py::arg("noise") = py::none());
  module->def("sweep", &Sweep, py::arg("case"), py::arg("load"),
              py::arg("from_hz"), py::arg("to_hz"), py::arg("amplitude"),
              py::arg("num_points"));
  module->def("save_simulation", &SaveSimulation, py::arg("case"),
              py::arg("records"), py::arg("noise_percent"), py::arg("seed"),
              py::arg("noise"), py::arg("path"), py::arg("overwrite") = false,
              py::arg("mat") = false);
}

}  // namespace pinode::python
