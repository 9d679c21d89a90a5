// Drafts a case from the files of loggers, and checks it.
//
// Reads the records, finds what they say of themselves (columns, units, the
// first mode), takes the rest from flags or asks for it on a terminal, and
// writes a case with comments. Files of a later state give a second case, with
// the same model, for pinode_damage.
//
// Sample run:
//   pinode_new before.csv --later=after.csv --storeys=5 --weights="900 kN"
//   pinode_update --case=case.toml --output_dir=D
//   pinode_damage --baseline=D --case=case_later.toml --output_dir=E

#include <gflags/gflags.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "apps/check_text.h"
#include "apps/launcher.h"
#include "apps/print.h"
#include "apps/program.h"
#include "apps/text_flags.h"
#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/case/draft/case_draft.h"
#include "pinode/case/draft/case_draft_text.h"
#include "pinode/case/results/case_check.h"
#include "pinode/case/results/check_files.h"
#include "pinode/case/results/result_folder.h"

DECLARE_string(time_unit);

DEFINE_string(case, "case.toml",
              "case file to write; the file for --later has the same name "
              "with _later. Format: see case_files.md (in the source tree: "
              "pinode/case/README.md)");
DEFINE_string(later, "",
              "records of a later state, separated by commas; they get a case "
              "of their own with the same model, for pinode_damage");
DEFINE_string(holdout, "",
              "record that is predicted and not fitted, or 'none'; empty: the "
              "last record of a state that has several");
DEFINE_string(storeys, "", "number of storeys");
DEFINE_string(weights, "",
              "weights or masses of the floors, one for all or one each from "
              "the lowest up: \"900 kN\", \"900, 700 kN\", \"2000 kg\"; units: "
              "N kN MN kgf lbf kip kg t");
DEFINE_string(stiffness, "",
              "stiffnesses of the storeys, one for all or one each from the "
              "lowest up, such as \"150000 kN/m\"; empty: all equal, from the "
              "first mode of the records");
DEFINE_string(first_mode_hz, "",
              "frequency of the first mode, if the records do not show it");
DEFINE_string(damping_ratio, "0.02",
              "initial damping as a fraction of critical; the fit updates it");
DEFINE_string(
    damping, "",
    "free damping: storeys (a factor each), rayleigh (two factors) or "
    "modes (a ratio for each of the lowest five, one for the "
    "others); empty: storeys if the records show them, else rayleigh");
DEFINE_string(base, "",
              "column of the acceleration of the base, or 'none'; empty: found "
              "by its name");
DEFINE_string(sensors, "",
              "floor of each column, such as \"acc_1=1,acc_2=-2\"; 1 is the "
              "lowest above the base, negative: upside down; other columns are "
              "left out; empty: found by the names");
DEFINE_string(
    deck, "",
    "deck of CalculiX (FILE.inp) instead of storeys; its matrices, from "
    "pinode.calculix.export of Python, are beside it or in FILE_export; "
    "--sensors then takes nodes and directions: \"a1=1051.1,a2=-1051.2\"");
DEFINE_string(deck_units, "",
              "units of force and length in the deck, such as N,mm");
DEFINE_string(
    factor, "",
    "factor on the properties of the element sets in the changed exports "
    "of the deck");
DEFINE_string(force, "",
              "columns of measured forces with their floor or DOF: \"F=3\"");
DEFINE_string(force_unit, "",
              "unit of the forces, if the files do not state it");
DEFINE_string(base_direction, "",
              "direction of the measured base motion in the deck: x, y or z");
DEFINE_string(ignore, "", "columns to leave out, separated by commas");
DEFINE_string(unit, "",
              "unit of the columns, if the files do not state it or --scale "
              "changes it, such as m/s^2, mm/s^2, g, mg or gal");
DEFINE_string(time, "",
              "column of the time; empty: found by its name or clock times");
DEFINE_double(sampling_rate_hz, 0.0,
              "sampling rate of files without a time column");
DEFINE_string(title, "", "title of the case");
DEFINE_string(
    output_dir, "",
    "folder for the check of the case, as pinode_check writes it; "
    "must not exist without --overwrite; empty: print the check only");
DEFINE_bool(overwrite, false,
            "replace a case that pinode_new wrote, and the output folder");

namespace pinode {
namespace {

std::vector<std::string> Files(const std::string& text) {
  std::vector<std::string> files;
  for (const std::string_view part : Split(text, ',')) {
    if (!part.empty()) files.emplace_back(part);
  }
  return files;
}

// Path of the case of the later state: "frame_later.toml" beside "frame.toml".
std::string LaterPath(const std::string& path) {
  const std::filesystem::path whole(path);
  std::filesystem::path later = whole;
  later.replace_filename(whole.stem().string() + "_later" +
                         whole.extension().string());
  return later.string();
}

DraftRequest RequestOfFlags(const std::vector<std::string>& logs) {
  DraftRequest request;
  request.logs = logs;
  request.later_logs = Files(FLAGS_later);
  request.holdout = FLAGS_holdout;
  request.case_path = FLAGS_case;
  request.later_case_path = LaterPath(FLAGS_case);
  request.title = FLAGS_title;
  request.storeys = FLAGS_storeys;
  request.weights = FLAGS_weights;
  request.stiffness = FLAGS_stiffness;
  request.first_mode_hz = FLAGS_first_mode_hz;
  request.damping_ratio = FLAGS_damping_ratio;
  request.damping = FLAGS_damping;
  request.base = FLAGS_base;
  request.sensors = FLAGS_sensors;
  request.deck = FLAGS_deck;
  request.deck_units = FLAGS_deck_units;
  request.factor = FLAGS_factor;
  request.force = FLAGS_force;
  request.force_unit = FLAGS_force_unit;
  request.base_direction = FLAGS_base_direction;
  request.ignore = FLAGS_ignore;
  request.unit = FLAGS_unit;
  request.time.time = FLAGS_time;
  request.time.time_unit = FLAGS_time_unit;
  request.time.sampling_rate_hz = FLAGS_sampling_rate_hz;
  return request;
}

// Checks that a case may be written to `path`.
bool MayWriteCase(const std::string& path, std::string* error) {
  std::error_code status;
  const std::filesystem::path folder =
      std::filesystem::path(path).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, status)) {
    *error = path + ": there is no folder " + folder.string() +
             "; create it, or give another name with --case";
    return false;
  }
  if (!std::filesystem::exists(path, status)) return true;
  if (!FLAGS_overwrite) {
    *error = path +
             " exists; give --overwrite to replace it, or another name with "
             "--case";
    return false;
  }
  std::string text;
  if (!ReadBinaryFile(path, &text, error)) return false;
  if (IsCaseDraft(text)) return true;
  *error = path +
           " was not written by pinode_new and is not replaced; give another "
           "name with --case";
  return false;
}

bool CheckFlags(DraftRequest* request, std::string* error) {
  if (!ReadTextFlags(&request->time.format, error) ||
      !ReadScaleFlag(&request->time.scales, error)) {
    return false;
  }
  if (FLAGS_case.empty()) {
    *error = "--case is empty, expected the name of a file to write";
    return false;
  }
  if (FLAGS_sampling_rate_hz < 0.0) {
    *error = "--sampling_rate_hz is negative, expected a rate in Hz";
    return false;
  }
  if (FLAGS_sampling_rate_hz > 0.0 && !FLAGS_time.empty()) {
    *error = "--time and --sampling_rate_hz were both given; give one of them";
    return false;
  }
  if (!MayWriteCase(FLAGS_case, error) ||
      (!FLAGS_later.empty() && !MayWriteCase(LaterPath(FLAGS_case), error))) {
    return false;
  }
  return FLAGS_output_dir.empty() ||
         (CheckOutputFolder(FLAGS_output_dir, FLAGS_overwrite, false, error) &&
          MayGiveWayToCheck(FLAGS_output_dir, error));
}

// Drafts the cases. On a terminal, asks for what is missing, and again after an
// answer that cannot be.
bool DraftWithAnswers(DraftRequest* request, std::vector<CaseDraft>* drafts,
                      std::string* error) {
  const std::map<std::string, std::string*> answers = {
      {"storeys", &request->storeys},
      {"weights", &request->weights},
      {"first_mode_hz", &request->first_mode_hz},
      {"base", &request->base},
      {"sensors", &request->sensors},
      {"deck_units", &request->deck_units},
      {"factor", &request->factor},
      {"force_unit", &request->force_unit},
      {"base_direction", &request->base_direction},
      {"unit", &request->unit},
      {"time", &request->time.time},
      {"time_unit", &request->time.time_unit}};
  const bool is_terminal =
      isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
  std::string* last = nullptr;
  DraftQuestion question;
  while (!DraftCases(*request, drafts, &question, error)) {
    const auto asked = answers.find(question.flag);
    if (asked == answers.end() || !is_terminal) {
      if (!question.flag.empty()) *error = question.AsError();
      if (last == nullptr || !question.flag.empty()) return false;
      Print("%s\n", error->c_str());
    } else {
      last = asked->second;
      Print("%s.\nFor example: %s\n", question.text.c_str(),
            question.example.c_str());
    }
    Print("> ");
    std::fflush(stdout);
    if (!std::getline(std::cin, *last) || last->empty()) {
      *error = "no answer; see the flag in --help";
      return false;
    }
  }
  return true;
}

// A case that is ready to be written.
struct CheckedDraft {
  CaseDraft draft;
  std::string text;
  Case c;
  CaseCheck check;
};

// Reads the drafts back as cases, and checks them.
bool CheckDrafts(const std::vector<CaseDraft>& drafts,
                 const std::string& command, std::vector<CheckedDraft>* checked,
                 std::string* error) {
  for (const CaseDraft& draft : drafts) {
    checked->emplace_back();
    CheckedDraft& one = checked->back();
    one.draft = draft;
    one.text = CaseDraftText(draft, command);
    if (!ReadCaseDraft(one.text, draft.path, &one.c, error)) {
      *error = "no case can be written for these records: " + *error;
      return false;
    }
    one.check = CheckCase(one.c);
  }
  return true;
}

// Writes all cases or none.
bool WriteCases(const std::vector<CheckedDraft>& checked, std::string* error) {
  std::vector<std::string> added;
  for (const CheckedDraft& one : checked) {
    std::error_code status;
    const bool is_new = !std::filesystem::exists(one.draft.path, status);
    if (!WriteFileAtomically(one.draft.path, one.text, error)) {
      for (const std::string& path : added) {
        std::filesystem::remove(path, status);
      }
      return false;
    }
    if (is_new) added.push_back(one.draft.path);
  }
  return true;
}

void PrintSentences(const char* title,
                    const std::vector<std::string>& sentences) {
  if (sentences.empty()) return;
  Print("%s\n", title);
  for (const std::string& sentence : sentences) {
    Print("  %s\n", sentence.c_str());
  }
  Print("\n");
}

void PrintNextSteps(const std::vector<CheckedDraft>& checked) {
  std::filesystem::path folder(checked[0].draft.path);
  folder.replace_extension();
  const std::string result = folder.string() + "_result";
  Print("\nWritten: %s", checked[0].draft.path.c_str());
  if (checked.size() > 1) Print(", %s", checked[1].draft.path.c_str());
  const std::string deck = FLAGS_deck.empty() ? "" : " --deck=" + FLAGS_deck;
  Print("\nNext:\n  pinode_update --case=%s --output_dir=%s%s\n",
        checked[0].draft.path.c_str(), result.c_str(), deck.c_str());
  if (checked.size() > 1) {
    Print("  pinode_damage --baseline=%s --case=%s --output_dir=%s\n",
          result.c_str(), checked[1].draft.path.c_str(),
          (folder.string() + "_damage").c_str());
  }
}

// Prints all of the first check, and of others what is special.
int PrintChecked(const std::vector<CheckedDraft>& checked) {
  int status = kExitDone;
  std::vector<std::string> assumptions;
  std::vector<std::string> remarks;
  for (const CheckedDraft& one : checked) {
    for (const std::string& sentence : one.draft.assumptions) {
      assumptions.push_back(sentence);
    }
    for (const std::string& sentence : one.draft.remarks) {
      remarks.push_back(sentence);
    }
    if (!one.check.ok()) status = kExitNotUsable;
  }
  PrintSentences("Read from the files", assumptions);
  PrintSentences("Please check these sensors", remarks);
  PrintCaseCheck(checked[0].c, checked[0].check);
  for (size_t i = 1; i < checked.size(); ++i) {
    const CaseCheck& check = checked[i].check;
    std::vector<std::string> sentences = check.questions;
    if (!check.ok()) sentences.push_back("Not assessed: " + check.not_assessed);
    PrintSentences(("\n" + checked[i].draft.path).c_str(), sentences);
  }
  PrintNextSteps(checked);
  return status;
}

bool WriteCheckFolder(const CheckedDraft& checked, ResultFolder* folder,
                      std::string* error) {
  return folder->Open(FLAGS_output_dir, FLAGS_overwrite, false, error) &&
         WriteCheckFiles(checked.c, checked.check, folder->working_path(),
                         error) &&
         folder->Commit(error);
}

}  // namespace

int RunProgram(int argc, char** argv) {
  int status;
  std::vector<std::string> logs;
  if (!ParseFlags(
          argc, argv,
          "pinode_new LOG... --storeys=N --weights=WEIGHTS [--later=FILE,...]\n"
          "  or:  pinode_new LOG... --deck=FILE --deck_units=UNITS "
          "[--case=FILE]\n"
          "       [--output_dir=FOLDER]\n\n"
          "Drafts a case from the files of data loggers, and asks on a "
          "terminal for missing answers. The structure is a frame of "
          "storeys with sensors at its base and floors, or a "
          "deck with its exported matrices. Writes "
          "the case with comments and prints its check, as pinode_check "
          "does.",
          &status, &logs)) {
    return status;
  }
  if (NumLaunchedRanks() > 1) {
    return Refuse("pinode_new runs in one process, expected no launcher");
  }

  // 1. What the files and the user say.
  std::string error;
  DraftRequest request = RequestOfFlags(logs);
  std::vector<CaseDraft> drafts;
  std::vector<CheckedDraft> checked;
  if (!CheckFlags(&request, &error) ||
      !DraftWithAnswers(&request, &drafts, &error) ||
      !CheckDrafts(drafts, CommandLine(argc, argv), &checked, &error)) {
    return Refuse(error);
  }

  // 2. The cases, once they were read back.
  CatchInterrupts();
  if (!WriteCases(checked, &error)) {
    PrintError("%s", error.c_str());
    return kExitNotUsable;
  }
  status = PrintChecked(checked);
  if (FLAGS_output_dir.empty()) return status;
  ResultFolder folder;
  if (!WriteCheckFolder(checked[0], &folder, &error)) {
    return CannotWrite(error, folder);
  }
  Print("Check: %s\n", folder.final_path().c_str());
  return status;
}

}  // namespace pinode
