// What all programs share: flags, exit statuses, interrupts.

#ifndef PINODE_APPS_PROGRAM_H_
#define PINODE_APPS_PROGRAM_H_

#include <string>

#include "pinode/case/results/result_folder.h"

namespace pinode {

// Exit statuses of every program.
inline constexpr int kExitDone = 0;
inline constexpr int kExitNotUsable = 1;    // ran; files, or one line, say so
inline constexpr int kExitBadInput = 2;     // one line on standard error
inline constexpr int kExitInterrupted = 3;  // best so far written

// The program, of which each has one; returns what it is to exit with. `main`
// is in program.cc: what could not be written to standard output, which may be
// all that there is, does not pass for done.
int RunProgram(int argc, char** argv);

// Sets the flags from the command line and starts logging to standard error.
// gflags' own parser leaves with status 1 on help and on mistakes alike, so
// names and values are checked here. Returns true where the program is to go
// on; otherwise *status is what it is to exit with: kExitDone after --help or
// --version, kExitBadInput after one line about what is wrong.
[[nodiscard]] bool ParseFlags(int argc, char** argv, const std::string& usage,
                              int* status);

// Prints `message` as the one line of an error and returns kExitBadInput.
int Refuse(const std::string& message);

// The same for results that could not be written, and kExitNotUsable. Where
// the folder has a checkpoint, the line says how to go on.
int CannotWrite(const std::string& message, const ResultFolder& folder);

// The command line as it could be typed again.
std::string CommandLine(int argc, char** argv);

// From now on SIGINT, SIGTERM and SIGHUP set a mark instead of ending the
// process, however many come: `timeout` sends two. Only who presses Ctrl-C a
// third time will not wait for results.
void CatchInterrupts();
bool Interrupted();

}  // namespace pinode

#endif  // PINODE_APPS_PROGRAM_H_
