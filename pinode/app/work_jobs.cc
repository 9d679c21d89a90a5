#include "pinode/app/work_jobs.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/fnv.h"
#include "pinode/base/free_memory.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/draft/case_draft_text.h"
#include "pinode/case/results/baseline_folder.h"
#include "pinode/case/results/case_check.h"
#include "pinode/case/results/case_picture.h"
#include "pinode/case/results/case_result.h"
#include "pinode/case/results/check_files.h"
#include "pinode/case/results/damage_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/results/updated_deck.h"
#include "pinode/case/run/damage_case.h"
#include "pinode/case/run/find_modes.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/case/sections/modes_data_file.h"
#include "pinode/report/html_report.h"
#include "pinode/report/modes_report.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double SecondsFrom(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

HtmlReportOptions ReportOptions() {
  HtmlReportOptions options;
  options.num_threads = DefaultThreads();
  return options;
}

// Returns the text of a case without its lines of comment.
std::string WithoutComments(const std::string& text) {
  std::istringstream lines(text);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] != '#') kept += line + "\n";
  }
  return kept;
}

std::string HashOf(const std::string& text) {
  return std::to_string(Fnv1a(text.data(), text.size()));
}

// Writes a case. Sets *changed if it says something else than the file that was
// there.
bool WriteCase(const std::string& path, const std::string& text,
               WorkState* state, bool* changed, std::string* error) {
  std::error_code status;
  std::string before;
  std::string& written = state->written[fs::path(path).filename().string()];
  *changed = false;
  if (fs::exists(path, status)) {
    if (!ReadBinaryFile(path, &before, error)) return false;
    *changed = WithoutComments(before) != WithoutComments(text);
    if (*changed && written != HashOf(before)) {
      *error = path +
               " was edited by hand and is not replaced. Save it below to use "
               "it as it is, or draft it anew there";
      return false;
    }
  }
  if (!WriteFileAtomically(path, text, error)) return false;
  written = HashOf(text);
  return true;
}

// Writes the check of a case to the folder `path`.
bool WriteCheck(const Case& c, const CaseCheck& check, const std::string& path,
                std::string* error) {
  ResultFolder folder;
  return folder.Open(path, true, false, error) &&
         WriteCheckFiles(c, check, folder.working_path(), error) &&
         folder.Commit(error);
}

// Takes the cases that are there for drafted ones, which may be replaced.
bool TakeAsDrafted(const WorkFolder& folder, WorkState* state,
                   std::string* error) {
  std::error_code status;
  for (const std::string& path :
       {folder.case_path(), folder.later_case_path()}) {
    std::string text;
    if (!fs::exists(path, status)) continue;
    if (!ReadBinaryFile(path, &text, error)) return false;
    state->written[fs::path(path).filename().string()] = HashOf(text);
  }
  return true;
}

// True for cases with restoring forces, searches for terms, or responses of all
// DOFs; as in pinode_update.
bool LooksAtStates(const Case& c) {
  return !c.problem.dynamics->IsLinear() || !c.candidates.empty() ||
         c.finite_element != nullptr;
}

// Deck from which the case's matrices came; empty: none.
std::string DeckOf(const WorkFolder& folder) {
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(folder.At("deck"), status)) {
    if (entry.path().extension() == ".inp") return entry.path().string();
  }
  return "";
}

// A fit and what becomes of it.
struct FittedWork {
  IdentificationSummary summary;
  IdentifiedModel model;
  // Changes since the baseline; nullptr: there was no comparison.
  const DamageResult* damage = nullptr;
  std::string command;
  double seconds = 0.0;
};

// Writes results and report to `folder`, and puts it in place.
bool WriteWork(const WorkFolder& work, const Case& c, FittedWork* fitted,
               ResultFolder* folder, std::string* error) {
  const std::string deck = DeckOf(work);
  std::string remark;
  if (!deck.empty() &&
      !WriteUpdatedDeck(c, fitted->summary, fitted->model, deck,
                        folder->working_path(), &remark, error)) {
    remark = "No updated deck: " + *error;
  }
  if (!remark.empty()) fitted->summary.remarks.push_back(remark);
  ReturnFreedMemory();
  if (!WriteCaseResult(c, fitted->summary, fitted->model, *folder, error)) {
    return false;
  }
  ReportInput report =
      MakeReportInput(c.problem, fitted->summary, fitted->model,
                      {c.path, fitted->command, fitted->seconds});
  report.damage = fitted->damage;
  const std::optional<StructurePicture> picture =
      PictureOfCase(c, fitted->summary, fitted->model, fitted->damage);
  if (picture.has_value()) report.structure = &*picture;
  return WriteVtu(picture, folder->working_path(), error) &&
         WriteHtmlReport(report, ReportOptions(),
                         folder->working_path() + "/report.html", error) &&
         folder->Commit(error);
}

// Returns the contents of damage.json if the changes were not judged.
DamageResult NotJudged(const JudgedChange& judgement,
                       const std::vector<Baseline>& baselines,
                       const ChangeOptions& options) {
  DamageResult result;
  for (const Baseline& baseline : baselines) {
    result.baselines.push_back(baseline.name);
  }
  result.options = options;
  result.judgement.verdict = DamageVerdict::kCannotTell;
  result.judgement.sentence =
      judgement.interrupted ? "Stopped before the changes were judged."
      : judgement.why_not.empty()
          ? "The fit is not usable, and nothing can be said about changes: see "
            "the report."
          : "Nothing can be said about changes: " + judgement.why_not + ".";
  return result;
}

// Drafts, checks and writes the cases of a work.
bool DraftWork(const WorkFolder& folder, WorkState* state,
               DraftQuestion* question, std::string* error) {
  *question = DraftQuestion();
  const DraftRequest request = RequestOf(folder, *state);
  if (request.logs.empty()) {
    *error = "there is no baseline record yet; add a file of your logger";
    return false;
  }
  std::vector<CaseDraft> drafts;
  if (!DraftCases(request, &drafts, question, error)) return false;
  std::vector<Case> cases(drafts.size());
  std::vector<CaseCheck> checks;
  std::vector<std::string> texts;
  for (size_t i = 0; i < drafts.size(); ++i) {
    texts.push_back(CaseDraftText(drafts[i], CommandOf(folder, *state)));
    if (!ReadCaseDraft(texts[i], drafts[i].path, &cases[i], error)) {
      *error = "no case can be written for these records: " + *error;
      return false;
    }
    checks.push_back(CheckCase(cases[i]));
  }
  state->assumptions.clear();
  state->remarks.clear();
  for (size_t i = 0; i < drafts.size(); ++i) {
    bool changed = false;
    const bool is_later = i > 0;
    if (!WriteCase(drafts[i].path, texts[i], state, &changed, error) ||
        !WriteCheck(cases[i], checks[i],
                    folder.At(is_later ? kLaterCheckFolder : kCheckFolder),
                    error)) {
      return false;
    }
    if (changed && !is_later) state->is_result_old = true;
    if (changed) state->is_damage_old = true;
    for (const std::string& sentence : drafts[i].assumptions) {
      state->assumptions.push_back(folder.ForReader(sentence));
    }
    for (const std::string& sentence : drafts[i].remarks) {
      state->remarks.push_back(folder.ForReader(sentence));
    }
  }
  state->is_checked = true;
  return true;
}

}  // namespace

bool CheckWork(const WorkFolder& folder, bool anew, WorkState* state,
               DraftQuestion* question, std::string* error) {
  const std::map<std::string, std::string> before = state->written;
  if (anew && !TakeAsDrafted(folder, state, error)) return false;
  const std::map<std::string, std::string> taken = state->written;
  if (DraftWork(folder, state, question, error)) return true;
  // Edited cases that were not replaced are still edited ones.
  for (auto& [name, hash] : state->written) {
    const auto then = before.find(name);
    const auto now = taken.find(name);
    if (now != taken.end() && now->second == hash) {
      hash = then == before.end() ? "" : then->second;
    }
  }
  return false;
}
bool SaveCaseOfWork(const WorkFolder& folder, const EditedCase& edited,
                    WorkState* state, std::string* error) {
  const std::string path =
      edited.is_later ? folder.later_case_path() : folder.case_path();
  std::error_code status;
  std::string now;
  if (!fs::exists(path, status)) {
    *error = "there is no case yet; check it first";
    return false;
  }
  if (!ReadBinaryFile(path, &now, error)) return false;
  if (now != edited.before) {
    *error = path +
             " has changed since you began to edit it. Keep a copy of your "
             "text, and read the file again";
    return false;
  }
  Case c;
  if (!ReadCaseDraft(edited.text, path, &c, error)) return false;
  const CaseCheck check = CheckCase(c);
  if (!WriteFileAtomically(path, edited.text, error) ||
      !WriteCheck(c, check,
                  folder.At(edited.is_later ? kLaterCheckFolder : kCheckFolder),
                  error)) {
    return false;
  }
  // Who has edited the file may have done so after the fit.
  const bool is_other =
      edited.text != now ||
      HashOf(now) != state->written[fs::path(path).filename().string()];
  if (!edited.is_later && is_other) state->is_result_old = true;
  if (is_other) state->is_damage_old = true;
  if (!edited.is_later) state->is_checked = true;
  return true;
}

bool DraftLaterOf(const WorkFolder& earlier, const WorkFolder& folder,
                  WorkState* state, DraftQuestion* question,
                  std::string* error) {
  *question = DraftQuestion();
  WorkState known;
  if (!earlier.Load(&known, error)) return false;
  if (known.is_result_old) {
    *error = "the case of " + earlier.name() +
             " has changed since its fit; fit it again there";
    return false;
  }
  const auto is_later = [](const WorkFile& file) {
    return file.use == FileUse::kLater;
  };
  known.files.erase(
      std::remove_if(known.files.begin(), known.files.end(), is_later),
      known.files.end());
  DraftRequest request = RequestOf(earlier, known);
  request.later_logs = RequestOf(folder, *state).later_logs;
  request.later_case_path = folder.later_case_path();
  if (request.logs.empty() || request.later_logs.empty()) {
    *error = request.logs.empty()
                 ? earlier.name() + " has no records to compare with"
                 : "there is no record of a later state; add one";
    return false;
  }
  // The later state has the model of that case, and is drafted anew.
  std::string drafted;
  if (!ReadBinaryFile(earlier.case_path(), &drafted, error)) return false;
  if (HashOf(drafted) !=
      known.written[fs::path(earlier.case_path()).filename().string()]) {
    *error = "the case of " + earlier.name() +
             " was edited by hand, and a later state cannot be drafted from "
             "it. Add the later records there, or use pinode_damage with a "
             "case of your own";
    return false;
  }
  std::string edited;
  std::error_code status;
  const std::string path = folder.later_case_path();
  if (fs::exists(path, status)) {
    if (!ReadBinaryFile(path, &edited, error)) return false;
    if (HashOf(edited) != state->written[fs::path(path).filename().string()]) {
      Case c;
      state->is_damage_old = true;
      return ReadCaseDraft(edited, path, &c, error) &&
             WriteCheck(c, CheckCase(c), folder.At(kLaterCheckFolder), error);
    }
  }
  std::vector<CaseDraft> drafts;
  if (!DraftCases(request, &drafts, question, error)) return false;
  const CaseDraft& draft = drafts.back();
  // As it is run in the folder of that work.
  std::string later;
  for (const std::string& log : request.later_logs) {
    later += (later.empty() ? "" : ",") +
             fs::path(log).lexically_relative(earlier.path()).string();
  }
  const std::string command =
      CommandOf(earlier, known) + " --later=" + ShellWord(later);
  const std::string text = CaseDraftText(draft, command);
  Case c;
  bool changed = false;
  if (!ReadCaseDraft(text, draft.path, &c, error)) {
    *error = "no case can be written for these records: " + *error;
    return false;
  }
  if (!WriteCase(draft.path, text, state, &changed, error) ||
      !WriteCheck(c, CheckCase(c), folder.At(kLaterCheckFolder), error)) {
    return false;
  }
  if (changed) state->is_damage_old = true;
  return true;
}

bool FitWork(const WorkFolder& folder, bool resume, CaseWatch* watch,
             std::string* error) {
  const auto begin = Clock::now();
  Case c;
  if (!ReadCase(folder.case_path(), &c, error)) return false;
  c.options.keep_states = LooksAtStates(c);
  ResultFolder results;
  FittedWork fitted;
  fitted.command = "pinode_update --case=case.toml --output_dir=" +
                   std::string(kResultFolder);
  KeepFreedMemory();
  if (!results.Open(folder.At(kResultFolder), true, resume, error) ||
      !FitCase(results, nullptr, watch, &c, &fitted.summary, &fitted.model,
               error)) {
    return false;
  }
  if (c.profiles.has_value() && !watch->StopsProfiles()) {
    ProfileCase(results, watch, &c, fitted.model, &fitted.summary);
  }
  fitted.seconds = SecondsFrom(begin);
  return WriteWork(folder, c, &fitted, &results, error);
}

bool CompareWork(const WorkFolder& folder, const std::string& baseline,
                 bool resume, CaseWatch* watch, std::string* error) {
  const auto begin = Clock::now();
  Case c;
  std::vector<Baseline> baselines(1);
  IdentifiedModel begin_from;
  if (!ReadCase(folder.later_case_path(), &c, error) ||
      !ReadBaseline(baseline, c, &baselines[0], error) ||
      !PrepareForBaselines(baselines, &c, &begin_from, error)) {
    return false;
  }
  ResultFolder results;
  FittedWork fitted;
  fitted.command =
      "pinode_damage --baseline=" +
      fs::path(baseline).lexically_relative(folder.path()).string() +
      " --case=case_later.toml --output_dir=" + std::string(kDamageFolder);
  KeepFreedMemory();
  if (!results.Open(folder.At(kDamageFolder), true, resume, error) ||
      !FitCase(results, &begin_from, watch, &c, &fitted.summary, &fitted.model,
               error)) {
    return false;
  }
  const ChangeOptions options;
  const JudgedChange judgement =
      JudgeChange(fitted.summary, fitted.model, baselines, options, watch, &c);
  const DamageResult not_judged = NotJudged(judgement, baselines, options);
  const DamageResult& result = judgement.judged ? judgement.result : not_judged;
  if (judgement.judged) {
    fitted.summary = result.summary;
    fitted.model = result.model;
    fitted.damage = &result;
  }
  fitted.seconds = SecondsFrom(begin);
  return WriteFileAtomically(results.working_path() + "/damage.json",
                             DamageAsJson(result), error) &&
         WriteWork(folder, c, &fitted, &results, error);
}

bool FindModesOfWork(const WorkFolder& folder, const WorkState& state,
                     const WorkFile& file,
                     const std::vector<std::string>& columns,
                     std::string* error) {
  const auto begin = Clock::now();
  const LogOptions time = LogOptionsOf(state);
  ModesDataFile data;
  data.path = folder.PathOf(file);
  data.columns = columns;
  data.quantities = {"acceleration"};
  data.time_column = time.time;
  data.sampling_rate_hz = time.sampling_rate_hz;
  ModesCase c;
  FoundModes found;
  if (!ReadModesDataFile(data, &c, error) || !FindModes(c, &found, error)) {
    return false;
  }
  ModesReportInput report;
  report.title = c.title;
  report.origin = {c.path, "", SecondsFrom(begin)};
  report.records = &c.records;
  report.by_record = &found.by_record;
  report.merged = &found.result.merged;
  report.remarks = found.result.remarks;
  ResultFolder results;
  return results.Open(folder.At(kModesFolder), true, false, error) &&
         WriteModesFiles(found.result, results.working_path(), error) &&
         WriteModesReport(report, ReportOptions(),
                          results.working_path() + "/report.html", error) &&
         results.Commit(error);
}

}  // namespace pinode
