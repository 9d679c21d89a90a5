#include <pybind11/complex.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/results/case_picture.h"
#include "pinode/case/results/case_result.h"
#include "pinode/case/results/damage_files.h"
#include "pinode/case/results/discover_files.h"
#include "pinode/case/results/matlab_results.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/results/result_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/results/updated_deck.h"
#include "pinode/case/run/fit_case.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/problem/motion_levels.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/result_fields.h"
#include "pinode/python/binding/case_tree.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/python/binding/fit_archive.h"
#include "pinode/python/binding/watch.h"
#include "pinode/report/console.h"
#include "pinode/report/html_report.h"
#include "pinode/report/restoring_force.h"
#include "pinode/report/structure_view.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/problem/prior_comparison.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

using Clock = std::chrono::steady_clock;

// Returns values of another fit by name, clamped to the bounds of `problem`.
IdentifiedModel BeginFromFit(const Fit& fit,
                             const IdentificationProblem& problem) {
  if (ProblemHash(fit.c.problem) == ProblemHash(problem)) {
    IdentifiedModel same = fit.model;
    same.resume_stage = 0;
    return same;
  }
  IdentifiedModel begin = BeginFrom(ParametersByName(fit.c.problem, fit.model),
                                    IdentifiedModel(), problem);
  const ParameterLayout layout(problem);
  for (int i = 0; i < layout.num_parameters(); ++i) {
    const Parameter& parameter = layout.parameter(i);
    begin.parameters[i] =
        parameter.free
            ? std::clamp(begin.parameters[i], parameter.lower, parameter.upper)
            : parameter.value;
  }
  return begin;
}

ReportInput ReportOf(const Fit& fit) {
  ReportInput report = MakeReportInput(fit.c.problem, fit.summary, fit.model,
                                       {fit.c.path, "", fit.seconds});
  report.damage = fit.damage.get();
  if (fit.discovery != nullptr) {
    report.equations = &fit.discovery->equations;
  }
  return report;
}

std::optional<StructurePicture> PictureOf(const Fit& fit) {
  return PictureOfCase(fit.c, fit.summary, fit.model, fit.damage.get());
}

// Returns the section of a page; empty: the case has no geometry.
std::string StructureHtml(const Fit& fit) {
  const std::optional<StructurePicture> picture = PictureOf(fit);
  return picture.has_value() ? StructureSection(*picture) : std::string();
}

std::shared_ptr<Fit> IdentifyCase(const CaseHandle& handle, const Fit* begin,
                                  bool profiles, const FitRequest& request) {
  CheckFit(handle);
  const auto begun = Clock::now();
  const auto work = std::make_shared<FitWork>();
  work->fit->c = handle.c;
  SetThreads(request, &work->fit->c);
  const bool has_begin = begin != nullptr;
  if (has_begin) {
    work->begin_from = BeginFromFit(*begin, work->fit->c.problem);
  }
  OpenFolder(request, work.get());
  const auto python = std::make_shared<PythonWatch>(request.callback);
  python->Run([work, python, begun, has_begin, profiles] {
    Fit& fit = *work->fit;
    work->ok =
        FitCase(work->folder, has_begin ? &work->begin_from : nullptr,
                python.get(), &fit.c, &fit.summary, &fit.model, &work->error);
    if (!work->ok) return;
    if ((profiles || fit.c.profiles.has_value()) && !python->stopped()) {
      ProfileCase(work->folder, python.get(), &fit.c, fit.model, &fit.summary);
    }
    fit.seconds = std::chrono::duration<double>(Clock::now() - begun).count();
    fit.troubles = python->troubles();
    if (work->folder.writes() && !python->abandoned()) {
      work->ok = WriteFit(fit, work->extras, work->folder, &work->error) &&
                 work->folder.Commit(&work->error);
    }
  });
  Require(work->ok, work->error);
  return work->fit;
}

py::list ParametersOf(const Fit& fit) {
  py::list list;
  for (const ParameterEstimate& parameter : fit.summary.parameters) {
    py::dict entry;
    VisitFields(parameter, [&entry](const char* name, const auto& value) {
      entry[name] = value;
    });
    list.append(std::move(entry));
  }
  return list;
}

py::list FindingsOf(const Fit& fit) {
  py::list list;
  for (const Finding& finding : fit.summary.verdict.findings()) {
    py::dict entry;
    VisitFields(finding, [&entry](const char* name, const auto& value) {
      if constexpr (!std::is_enum_v<std::decay_t<decltype(value)>>) {
        entry[name] = value;
      }
    });
    entry["grade"] = GradeName(finding.grade);
    list.append(std::move(entry));
  }
  return list;
}

template <typename T>
py::dict DictOf(const T& fields) {
  py::dict entry;
  VisitFields(fields, [&entry](const char* name, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, std::vector<ExplainedValue>>) {
      py::list values;
      for (const ExplainedValue& one : value) values.append(DictOf(one));
      entry[name] = std::move(values);
    } else {
      entry[name] = value;
    }
  });
  return entry;
}

py::list ExplanationsOf(const Fit& fit) {
  py::list list;
  for (const Explanation& explanation : fit.summary.explanations) {
    list.append(DictOf(explanation));
  }
  return list;
}

py::list LevelsOf(const Fit& fit) {
  py::list list;
  for (const MotionLevel& level : MotionLevels(fit.c.problem)) {
    list.append(DictOf(level));
  }
  return list;
}

size_t RecordIndex(const Fit& fit, const std::string& name) {
  for (size_t r = 0; r < fit.summary.records.size(); ++r) {
    if (fit.summary.records[r].name == name) return r;
  }
  throw Error("there is no record '" + name + "' in the result");
}

// Returns rows of `values` in the units of the record's file, by channel.
py::dict RowsByChannel(const IdentificationRecord& record, const Matrix& values,
                       bool absolute) {
  py::dict rows;
  if (values.cols() != record.num_samples()) return rows;
  for (size_t i = 0; i < record.channels.size(); ++i) {
    const MeasuredChannel& channel = record.channels[i];
    const double factor = absolute ? std::abs(channel.description.factor)
                                   : channel.description.factor;
    rows[py::str(channel.observation.name)] = FromVector(
        values.row(static_cast<Eigen::Index>(i)).transpose() / factor);
  }
  return rows;
}

py::dict RecordOf(const std::shared_ptr<Fit>& fit, const std::string& name) {
  const size_t r = RecordIndex(*fit, name);
  const RecordScore& score = fit->summary.records[r];
  const IdentificationRecord& record = fit->c.problem.records[r];
  py::dict units, measured;
  for (const MeasuredChannel& channel : record.channels) {
    const py::str key(channel.observation.name);
    units[key] = fit->c.problem.UnitOf(channel);
    measured[key] = Samples(channel, py::cast(fit));
  }
  py::dict result;
  result["time"] = FromVector(FileTimes(record));
  result["measured"] = std::move(measured);
  result["predicted"] = RowsByChannel(record, score.prediction, false);
  result["deviation"] = RowsByChannel(record, score.deviations, true);
  result["units"] = std::move(units);
  result["states"] = View(score.states, py::cast(fit));
  result["start"] = FromVector(score.start);
  return result;
}

// Returns by record and channel the simulation of the initial model; records
// without a finite one are left out.
py::dict Before(const Fit& fit) {
  const std::vector<IdentificationRecord>& records = fit.c.problem.records;
  PriorRuns runs(fit.c.problem, fit.model);
  py::dict result;
  for (size_t r = 0; r < fit.summary.records.size(); ++r) {
    std::vector<int> channels(records[r].channels.size());
    std::iota(channels.begin(), channels.end(), 0);
    Matrix shown;
    {
      py::gil_scoped_release release;
      shown = runs.Run(static_cast<int>(r), channels);
    }
    result[py::str(records[r].name)] = RowsByChannel(records[r], shown, false);
  }
  return result;
}

py::dict Matrices(const Fit& fit) {
  StructuralDynamics dynamics = *fit.c.problem.dynamics;
  if (fit.model.parameters.size() >= dynamics.num_parameters()) {
    dynamics.SetParameters(
        fit.model.parameters.head(dynamics.num_parameters()));
  }
  const StructuralModel updated =
      dynamics.CorrectedModel(dynamics.Parameters());
  py::dict result;
  result["mass"] = FromMatrix(updated.mass);
  result["damping"] = FromMatrix(updated.damping);
  result["stiffness"] = FromMatrix(updated.stiffness);
  return result;
}

// Returns the true force from the case, in the model's unit; nullptr: unknown.
const ForceTruth* TruthOf(const Fit& fit, const std::string& name) {
  for (const ForceTruth& truth : fit.c.problem.description.force_truths) {
    if (truth.name == name && truth.times.size() > 0) return &truth;
  }
  return nullptr;
}

py::list Forces(const Fit& fit) {
  py::list list;
  for (const ForceEstimate& force : fit.summary.forces) {
    const IdentificationRecord& record =
        fit.c.problem.records[static_cast<size_t>(force.record)];
    const double factor = record.description.time_factor;
    py::dict entry;
    entry["name"] = force.name;
    entry["record"] = record.name;
    entry["unit"] = fit.c.problem.description.units.force;
    entry["time"] = FromVector(force.times / factor);
    entry["force"] = FromVector(force.value);
    entry["lower95"] = FromVector(force.lower95);
    entry["upper95"] = FromVector(force.upper95);
    if (const ForceTruth* truth = TruthOf(fit, force.name)) {
      py::dict known;
      known["time"] = FromVector(truth->times / factor);
      known["force"] = FromVector(truth->values);
      entry["truth"] = std::move(known);
    }
    list.append(std::move(entry));
  }
  return list;
}

py::list Profiles(const Fit& fit) {
  py::list list;
  for (const ParameterProfile& profile : fit.summary.profiles) {
    const auto size = static_cast<Eigen::Index>(profile.points.size());
    Vector values(size), ratios(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      values[i] = profile.points[static_cast<size_t>(i)].value;
      ratios[i] = profile.points[static_cast<size_t>(i)].ratio;
    }
    py::dict entry;
    entry["name"] = profile.name;
    entry["unit"] = profile.unit;
    entry["values"] = FromVector(values);
    entry["likelihood_ratios"] = FromVector(ratios);
    entry["lower95"] = profile.lower95;
    entry["upper95"] = profile.upper95;
    entry["threshold95"] = profile.threshold95;
    entry["threshold99"] = profile.threshold99;
    entry["determination"] = DeterminationName(profile.determination);
    list.append(std::move(entry));
  }
  return list;
}

// Returns the forces of laws and networks along the predicted states of a
// record.
py::list Loops(const Fit& fit) {
  py::list list;
  const ReportInput report = ReportOf(fit);
  for (const RestoringForceLoop& loop : ComputeRestoringForceLoops(report)) {
    py::dict entry;
    entry["term"] = loop.term;
    entry["type"] = loop.type;
    entry["output"] = loop.output;
    entry["record"] =
        fit.c.problem.records[static_cast<size_t>(loop.record)].name;
    entry["is_acceleration"] = loop.is_acceleration;
    entry["deformation_name"] = loop.deformation_name;
    entry["deformation_unit"] = loop.deformation_unit;
    entry["rate_name"] = loop.rate_name;
    entry["rate_unit"] = loop.rate_unit;
    entry["force_unit"] = loop.force_unit;
    entry["time"] = FromVector(loop.time);
    entry["deformation"] = FromVector(loop.deformation);
    entry["rate"] = FromVector(loop.rate);
    entry["force"] = FromVector(loop.force);
    if (loop.known != nullptr) {
      py::dict known;
      known["name"] = loop.known->name;
      known["deformation"] = FromVector(loop.known->deformation);
      known["force"] = FromVector(loop.known->force);
      entry["known"] = std::move(known);
    }
    list.append(std::move(entry));
  }
  return list;
}

// Returns spectral densities of the ambient records per Hz, channels x
// frequencies.
py::list Ambient(const std::shared_ptr<Fit>& fit) {
  const double to_hz = fit->c.problem.description.HzPerModelFrequency();
  py::list list;
  for (const AmbientScore& score : fit->summary.ambient) {
    py::dict entry;
    entry["name"] = score.name;
    entry["channels"] = score.channels;
    entry["probability"] = score.probability;
    entry["explained"] = FromVector(score.explained);
    if (score.by_measured_loads.size() > 0) {
      entry["by_measured_loads"] = FromVector(score.by_measured_loads);
      entry["coherence_probability"] = score.coherence_probability;
    }
    entry["frequencies_hz"] = FromVector(to_hz * score.frequencies);
    entry["lines"] = FromVector(score.lines);
    entry["measured"] = FromMatrix(score.measured / to_hz);
    entry["modelled"] = FromMatrix(score.modelled / to_hz);
    list.append(std::move(entry));
  }
  return list;
}

// Returns measured and modelled frequency responses, pairs x lines.
py::list Frfs(const std::shared_ptr<Fit>& fit) {
  const double to_hz = fit->c.problem.description.HzPerModelFrequency();
  const auto complex = [](const Matrix& real, const Matrix& imaginary) {
    return FromMatrix(real).attr("__add__")(
        FromMatrix(imaginary).attr("__mul__")(std::complex<double>(0.0, 1.0)));
  };
  py::list list;
  for (const FrfScore& score : fit->summary.frfs) {
    py::dict entry;
    entry["name"] = score.name;
    entry["pairs"] = score.pairs;
    entry["errors"] = FromVector(score.errors);
    entry["initial_errors"] = FromVector(score.prior_errors);
    entry["unexplained"] = FromVector(score.unexplained);
    entry["sigma"] = FromVector(score.sigma);
    entry["probability"] = score.probability;
    entry["frequencies_hz"] = FromVector(to_hz * score.frequencies);
    entry["measured"] = complex(score.measured_real, score.measured_imaginary);
    entry["modelled"] = complex(score.modelled_real, score.modelled_imaginary);
    list.append(std::move(entry));
  }
  return list;
}

// Returns one row per iteration.
py::dict History(const Fit& fit) {
  py::dict result;
  VisitFields(IterationRecord(), [&result](const char* name, const auto&) {
    result[name] = py::list();
  });
  for (const IterationRecord& record : fit.summary.iterations) {
    VisitFields(record, [&result](const char* name, const auto& value) {
      result[name].cast<py::list>().append(value);
    });
  }
  return result;
}

std::string Json(const Fit& fit) {
  std::string text, error;
  Require(
      FormatResultJson(fit.c.problem, fit.summary, fit.model, &text, &error),
      error);
  return text;
}

// Writes model.toml, the model as it was found, with its arrays.
void SaveModel(const Fit& fit, const std::string& folder) {
  std::string error;
  Require(WriteModelCase(fit.c, CompleteModel(fit.c.problem, fit.model), folder,
                         folder, &error),
          error);
}

py::tuple State(const Fit& fit) {
  const CaseData none;
  std::string packed;
  {
    py::gil_scoped_release release;
    packed = PackFit(fit);
  }
  return py::make_tuple(
      TreeToPython(*fit.c.source, fit.c.data != nullptr ? *fit.c.data : none),
      fit.c.path, py::bytes(packed));
}

std::shared_ptr<Fit> FromState(const py::object& tree, const std::string& path,
                               const py::bytes& bytes) {
  auto data = std::make_shared<CaseData>();
  const TomlValue value = TreeFromPython(tree, data.get());
  auto fit = std::make_shared<Fit>();
  const std::string packed = bytes;
  std::string error;
  bool is_read = false;
  bool is_unpacked = false;
  {
    py::gil_scoped_release release;
    is_read =
        ReadCaseTree(value, path, data, CasePurpose::kFit, &fit->c, &error);
    is_unpacked = is_read && UnpackFit(packed, fit.get());
  }
  Require(is_read, error);
  Require(is_unpacked,
          "this is not a fit of that case by this version of pinode");
  return fit;
}

}  // namespace

void SetThreads(const FitRequest& request, Case* c) {
  if (request.threads < 0) throw Error("threads must not be negative");
  if (request.threads > 0) c->options.num_threads = request.threads;
  std::string error;
  Require(c->options.IsValid(&error), error);
}

void OpenFolder(const FitRequest& request, FitWork* work) {
  work->extras = request.extras;
  if (request.output.empty()) return;
  const bool ok = work->folder.Open(request.output, request.overwrite,
                                    request.resume, &work->error);
  Require(ok, work->error);
}

bool WriteFit(const Fit& fit, const FolderExtras& extras,
              const ResultFolder& folder, std::string* error) {
  const std::string& path = folder.working_path();
  IdentificationSummary summary = fit.summary;
  if (!extras.deck.empty()) {
    std::string remark;
    if (!WriteUpdatedDeck(fit.c, summary, fit.model, extras.deck, path, &remark,
                          error)) {
      return false;
    }
    if (!remark.empty()) summary.remarks.push_back(std::move(remark));
  }
  HtmlReportOptions options;
  options.num_threads = DefaultThreads();
  const std::optional<StructurePicture> picture = PictureOf(fit);
  ReportInput report = ReportOf(fit);
  report.summary = &summary;
  if (picture.has_value()) report.structure = &*picture;
  return WriteCaseResult(fit.c, summary, fit.model, folder, error) &&
         (fit.damage == nullptr ||
          WriteFileAtomically(path + "/damage.json", DamageAsJson(*fit.damage),
                              error)) &&
         (fit.discovery == nullptr ||
          WriteDiscoverFiles(*fit.discovery, path, error)) &&
         WriteVtu(picture, path, error) &&
         WriteHtmlReport(report, options, path + "/report.html", error) &&
         (!extras.mat || WriteMatlabResults(path, error));
}

void BindFit(py::module_* module) {
  py::class_<Fit, std::shared_ptr<Fit>>(*module, "FitHandle")
      .def_static("from_state", &FromState, py::arg("tree"), py::arg("path"),
                  py::arg("packed"))
      .def("state", &State)
      .def("case",
           [](const Fit& fit) {
             auto handle = std::make_shared<CaseHandle>();
             handle->c = fit.c;
             return handle;
           })
      .def_property_readonly(
          "usable", [](const Fit& fit) { return fit.summary.usable(); })
      .def_property_readonly(
          "verdict",
          [](const Fit& fit) { return GradeName(fit.summary.verdict.grade()); })
      .def_property_readonly("findings", &FindingsOf)
      .def_property_readonly("explanations", &ExplanationsOf)
      .def_property_readonly("levels_of_motion", &LevelsOf)
      .def_property_readonly("message",
                             [](const Fit& fit) { return fit.summary.message; })
      .def_property_readonly("termination",
                             [](const Fit& fit) {
                               return TerminationName(fit.summary.termination);
                             })
      .def_property_readonly("seconds",
                             [](const Fit& fit) { return fit.seconds; })
      .def_property_readonly("troubles",
                             [](const Fit& fit) { return fit.troubles; })
      .def_property_readonly("covariance",
                             [](const std::shared_ptr<Fit>& fit) {
                               return View(fit->summary.covariance,
                                           py::cast(fit));
                             })
      .def_property_readonly(
          "covariance_names",
          [](const Fit& fit) { return fit.summary.covariance_names; })
      .def_property_readonly(
          "remarks", [](const Fit& fit) { return RemarksOf(ReportOf(fit)); })
      .def_property_readonly(
          "sentence",
          [](const Fit& fit) { return VerdictSentence(ReportOf(fit)); })
      .def("brief", [](const Fit& fit) { return fit.summary.BriefReport(); })
      .def("report",
           [](const Fit& fit) { return ConsoleReport(ReportOf(fit)); })
      .def("parameters", &ParametersOf)
      .def("record", &RecordOf, py::arg("name"))
      .def("before", &Before)
      .def("matrices", &Matrices)
      .def("forces", &Forces)
      .def("profiles", &Profiles)
      .def("loops", &Loops)
      .def("ambient", &Ambient)
      .def("frfs", &Frfs)
      .def("history", &History)
      .def("json", &Json)
      .def("structure", &StructureHtml)
      .def("save_model", &SaveModel, py::arg("folder"))
      .def(
          "save",
          [](const Fit& fit, const std::string& path, bool overwrite, bool mat,
             const std::string& deck) {
            ResultFolder folder;
            std::string error;
            bool ok = false;
            {
              py::gil_scoped_release release;
              ok = (deck.empty() || CheckDeck(fit.c, deck, &error)) &&
                   folder.Open(path, overwrite, /*resume=*/false, &error) &&
                   WriteFit(fit, {mat, deck}, folder, &error) &&
                   folder.Commit(&error);
            }
            Require(ok, error);
          },
          py::arg("folder"), py::arg("overwrite") = false,
          py::arg("mat") = false, py::arg("deck") = "");
  module->def(
      "identify",
      [](const CaseHandle& handle, const Fit* begin_from, bool profiles,
         int threads, const py::object& callback, const std::string& output,
         bool overwrite, bool resume, bool mat) {
        return IdentifyCase(
            handle, begin_from, profiles,
            {threads, callback, output, overwrite, resume, {mat, ""}});
      },
      py::arg("case"), py::arg("begin_from") = nullptr,
      py::arg("profiles") = false, py::arg("threads") = 0,
      py::arg("callback") = py::none(), py::arg("output") = "",
      py::arg("overwrite") = false, py::arg("resume") = false,
      py::arg("mat") = false);
}

}  // namespace pinode::python
