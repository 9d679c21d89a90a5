#include "pinode/report/gnuplot.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <string_view>
#include <utility>

// POSIX leaves the declaration to the program; glibc has one as an extension.
extern char** environ;  // NOLINT(readability-redundant-declaration)

namespace pinode {
namespace {

using Clock = std::chrono::steady_clock;

// File descriptor that closes itself.
class Descriptor {
 public:
  Descriptor() = default;
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void Reset(int descriptor) {
    Close();
    descriptor_ = descriptor;
  }
  void Close() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }
  int get() const { return descriptor_; }
  bool is_open() const { return descriptor_ >= 0; }

 private:
  int descriptor_ = -1;
};

bool MakePipe(Descriptor* read_end, Descriptor* write_end) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return false;
  read_end->Reset(ends[0]);
  write_end->Reset(ends[1]);
  return fcntl(ends[0], F_SETFL, O_NONBLOCK) == 0;
}

// Makes an unnamed file that contains `text`. From a file gnuplot reads in
// blocks; from a pipe as standard input it reads byte by byte.
bool MakeInput(std::string_view text, Descriptor* input) {
  input->Reset(memfd_create("gnuplot", MFD_CLOEXEC));
  if (!input->is_open()) return false;
  while (!text.empty()) {
    const ssize_t count = write(input->get(), text.data(), text.size());
    if (count < 0 && errno != EINTR) return false;
    if (count > 0) text.remove_prefix(static_cast<size_t>(count));
  }
  return lseek(input->get(), 0, SEEK_SET) == 0;
}

std::string SystemError(int code) { return std::strerror(code); }

// Starts the program in a process group of its own, so that Ctrl-C at the
// terminal stops a fit but not its figures.
int Start(const std::string& program, int input, int output, int complaints,
          pid_t* process) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, complaints, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK |
                                            POSIX_SPAWN_SETSIGDEF |
                                            POSIX_SPAWN_SETPGROUP);
  // posix_spawnp takes char*, and changes nothing.
  std::string name = program;
  std::string defaults = "--default-settings";
  // Its standard input, opened as a file.
  std::string file = "/dev/stdin";
  const bool can_open = access("/proc/self/fd", X_OK) == 0;
  char* const arguments[] = {name.data(), defaults.data(),
                             can_open ? file.data() : nullptr, nullptr};
  const int code = posix_spawnp(process, name.c_str(), &actions, &attributes,
                                arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return code;
}

// Reads the available output; closes *from at its end.
void Drain(Descriptor* from, std::string* to) {
  std::array<char, 65536> buffer;
  while (from->is_open()) {
    const ssize_t count = read(from->get(), buffer.data(), buffer.size());
    if (count > 0) {
      to->append(buffer.data(), static_cast<size_t>(count));
    } else if (count < 0 && errno == EINTR) {
      continue;
    } else {
      if (count == 0 || errno != EAGAIN) from->Close();
      return;
    }
  }
}

// Returns the first few lines with content, joined to one line.
std::string Condense(const std::string& complaint) {
  std::string line;
  for (const char byte : complaint) {
    const bool blank = byte == ' ' || byte == '\n' || byte == '\t';
    if (blank && (line.empty() || line.back() == ' ')) continue;
    line += blank ? ' ' : byte;
    if (line.size() >= 300) break;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

// One run of the program, and its connections.
struct GnuplotRun {
  pid_t process = -1;
  Descriptor answer;
  Descriptor complaints;
};

bool Begin(const std::string& program, std::string_view script, GnuplotRun* run,
           std::string* error) {
  Descriptor input, their_answer, their_complaints;
  if (!MakeInput(script, &input)) {
    *error = "no memory for gnuplot's script: " + SystemError(errno);
    return false;
  }
  if (!MakePipe(&run->answer, &their_answer) ||
      !MakePipe(&run->complaints, &their_complaints)) {
    *error = "no pipe to gnuplot: " + SystemError(errno);
    return false;
  }
  const int code = Start(program, input.get(), their_answer.get(),
                         their_complaints.get(), &run->process);
  if (code != 0) {
    *error = "'" + program + "' could not be started: " + SystemError(code);
    return false;
  }
  return true;
}

// Reads the output until the program closes it. Returns false if the deadline
// passes before.
bool Listen(Clock::time_point deadline, GnuplotRun* run, std::string* answer,
            std::string* complaint) {
  while (run->answer.is_open() || run->complaints.is_open()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
                          deadline - Clock::now())
                          .count();
    if (left <= 0) return false;
    // Closed descriptors are -1, which poll() ignores.
    pollfd events[2] = {{run->answer.get(), POLLIN, 0},
                        {run->complaints.get(), POLLIN, 0}};
    if (poll(events, 2, static_cast<int>(left)) < 0 && errno != EINTR) break;
    if (events[0].revents != 0) Drain(&run->answer, answer);
    if (events[1].revents != 0) Drain(&run->complaints, complaint);
  }
  return true;
}

// Waits until the program has ended, and kills it at the deadline, or at once
// if `timed_out`. Returns false then; else *failed tells if it ended with an
// error.
bool WaitForEnd(pid_t process, Clock::time_point deadline, bool timed_out,
                bool* failed) {
  int status = 0;
  pid_t ended = 0;
  for (;;) {
    if (timed_out) kill(process, SIGKILL);
    ended = waitpid(process, &status, timed_out ? 0 : WNOHANG);
    if (ended > 0 || (ended < 0 && errno != EINTR)) break;
    // It closed its outputs and still runs: rare, so a plain wait suffices.
    if (ended == 0) {
      timed_out = Clock::now() >= deadline;
      usleep(1000);
    }
  }
  // If the host program ignores SIGCHLD, no status is available.
  *failed =
      ended == process && (!WIFEXITED(status) || WEXITSTATUS(status) != 0);
  return !timed_out;
}

}  // namespace

bool RunGnuplot(const std::string& script, const GnuplotOptions& options,
                std::string* output, std::string* error) {
  const Clock::time_point deadline =
      Clock::now() +
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
          std::clamp(options.timeout_seconds, 0.0, 86400.0)));
  GnuplotRun run;
  if (!Begin(options.program, script, &run, error)) return false;
  std::string svg, complaint;
  const bool answered = Listen(deadline, &run, &svg, &complaint);
  bool failed = false;
  if (!WaitForEnd(run.process, deadline, /*timed_out=*/!answered, &failed)) {
    *error = "gnuplot did not finish in time";
    return false;
  }
  if (failed || svg.empty()) {
    *error = "gnuplot failed";
    const std::string reason = Condense(complaint);
    if (!reason.empty()) *error += ": " + reason;
    return false;
  }
  *output = std::move(svg);
  return true;
}

std::string GnuplotString(const std::string& text) {
  std::string quoted = "'";
  for (const char byte : text) {
    const unsigned char code = static_cast<unsigned char>(byte);
    if (byte == '\'') {
      // gnuplot expects a doubled quote, but not at the beginning of a string,
      // where it reads the two as an empty one.
      quoted += "\u2019";
    } else {
      quoted += code < 0x20 || code == 0x7F ? ' ' : byte;
    }
  }
  return quoted + "'";
}

}  // namespace pinode
