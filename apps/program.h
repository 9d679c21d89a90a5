// Common part of all programs: flags, exit statuses, interrupts.

#ifndef PINODE_APPS_PROGRAM_H_
#define PINODE_APPS_PROGRAM_H_

#include <string>
#include <vector>

#include "pinode/case/results/result_folder.h"

namespace pinode {

// Exit statuses of every program.
inline constexpr int kExitDone = 0;
inline constexpr int kExitNotUsable = 1;    // ran; files, or one line, say so
inline constexpr int kExitBadInput = 2;     // one line on standard error
inline constexpr int kExitInterrupted = 3;  // best so far written

// Runs the program and returns its exit status; each program defines it once.
// `main` is in program.cc. It reports a failure if standard output, which may
// be the only result, could not be written.
int RunProgram(int argc, char** argv);

// Sets the flags from the command line and starts logging to standard error.
// gflags' own parser exits with status 1 for help and errors alike, so names
// and values are checked here. Returns true if the program is to continue.
// Otherwise *status is its exit status: kExitDone after --help or --version,
// kExitBadInput after one line about the error. Arguments that are no flags go
// to `files`; without it they are refused.
[[nodiscard]] bool ParseFlags(int argc, char** argv, const std::string& usage,
                              int* status,
                              std::vector<std::string>* files = nullptr);

// Prints `message` as one line of an error and returns kExitBadInput.
int Refuse(const std::string& message);

// Reports results that could not be written, and returns kExitNotUsable. If the
// folder has a checkpoint, the line says how to continue.
int CannotWrite(const std::string& message, const ResultFolder& folder);

// Returns the command line as it could be typed again.
std::string CommandLine(int argc, char** argv);

// Makes SIGINT, SIGTERM and SIGHUP set a mark instead of ending the process,
// however many come: `timeout` sends two. Only a third Ctrl-C ends the process
// without results. Before this call, and after ParseFlags, they end the process
// at once with status kExitInterrupted and one line. Programs that save nothing
// on their way call it before they write their folder, which so becomes whole.
void CatchInterrupts();
bool Interrupted();

}  // namespace pinode

#endif  // PINODE_APPS_PROGRAM_H_
