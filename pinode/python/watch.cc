#include "pinode/python/watch.h"

#include <utility>

namespace pinode::python {

namespace py = pybind11;

namespace {

py::dict AsDict(const std::string& what,
                const IdentificationProgress& progress) {
  py::dict dict;
  dict["fit"] = what;
  dict["stage"] = progress.stage;
  dict["num_stages"] = progress.num_stages;
  dict["iteration"] = progress.iteration;
  dict["cost"] = progress.cost;
  dict["largest_gap"] = progress.largest_gap;
  dict["free_run_error"] = progress.free_run_error;
  dict["elapsed_seconds"] = progress.elapsed_seconds;
  dict["expected_seconds"] = progress.expected_seconds;
  return dict;
}

}  // namespace

PythonWatch::PythonWatch(py::object callback)
    : callback_(std::move(callback)) {}

FitWatch PythonWatch::watch() {
  FitWatch watch;
  watch.on_iteration = [this](const std::string& what,
                              const IdentificationProgress& progress) {
    return GoOn(what, &progress);
  };
  watch.stop = [this] { return !GoOn("", nullptr); };
  watch.on_trouble = [this](const std::string& sentence) {
    troubles_.push_back(sentence);
  };
  return watch;
}

bool PythonWatch::GoOn(const std::string& what,
                       const IdentificationProgress* progress) {
  if (stopped_) return false;
  py::gil_scoped_acquire acquire;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (progress != nullptr && !callback_.is_none()) {
      const py::object answer = callback_(AsDict(what, *progress));
      if (answer.ptr() == Py_False) stopped_ = true;
    }
  } catch (py::error_already_set& failure) {
    stopped_ = true;
    // At Ctrl-C the best so far is kept, from wherever it was noticed.
    if (!failure.matches(PyExc_KeyboardInterrupt)) {
      failure_ = std::current_exception();
    }
  }
  return !stopped_;
}

void PythonWatch::Rethrow() {
  if (failure_ != nullptr) std::rethrow_exception(std::exchange(failure_, {}));
}

}  // namespace pinode::python
