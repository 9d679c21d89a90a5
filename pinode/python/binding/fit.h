// Objects that Python holds: a case, and a fit with its results.

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

// Returns a channel's samples in the units of its file, as a read-only array.
// It is a view into `owner` if these are the model's units.
pybind11::array Samples(const MeasuredChannel& channel,
                        const pybind11::handle& owner);

struct Fit {
  Case c;  // as fitted: without terms that were left out, and so on
  IdentificationSummary summary;
  IdentifiedModel model;
  // Damage analysis or discovery to which the fit belongs; null: neither.
  std::shared_ptr<const DamageResult> damage;
  std::shared_ptr<const Discovery> discovery;
  double seconds = 0.0;  // elapsed time
  // Sentences on problems besides the fit.
  std::vector<std::string> troubles;
};

// Optional files of a result folder.
struct FolderExtras {
  bool mat = false;  // results.mat
  // Input deck, which is written again with the results; empty: none.
  std::string deck;
};

// Settings of a fit.
struct FitRequest {
  int threads = 0;  // 0: as the case says
  pybind11::object callback;
  // Path of the result folder; empty: none is written.
  std::string output;
  bool overwrite = false;
  bool resume = false;
  FolderExtras extras;
};

// Data of a fit at work, which may outlive the call that began it.
struct FitWork {
  std::shared_ptr<Fit> fit = std::make_shared<Fit>();
  IdentifiedModel begin_from;
  FolderExtras extras;
  ResultFolder folder;
  bool ok = false;
  std::string error;
};

// Opens the request's folder of results, if it has one. Throws Error.
void OpenFolder(const FitRequest& request, FitWork* work);

// Throws Error if the case has no free parameters or data for a fit.
void CheckFit(const CaseHandle& handle);
// Sets the request's threads in the options of the case.
void SetThreads(const FitRequest& request, Case* c);

// Writes the result folder as the programs do, report included; the caller
// commits it.
[[nodiscard]] bool WriteFit(const Fit& fit, const FolderExtras& extras,
                            const ResultFolder& folder, std::string* error);

// Add the parts of the module, one file each.
void BindCase(pybind11::module_* module);
void BindFit(pybind11::module_* module);
void BindStudy(pybind11::module_* module);
void BindFrfs(pybind11::module_* module);
void BindModes(pybind11::module_* module);
void BindSimulation(pybind11::module_* module);
void BindPlan(pybind11::module_* module);

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_FIT_H_
