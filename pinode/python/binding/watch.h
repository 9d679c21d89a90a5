// Library calls watched from Python.

#ifndef PINODE_PYTHON_BINDING_WATCH_H_
#define PINODE_PYTHON_BINDING_WATCH_H_

#include <pybind11/pybind11.h>

#include <atomic>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "pinode/case/run/fit_case.h"

namespace pinode::python {

// Runs the library without the interpreter's lock. Takes the lock to ask for
// signals and to call back, and ends fits at Ctrl-C. Any other exception of a
// signal's handler or of the callback ends the fit too, and is thrown on when
// the fit is over.
class PythonWatch : public CaseWatch {
 public:
  // `callback` is called with a dictionary after each iteration, and ends the
  // fit by returning False. None: there is none.
  explicit PythonWatch(pybind11::object callback);

  bool OnIteration(const std::string& what,
                   const IdentificationProblem& problem,
                   const IdentificationProgress& progress) override;
  bool StopsProfiles() override;
  void OnTrouble(const std::string& sentence) override;

  // Calls `work`, which may use this watch, without the lock.
  template <typename Work>
  void Run(const Work& work) {
    {
      pybind11::gil_scoped_release release;
      work();
    }
    Rethrow();
  }

  // True if the user stopped the fit.
  bool stopped() const { return stopped_; }
  // Sentences on problems besides the fit.
  const std::vector<std::string>& troubles() const { return troubles_; }

 private:
  void Rethrow();
  bool GoOn(const std::string& what, const IdentificationProgress* progress);

  pybind11::object callback_;
  std::atomic<bool> stopped_{false};
  std::exception_ptr failure_;
  std::vector<std::string> troubles_;
};

// Calls `work` in a thread of its own, without the interpreter's lock, and
// checks for signals meanwhile. Exceptions of `work` are rethrown. Ctrl-C, or
// another exception of a signal's handler, is thrown within a twentieth of a
// second. `work` then finishes in the background, its result is discarded, and
// the interpreter waits for it before it ends. `work` has to own all its data
// and must not touch Python.
void RunInterruptibly(std::function<void()> work);

// Calls `work` in the same way, and throws Error with its sentence if it
// returns false.
void RequireInterruptibly(std::function<bool(std::string* error)> work);

// Makes the interpreter wait for such work when it ends.
void WaitForWorkAtExit();

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_WATCH_H_
