// Model updating: the main job.
//
// Reads a case, identifies its unknowns from the records and writes a result
// folder with the updated matrices and a report.
//
// Sample runs:
//   pinode_update --case=data/three_storey/three_storey.toml --output_dir=out
//   pinode_update --case=... --output_dir=out --resume
//   mpirun -n 8 pinode_update --case=... --output_dir=out

#include <gflags/gflags.h>

#include <chrono>
#include <optional>
#include <string>

#include "apps/console_watch.h"
#include "apps/deck_flag.h"
#include "apps/fit_flags.h"
#include "apps/print.h"
#include "apps/program.h"
#include "apps/ranks.h"
#include "pinode/base/free_memory.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/results/case_picture.h"
#include "pinode/case/results/case_result.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/run/fit_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/report/console.h"
#include "pinode/report/html_report.h"

DEFINE_bool(profiles, false,
            "compute likelihood profiles of all named free parameters after "
            "the fit, like [profiles] in the case");

namespace pinode {
namespace {

// True for cases with restoring forces, searches for terms, or responses of all
// DOFs.
bool LooksAtStates(const Case& c) {
  return !c.problem.dynamics->IsLinear() || !c.candidates.empty() ||
         c.finite_element != nullptr;
}

}  // namespace

int RunProgram(int argc, char** argv) {
  const auto begin = std::chrono::steady_clock::now();
  int status;
  if (!ParseFlags(
          argc, argv,
          "pinode_update --case=FILE --output_dir=FOLDER [--deck=FILE]\n\n"
          "Identifies the unknowns of a case from its records and "
          "writes the updated model\nand a report.",
          &status)) {
    return status;
  }

  // 1. All checks of the input, before any work.
  std::string error;
  Case c;
  CatchInterrupts();
  Ranks ranks;
  if (!ranks.Agree(
          ReadFitFlags(ranks.tables(), &c, &error) && CheckDeckFlag(c, &error),
          c, &error)) {
    return Refuse(error);
  }
  ranks.ShareWork(&c.options);
  c.options.keep_states = LooksAtStates(c);

  // 2. A folder that stays invisible until it is complete, even if interrupted.
  ResultFolder folder;
  if (!ranks.Open(FLAGS_output_dir, FLAGS_overwrite, FLAGS_resume, &folder,
                  &error)) {
    return Refuse(error);
  }

  // 3. The fit, with a checkpoint after every iteration.
  IdentificationSummary summary;
  IdentifiedModel model;
  ConsoleWatch watch(FLAGS_progress);
  KeepFreedMemory();
  if (!FitCase(folder, nullptr, &watch, &c, &summary, &model, &error)) {
    return Refuse(error);
  }

  const bool profiles = FLAGS_profiles || c.profiles.has_value();
  if (profiles && !ranks.Interrupted()) {
    ProfileCase(folder, &watch, &c, model, &summary);
  }
  const bool cut_off = summary.termination == Termination::kInterrupted ||
                       (profiles && ranks.Interrupted());

  const int status_of_fit =
      cut_off ? kExitInterrupted : StatusOf(summary.verdict);
  if (!ranks.is_first()) return status_of_fit;

  // 4. Results and report.
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
          .count();
  std::string deck_error;
  const bool has_deck = WriteDeck(c, model, folder, &summary, &deck_error);
  ReturnFreedMemory();
  // Written before the report, whose simulations of the initial model take
  // memory of their own.
  if (!WriteCaseResult(c, summary, model, folder, &error)) {
    return CannotWrite(error, folder);
  }
  ReportInput report = MakeReportInput(
      c.problem, summary, model, {c.path, CommandLine(argc, argv), seconds});
  const std::optional<StructurePicture> picture =
      PictureOfCase(c, summary, model, nullptr);
  if (picture.has_value()) report.structure = &*picture;
  HtmlReportOptions report_options;
  report_options.num_threads = DefaultThreads();
  if (!WriteVtu(picture, folder.working_path(), &error) ||
      !WriteHtmlReport(report, report_options,
                       folder.working_path() + "/report.html", &error) ||
      !WriteForMatlab(folder, &error) || !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }
  Print("%s\nResults: %s\n", ConsoleReport(report).c_str(),
        folder.final_path().c_str());
  if (cut_off) {
    PrintError(
        "interrupted; the best result so far is in %s; continue with "
        "--resume",
        folder.final_path().c_str());
  }
  if (!has_deck) {
    PrintNoDeck(deck_error);
    if (status_of_fit == kExitDone) return kExitNotUsable;
  }
  return status_of_fit;
}

}  // namespace pinode
