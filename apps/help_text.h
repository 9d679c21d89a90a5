// What --help and --version print, in the layout that help2man makes manual
// pages from (and shell_completion.sh completions).

#ifndef PINODE_APPS_HELP_TEXT_H_
#define PINODE_APPS_HELP_TEXT_H_

#include <string>
#include <vector>

namespace pinode {

// Names of the flags that the programs define, and of those of the log; not of
// all that gflags and glog bring along.
std::vector<std::string> OwnFlagNames();

// `usage`: the command line with the flags it needs, an empty line, and
// sentences of what the program does.
std::string HelpText(const std::string& usage);

// "pinode_update 0.1.0"; `command`: as it was called, with folders or without.
std::string VersionText(const std::string& command);

}  // namespace pinode

#endif  // PINODE_APPS_HELP_TEXT_H_
