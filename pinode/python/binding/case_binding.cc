#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/case/results/case_check.h"
#include "pinode/case/results/check_files.h"
#include "pinode/case/results/matlab_results.h"
#include "pinode/case/results/result_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_folder.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/python/binding/case_tree.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/python/binding/watch.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/model/modal_mass.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

CasePurpose PurposeOf(const std::string& name) {
  if (name == "fit") return CasePurpose::kFit;
  if (name == "check") return CasePurpose::kCheck;
  if (name == "simulation") return CasePurpose::kSimulation;
  if (name == "planning") return CasePurpose::kPlanning;
  throw Error("purpose is '" + name +
              "', expected fit, check, simulation or planning");
}

const char* PurposeName(CasePurpose purpose) {
  return purpose == CasePurpose::kFit          ? "fit"
         : purpose == CasePurpose::kCheck      ? "check"
         : purpose == CasePurpose::kSimulation ? "simulation"
                                               : "planning";
}

// Finds the purpose: a fit or a check, unless a record has no channel, as only
// plans allow.
bool FindPurpose(const std::string& path, CasePurpose* purpose,
                 std::string* error) {
  std::string text;
  TomlValue tree;
  if (!ReadTextFile(path, &text, error) ||
      !ParseToml(text, path, &tree, error)) {
    return false;
  }
  *purpose = CasePurpose::kCheck;
  const TomlValue* records = tree.Find("record");
  if (records == nullptr) return true;
  for (const TomlValue& record : records->elements) {
    const TomlValue* excitation = record.Find("excitation");
    const TomlValue* channels = record.Find("channel");
    if ((excitation == nullptr || excitation->text != "ambient") &&
        (channels == nullptr || channels->elements.empty())) {
      *purpose = CasePurpose::kPlanning;
    }
  }
  return true;
}

std::shared_ptr<CaseHandle> ReadFile(const std::string& path,
                                     const std::string& purpose) {
  auto handle = std::make_shared<CaseHandle>();
  const bool any = purpose == "any";
  if (!any) handle->purpose = PurposeOf(purpose);
  RequireInterruptibly([handle, path, any](std::string* error) {
    if (any && !FindPurpose(path, &handle->purpose, error)) return false;
    Case* c = &handle->c;
    switch (handle->purpose) {
      case CasePurpose::kFit:
        return ReadCase(path, c, error);
      case CasePurpose::kCheck:
        return ReadCaseForCheck(path, c, error);
      case CasePurpose::kSimulation:
        return ReadCaseForSimulation(path, c, error);
      case CasePurpose::kPlanning:
        break;
    }
    return ReadCaseForPlanning(path, /*force_dof=*/"", c, error);
  });
  return handle;
}

std::shared_ptr<CaseHandle> ReadTree(const py::object& tree,
                                     const std::string& path,
                                     const std::string& purpose) {
  auto handle = std::make_shared<CaseHandle>();
  handle->purpose = PurposeOf(purpose);
  auto data = std::make_shared<CaseData>();
  const TomlValue value = TreeFromPython(tree, data.get());
  RequireInterruptibly([handle, value, path, data](std::string* error) {
    return ReadCaseTree(value, path, data, handle->purpose, &handle->c, error);
  });
  return handle;
}

const CaseData& DataOf(const Case& c) {
  static const auto& none = *new CaseData();
  return c.data == nullptr ? none : *c.data;
}

py::list Parameters(const CaseHandle& handle) {
  const ParameterLayout layout(handle.c.problem);
  py::list list;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    if (!layout.IsNamed(i)) continue;
    const Parameter& parameter = layout.parameter(i);
    py::dict entry;
    entry["name"] = parameter.name;
    entry["unit"] = parameter.unit;
    entry["value"] = parameter.value;
    entry["lower"] = parameter.lower;
    entry["upper"] = parameter.upper;
    entry["free"] = parameter.free;
    list.append(std::move(entry));
  }
  return list;
}

py::list Records(const CaseHandle& handle) {
  py::list list;
  for (const IdentificationRecord& record : handle.c.problem.records) {
    py::dict entry;
    entry["name"] = record.name;
    entry["role"] =
        record.role == IdentificationRecord::Role::kTrain ? "train" : "holdout";
    entry["num_samples"] = record.num_samples();
    entry["step"] = record.sampling_step() / record.description.time_factor;
    py::list channels;
    for (const MeasuredChannel& channel : record.channels) {
      channels.append(channel.observation.name);
    }
    entry["channels"] = std::move(channels);
    entry["remarks"] = record.description.remarks;
    list.append(std::move(entry));
  }
  for (const AmbientRecord& record : handle.c.problem.ambient) {
    py::dict entry;
    entry["name"] = record.name;
    entry["role"] = "ambient";
    entry["num_samples"] = record.samples.cols();
    entry["step"] = record.sampling_step;
    py::list channels;
    for (const Observation& channel : record.channels) {
      channels.append(channel.name);
    }
    entry["channels"] = std::move(channels);
    entry["remarks"] = py::list();
    list.append(std::move(entry));
  }
  return list;
}

// Returns a record's measured channels as they are fitted, in the units of its
// file.
py::dict Measured(const std::shared_ptr<CaseHandle>& handle,
                  const std::string& name) {
  for (const IdentificationRecord& record : handle->c.problem.records) {
    if (record.name != name) continue;
    py::dict columns;
    columns["time"] = ReadOnly(FromVector(FileTimes(record)));
    for (const MeasuredChannel& channel : record.channels) {
      columns[py::str(channel.observation.name)] =
          Samples(channel, py::cast(handle));
    }
    return columns;
  }
  throw Error("there is no record '" + name + "'");
}

// Returns frequencies, damping ratios and shapes of the present model.
py::dict Modes(const CaseHandle& handle) {
  const StructuralDynamics& dynamics = *handle.c.problem.dynamics;
  const StructuralModel model = dynamics.HeldModel(dynamics.Parameters());
  if (model.num_dofs() == 0) {
    throw Error(
        "the motion of every DOF is prescribed, so that there are no "
        "modes");
  }
  ModalProperties modes;
  std::string error;
  Require(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error),
      error);
  py::dict result;
  result["frequencies_hz"] = FromVector(
      handle.c.problem.description.HzPerModelFrequency() * modes.frequency_hz);
  result["damping_ratios"] = FromVector(modes.damping_ratio);
  result["dofs"] = model.dof_names;
  result["shapes"] = FromMatrix(modes.mode_shapes);
  const ModalMasses masses = EffectiveModalMasses(model, modes.mode_shapes);
  result["directions"] = model.directions;
  result["participation"] = FromMatrix(masses.participation);
  result["effective_masses"] = FromMatrix(masses.effective);
  result["moving_masses"] = FromVector(masses.moving);
  return result;
}

// Returns (data, row indices, column pointers, size); None if there is no
// matrix.
py::object Compressed(const SparseMatrix& matrix) {
  if (matrix.rows() == 0) return py::none();
  return py::make_tuple(FromSparse(matrix), matrix.rows());
}

// Returns the matrices of a finite-element model, for all DOFs of the export,
// and those of its groups.
py::dict FullMatrices(const CaseHandle& handle) {
  if (handle.c.finite_element == nullptr) {
    throw Error(
        "the case has no finite-element model; its matrices are mass, damping "
        "and stiffness");
  }
  const ReducedStructure& structure = *handle.c.finite_element;
  const std::vector<GroupTerm>& terms = handle.c.problem.dynamics->groups();
  py::dict groups;
  for (size_t i = 0; i < terms.size() && i < structure.groups.size(); ++i) {
    groups[py::str(terms[i].group.name)] =
        Compressed(structure.groups[i].matrix);
  }
  py::dict result;
  result["dofs"] = structure.exported.dof_names;
  result["mass"] = Compressed(structure.exported.mass);
  result["damping"] = Compressed(structure.damping);
  result["stiffness"] = Compressed(structure.exported.stiffness);
  result["groups"] = std::move(groups);
  return result;
}

py::list Steps(const CaseHandle& handle) {
  py::list list;
  const std::vector<IdentificationRecord>& records = handle.c.problem.records;
  for (size_t r = 0; r < records.size() && r < handle.c.substeps.size(); ++r) {
    const SubstepChoice& choice = handle.c.substeps[r];
    py::dict entry;
    entry["record"] = records[r].name;
    entry["integrator"] = IntegratorName(choice.integrator);
    entry["substeps"] = choice.integrator == Integrator::kExponential
                            ? records[r].exponential_steps
                            : records[r].substeps;
    entry["fastest_mode"] = choice.stability.largest_eigenvalue;
    list.append(std::move(entry));
  }
  return list;
}

// Checks a case; with `output`, writes a folder as pinode_check does.
py::dict Check(const std::shared_ptr<const CaseHandle>& given,
               const std::string& output, bool overwrite, bool mat) {
  const CaseHandle& handle = *given;
  const IdentificationProblem& problem = handle.c.problem;
  const bool has_measurements = !problem.records.empty() ||
                                !problem.modal.empty() || problem.HasSpectra();
  if (has_measurements) CheckFit(handle);
  ResultFolder folder;
  std::string error;
  Require(output.empty() ||
              (MayGiveWayToCheck(output, &error) &&
               folder.Open(output, overwrite, /*resume=*/false, &error)),
          error);
  const auto checked = std::make_shared<CaseCheck>();
  RunInterruptibly([given, checked] { *checked = CheckCase(given->c); });
  const CaseCheck& check = *checked;
  bool ok = output.empty();
  if (!ok) {
    py::gil_scoped_release release;
    ok = WriteCheckFiles(handle.c, check, folder.working_path(), &error) &&
         (!mat || WriteMatlabResults(folder.working_path(), &error)) &&
         folder.Commit(&error);
  }
  Require(ok, error);
  py::dict result;
  result["steps"] = Steps(handle);
  result["remarks"] = problem.description.remarks;
  if (!has_measurements) return result;
  if (!check.ok()) {
    result["not_assessed"] = check.not_assessed;
    return result;
  }
  const ProblemAssessment& assessment = check.assessment;
  result["num_free"] = assessment.num_free;
  result["num_residuals"] = assessment.num_residuals;
  result["num_starts"] = assessment.num_starts;
  result["undetermined"] = assessment.undetermined;
  result["assessment_remarks"] = assessment.remarks;
  py::list expected;
  for (const ExpectedDeviation& parameter : assessment.expected) {
    py::dict entry;
    entry["name"] = parameter.name;
    entry["unit"] = parameter.unit;
    entry["initial"] = parameter.initial;
    entry["sigma"] = parameter.sigma;
    expected.append(std::move(entry));
  }
  result["expected"] = std::move(expected);
  return result;
}

}  // namespace

py::array Samples(const MeasuredChannel& channel, const py::handle& owner) {
  const double factor = channel.description.factor;
  return factor == 1.0 ? View(channel.values, owner)
                       : ReadOnly(FromVector(channel.values / factor));
}

void CheckFit(const CaseHandle& handle) {
  if (handle.purpose == CasePurpose::kSimulation ||
      handle.purpose == CasePurpose::kPlanning) {
    throw Error(
        std::string("the case is for a ") +
        (handle.purpose == CasePurpose::kPlanning ? "plan" : "simulation") +
        " and has no measured responses, expected one with values for its "
        "channels");
  }
  std::string error;
  Require(handle.c.problem.IsValid(&error), error);
}

void BindCase(py::module_* module) {
  using Handle = std::shared_ptr<CaseHandle>;
  py::class_<CaseHandle, Handle>(*module, "CaseHandle")
      .def_static("read", &ReadFile, py::arg("path"), py::arg("purpose"))
      .def_static("from_tree", &ReadTree, py::arg("tree"), py::arg("path"),
                  py::arg("purpose"))
      .def("tree",
           [](const CaseHandle& handle) {
             return TreeToPython(*handle.c.source, DataOf(handle.c));
           })
      .def(
          "toml",
          [](const CaseHandle& handle) { return FormatToml(*handle.c.source); })
      .def(
          "save",
          [](const CaseHandle& handle, const std::string& folder) {
            std::string error;
            Require(WriteCaseFolder(*handle.c.source, DataOf(handle.c),
                                    handle.c.path, folder, &error),
                    error);
          },
          py::arg("folder"))
      .def_property_readonly(
          "path", [](const CaseHandle& handle) { return handle.c.path; })
      .def_property_readonly(
          "purpose",
          [](const CaseHandle& handle) { return PurposeName(handle.purpose); })
      .def_property_readonly("title",
                             [](const CaseHandle& handle) {
                               return handle.c.problem.description.title;
                             })
      .def_property_readonly(
          "dofs",
          [](const CaseHandle& handle) {
            return handle.c.problem.dynamics->model().dof_names;
          })
      .def_property_readonly("mass",
                             [](const Handle& handle) {
                               return View(
                                   handle->c.problem.dynamics->model().mass,
                                   py::cast(handle));
                             })
      .def_property_readonly("damping",
                             [](const Handle& handle) {
                               return View(
                                   handle->c.problem.dynamics->model().damping,
                                   py::cast(handle));
                             })
      .def_property_readonly(
          "stiffness",
          [](const Handle& handle) {
            return View(handle->c.problem.dynamics->model().stiffness,
                        py::cast(handle));
          })
      .def("parameters", &Parameters)
      .def("records", &Records)
      .def("measured", &Measured, py::arg("record"))
      .def("modes", &Modes)
      .def("full_matrices", &FullMatrices)
      .def("check", &Check, py::arg("output") = "",
           py::arg("overwrite") = false, py::arg("mat") = false);
}

}  // namespace pinode::python
