#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/stopwatch.h"
#include "pinode/case/results/baseline_folder.h"
#include "pinode/case/results/damage_files.h"
#include "pinode/case/results/discover_files.h"
#include "pinode/case/results/grown_case.h"
#include "pinode/case/results/refit_checkpoint.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/results/same_structure.h"
#include "pinode/case/run/damage_case.h"
#include "pinode/discover/equation_values.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/python/binding/watch.h"
#include "pinode/report/report.h"
#include "pinode/study/terms/discovered_problem.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

bool BaselineOfFit(const Fit& fit, size_t number, const Case& c,
                   Baseline* baseline, std::string* error) {
  const std::string& title = fit.c.problem.description.title;
  const std::string name = (title.empty() ? std::string("baseline") : title) +
                           " " + std::to_string(number);
  return BaselineFrom(name, fit.c.problem, fit.summary, fit.model, baseline,
                      error) &&
         CompareWithCase(fit.c, c, baseline, error);
}

// Reads baselines, which are fits or folders with results.
std::vector<Baseline> ReadBaselines(const py::list& list, const Case& c) {
  std::vector<Baseline> baselines;
  for (const py::handle& entry : list) {
    baselines.emplace_back();
    std::string folder;
    std::shared_ptr<Fit> fit;
    if (py::isinstance<py::str>(entry)) {
      folder =
          Cast<std::string>(entry, "a baseline", "a fit or a result folder");
    } else {
      fit = Cast<std::shared_ptr<Fit>>(entry, "a baseline",
                                       "a fit or a result folder");
    }
    std::string error;
    bool ok = false;
    {
      py::gil_scoped_release release;
      ok = fit == nullptr ? ReadBaseline(folder, c, &baselines.back(), &error)
                          : BaselineOfFit(*fit, baselines.size(), c,
                                          &baselines.back(), &error);
    }
    Require(ok, error);
  }
  return baselines;
}

void KeepJudgement(JudgedChange judgement, Fit* fit) {
  if (judgement.judged) {
    auto damage = std::make_shared<DamageResult>(std::move(judgement.result));
    fit->summary = damage->summary;
    fit->model = damage->model;
    fit->damage = std::move(damage);
  } else if (!judgement.why_not.empty()) {
    fit->troubles.push_back("nothing can be said about changes: " +
                            judgement.why_not);
  }
}

std::shared_ptr<Fit> AnalyseCase(const CaseHandle& handle, const Fit* given,
                                 const py::list& baselines, double threshold,
                                 double false_alarm_rate,
                                 const FitRequest& request) {
  CheckFit(handle);
  ChangeOptions change;
  change.threshold = threshold;
  change.false_alarm_rate = false_alarm_rate;
  std::string error;
  Require(change.IsValid(&error), error);
  const auto work = std::make_shared<FitWork>();
  Fit* fit = work->fit.get();
  fit->c = given != nullptr ? given->c : handle.c;
  SetThreads(request, &fit->c);
  if (FreeGroups(*fit->c.problem.dynamics).empty()) {
    throw Error("no group is free; free the groups that may have changed");
  }
  const std::vector<Baseline> healthy = ReadBaselines(baselines, fit->c);
  const bool is_fitted = given != nullptr;
  if (is_fitted) {
    fit->summary = given->summary;
    fit->model = given->model;
    Require(!healthy.empty(),
            "there is no baseline, expected a result of baseline records");
  } else {
    bool ok = false;
    {
      py::gil_scoped_release release;
      ok = PrepareForBaselines(healthy, &fit->c, &work->begin_from, &error);
    }
    Require(ok, error);
  }
  OpenFolder(request, work.get());
  const auto python = std::make_shared<PythonWatch>(request.callback);
  const auto begun = std::chrono::steady_clock::now();
  python->Run([work, python, begun, is_fitted, healthy, change] {
    Fit& fitted = *work->fit;
    work->ok = is_fitted ||
               FitCase(work->folder, &work->begin_from, python.get(), &fitted.c,
                       &fitted.summary, &fitted.model, &work->error);
    if (!work->ok) return;
    JudgedChange judgement = JudgeChange(fitted.summary, fitted.model, healthy,
                                         change, python.get(), &fitted.c);
    fitted.troubles = python->troubles();
    fitted.seconds = SecondsSince(begun);
    KeepJudgement(std::move(judgement), &fitted);
    if (work->folder.writes() && !python->abandoned()) {
      work->ok = WriteFit(fitted, work->extras, work->folder, &work->error) &&
                 work->folder.Commit(&work->error);
    }
  });
  Require(work->ok, work->error);
  return work->fit;
}

// Returns the model in a result folder of the case, as a fit without other
// data.
std::shared_ptr<Fit> FitOfFolder(const CaseHandle& handle,
                                 const std::string& folder) {
  CheckFit(handle);
  if (handle.c.discover.source != DiscoveryOptions::Source::kNetwork) {
    throw Error(
        "a model is of no use with source = 'derivatives', expected none");
  }
  auto fit = std::make_shared<Fit>();
  fit->c = handle.c;
  std::string error;
  bool ok = false;
  {
    py::gil_scoped_release release;
    ok = ReadFittedModel(folder, &fit->c, &fit->model, &error);
  }
  Require(ok, error);
  return fit;
}

// Returns the case of a discovery, with the options of `handle`. Throws Error
// if there are no networks or records to discover equations from.
Case CaseToDiscover(const CaseHandle& handle, const Fit* fit,
                    const FitRequest& request) {
  CheckFit(handle);
  Case c = fit != nullptr ? fit->c : handle.c;
  SetThreads(request, &c);
  c.discover = handle.c.discover;
  c.discover.num_threads = c.options.num_threads;
  if (c.problem.num_train_records() == 0) {
    throw Error("no training record, expected one to discover equations from");
  }
  if (c.discover.source == DiscoveryOptions::Source::kNetwork &&
      fit == nullptr) {
    throw Error(
        "equations come from the networks of a model, expected one, or "
        "source = 'derivatives'");
  }
  return c;
}

// Puts `equations` in place of the networks, refitted if the case asks for it.
// On entry *result has the model from which they were found.
bool PutInPlace(const Case& c, const std::vector<DiscoveredEquation>& equations,
                IdentificationWatch* watch, RefitCheckpoint* checkpoint,
                Fit* result, Discovery* discovery, std::string* error) {
  *discovery = WithoutRefit(c.problem, equations);
  result->c = c;
  if (discovery->num_terms() == 0) return true;
  const IdentifiedModel model = result->model;
  if (!c.discover.refit) {
    IdentificationProblem problem;
    return MakeDiscoveredProblem(c.problem, model, equations, {}, &problem,
                                 &result->model, error) &&
           CaseWithEquations(c, equations, problem, /*given_steps=*/false,
                             &result->c, error);
  }
  std::vector<DiscoveredEquation> resumed;
  if (!checkpoint->Read(equations, &resumed, error)) return false;
  DiscoveryOptions discover = c.discover;
  discover.on_equations = [checkpoint](
                              int, const std::vector<DiscoveredEquation>& now) {
    checkpoint->Save(now);
  };
  if (!RefitEquations(c.problem, model, equations, discover, c.options,
                      resumed.empty() ? nullptr : &resumed, watch, discovery,
                      error) ||
      !CaseWithEquations(c, discovery->equations, discovery->problem,
                         /*given_steps=*/true, &result->c, error)) {
    return false;
  }
  result->summary = discovery->summary;
  result->model = discovery->model;
  return true;
}

// Source of terms, and the terms found.
struct FoundTerms {
  Case c;
  IdentifiedModel model;
  std::vector<DiscoveredEquation> equations;
};

// Finds the terms of networks of `fit` (null: of the records).
std::shared_ptr<const FoundTerms> FindTerms(Case given, const Fit* fit) {
  const auto found = std::make_shared<FoundTerms>();
  found->c = std::move(given);
  if (fit != nullptr) found->model = fit->model;
  RequireInterruptibly([found](std::string* error) {
    const Case& c = found->c;
    return c.discover.source == DiscoveryOptions::Source::kNetwork
               ? DiscoverFromNetworks(c.problem, found->model, c.discover,
                                      &found->equations, error)
               : DiscoverFromDerivatives(c.problem, c.discover,
                                         &found->equations, &found->model,
                                         error);
  });
  return found;
}

// Returns the fit with these terms, refitted if the case asks for it.
std::shared_ptr<Fit> DiscoverCase(const CaseHandle& handle, const Fit* fit,
                                  const FitRequest& request) {
  Case c = CaseToDiscover(handle, fit, request);
  const auto work = std::make_shared<FitWork>();
  OpenFolder(request, work.get());
  const auto python = std::make_shared<PythonWatch>(request.callback);
  const auto begun = std::chrono::steady_clock::now();
  const std::shared_ptr<const FoundTerms> found = FindTerms(std::move(c), fit);
  python->Run([work, python, begun, found] {
    Fit* result = work->fit.get();
    const auto discovery = std::make_shared<Discovery>();
    RefitCheckpoint checkpoint(work->folder, found->c.problem);
    result->model = found->model;
    work->ok = PutInPlace(found->c, found->equations, python.get(), &checkpoint,
                          result, discovery.get(), &work->error);
    if (!work->ok) return;
    if (!discovery->refitted) {
      result->summary.verdict = discovery->verdict();
      result->summary.message = discovery->Message();
    }
    result->troubles = python->troubles();
    result->seconds = SecondsSince(begun);
    if (!checkpoint.trouble().empty()) {
      result->troubles.push_back("no checkpoint: " + checkpoint.trouble());
    }
    result->discovery = discovery;
    if (!work->folder.writes() || python->abandoned()) return;
    const bool interrupted =
        discovery->refitted &&
        discovery->summary.termination == Termination::kInterrupted;
    work->ok = WriteFit(*result, work->extras, work->folder, &work->error) &&
               (!interrupted ||
                checkpoint.Write(discovery->equations, &work->error)) &&
               work->folder.Commit(&work->error);
  });
  Require(work->ok, work->error);
  return work->fit;
}

// Returns for each equation and each feature of its terms, along the training
// records: the feature, its terms, and the regressed values less the other
// terms.
py::list EquationSamples(const Fit& fit) {
  py::list list;
  if (fit.discovery == nullptr) return list;
  const UnitSystem& units = fit.c.problem.description.units;
  for (const DiscoveredEquation& equation : fit.discovery->equations) {
    EquationValues values;
    std::string error;
    if (!EvaluateAtSamples(equation, &values, &error) ||
        values.sum.size() != equation.sample_features.rows()) {
      continue;
    }
    for (size_t f = 0; f < values.parts.size(); ++f) {
      const Vector& part = values.parts[f];
      if (part.size() == 0) continue;
      py::dict entry;
      entry["output"] = equation.output;
      entry["unit"] = UnitName(equation.acts_as == ActsAs::kForce
                                   ? Dimension::kForce
                                   : Dimension::kAcceleration,
                               units);
      entry["feature"] = equation.feature_names[f];
      entry["feature_unit"] = FeatureUnit(equation.features[f], units);
      entry["at"] = FromVector(
          equation.sample_features.col(static_cast<Eigen::Index>(f)));
      entry["terms"] = FromVector(part);
      entry["regressed"] =
          FromVector(equation.sample_outputs - (values.sum - part));
      list.append(std::move(entry));
    }
  }
  return list;
}

}  // namespace

void BindStudy(py::module_* module) {
  module->def(
      "damage",
      [](const CaseHandle& handle, const Fit* fit, const py::list& baselines,
         double threshold, double false_alarm_rate, int threads,
         const py::object& callback, const std::string& output, bool overwrite,
         bool resume, bool mat) {
        return AnalyseCase(
            handle, fit, baselines, threshold, false_alarm_rate,
            {threads, callback, output, overwrite, resume, {mat, ""}});
      },
      py::arg("case"), py::arg("fit"), py::arg("baselines"),
      py::arg("threshold") = 0.05, py::arg("false_alarm_rate") = 0.05,
      py::arg("threads") = 0, py::arg("callback") = py::none(),
      py::arg("output") = "", py::arg("overwrite") = false,
      py::arg("resume") = false, py::arg("mat") = false);
  module->def(
      "discover",
      [](const CaseHandle& handle, const Fit* fit, int threads,
         const py::object& callback, const std::string& output, bool overwrite,
         bool resume, bool mat) {
        return DiscoverCase(
            handle, fit,
            {threads, callback, output, overwrite, resume, {mat, ""}});
      },
      py::arg("case"), py::arg("fit"), py::arg("threads") = 0,
      py::arg("callback") = py::none(), py::arg("output") = "",
      py::arg("overwrite") = false, py::arg("resume") = false,
      py::arg("mat") = false);
  module->def("fit_of_folder", &FitOfFolder, py::arg("case"),
              py::arg("folder"));
  module->def(
      "damage_json",
      [](const Fit& fit) {
        return fit.damage == nullptr ? std::string("null")
                                     : DamageAsJson(*fit.damage);
      },
      py::arg("fit"));
  module->def(
      "discovery_json",
      [](const Fit& fit) {
        return fit.discovery == nullptr ? std::string("null")
                                        : DiscoveryAsJson(*fit.discovery);
      },
      py::arg("fit"));
  module->def("equation_samples", &EquationSamples, py::arg("fit"));
  module->def(
      "equations_text",
      [](const Fit& fit) {
        return fit.discovery == nullptr ? std::string()
                                        : EquationsAsText(*fit.discovery);
      },
      py::arg("fit"));
}

}  // namespace pinode::python
