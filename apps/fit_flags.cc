#include "apps/fit_flags.h"

#include "apps/program.h"
#include "pinode/case/results/matlab_results.h"
#include "pinode/case/results/result_folder.h"

DEFINE_string(
    case, "",
    "case file (TOML); format: see case_files.md (in the source tree: "
    "pinode/case/README.md)");
DEFINE_string(output_dir, "",
              "folder for the results; must not exist without --overwrite or "
              "--resume");
DEFINE_bool(overwrite, false, "replace an existing output folder");
DEFINE_bool(resume, false,
            "continue an interrupted fit from its checkpoint in the output "
            "folder");
DEFINE_int32(threads, 0, "number of threads; 0: as in the case");
DEFINE_bool(mat, false,
            "also write results.mat for MATLAB and Octave, with the tables, "
            "matrices and texts of the output folder");
DEFINE_bool(strict, false,
            "exit with status 1 also if the result is usable with care");
DEFINE_bool(progress, true, "show progress on standard error");

namespace pinode {

bool ReadFitFlags(SharedTables* tables, Case* c, std::string* error) {
  if (FLAGS_case.empty()) {
    *error = "--case=FILE is missing; see --help";
    return false;
  }
  if (FLAGS_output_dir.empty()) {
    *error = "--output_dir=FOLDER is missing; see --help";
    return false;
  }
  if (FLAGS_threads < 0) {
    *error = "--threads is " + std::to_string(FLAGS_threads) +
             ", expected a number of threads, or 0 for that of the case";
    return false;
  }
  if (!CheckOutputFolder(FLAGS_output_dir, FLAGS_overwrite, FLAGS_resume,
                         error) ||
      !ReadCase(FLAGS_case, tables, c, error)) {
    return false;
  }
  if (FLAGS_threads > 0) c->options.num_threads = FLAGS_threads;
  return true;
}

int StatusOf(const Verdict& verdict) {
  const Grade worst = FLAGS_strict ? Grade::kGood : Grade::kWithCare;
  return verdict.grade() <= worst ? kExitDone : kExitNotUsable;
}

bool WriteForMatlab(const ResultFolder& folder, std::string* error) {
  return !FLAGS_mat || WriteMatlabResults(folder.working_path(), error);
}

}  // namespace pinode
