// Damage detection: what changed in a structure since healthy records.
//
// Reads a case with new records and the results of pinode_update for one or
// more healthy ones, fits the case beginning from the healthy state, and
// compares: which groups changed, by how much, how surely.
//
// Sample run:
//   pinode_update --case=healthy.toml --output_dir=D
//   pinode_damage --baseline=D --case=new.toml --output_dir=E

#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "apps/fit_flags.h"
#include "apps/fitting.h"
#include "apps/program.h"
#include "pinode/base/file.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/baseline_folder.h"
#include "pinode/case/case_file.h"
#include "pinode/case/case_result.h"
#include "pinode/case/damage_files.h"
#include "pinode/case/grown_case.h"
#include "pinode/case/result_folder.h"
#include "pinode/report/console.h"
#include "pinode/report/html_report.h"
#include "pinode/study/damage_analysis.h"

DEFINE_string(baseline, "",
              "result folders of pinode_update for healthy records of the same "
              "structure, separated by commas");
DEFINE_double(threshold, 0.05,
              "loss of stiffness from which damage is called, as a fraction");
DEFINE_double(false_alarm_rate, 0.05,
              "probability of calling any change where there is none");

int main(int argc, char** argv) {
  using namespace pinode;
  const auto begin = std::chrono::steady_clock::now();
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_damage --baseline=FOLDER[,FOLDER...] --case=FILE "
                  "--output_dir=FOLDER\n\n"
                  "Says what changed in a structure since healthy records.",
                  &status)) {
    return status;
  }

  // 1. Everything that can be wrong with the input, before any work.
  if (FLAGS_baseline.empty()) {
    return Refuse("--baseline=FOLDER is missing; see --help");
  }
  ChangeOptions change_options;
  change_options.threshold = FLAGS_threshold;
  change_options.false_alarm_rate = FLAGS_false_alarm_rate;
  std::string error;
  if (!change_options.IsValid(&error)) return Refuse("--" + error);
  Case c;
  if (!ReadFitFlags(&c, &error)) return Refuse(error);
  if (FreeGroups(*c.problem.dynamics).empty()) {
    return Refuse(FLAGS_case +
                  ": no [[group]] is free, expected those whose change is "
                  "asked for");
  }
  std::vector<Baseline> baselines;
  for (size_t at = 0; at <= FLAGS_baseline.size();) {
    const size_t end =
        std::min(FLAGS_baseline.find(',', at), FLAGS_baseline.size());
    const std::string folder = FLAGS_baseline.substr(at, end - at);
    at = end + 1;
    if (folder.empty()) return Refuse("--baseline has an empty name in it");
    baselines.emplace_back();
    if (!ReadBaseline(folder, c, &baselines.back(), &error)) {
      return Refuse(error);
    }
  }
  IdentifiedModel begin_from = BeginFromBaseline(baselines[0], c.problem);
  if (RenewsBasis(c) && !RenewCase(c, begin_from, &c, &begin_from, &error)) {
    return Refuse(error);
  }

  // 2. The new state.
  ResultFolder folder;
  if (!folder.Open(FLAGS_output_dir, FLAGS_overwrite, FLAGS_resume, &error)) {
    return Refuse(error);
  }
  IdentificationSummary summary;
  IdentifiedModel model;
  if (!FitCase(folder, &begin_from, FLAGS_progress, &c, &summary, &model,
               &error)) {
    return Refuse(error);
  }

  // 3. What changed. A fit that is not usable says nothing about that.
  bool interrupted = summary.termination == Termination::kInterrupted;
  bool judged = false;
  DamageResult result;
  if (summary.usable && summary.covariance.size() > 0) {
    DamageAnalysisOptions options;
    options.change = change_options;
    options.search = c.damage;
    options.identification = c.options;
    const FitFunction fit = FitWithProgress(FLAGS_progress);
    options.fit = [&](const std::string& what,
                      const IdentificationProblem& problem,
                      const IdentificationOptions& fit_options,
                      const IdentifiedModel* from,
                      IdentificationSummary* outcome, IdentifiedModel* found) {
      fit(what, problem, fit_options, from, outcome, found);
      interrupted =
          interrupted || outcome->termination == Termination::kInterrupted;
    };
    judged = AnalyseDamage(c.problem, summary, model, baselines, options,
                           &result, &error) &&
             CaseWithCandidates(c, result.added, result.problem, &c, &error);
    if (!judged) {
      std::fprintf(stderr, "nothing can be said about changes: %s\n",
                   error.c_str());
    }
  }
  if (judged) {
    summary = result.summary;
    model = result.model;
  }

  // 4. Results and report.
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
          .count();
  ReportInput report = MakeReportInput(
      c.problem, summary, model, {c.path, CommandLine(argc, argv), seconds});
  if (judged) report.damage = &result;
  HtmlReportOptions report_options;
  report_options.num_threads = DefaultThreads();
  if (!WriteCaseResult(c, summary, model, folder, &error) ||
      (judged && !WriteFileAtomically(folder.working_path() + "/damage.json",
                                      DamageAsJson(result), &error)) ||
      !WriteHtmlReport(report, report_options,
                       folder.working_path() + "/report.html", &error) ||
      !folder.Commit(&error)) {
    return Refuse(error);
  }
  if (judged) {
    std::printf("%s\n\nChange since the baseline\n%s\n",
                result.judgement.sentence.c_str(),
                MakeChangeTable(result).ToText().c_str());
    for (const std::string& remark : result.remarks) {
      std::printf("%s\n", remark.c_str());
    }
  }
  std::printf("%s\nResults: %s\n", ConsoleReport(report).c_str(),
              folder.final_path().c_str());
  if (interrupted) {
    std::fprintf(stderr, "interrupted; continue with --resume\n");
    return kExitInterrupted;
  }
  return summary.usable && judged ? kExitDone : kExitNotUsable;
}
