// Library calls watched from Python.

#ifndef PINODE_PYTHON_BINDING_WATCH_H_
#define PINODE_PYTHON_BINDING_WATCH_H_

#include <pybind11/pybind11.h>

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pinode/case/run/fit_case.h"

namespace pinode::python {

// Work in a thread of its own, for which a thread of Python waits.
class Work;

// Runs a fit without the interpreter's lock, and ends it at Ctrl-C: the best
// result so far is kept. A second Ctrl-C, in the same fit or within ten seconds
// of the first, is thrown as KeyboardInterrupt; thus a loop of fits ends too.
// Any other exception of a signal's handler or of the callback ends the fit and
// is thrown when the fit is over.
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

  // Calls `work`, which may use this watch, in another thread, and waits for
  // it. The callback is called in this thread. After a second Ctrl-C `work`
  // finishes in the background; therefore it has to own all its data, this
  // watch included, and must not touch Python.
  void Run(std::function<void()> work);

  // True if the user stopped the fit.
  bool stopped() const { return stopped_; }
  // True if a second Ctrl-C ended the call. The result is discarded then, and
  // must not be written.
  bool abandoned() const { return abandoned_; }
  // Sentences on problems besides the fit.
  const std::vector<std::string>& troubles() const { return troubles_; }

 private:
  bool GoOn(const std::string& what, const IdentificationProgress* progress);
  // Asks for signals, and calls back with `progress` unless that is null.
  void CallPython(const std::string& what,
                  const IdentificationProgress* progress);
  void KeepFailure(const pybind11::error_already_set& failure);

  pybind11::object callback_;
  std::weak_ptr<Work> work_;
  std::atomic<bool> stopped_{false};
  std::atomic<bool> abandoned_{false};
  bool interrupted_ = false;
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
