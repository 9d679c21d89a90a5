#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/parallel_for.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/python/convert.h"
#include "pinode/python/fit.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

py::dict ModeAsDict(const IdentifiedMode& mode) {
  py::dict entry;
  entry["frequency_hz"] = mode.frequency_hz;
  entry["frequency_sigma"] = mode.frequency_sigma;
  entry["frequency_lower95"] = mode.frequency_lower95;
  entry["frequency_upper95"] = mode.frequency_upper95;
  entry["damping_ratio"] = mode.damping_ratio;
  entry["damping_sigma"] = mode.damping_sigma;
  entry["damping_lower95"] = mode.damping_lower95;
  entry["damping_upper95"] = mode.damping_upper95;
  entry["shape"] =
      py::array_t<std::complex<double>>(mode.shape.size(), mode.shape.data());
  entry["shape_sigma_real"] = FromVector(mode.shape_sigma_real);
  entry["shape_sigma_imaginary"] = FromVector(mode.shape_sigma_imaginary);
  entry["phase_collinearity"] = mode.phase_collinearity;
  entry["orders_seen"] = mode.orders_seen;
  entry["orders_possible"] = mode.orders_possible;
  return entry;
}

// Of one set-up after the other: name, channel names, derivatives, samples
// (samples x channels) and the step in seconds.
ResponseRecord RecordFrom(const py::handle& setup) {
  const auto parts = Cast<py::tuple>(setup, "a set-up", "a tuple");
  if (parts.size() != 5) throw Error("a set-up has five parts");
  ResponseRecord record;
  record.name = Cast<std::string>(parts[0], "its name", "a text");
  const std::string where = "record '" + record.name + "': ";
  const auto names = Cast<std::vector<std::string>>(parts[1], where + "names",
                                                    "a list of texts");
  const auto derivatives = Cast<std::vector<int>>(
      parts[2], where + "derivatives", "a list of whole numbers");
  if (names.size() != derivatives.size()) {
    throw Error("record '" + record.name +
                "': " + std::to_string(names.size()) + " channels and " +
                std::to_string(derivatives.size()) +
                " quantities, expected one for each");
  }
  for (size_t i = 0; i < names.size(); ++i) {
    record.channels.push_back({names[i], derivatives[i]});
  }
  record.samples =
      ToMatrix(parts[3], "record '" + record.name + "'").transpose();
  record.sampling_step = Cast<double>(parts[4], where + "step", "a number");
  std::string error;
  Require(record.IsValid(&error), error);
  return record;
}

py::dict FindModes(const py::list& list, double lowest_hz, double highest_hz,
                   int block_rows, int max_order,
                   const std::vector<std::string>& references,
                   const std::vector<double>& pick, int threads) {
  std::vector<ResponseRecord> records;
  for (const py::handle& setup : list) records.push_back(RecordFrom(setup));
  if (records.empty()) {
    throw Error("there is no record, expected one or more");
  }
  if (threads < 1 || threads > kMostThreads) {
    throw Error("threads is " + std::to_string(threads) +
                ", it must be from 1 to " + std::to_string(kMostThreads));
  }
  ModeIdentificationOptions options;
  options.lowest_hz = lowest_hz;
  options.highest_hz = highest_hz;
  options.block_rows = block_rows;
  options.max_order = max_order;
  options.references = references;
  options.stabilisation.pick = pick;
  options.num_threads = threads;
  std::vector<SetupModes> setups;
  std::vector<std::string> remarks;
  MergedModes merged;
  std::string error;
  bool ok = true;
  {
    py::gil_scoped_release release;
    for (size_t i = 0; ok && i < records.size(); ++i) {
      ModesOfRecord modes;
      ok = IdentifyModes(records[i], options, &modes, &error);
      SetupModes setup;
      setup.name = records[i].name;
      for (const ResponseChannel& channel : records[i].channels) {
        setup.places.push_back(channel.name);
      }
      setup.modes = std::move(modes.modes);
      setups.push_back(std::move(setup));
      remarks.insert(remarks.end(), modes.remarks.begin(), modes.remarks.end());
    }
    ok = ok && MergeSetups(setups, MergeOptions(), &merged, &error);
  }
  Require(ok, error);
  remarks.insert(remarks.end(), merged.remarks.begin(), merged.remarks.end());
  py::list modes;
  for (const MergedMode& mode : merged.modes) {
    modes.append(ModeAsDict(mode.mode));
  }
  py::dict result;
  result["places"] = merged.places;
  result["modes"] = std::move(modes);
  result["remarks"] = remarks;
  return result;
}

}  // namespace

void BindModes(py::module_* module) {
  module->def("identify_modes", &FindModes, py::arg("setups"),
              py::arg("lowest_hz") = 0.0, py::arg("highest_hz") = 0.0,
              py::arg("block_rows") = 0, py::arg("max_order") = 0,
              py::arg("references") = std::vector<std::string>(),
              py::arg("pick") = std::vector<double>(), py::arg("threads") = 1);
}

}  // namespace pinode::python
