// Checks a case: reads it and all its files, fits nothing, and reports what an
// identification could determine.
//
// Sample runs:
//   pinode_check --case=data/three_storey/three_storey.toml
//   pinode_check --case=data/three_storey/three_storey.toml --plan=2
//   pinode_check --case=data/three_storey/three_storey.toml --output_dir=out
//   pinode_check --keys

#include <gflags/gflags.h>

#include <functional>
#include <string>

#include "apps/check_text.h"
#include "apps/launcher.h"
#include "apps/print.h"
#include "apps/program.h"
#include "apps/sensor_planning.h"
#include "pinode/case/results/case_check.h"
#include "pinode/case/results/check_files.h"
#include "pinode/case/results/matlab_results.h"
#include "pinode/case/results/plan_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/case/text/case_keys.h"

DEFINE_string(
    case, "",
    "case file (TOML); format: see case_files.md (in the source tree: "
    "pinode/case/README.md)");
DEFINE_bool(keys, false,
            "print every key of a case with its type, default and meaning, as "
            "tables in Markdown, and read no case");
DEFINE_int32(
    plan, 0,
    "choose this number of sensors: those that determine the groups "
    "best, from the places in [plan] or from all; no response needs to "
    "be measured");
DEFINE_string(output_dir, "",
              "folder for the printed results as tables, matrices and JSON; "
              "must not exist without --overwrite; empty: write no files");
DEFINE_bool(overwrite, false, "replace an existing output folder");
DEFINE_bool(mat, false, "also write results.mat for MATLAB and Octave");

namespace pinode {
namespace {

bool CheckFlags(std::string* error) {
  if (FLAGS_case.empty()) {
    *error = "--case=FILE is missing; see --help";
  } else if (FLAGS_plan < 0) {
    *error = "--plan is negative, expected a number of sensors";
  } else if (FLAGS_output_dir.empty()) {
    if (!FLAGS_mat && !FLAGS_overwrite) return true;
    *error = std::string(FLAGS_mat ? "--mat" : "--overwrite") +
             " needs --output_dir=FOLDER";
  } else {
    return CheckOutputFolder(FLAGS_output_dir, FLAGS_overwrite, false, error) &&
           MayGiveWayToCheck(FLAGS_output_dir, error);
  }
  return false;
}

// Writes a folder with `write` on request. Returns `status`, or the exit status
// of a failure.
int WriteFolder(int status,
                const std::function<bool(const std::string& folder,
                                         std::string* error)>& write) {
  if (FLAGS_output_dir.empty()) return status;
  ResultFolder folder;
  std::string error;
  CatchInterrupts();
  if (!folder.Open(FLAGS_output_dir, FLAGS_overwrite, false, &error)) {
    return Refuse(error);
  }
  if (!write(folder.working_path(), &error) ||
      (FLAGS_mat && !WriteMatlabResults(folder.working_path(), &error)) ||
      !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }
  Print("Results: %s\n", folder.final_path().c_str());
  return status;
}

}  // namespace

int RunProgram(int argc, char** argv) {
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_check --case=FILE [--output_dir=FOLDER]\n\n"
                  "Reads a case and its files without fitting anything. Prints "
                  "modes, steps, sizes, and\nwhich parameters the sensors do "
                  "not determine. With --plan it chooses places for sensors.",
                  &status)) {
    return status;
  }
  if (NumLaunchedRanks() > 1) {
    return Refuse("pinode_check runs in one process, expected no launcher");
  }
  if (FLAGS_keys) {
    std::printf("%s", KeyReference().c_str());
    return kExitDone;
  }
  Case c;
  std::string error;
  if (!CheckFlags(&error)) return Refuse(error);
  if (FLAGS_plan > 0) {
    CasePlan planned;
    if (!PlanForCase(FLAGS_case, FLAGS_plan, &c, &planned, &error)) {
      return Refuse(error);
    }
    Print("%s", CasePlanText(c, planned).c_str());
    return WriteFolder(
        planned.plan.undetermined_by_plan.empty() ? kExitDone : kExitNotUsable,
        [&](const std::string& folder, std::string* failure) {
          return WritePlanFiles(c, planned, folder, failure);
        });
  }
  if (!ReadCaseForCheck(FLAGS_case, &c, &error)) return Refuse(error);
  const CaseCheck check = CheckCase(c);
  PrintCaseCheck(c, check);
  return WriteFolder(check.ok() ? kExitDone : kExitNotUsable,
                     [&](const std::string& folder, std::string* failure) {
                       return WriteCheckFiles(c, check, folder, failure);
                     });
}

}  // namespace pinode
