// The extension module behind Python's package pinode.

#include <pybind11/pybind11.h>

#include "pinode/base/logging.h"
#include "pinode/dynamics/element_library.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/python/binding/watch.h"
#include "pinode/report/report.h"

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
}
