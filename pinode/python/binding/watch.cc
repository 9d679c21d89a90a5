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

// Time after an interrupt in which another one counts as the second.
constexpr std::chrono::seconds kSecondPress(10);

// True if an interrupt was noticed within `kSecondPress` before this call,
// which notices another one. Used under the interpreter's lock alone.
bool IsSecondPress() {
  using Steady = std::chrono::steady_clock;
  static Steady::time_point last = Steady::time_point::min();
  const Steady::time_point now = Steady::now();
  const bool second =
      last != Steady::time_point::min() && now - last < kSecondPress;
  last = now;
  return second;
}

}  // namespace

class Work {
 public:
  explicit Work(std::function<void()> work) : work_(std::move(work)) {}

  // Starts the work in a thread. If no thread can be started, it is done when
  // this returns. Needs the interpreter's lock.
  static void Begin(const std::shared_ptr<Work>& work) {
    try {
      std::thread([work] { work->Do(); }).detach();
    } catch (const std::system_error&) {
      {
        const std::lock_guard<std::mutex> lock(work->mutex_);
        work->is_abandoned_ = true;
      }
      py::gil_scoped_release release;
      work->Do();
    }
  }

  // Calls `call` in the thread that waits, with the interpreter's lock, and
  // returns when it has returned. Called by the work. Does nothing if nobody
  // waits any more.
  void Ask(const std::function<void()>& call) {
    const std::lock_guard<std::mutex> turn(turn_);
    std::unique_lock<std::mutex> lock(mutex_);
    if (is_abandoned_) return;
    call_ = &call;
    changed_.notify_all();
    changed_.wait(lock, [this] { return call_ == nullptr || is_abandoned_; });
    call_ = nullptr;
  }

  // True if it is done. Answers a call of the work, or waits for one for
  // `kSignalInterval` at most. Needs the interpreter's lock, and releases it
  // meanwhile.
  bool Wait() {
    const std::function<void()>* call = nullptr;
    {
      py::gil_scoped_release release;
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait_for(lock, kSignalInterval,
                        [this] { return is_done_ || call_ != nullptr; });
      if (is_done_) return true;
      call = call_;
    }
    if (call == nullptr) return false;
    (*call)();
    const std::lock_guard<std::mutex> lock(mutex_);
    call_ = nullptr;
    changed_.notify_all();
    return false;
  }

  // Lets it finish in the background, without any more answers.
  void Abandon() {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_abandoned_ = true;
    changed_.notify_all();
  }

  // Rethrows the exception of finished work.
  void Rethrow() {
    if (failure_ != nullptr) std::rethrow_exception(failure_);
  }

 private:
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
    changed_.notify_all();
  }

  std::function<void()> work_;
  std::mutex turn_;  // held by the thread of the work that asks
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* call_ = nullptr;
  bool is_done_ = false;
  bool is_abandoned_ = false;
  std::exception_ptr failure_;
};

namespace {

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
  Work::Begin(begun);
  while (!begun->Wait()) {
    if (PyErr_CheckSignals() != 0) {
      begun->Abandon();
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
  if (const std::shared_ptr<Work> work = work_.lock()) {
    work->Ask([&] { CallPython(what, progress); });
  }
  return !stopped_;
}

void PythonWatch::CallPython(const std::string& what,
                             const IdentificationProgress* progress) {
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (stopped_ || progress == nullptr || callback_.is_none()) return;
    const py::object answer = callback_(AsDict(what, *progress));
    if (answer.ptr() == Py_False) stopped_ = true;
  } catch (const py::error_already_set& failure) {
    KeepFailure(failure);
  }
}

void PythonWatch::KeepFailure(const py::error_already_set& failure) {
  stopped_ = true;
  if (failure.matches(PyExc_KeyboardInterrupt)) {
    // At Ctrl-C the best result so far is kept, wherever the signal was
    // noticed.
    const bool is_second = IsSecondPress() || interrupted_;
    interrupted_ = true;
    if (!is_second) return;
    abandoned_ = true;
  }
  failure_ = std::current_exception();
}

void PythonWatch::Run(std::function<void()> work) {
  const auto begun = std::make_shared<Work>(std::move(work));
  work_ = begun;
  Work::Begin(begun);
  bool done = false;
  while (!done && !abandoned_) {
    done = begun->Wait();
    if (!done) CallPython("", nullptr);
  }
  // Both need the interpreter's lock when they are freed.
  callback_ = py::object();
  const std::exception_ptr failure = std::exchange(failure_, nullptr);
  if (!done) {
    begun->Abandon();
    Unheard().work.push_back(begun);
  } else {
    begun->Rethrow();
  }
  if (failure != nullptr) std::rethrow_exception(failure);
}

}  // namespace pinode::python
