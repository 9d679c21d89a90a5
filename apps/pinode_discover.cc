// Discovery: closed-form equations from the networks of an identified model.
//
// Reads a case and the result of pinode_update for it, regresses each
// network on a library of candidates along the predicted states, puts the
// selected terms in the networks' place and fits their coefficients to the
// trajectories. With source = "derivatives" in the case no network is trained:
// what it would have to supply is taken from smoothed records.
//
// Sample run:
//   pinode_update   --case=C.toml --output_dir=D
//   pinode_discover --model=D --case=C.toml --output_dir=E
//   pinode_simulate --case=E/model.toml --output_dir=F

#include <gflags/gflags.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apps/fit_flags.h"
#include "apps/program.h"
#include "apps/progress_line.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/case_file.h"
#include "pinode/case/case_result.h"
#include "pinode/case/checkpoint_file.h"
#include "pinode/case/discover_files.h"
#include "pinode/case/grown_case.h"
#include "pinode/case/model_case.h"
#include "pinode/case/result_folder.h"
#include "pinode/discover/discovery.h"
#include "pinode/report/html_report.h"
#include "pinode/study/discovered_problem.h"
#include "pinode/study/refit.h"

DEFINE_string(model, "",
              "result folder of pinode_update for this case; none with source "
              "= \"derivatives\" in its section [discover]");

int main(int argc, char** argv) {
  using namespace pinode;
  const auto begin = std::chrono::steady_clock::now();
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_discover --model=FOLDER --case=FILE "
                  "--output_dir=FOLDER\n\n"
                  "Finds closed-form equations in place of the networks of an "
                  "identified model.",
                  &status)) {
    return status;
  }

  // 1. Everything that can be wrong with the input, before any work.
  std::string error;
  Case c;
  if (!ReadFitFlags(&c, &error)) return Refuse(error);
  std::error_code ignored;
  if (!FLAGS_model.empty() &&
      std::filesystem::equivalent(FLAGS_model, FLAGS_output_dir, ignored)) {
    return Refuse(
        "--output_dir is the folder of --model, expected another one");
  }
  if (c.problem.num_train_records() == 0) {
    return Refuse(FLAGS_case +
                  ": no training record, expected one to discover "
                  "equations from");
  }
  c.discover.num_threads = c.options.num_threads;
  const bool from_networks =
      c.discover.source == DiscoveryOptions::Source::kNetwork;
  if (from_networks && FLAGS_model.empty()) {
    return Refuse("--model=FOLDER is missing; see --help");
  }
  if (!from_networks && !FLAGS_model.empty()) {
    return Refuse("--model is of no use with source = \"derivatives\" in " +
                  FLAGS_case + ", expected none");
  }
  Checkpoint checkpoint;
  if (from_networks &&
      (!ReadCheckpoint(FLAGS_model + "/checkpoint.json", c.problem, &checkpoint,
                       &error) ||
       (RenewsBasis(c) &&
        !RenewCase(c, checkpoint.model, &c, &checkpoint.model, &error)))) {
    return Refuse(error);
  }

  // 2. Terms from the networks, along the predicted states; or from records.
  std::vector<DiscoveredEquation> equations;
  if (!(from_networks
            ? DiscoverFromNetworks(c.problem, checkpoint.model, c.discover,
                                   &equations, &error)
            : DiscoverFromDerivatives(c.problem, c.discover, &equations,
                                      &checkpoint.model, &error))) {
    return Refuse(FLAGS_case + ": " + error);
  }
  ResultFolder folder;
  if (!folder.Open(FLAGS_output_dir, FLAGS_overwrite, FLAGS_resume, &error)) {
    return Refuse(error);
  }
  const std::string problem_hash = ProblemIdentity(c.problem);
  std::vector<DiscoveredEquation> resumed;
  if (!folder.resume_path().empty() &&
      !ReadDiscoverCheckpoint(folder.resume_path(), problem_hash, equations,
                              &resumed, &error)) {
    return Refuse(error);
  }

  // 3. The terms in place of the networks, fitted to the trajectories.
  Discovery discovery = WithoutRefit(c.problem, equations);
  if (c.discover.refit && discovery.num_terms() > 0) {
    CatchInterrupts();
    ProgressLine line(FLAGS_progress);
    std::string which;
    c.options.callback = [&](const IdentificationProgress& progress) {
      line.Show(which, progress);
      return !Interrupted();
    };
    auto written = std::chrono::steady_clock::time_point();
    bool warned = false;
    c.discover.on_equations =
        [&](int fit, const std::vector<DiscoveredEquation>& current) {
          size_t terms = 0;
          for (const DiscoveredEquation& equation : current) {
            terms += equation.terms.size();
          }
          which = "fit " + std::to_string(fit) + ", " + std::to_string(terms) +
                  (terms == 1 ? " term  " : " terms  ");
          const auto now = std::chrono::steady_clock::now();
          if (now - written < std::chrono::seconds(1)) return;
          written = now;
          std::string problem;
          if (!WriteDiscoverCheckpoint(folder.checkpoint_path(), problem_hash,
                                       current, &problem) &&
              !warned) {
            std::fprintf(stderr, "no checkpoint: %s\n", problem.c_str());
            warned = true;
          }
        };
    const bool refitted = RefitEquations(
        c.problem, checkpoint.model, equations, c.discover, c.options,
        resumed.empty() ? nullptr : &resumed, &discovery, &error);
    line.End();
    if (!refitted) return Refuse(error);
  }
  const bool interrupted =
      discovery.refitted &&
      discovery.summary.termination == Termination::kInterrupted;

  // 4. Equations, the model that has them, and a report.
  if (discovery.refitted) {
    Case discovered;
    if (!CaseWithEquations(c, discovery.equations, discovery.problem,
                           /*given_steps=*/true, &discovered, &error)) {
      return Refuse(error);
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
            .count();
    ReportInput report =
        MakeReportInput(discovered.problem, discovery.summary, discovery.model,
                        {c.path, CommandLine(argc, argv), seconds});
    report.equations = &discovery.equations;
    HtmlReportOptions report_options;
    report_options.num_threads = DefaultThreads();
    if (!WriteCaseResult(discovered, discovery.summary, discovery.model, folder,
                         &error) ||
        !WriteHtmlReport(report, report_options,
                         folder.working_path() + "/report.html", &error) ||
        (interrupted &&
         !WriteDiscoverCheckpoint(folder.checkpoint_path(), problem_hash,
                                  discovery.equations, &error))) {
      return Refuse(error);
    }
  } else if (discovery.num_terms() > 0) {
    Case discovered;
    IdentificationProblem problem;
    IdentifiedModel initial;
    if (!MakeDiscoveredProblem(c.problem, checkpoint.model, equations, {},
                               &problem, &initial, &error) ||
        !CaseWithEquations(c, equations, problem, /*given_steps=*/false,
                           &discovered, &error) ||
        !WriteModelCase(discovered, initial, folder.working_path(),
                        folder.final_path(), &error)) {
      return Refuse(error);
    }
  }
  // Of a refit of which nothing was left.
  if (!discovery.refitted) {
    std::filesystem::remove(folder.checkpoint_path(), ignored);
  }
  if (!WriteDiscoverFiles(discovery, folder.working_path(), &error) ||
      !folder.Commit(&error)) {
    return Refuse(error);
  }
  std::printf("%s\n", EquationsAsText(discovery).c_str());
  for (const std::string& dropped : discovery.dropped) {
    std::printf("dropped in the refit: %s\n", dropped.c_str());
  }
  for (const std::string& added : discovery.added) {
    std::printf("added in the refit: %s\n", added.c_str());
  }
  if (discovery.refitted) {
    std::printf("%s\n", discovery.summary.BriefReport().c_str());
  }
  std::printf("Results: %s\n", folder.final_path().c_str());
  if (interrupted) {
    std::fprintf(stderr, "interrupted; continue with --resume\n");
    return kExitInterrupted;
  }
  const bool usable = discovery.num_terms() > 0 &&
                      (!discovery.refitted || discovery.summary.usable);
  return usable ? kExitDone : kExitNotUsable;
}
