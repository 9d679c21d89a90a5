// Output of --help and --version, in the layout from which help2man makes
// manual pages (and shell_completion.sh completions).

#ifndef PINODE_APPS_HELP_TEXT_H_
#define PINODE_APPS_HELP_TEXT_H_

#include <string>
#include <vector>

namespace pinode {

// Returns the names of the flags that the programs define, and of those of the
// log, without the other flags of gflags and glog.
std::vector<std::string> OwnFlagNames();

// Returns the help. `usage`: the command line with the required flags, an empty
// line, and sentences on the program's purpose.
std::string HelpText(const std::string& usage);

// Returns "pinode_update 0.1.0"; `command`: as it was called, with folders or
// without.
std::string VersionText(const std::string& command);

}  // namespace pinode

#endif  // PINODE_APPS_HELP_TEXT_H_
