// The extension module behind Python's package pinode.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/dynamics/element_library.h"
#include "pinode/dynamics/elements.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/python/binding/watch.h"
#include "pinode/report/report.h"

namespace {

// ElementTypes returns the parameters of each type, with True for those that
// must be given.
pybind11::dict ElementTypes() {
  pybind11::dict types;
  for (const std::string& type : pinode::ElementTypes()) {
    pybind11::dict parameters;
    for (const pinode::ElementParameterInfo& info :
         pinode::ElementParameters(type)) {
      parameters[info.name.c_str()] = std::isnan(info.default_value);
    }
    types[type.c_str()] = std::move(parameters);
  }
  return types;
}

// FunctionError returns what is wrong with a function of these features, or an
// empty text.
std::string FunctionError(const std::string& text,
                          const std::vector<std::string>& features) {
  pinode::LibraryFunction function;
  std::string error;
  const bool parsed =
      pinode::LibraryFunction::Parse(text, features, &function, &error);
  return parsed ? "" : error;
}

}  // namespace

PYBIND11_MODULE(_pinode, module) {
  using namespace pinode::python;
  // Log messages of Ceres and others do not belong in a notebook.
  FLAGS_logtostderr = true;
  FLAGS_minloglevel = google::GLOG_FATAL;
  module.doc() = "Structural identification; see the package pinode.";
  module.attr("__version__") = pinode::PinodeVersion();
  pybind11::register_exception<Error>(module, "Error", PyExc_ValueError);
  BindCase(&module);
  BindFit(&module);
  BindStudy(&module);
  BindSimulation(&module);
  BindModes(&module);
  BindFrfs(&module);
  BindPlan(&module);
  WaitForWorkAtExit();
  module.def("element_compiler_flags", &pinode::ElementCompilerFlags);
  module.def("element_types", &ElementTypes);
  module.def("function_error", &FunctionError, pybind11::arg("text"),
             pybind11::arg("features"));
}
