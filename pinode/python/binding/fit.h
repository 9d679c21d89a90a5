// What Python holds: a case, and a fit of it with what was found from it.

#ifndef PINODE_PYTHON_BINDING_FIT_H_
#define PINODE_PYTHON_BINDING_FIT_H_

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/laws/refit.h"

namespace pinode::python {

struct CaseHandle {
  Case c;
  CasePurpose purpose = CasePurpose::kFit;
};

// A channel's samples in the units of its file, as an array that cannot be
// written to: `owner`'s own where these are the model's.
pybind11::array Samples(const MeasuredChannel& channel,
                        const pybind11::handle& owner);

struct Fit {
  Case c;  // as it was fitted: without terms that were left out, and so on
  IdentificationSummary summary;
  IdentifiedModel model;
  // What it is a part of; null: of neither.
  std::shared_ptr<const DamageResult> damage;
  std::shared_ptr<const Discovery> discovery;
  double seconds = 0.0;  // on the clock
  // Sentences on what went wrong beside it.
  std::vector<std::string> troubles;
};

// What a result folder may have beside what it always has.
struct FolderExtras {
  bool mat = false;  // results.mat
  // An input deck, which is written with what was found; empty: none.
  std::string deck;
};

// How a fit is run.
struct FitRequest {
  int threads = 0;  // 0: as the case says
  pybind11::object callback;
  // Of the result folder; empty: none is written.
  std::string output;
  bool overwrite = false;
  bool resume = false;
  FolderExtras extras;
};

// Throws Error where the case has nothing to be fitted.
void CheckFit(const CaseHandle& handle);
// The options of the case with the request's threads.
void SetThreads(const FitRequest& request, Case* c);

// Writes what the programs do to a result folder, report included; the caller
// commits it.
[[nodiscard]] bool WriteFit(const Fit& fit, const FolderExtras& extras,
                            const ResultFolder& folder, std::string* error);

// One file a part of the module; each adds to it what its name says.
void BindCase(pybind11::module_* module);
void BindFit(pybind11::module_* module);
void BindStudy(pybind11::module_* module);
void BindModes(pybind11::module_* module);
void BindSimulation(pybind11::module_* module);
void BindPlan(pybind11::module_* module);

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_FIT_H_
