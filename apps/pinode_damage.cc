// Damage detection: changes of a structure relative to baselines.
//
// Reads a case with new records and the results of pinode_update for one or
// more baselines. Fits the case beginning from the baseline, and reports which
// groups changed, by how much, and with which probability.
//
// Sample run:
//   pinode_update --case=healthy.toml --output_dir=D
//   pinode_damage --baseline=D --case=new.toml --output_dir=E

#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "apps/console_watch.h"
#include "apps/deck_flag.h"
#include "apps/fit_flags.h"
#include "apps/print.h"
#include "apps/program.h"
#include "apps/ranks.h"
#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/free_memory.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/results/baseline_folder.h"
#include "pinode/case/results/case_picture.h"
#include "pinode/case/results/case_result.h"
#include "pinode/case/results/damage_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/run/damage_case.h"
#include "pinode/case/run/fit_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/report/console.h"
#include "pinode/report/html_report.h"
#include "pinode/study/damage/damage_analysis.h"

DEFINE_string(
    baseline, "",
    "result folders of pinode_update for baseline records of the same "
    "structure, separated by commas");
DEFINE_double(threshold, 0.05,
              "smallest loss of stiffness that counts as damage, as a "
              "fraction; with several baselines, a smaller loss also counts if "
              "it exceeds their scatter");
DEFINE_double(false_alarm_rate, 0.05,
              "probability of finding a change if there is none");

namespace pinode {
namespace {

bool ReadChangeFlags(ChangeOptions* options, std::string* error) {
  if (FLAGS_baseline.empty()) {
    *error = "--baseline=FOLDER is missing; see --help";
    return false;
  }
  options->threshold = FLAGS_threshold;
  options->false_alarm_rate = FLAGS_false_alarm_rate;
  if (options->IsValid(error)) return true;
  *error = "--" + *error;
  return false;
}

bool ReadCase(SharedTables* tables, Case* c, std::string* error) {
  if (!ReadFitFlags(tables, c, error)) return false;
  if (!FreeGroups(*c->problem.dynamics).empty()) return true;
  *error =
      FLAGS_case +
      ": no [[group]] is free; set free = true in the groups that may have "
      "changed";
  return false;
}

// Reads the folders of --baseline for the case `c`.
bool ReadBaselines(const Case& c, std::vector<Baseline>* baselines,
                   std::string* error) {
  for (const std::string_view part : Split(FLAGS_baseline, ',')) {
    const std::string folder(part);
    if (folder.empty()) {
      *error =
          "--baseline contains an empty name; separate folders by one comma";
      return false;
    }
    baselines->emplace_back();
    if (!ReadBaseline(folder, c, &baselines->back(), error)) return false;
  }
  return true;
}

// Writes the judgement and the report.
bool WriteDamageFiles(const DamageResult& result, const ReportInput& report,
                      const std::string& folder, std::string* error) {
  HtmlReportOptions report_options;
  report_options.num_threads = DefaultThreads();
  return WriteFileAtomically(folder + "/damage.json", DamageAsJson(result),
                             error) &&
         WriteHtmlReport(report, report_options, folder + "/report.html",
                         error);
}

// Returns what damage.json says where changes were not judged: who waits for
// the file finds it in every folder.
DamageResult NotJudged(const JudgedChange& judgement,
                       const std::vector<Baseline>& baselines,
                       const ChangeOptions& change) {
  DamageResult result;
  for (const Baseline& baseline : baselines) {
    result.baselines.push_back(baseline.name);
  }
  result.options = change;
  result.judgement.verdict = DamageVerdict::kCannotTell;
  result.judgement.sentence =
      judgement.interrupted
          ? "Interrupted before the changes were judged: continue with "
            "--resume."
      : judgement.why_not.empty()
          ? "The fit is not usable, and nothing can be said about changes: "
            "result.json gives the reasons."
          : "Nothing can be said about changes: " + judgement.why_not + ".";
  return result;
}

void PrintChange(const DamageResult& result) {
  Print("%s\n\nChange since the baseline\n%s\n",
        result.judgement.sentence.c_str(),
        MakeChangeTable(result).ToText().c_str());
  const TextTable explanations = MakeChangeExplanationTable(result);
  if (!explanations.empty()) {
    Print("Explanations that these records cannot tell apart\n%s\n",
          explanations.ToText().c_str());
  }
  for (const std::string& remark : result.remarks) {
    Print("%s\n", remark.c_str());
  }
}

}  // namespace

int RunProgram(int argc, char** argv) {
  const auto begin = std::chrono::steady_clock::now();
  int status;
  if (!ParseFlags(
          argc, argv,
          "pinode_damage --baseline=FOLDER,... --case=FILE "
          "--output_dir=FOLDER\n\n"
          "Finds what changed in a structure relative to its baselines.",
          &status)) {
    return status;
  }

  // 1. All checks of the input, before any work.
  std::string error;
  ChangeOptions change;
  Case c;
  std::vector<Baseline> baselines;
  IdentifiedModel begin_from;
  CatchInterrupts();
  Ranks ranks;
  if (!ranks.Agree(ReadChangeFlags(&change, &error) &&
                       ReadCase(ranks.tables(), &c, &error) &&
                       CheckDeckFlag(c, &error) &&
                       ReadBaselines(c, &baselines, &error) &&
                       PrepareForBaselines(baselines, &c, &begin_from, &error),
                   c, &error)) {
    return Refuse(error);
  }
  ranks.ShareWork(&c.options);

  // 2. The new state.
  ConsoleWatch watch(FLAGS_progress);
  KeepFreedMemory();
  ResultFolder folder;
  IdentificationSummary summary;
  IdentifiedModel model;
  if (!ranks.Open(FLAGS_output_dir, FLAGS_overwrite, FLAGS_resume, &folder,
                  &error) ||
      !FitCase(folder, &begin_from, &watch, &c, &summary, &model, &error)) {
    return Refuse(error);
  }

  // 3. The changes.
  const JudgedChange judgement =
      JudgeChange(summary, model, baselines, change, &watch, &c);
  if (!judgement.why_not.empty()) {
    PrintError("no verdict on changes: %s", judgement.why_not.c_str());
  }
  const DamageResult not_judged = NotJudged(judgement, baselines, change);
  const DamageResult& result = judgement.judged ? judgement.result : not_judged;
  if (judgement.judged) {
    summary = result.summary;
    model = result.model;
  }

  const int status_of_fit = judgement.interrupted ? kExitInterrupted
                            : judgement.judged    ? StatusOf(summary.verdict)
                                                  : kExitNotUsable;
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
  if (judgement.judged) report.damage = &result;
  const std::optional<StructurePicture> picture =
      PictureOfCase(c, summary, model, report.damage);
  if (picture.has_value()) report.structure = &*picture;
  if (!WriteVtu(picture, folder.working_path(), &error) ||
      !WriteDamageFiles(result, report, folder.working_path(), &error) ||
      !WriteForMatlab(folder, &error) || !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }

  // 5. Output on the console.
  if (judgement.judged) PrintChange(result);
  Print("%s\nResults: %s\n", ConsoleReport(report).c_str(),
        folder.final_path().c_str());
  if (judgement.interrupted) {
    PrintError("interrupted; continue with --resume");
  }
  if (!has_deck) {
    PrintNoDeck(deck_error);
    if (status_of_fit == kExitDone) return kExitNotUsable;
  }
  return status_of_fit;
}

}  // namespace pinode
