#include "apps/program.h"

#include <dlfcn.h>
#include <gflags/gflags.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

#include "apps/help_text.h"
#include "apps/launcher.h"
#include "apps/print.h"
#include "pinode/base/arrays/quiet_hdf5.h"
#include "pinode/base/free_memory.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/base/unpacked_size.h"
#include "pinode/dynamics/own_code.h"

DEFINE_bool(no_code, false,
            "refuse cases whose elements run code of their own (a `file` of "
            "[[element]]); for cases from strangers");
DEFINE_double(unpacked_gb, 2.0,
              "largest size in GB that one file may take in memory; files may "
              "always take 16 times their own size");

DECLARE_int32(v);
DECLARE_bool(logtostderr);
DECLARE_int32(minloglevel);

namespace pinode {
namespace {

volatile std::sig_atomic_t interrupts = 0;
// False until the program asks for interrupts itself: it has nothing to save.
volatile std::sig_atomic_t is_caught = 0;

void OnInterrupt(int signal) {
  if (is_caught == 0) {
    constexpr char kLine[] = "interrupted; nothing was written\n";
    // A failure to write it cannot be reported either.
    (void)!write(STDERR_FILENO, kLine, sizeof(kLine) - 1);
    _exit(kExitInterrupted);
  }
  interrupts = interrupts + 1;
  if (signal == SIGINT && interrupts > 2) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

void HandleInterrupts() {
  struct sigaction action = {};
  struct sigaction before = {};
  action.sa_handler = OnInterrupt;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // Under nohup SIGHUP is ignored, and stays so.
    sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
    sigaction(signal, &action, nullptr);
  }
}

// Ends the program after an exception that cannot be handled. A lack of memory
// is no fault of the program: it prints a sentence, and written files stay.
[[noreturn]] void OnTerminate() {
  try {
    if (std::current_exception() != nullptr) {
      std::rethrow_exception(std::current_exception());
    }
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr,
                 "out of memory; use fewer samples, sensors or threads. "
                 "If there is a checkpoint, --resume continues from it\n");
    std::fflush(nullptr);
    std::_Exit(kExitNotUsable);
  } catch (...) {
  }
  std::abort();
}

// Returns the name of the flag in "--name", "--name=value" or "--noname"; sets
// *value and *has_value.
std::string FlagName(const std::string& argument, std::string* value,
                     bool* has_value) {
  std::string name = argument.substr(argument[1] == '-' ? 2 : 1);
  const size_t equals = name.find('=');
  *has_value = equals != std::string::npos;
  if (*has_value) {
    *value = name.substr(equals + 1);
    name.resize(equals);
  }
  return name;
}

// Values of a flag of gflags' type, for messages.
std::string ValuesOf(const std::string& type) {
  if (type == "bool") return "true or false";
  if (type == "double") return "a number";
  return "a whole number";
}

}  // namespace

bool ParseFlags(int argc, char** argv, const std::string& usage, int* status,
                std::vector<std::string>* files) {
  *status = kExitBadInput;
  std::set_terminate(OnTerminate);
  // A file above the limit of `ulimit -f` is then an error of its writer.
  std::signal(SIGXFSZ, SIG_IGN);
  QuietHdf5AtExit();
  ReturnFreedMemory();
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.size() < 2 || argument[0] != '-') {
      if (files != nullptr) {
        files->push_back(argument);
        continue;
      }
      gflags::CommandLineFlagInfo info;
      Refuse("'" + argument + "' is not a flag; " +
             (gflags::GetCommandLineFlagInfo("case", &info)
                  ? "write --case=" + argument + ", or see --help"
                  : "see --help"));
      return false;
    }
    std::string value;
    bool has_value = false;
    std::string name = FlagName(argument, &value, &has_value);
    if (name == "help" || name == "h") {
      Print("%s", HelpText(usage).c_str());
      *status = kExitDone;
      return false;
    }
    if (name == "version") {
      Print("%s\n", VersionText(argv[0]).c_str());
      *status = kExitDone;
      return false;
    }
    // --no-code is --no_code.
    std::replace(name.begin(), name.end(), '-', '_');
    gflags::CommandLineFlagInfo info;
    if (!gflags::GetCommandLineFlagInfo(name.c_str(), &info) &&
        name.rfind("no", 0) == 0 && !has_value &&
        gflags::GetCommandLineFlagInfo(name.c_str() + 2, &info) &&
        info.type == "bool") {
      name = name.substr(2);
      value = "false";
      has_value = true;
    }
    if (!gflags::GetCommandLineFlagInfo(name.c_str(), &info)) {
      const std::string nearest = NearestName(name, OwnFlagNames());
      Refuse("unknown flag '--" + name + "'" +
             (nearest.empty() ? "" : ", did you mean '--" + nearest + "'?") +
             "; see --help");
      return false;
    }
    if (!has_value && info.type == "bool") {
      value = "true";
    } else if (!has_value) {
      if (i + 1 >= argc) {
        Refuse("flag '--" + name + "' needs a value");
        return false;
      }
      value = argv[++i];
    }
    if (gflags::SetCommandLineOption(name.c_str(), value.c_str()).empty()) {
      Refuse("flag '--" + name + "' is '" + value + "', expected " +
             ValuesOf(info.type));
      return false;
    }
  }
  if (!(FLAGS_unpacked_gb > 0.0)) {
    Refuse("--unpacked_gb is " + FormatNumber(FLAGS_unpacked_gb) +
           ", expected a positive number of GB");
    return false;
  }
  SetLargestUnpackedBytes(1e9 * FLAGS_unpacked_gb);
  if (FLAGS_no_code) RefuseOwnCode();
  // Launchers of several ranks look after signals themselves.
  if (NumLaunchedRanks() == 1) HandleInterrupts();
  FLAGS_logtostderr = true;
  // Log messages of Ceres and others appear on request only.
  if (FLAGS_v == 0) FLAGS_minloglevel = google::GLOG_FATAL;
  google::InitGoogleLogging(argv[0]);
  return true;
}

int Refuse(const std::string& message) {
  PrintError("%s", message.c_str());
  return kExitBadInput;
}

int CannotWrite(const std::string& message, const ResultFolder& folder) {
  std::error_code status;
  const bool can_resume =
      std::filesystem::exists(folder.checkpoint_path(), status);
  PrintError("%s%s", message.c_str(),
             can_resume ? "; continue with --resume" : "");
  return kExitNotUsable;
}

std::string CommandLine(int argc, char** argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) {
    std::string word = argv[i];
    if (i == 0) word = word.substr(word.find_last_of('/') + 1);
    const bool plain =
        word.find_first_not_of(
            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
            "-_=./,:+@%") == std::string::npos;
    if (!plain) {
      std::string quoted = "'";
      for (const char c : word) {
        quoted += c == '\'' ? "'\\''" : std::string(1, c);
      }
      word = quoted + "'";
    }
    line += (i > 0 ? " " : "") + word;
  }
  return line;
}

void CatchInterrupts() {
  is_caught = 1;
  HandleInterrupts();
}

bool Interrupted() { return interrupts > 0; }

}  // namespace pinode

namespace {

// Starts the program again with one thread in OpenBLAS, if one with threads is
// linked and nobody has said how many. It starts them when it is loaded. Where
// memory is short, they ask for theirs in a loop that never ends.
void UseOneBlasThread(char** argv) {
  constexpr char kVariable[] = "OPENBLAS_NUM_THREADS";
  const auto kind =
      reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_parallel"));
  if (std::getenv(kVariable) != nullptr || kind == nullptr || kind() == 0) {
    return;
  }
  setenv(kVariable, "1", 0);
  execv("/proc/self/exe", argv);
  // If it cannot be started again, it continues as it is.
}

// Ends the process without the end of libraries. Where memory is short,
// OpenBLAS waits there for ever for threads that it could not start, and
// ignores every signal that the program catches.
[[noreturn]] void End(int status) {
#if defined(__SANITIZE_ADDRESS__)
  std::exit(status);  // leaks are looked for at the end
#else
  std::fflush(nullptr);
  std::_Exit(status);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  UseOneBlasThread(argv);
  const int status = pinode::RunProgram(argc, argv);
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) End(status);
  if (errno == 0) {
    // A write before the last one failed and left the buffer empty. Another one
    // to the same place says why.
    std::clearerr(stdout);
    std::fputc('\n', stdout);
    std::fflush(stdout);
  }
  const char* why =
      errno != 0 ? std::strerror(errno) : "an earlier write failed";
  pinode::PrintError("standard output cannot be written: %s", why);
  End(status == pinode::kExitDone ? pinode::kExitNotUsable : status);
}
