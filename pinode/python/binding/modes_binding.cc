#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <complex>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/results/case_picture.h"
#include "pinode/case/results/matlab_results.h"
#include "pinode/case/results/modes_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/run/find_modes.h"
#include "pinode/case/sections/modes_data_file.h"
#include "pinode/case/sections/modes_section.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/modal_spectra.h"
#include "pinode/modal/spectra.h"
#include "pinode/python/binding/case_tree.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/python/binding/watch.h"
#include "pinode/report/modes_report.h"
#include "pinode/report/structure_view.h"

namespace pinode::python {
namespace {

namespace py = pybind11;
using Clock = std::chrono::steady_clock;

// Number of singular values, as in the report.
constexpr int kSingularValues = 3;

// The request and its result.
struct ModesHandle {
  ModesCase c;
  FoundModes found;
  double seconds = 0.0;
};

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
  entry["degrees_of_freedom"] = mode.degrees_of_freedom;
  entry["is_harmonic"] = mode.is_harmonic;
  return entry;
}

// Returns the poles of one record at one rate, by columns.
py::dict BandAsDict(const std::string& record, const AnalysedBand& band) {
  const auto count = static_cast<Eigen::Index>(band.poles.size());
  Vector frequency(count), sigma(count), damping(count);
  std::vector<int> order, mode;
  for (Eigen::Index i = 0; i < count; ++i) {
    const DiagramPole& pole = band.poles[static_cast<size_t>(i)];
    frequency[i] = pole.frequency_hz;
    sigma[i] = pole.frequency_sigma;
    damping[i] = pole.damping_ratio;
    order.push_back(pole.order);
    mode.push_back(pole.mode);
  }
  py::dict entry;
  entry["record"] = record;
  entry["lowest_hz"] = band.lowest_hz;
  entry["highest_hz"] = band.highest_hz;
  entry["order"] = order;
  entry["frequency_hz"] = FromVector(frequency);
  entry["frequency_sigma"] = FromVector(sigma);
  entry["damping_ratio"] = FromVector(damping);
  entry["mode"] = mode;
  return entry;
}

// Converts one set-up: name, channel names, derivatives, samples (samples x
// channels), the step in seconds, measured loads (samples x loads) or None, and
// a flag for a free decay.
ResponseRecord RecordFrom(const py::handle& setup) {
  const auto parts = Cast<py::tuple>(setup, "a set-up", "a tuple");
  if (parts.size() != 7) throw Error("a set-up has seven parts");
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
  if (!parts[5].is_none()) {
    record.inputs = ToMatrix(parts[5], where + "loads").transpose();
  }
  record.free_decay =
      Cast<bool>(parts[6], where + "free_decay", "True or False");
  std::string error;
  Require(record.IsValid(&error), error);
  return record;
}

// Makes a case of records in memory, whose channels are places.
void AddRecords(const py::list& setups, ModesCase* c) {
  for (const py::handle& setup : setups) {
    c->records.push_back(RecordFrom(setup));
    for (const ResponseChannel& channel : c->records.back().channels) {
      c->places.push_back({channel.name, channel.name, {{channel.name, 1.0}}});
    }
  }
  if (c->records.empty()) {
    throw Error("there is no record, expected one or more");
  }
}

// Applies [modes] of `options`, a dictionary, to records in memory.
std::shared_ptr<ModesHandle> FromSetups(const py::list& setups,
                                        const py::dict& options,
                                        const std::string& title) {
  py::dict tree;
  tree["modes"] = options;
  CaseData none;
  auto handle = std::make_shared<ModesHandle>();
  std::string error;
  Require(ReadModesOptions(TreeFromPython(tree, &none), "", &handle->c, &error),
          error);
  handle->c.title = title;
  AddRecords(setups, &handle->c);
  return handle;
}

std::shared_ptr<ModesHandle> FromTree(const py::object& tree,
                                      const std::string& path) {
  auto handle = std::make_shared<ModesHandle>();
  const auto data = std::make_shared<CaseData>();
  const TomlValue value = TreeFromPython(tree, data.get());
  RequireInterruptibly([handle, value, path, data](std::string* error) {
    return ReadModesTree(value, path, data.get(), &handle->c, error);
  });
  return handle;
}

std::shared_ptr<ModesHandle> FromFile(const std::string& path) {
  auto handle = std::make_shared<ModesHandle>();
  RequireInterruptibly([handle, path](std::string* error) {
    return ReadModesCase(path, &handle->c, error);
  });
  return handle;
}

// Reads a single data file, whose columns are the channels, with [modes] of
// `options`.
std::shared_ptr<ModesHandle> FromDataFile(
    const std::string& path, const std::vector<std::string>& columns,
    const std::vector<std::string>& quantities, const std::string& time,
    double sampling_rate_hz, bool free_decay, const py::dict& options,
    const std::string& title, const std::map<std::string, std::string>& text,
    const std::map<std::string, double>& scales, double scale) {
  py::dict tree;
  tree["modes"] = options;
  CaseData none;
  ModesCase asked;
  std::string error;
  Require(ReadModesOptions(TreeFromPython(tree, &none), "", &asked, &error),
          error);
  ModesDataFile file = {path, columns, quantities, time, sampling_rate_hz,
                        {},   {}};
  std::string key;
  Require(
      ParseTextFormat({text.begin(), text.end()}, &file.format, &key, &error),
      key + ": " + error);
  Require(file.scales.Set(scale, scales, &error), "scale: " + error);
  auto handle = std::make_shared<ModesHandle>();
  ModesCase* c = &handle->c;
  RequireInterruptibly([handle, file](std::string* sentence) {
    return ReadModesDataFile(file, &handle->c, sentence);
  });
  c->options = asked.options;
  c->merge = asked.merge;
  c->keep_harmonics = asked.keep_harmonics;
  if (!title.empty()) c->title = title;
  for (ResponseRecord& record : c->records) record.free_decay = free_decay;
  return handle;
}

void Find(const std::shared_ptr<ModesHandle>& handle, int threads) {
  if (threads < 0 || threads > kMostThreads) {
    throw Error("threads is " + std::to_string(threads) +
                ", it must be from 1 to " + std::to_string(kMostThreads));
  }
  if (threads > 0) handle->c.options.num_threads = threads;
  const auto found = std::make_shared<FoundModes>();
  const auto begin = Clock::now();
  RequireInterruptibly([handle, found](std::string* error) {
    return FindModes(handle->c, found.get(), error);
  });
  handle->found = std::move(*found);
  handle->seconds = std::chrono::duration<double>(Clock::now() - begin).count();
}

void Save(const ModesHandle& handle, const std::string& path, bool overwrite,
          bool mat) {
  const FoundModes& found = handle.found;
  ModesReportInput report;
  report.title = handle.c.title;
  report.origin = {handle.c.path, "", handle.seconds};
  report.records = &handle.c.records;
  report.by_record = &found.by_record;
  report.merged = &found.result.merged;
  report.remarks = found.result.remarks;
  if (found.picture.has_value()) report.structure = &*found.picture;
  HtmlReportOptions options;
  options.num_threads = DefaultThreads();
  ResultFolder folder;
  std::string error;
  bool ok = false;
  {
    py::gil_scoped_release release;
    ok = folder.Open(path, overwrite, /*resume=*/false, &error) &&
         WriteModesFiles(found.result, folder.working_path(), &error) &&
         WriteVtu(found.picture, folder.working_path(), &error) &&
         WriteModesReport(report, options,
                          folder.working_path() + "/report.html", &error) &&
         (!mat || WriteMatlabResults(folder.working_path(), &error)) &&
         folder.Commit(&error);
  }
  Require(ok, error);
}

// Returns the [[mode]] entries that pinode_modes writes.
py::object ModesForCase(const ModesHandle& handle) {
  std::string error;
  TomlValue tree;
  Require(ParseToml(ModesAsToml(handle.found.result), "", &tree, &error),
          error);
  const py::object entries = TreeToPython(tree, CaseData());
  return entries.contains("mode") ? py::object(entries["mode"]) : py::list();
}

py::list ListOfModes(const ModesHandle& handle) {
  py::list modes;
  for (const MergedMode& mode : handle.found.result.merged.modes) {
    py::dict entry = ModeAsDict(mode.mode);
    entry["in_records"] = mode.in_setups;
    modes.append(std::move(entry));
  }
  return modes;
}

py::list Diagram(const ModesHandle& handle) {
  py::list bands;
  for (size_t i = 0; i < handle.found.by_record.size(); ++i) {
    for (const AnalysedBand& band : handle.found.by_record[i].bands) {
      bands.append(BandAsDict(handle.c.records[i].name, band));
    }
  }
  return bands;
}

// Returns for each record (channels in its order) the spectra of its
// stabilisation diagram and those of its modes.
py::dict Spectra(const ModesHandle& handle) {
  py::dict result;
  for (size_t i = 0; i < handle.found.by_record.size(); ++i) {
    const ResponseRecord& record = handle.c.records[i];
    pinode::Spectra all;
    ModalSpectra fitted;
    {
      py::gil_scoped_release release;
      all = EstimateSpectra(record, 0, kSingularValues);
      fitted = FitModalSpectra(record, handle.found.by_record[i]);
    }
    py::list channels;
    for (const ResponseChannel& channel : record.channels) {
      channels.append(channel.name);
    }
    py::dict entry;
    entry["channels"] = std::move(channels);
    entry["singular_hz"] = FromVector(all.frequency_hz);
    entry["singular_values"] = FromMatrix(all.singular_values);
    entry["frequency_hz"] = FromVector(fitted.frequency_hz);
    entry["measured"] = FromMatrix(fitted.measured);
    entry["modelled"] = FromMatrix(fitted.modelled);
    entry["explained"] = FromVector(fitted.explained);
    result[py::str(record.name)] = std::move(entry);
  }
  return result;
}

}  // namespace

void BindModes(py::module_* module) {
  py::class_<ModesHandle, std::shared_ptr<ModesHandle>>(*module, "ModesHandle")
      .def_static("from_setups", &FromSetups, py::arg("setups"),
                  py::arg("options"), py::arg("title"))
      .def_static("from_tree", &FromTree, py::arg("tree"), py::arg("path"))
      .def_static("read", &FromFile, py::arg("path"))
      .def_static("read_data", &FromDataFile, py::arg("path"),
                  py::arg("columns"), py::arg("quantities"), py::arg("time"),
                  py::arg("sampling_rate_hz"), py::arg("free_decay"),
                  py::arg("options"), py::arg("title"), py::arg("text"),
                  py::arg("scales"), py::arg("scale"))
      .def("find", &Find, py::arg("threads") = 0)
      .def("save", &Save, py::arg("path"), py::arg("overwrite") = false,
           py::arg("mat") = false)
      .def("for_case", &ModesForCase)
      .def("spectra", &Spectra)
      .def_property_readonly("modes", &ListOfModes)
      .def_property_readonly("diagram", &Diagram)
      .def_property_readonly(
          "methods",
          [](const ModesHandle& handle) {
            py::dict methods;
            for (size_t i = 0; i < handle.c.records.size(); ++i) {
              methods[py::str(handle.c.records[i].name)] =
                  ModalMethodName(handle.found.by_record[i].method);
            }
            return methods;
          })
      .def_property_readonly("places",
                             [](const ModesHandle& handle) {
                               return handle.found.result.merged.places;
                             })
      .def_property_readonly(
          "remarks",
          [](const ModesHandle& handle) { return handle.found.result.remarks; })
      .def_property_readonly("structure_html", [](const ModesHandle& handle) {
        return handle.found.picture.has_value()
                   ? StructureSection(*handle.found.picture)
                   : std::string();
      });
  module->def(
      "check_output_folder",
      [](const std::string& path, bool overwrite) {
        std::string error;
        Require(CheckOutputFolder(path, overwrite, /*resume=*/false, &error),
                error);
      },
      py::arg("path"), py::arg("overwrite"));
  module->def(
      "toml_tree",
      [](const std::string& path) {
        std::string text;
        std::string error;
        TomlValue tree;
        Require(ReadTextFile(path, &text, &error) &&
                    ParseToml(text, path, &tree, &error),
                error);
        return TreeToPython(tree, CaseData());
      },
      py::arg("path"));
}

}  // namespace pinode::python
