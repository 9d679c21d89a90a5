// A local page for the whole way from a logger's files to a verdict on damage.
//
// Serves the page on 127.0.0.1 and opens a browser. All data stays in a folder
// on this computer. Every step is that of the other programs: the page drafts a
// case as pinode_new does, fits it as pinode_update, compares as pinode_damage,
// and finds modes as pinode_modes.
//
// Sample runs:
//   pinode_app
//   pinode_app --port=8080 --open_browser=false --folder=bridge

#include <gflags/gflags.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>
#include <thread>

#include "apps/launcher.h"
#include "apps/print.h"
#include "apps/program.h"
#include "pinode/app/app_server.h"

DEFINE_int32(port, 0, "port of 127.0.0.1; 0: any that is free");
DEFINE_bool(open_browser, true, "open the page in the browser");
DEFINE_string(folder, "",
              "folder for uploaded files, cases and results, which is created "
              "if it does not exist; empty: pinode_app in the home folder. "
              "Format of the cases: see case_files.md (in the source tree: "
              "pinode/case/README.md)");
DEFINE_int32(upload_mb, 500, "largest file that can be uploaded, in MB");

extern char** environ;

namespace pinode {
namespace {

bool CheckFlags(std::string* error) {
  if (FLAGS_port < 0 || FLAGS_port > 65535) {
    *error =
        "--port is " + std::to_string(FLAGS_port) + ", expected 0 to 65535";
  } else if (FLAGS_upload_mb < 1) {
    *error = "--upload_mb is " + std::to_string(FLAGS_upload_mb) +
             ", expected 1 or more";
  } else {
    return true;
  }
  return false;
}

// Folder of --folder, or the one in the home folder.
bool FindFolder(std::string* folder, std::string* error) {
  *folder = FLAGS_folder;
  if (!folder->empty()) return true;
  const char* home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') {
    *error = "there is no home folder; give --folder=FOLDER";
    return false;
  }
  *folder = std::string(home) + "/pinode_app";
  return true;
}

// Opens the address in the user's browser. False if there is no way to.
bool OpenBrowser(const std::string& address) {
  const char* opener = "xdg-open";
  char* const arguments[] = {const_cast<char*>(opener),
                             const_cast<char*>(address.c_str()), nullptr};
  pid_t child = 0;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  // Browsers talk.
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1, 0);
  const bool started =
      posix_spawnp(&child, opener, &actions, nullptr, arguments, environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  if (!started) return false;
  std::thread([child] {
    int status = 0;
    waitpid(child, &status, 0);
  }).detach();
  return true;
}

}  // namespace

int RunProgram(int argc, char** argv) {
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_app [--folder=FOLDER] [--port=N] "
                  "[--open_browser=false]\n\n"
                  "Serves a page for browsers on this computer: from the files "
                  "of data loggers to a\nfitted model, its report, and a "
                  "verdict on damage. No data leaves the computer.",
                  &status)) {
    return status;
  }
  if (NumLaunchedRanks() > 1) {
    return Refuse("pinode_app runs in one process, expected no launcher");
  }
  std::string error;
  AppServerOptions options;
  AppServer server;
  options.port = FLAGS_port;
  options.upload_bytes = std::int64_t{1000000} * FLAGS_upload_mb;
  if (!CheckFlags(&error) || !FindFolder(&options.folder, &error) ||
      !server.Open(options, &error)) {
    return Refuse(error);
  }

  CatchInterrupts();
  server.Watch(Interrupted);
  Print("%s\n", server.address().c_str());
  const bool opened = FLAGS_open_browser && OpenBrowser(server.address());
  Print("%sCtrl-C ends pinode_app; all work is kept in %s.\n",
        opened ? "" : "Open this address in a browser on this computer. ",
        options.folder.c_str());
  std::fflush(stdout);
  server.Run();
  return kExitDone;
}

}  // namespace pinode
