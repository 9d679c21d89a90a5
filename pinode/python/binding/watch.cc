#include "pinode/python/binding/watch.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "pinode/python/binding/convert.h"

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

// Interval at which signals are checked.
constexpr std::chrono::milliseconds kSignalInterval(50);

// Work in a thread of its own.
class Work {
 public:
  explicit Work(std::function<void()> work) : work_(std::move(work)) {}

  // Does the work; called in that thread.
  void Do() {
    try {
      work_();
    } catch (...) {
      failure_ = std::current_exception();
    }
    // Its data are freed before it is reported as done.
    work_ = nullptr;
    const std::lock_guard<std::mutex> lock(mutex_);
    is_done_ = true;
    done_.notify_all();
  }

  // True if it is done, after `kSignalInterval` at most. Needs the
  // interpreter's lock, and releases it meanwhile.
  bool Wait() {
    py::gil_scoped_release release;
    std::unique_lock<std::mutex> lock(mutex_);
    return done_.wait_for(lock, kSignalInterval, [this] { return is_done_; });
  }

  // Rethrows the exception of finished work.
  void Rethrow() {
    if (failure_ != nullptr) std::rethrow_exception(failure_);
  }

 private:
  std::function<void()> work_;
  std::mutex mutex_;
  std::condition_variable done_;
  bool is_done_ = false;
  std::exception_ptr failure_;
};

// Abandoned work of the process that began it. Used under the interpreter's
// lock alone.
struct UnheardWork {
  pid_t process = 0;
  std::vector<std::shared_ptr<Work>> work;
};

UnheardWork& Unheard() {
  static auto& unheard = *new UnheardWork();
  // A forked process does not inherit threads.
  if (unheard.process != getpid()) unheard = {getpid(), {}};
  return unheard;
}

// Waits for abandoned work; a second Ctrl-C ends the wait.
void WaitForUnheard() {
  for (const std::shared_ptr<Work>& work : Unheard().work) {
    while (!work->Wait()) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
  }
}

}  // namespace

void RunInterruptibly(std::function<void()> work) {
  const auto begun = std::make_shared<Work>(std::move(work));
  try {
    std::thread([begun] { begun->Do(); }).detach();
  } catch (const std::system_error&) {
    // No thread could be started.
    py::gil_scoped_release release;
    begun->Do();
  }
  while (!begun->Wait()) {
    if (PyErr_CheckSignals() != 0) {
      Unheard().work.push_back(begun);
      throw py::error_already_set();
    }
  }
  begun->Rethrow();
}

void RequireInterruptibly(std::function<bool(std::string* error)> work) {
  struct Outcome {
    bool ok = false;
    std::string error;
  };
  const auto outcome = std::make_shared<Outcome>();
  RunInterruptibly([outcome, work = std::move(work)] {
    outcome->ok = work(&outcome->error);
  });
  Require(outcome->ok, outcome->error);
}

void WaitForWorkAtExit() {
  py::module_::import("atexit").attr("register")(
      py::cpp_function(&WaitForUnheard));
}

PythonWatch::PythonWatch(py::object callback)
    : callback_(std::move(callback)) {}

bool PythonWatch::OnIteration(const std::string& what,
                              const IdentificationProblem&,
                              const IdentificationProgress& progress) {
  return GoOn(what, &progress);
}

bool PythonWatch::StopsProfiles() { return !GoOn("", nullptr); }

void PythonWatch::OnTrouble(const std::string& sentence) {
  troubles_.push_back(sentence);
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
    // At Ctrl-C the best result so far is kept, wherever the signal was
    // noticed.
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
