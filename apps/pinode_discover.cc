// Discovery: closed-form equations from the networks of an identified model.
//
// Reads a case and the result of pinode_update for it, regresses each network
// on a library of candidates along the predicted states, puts the selected
// terms in the networks' place and fits their coefficients to the trajectories.
// With source = "derivatives" in the case no network is trained: the forces
// that it would supply are taken from smoothed records.
//
// Sample run:
//   pinode_update   --case=C.toml --output_dir=D
//   pinode_discover --model=D --case=C.toml --output_dir=E
//   pinode_simulate --case=E/model.toml --output_dir=F
//   mpirun -n 4 pinode_discover --model=D --case=C.toml --output_dir=E

#include <gflags/gflags.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/console_watch.h"
#include "apps/fit_flags.h"
#include "apps/print.h"
#include "apps/program.h"
#include "apps/ranks.h"
#include "pinode/base/free_memory.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/results/case_picture.h"
#include "pinode/case/results/case_result.h"
#include "pinode/case/results/discover_files.h"
#include "pinode/case/results/grown_case.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/results/refit_checkpoint.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/discover/discovery.h"
#include "pinode/report/html_report.h"
#include "pinode/report/report.h"
#include "pinode/study/laws/refit.h"
#include "pinode/study/terms/discovered_problem.h"

DEFINE_string(model, "",
              "result folder of pinode_update for this case; leave it out if "
              "[discover] has source = \"derivatives\"");

namespace pinode {
namespace {

using Clock = std::chrono::steady_clock;

// Checks the flags that only this program has.
bool CheckModelFlag(const Case& c, std::string* error) {
  std::error_code ignored;
  if (!FLAGS_model.empty() &&
      std::filesystem::equivalent(FLAGS_model, FLAGS_output_dir, ignored)) {
    *error = "--output_dir is the folder of --model; give another folder";
    return false;
  }
  if (c.problem.num_train_records() == 0) {
    *error = FLAGS_case +
             ": there is no training record, and equations are discovered from "
             "one. Add it";
    return false;
  }
  const bool from_networks =
      c.discover.source == DiscoveryOptions::Source::kNetwork;
  if (from_networks && FLAGS_model.empty()) {
    *error = "--model=FOLDER is missing; see --help";
    return false;
  }
  if (!from_networks && !FLAGS_model.empty()) {
    *error = FLAGS_case +
             " has source = \"derivatives\", which uses no model; leave out "
             "--model";
    return false;
  }
  if (!FLAGS_model.empty() &&
      !std::filesystem::is_directory(FLAGS_model, ignored)) {
    *error =
        FLAGS_model +
        ": there is no such folder, expected the result folder of a fit by "
        "pinode_update";
    return false;
  }
  return true;
}

// Reads the case, and the model whose networks are replaced (the initial model
// if terms come from records).
bool ReadInput(SharedTables* tables, Case* c, IdentifiedModel* model,
               std::string* error) {
  if (!ReadFitFlags(tables, c, error) || !CheckModelFlag(*c, error))
    return false;
  return FLAGS_model.empty() || ReadFittedModel(FLAGS_model, c, model, error);
}

bool FindTerms(const Case& c, IdentifiedModel* model,
               std::vector<DiscoveredEquation>* equations, std::string* error) {
  const bool found = c.discover.source == DiscoveryOptions::Source::kNetwork
                         ? DiscoverFromNetworks(c.problem, *model, c.discover,
                                                equations, error)
                         : DiscoverFromDerivatives(c.problem, c.discover,
                                                   equations, model, error);
  if (!found) *error = FLAGS_case + ": " + *error;
  return found;
}

// Watch on a refit: progress on standard error, and a checkpoint.
class RefitWatch : public ConsoleWatch {
 public:
  explicit RefitWatch(RefitCheckpoint* checkpoint)
      : ConsoleWatch(FLAGS_progress), checkpoint_(checkpoint) {}

  bool OnIteration(const std::string&, const IdentificationProblem& problem,
                   const IdentificationProgress& progress) override {
    return ConsoleWatch::OnIteration(which_, problem, progress);
  }
  // One line for all fits of a refit.
  void OnFitEnd(Termination) override {}
  void End() { line()->End(); }

  // For DiscoveryOptions::on_equations.
  void OnEquations(int fit, const std::vector<DiscoveredEquation>& equations) {
    Name(fit, equations);
    checkpoint_->Save(equations);
    if (warned_ || checkpoint_->trouble().empty()) return;
    OnTrouble("no checkpoint: " + checkpoint_->trouble());
    warned_ = true;
  }

 private:
  void Name(int fit, const std::vector<DiscoveredEquation>& equations) {
    size_t terms = 0;
    for (const DiscoveredEquation& equation : equations) {
      terms += equation.terms.size();
    }
    which_ = "fit " + std::to_string(fit) + ", " + std::to_string(terms) +
             (terms == 1 ? " term" : " terms");
  }

  RefitCheckpoint* const checkpoint_;
  std::string which_;
  bool warned_ = false;
};

// Puts the terms in the networks' place and fits them to the trajectories if
// the case asks for it; continues if `folder` resumes.
bool RefitTerms(const Case& c, const IdentifiedModel& model,
                const std::vector<DiscoveredEquation>& equations,
                const ResultFolder& folder, RefitCheckpoint* checkpoint,
                Discovery* discovery, std::string* error) {
  std::vector<DiscoveredEquation> resumed;
  const bool read = checkpoint->Read(equations, &resumed, error);
  // All ranks must have read the file before it is written again.
  if (!CommunicatorOrSingle(c.options.communicator).AllTrue(read)) {
    if (read) *error = folder.resume_path() + ": not all ranks can read it";
    return false;
  }
  *discovery = WithoutRefit(c.problem, equations);
  if (!c.discover.refit || discovery->num_terms() == 0) return true;
  RefitWatch watch(checkpoint);
  DiscoveryOptions discover = c.discover;
  discover.on_equations = [&watch](int fit,
                                   const std::vector<DiscoveredEquation>& now) {
    watch.OnEquations(fit, now);
  };
  KeepFreedMemory();
  const bool refitted = RefitEquations(
      c.problem, model, equations, discover, c.options,
      resumed.empty() ? nullptr : &resumed, &watch, discovery, error);
  watch.End();
  return refitted;
}

bool IsInterrupted(const Discovery& discovery) {
  return discovery.refitted &&
         discovery.summary.termination == Termination::kInterrupted;
}

// Writes the fitted model with the equations, and its report.
bool WriteFittedModel(const Case& c, const Discovery& discovery,
                      const ReportOrigin& origin, const ResultFolder& folder,
                      const RefitCheckpoint& checkpoint, std::string* error) {
  Case discovered;
  if (!CaseWithEquations(c, discovery.equations, discovery.problem,
                         /*given_steps=*/true, &discovered, error)) {
    return false;
  }
  // Written before the report's simulation of the initial model, which takes as
  // much memory as a record.
  if (!WriteCaseResult(discovered, discovery.summary, discovery.model, folder,
                       error)) {
    return false;
  }
  ReportInput report = MakeReportInput(discovered.problem, discovery.summary,
                                       discovery.model, origin);
  report.equations = &discovery.equations;
  const std::optional<StructurePicture> picture =
      PictureOfCase(discovered, discovery.summary, discovery.model, nullptr);
  if (picture.has_value()) report.structure = &*picture;
  HtmlReportOptions report_options;
  report_options.num_threads = DefaultThreads();
  return WriteVtu(picture, folder.working_path(), error) &&
         WriteHtmlReport(report, report_options,
                         folder.working_path() + "/report.html", error) &&
         (!IsInterrupted(discovery) ||
          checkpoint.Write(discovery.equations, error));
}

// Writes the model with the equations and the coefficients of the regression.
bool WriteUnfittedModel(const Case& c, const IdentifiedModel& model,
                        const std::vector<DiscoveredEquation>& equations,
                        const ResultFolder& folder, std::string* error) {
  Case discovered;
  IdentificationProblem problem;
  IdentifiedModel initial;
  return MakeDiscoveredProblem(c.problem, model, equations, {}, &problem,
                               &initial, error) &&
         CaseWithEquations(c, equations, problem, /*given_steps=*/false,
                           &discovered, error) &&
         WriteModelCase(discovered, initial, folder.working_path(),
                        folder.final_path(), error);
}

void PrintResult(const Discovery& discovery) {
  Print("%s\n", EquationsAsText(discovery).c_str());
  for (const std::string& dropped : discovery.dropped) {
    Print("dropped in the refit: %s\n", dropped.c_str());
  }
  for (const std::string& added : discovery.added) {
    Print("added in the refit: %s\n", added.c_str());
  }
  if (discovery.refitted) {
    Print("%s\n", discovery.summary.BriefReport().c_str());
    const std::string missed = WhatIsMissed(discovery.summary);
    if (!missed.empty()) Print("%s\n", missed.c_str());
  }
}

}  // namespace

int RunProgram(int argc, char** argv) {
  const auto begin = Clock::now();
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_discover --model=FOLDER --case=FILE "
                  "--output_dir=FOLDER\n\n"
                  "Finds closed-form equations that replace the networks of an "
                  "identified model.",
                  &status)) {
    return status;
  }
  // 1. All checks of the input, before any work.
  std::string error;
  Case c;
  IdentifiedModel model;
  Ranks ranks;
  if (!ranks.Agree(ReadInput(ranks.tables(), &c, &model, &error), c, &error)) {
    return Refuse(error);
  }
  ranks.ShareWork(&c.options);
  c.discover.num_threads = c.options.num_threads;
  c.discover.communicator = c.options.communicator;

  // 2. Terms from the networks, along the predicted states; or from records.
  std::vector<DiscoveredEquation> equations;
  if (!FindTerms(c, &model, &equations, &error)) return Refuse(error);

  // 3. The terms in place of the networks, fitted to the trajectories.
  ResultFolder folder;
  Discovery discovery;
  CatchInterrupts();
  if (!ranks.Open(FLAGS_output_dir, FLAGS_overwrite, FLAGS_resume, &folder,
                  &error)) {
    return Refuse(error);
  }
  RefitCheckpoint checkpoint(folder, c.problem);
  if (!RefitTerms(c, model, equations, folder, &checkpoint, &discovery,
                  &error)) {
    return Refuse(error);
  }

  const int status_of_fit = IsInterrupted(discovery)       ? kExitInterrupted
                            : discovery.verdict().usable() ? kExitDone
                                                           : kExitNotUsable;
  if (!ranks.is_first()) return status_of_fit;

  // 4. The model with the equations, and a report.
  const double seconds =
      std::chrono::duration<double>(Clock::now() - begin).count();
  if (discovery.refitted) {
    if (!WriteFittedModel(c, discovery,
                          {c.path, CommandLine(argc, argv), seconds}, folder,
                          checkpoint, &error)) {
      return CannotWrite(error, folder);
    }
  } else {
    if (discovery.num_terms() > 0 &&
        !WriteUnfittedModel(c, model, equations, folder, &error)) {
      return CannotWrite(error, folder);
    }
    // Checkpoint of a refit that left no terms.
    std::error_code ignored;
    std::filesystem::remove(folder.checkpoint_path(), ignored);
  }
  if (!WriteDiscoverFiles(discovery, folder.working_path(), &error) ||
      !WriteForMatlab(folder, &error) || !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }

  // 5. Output on the console.
  PrintResult(discovery);
  Print("Results: %s\n", folder.final_path().c_str());
  if (IsInterrupted(discovery)) {
    PrintError("interrupted; continue with --resume");
  }
  return status_of_fit;
}

}  // namespace pinode
