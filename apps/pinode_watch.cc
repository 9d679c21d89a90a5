// Watches a structure for years: modes of every record, their histories, what
// is normal, and alarms at a stated rate.
//
// Sample runs:
//   pinode_watch --structure=bridge.toml --store=watch.db --once
//   pinode_watch --structure=bridge.toml --store=watch.db --output_dir=page
//   pinode_watch --structure=bridge.toml --store=watch.db --backfill=old
//   pinode_watch --structure=bridge.toml --store=watch.db
//     --mend=reject:a.csv --by="N. N." --why="crane on the bridge"
//   pinode_watch --keys

#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/launcher.h"
#include "apps/print.h"
#include "apps/program.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/report/html_report.h"
#include "pinode/watch/folder_notice.h"
#include "pinode/watch/mending.h"
#include "pinode/watch/notify.h"
#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"
#include "pinode/watch/structure_keys.h"
#include "pinode/watch/watch.h"
#include "pinode/watch/watch_analysis.h"
#include "pinode/watch/watch_files.h"

DEFINE_string(structure, "",
              "structure file (TOML); format: see watching.md (in the source "
              "tree: pinode/watch/README.md); [modes] is that of a case: see "
              "case_files.md (in the source tree: pinode/case/README.md)");
DEFINE_string(store, "",
              "file of the store (SQLite); it is made if it does not exist");
DEFINE_bool(once, false,
            "process the records that are there and end; without it the "
            "folder is looked at again and again until the program is "
            "interrupted");
DEFINE_string(backfill, "",
              "read the records of this folder in place of the folder in the "
              "structure file, and end");
DEFINE_int32(interval_seconds, 60,
             "longest time between two looks at the folder; a new file "
             "is noticed sooner where the system tells of it");
DEFINE_string(
    output_dir, "",
    "folder for histories.csv, alarms.csv, watch.json, watch.prom and "
    "watch.html; must not exist without --overwrite; empty: write "
    "no files");
DEFINE_bool(overwrite, false, "replace an existing output folder");
DEFINE_string(mend, "",
              "store a decision and end: reject:FILE or accept:FILE for a "
              "record, name:HZ=NAME for a mode, acknowledge:TIME for an alarm; "
              "needs --by and --why");
DEFINE_string(by, "", "person who decides, with --mend");
DEFINE_string(why, "", "reason of the decision, with --mend");
DEFINE_bool(keys, false,
            "print every key of a structure file with its type, default and "
            "meaning, as tables in Markdown, and read no file");

namespace pinode {
namespace {

bool CheckFlags(std::string* error) {
  if (FLAGS_structure.empty()) {
    *error = "--structure=FILE is missing; see --help";
  } else if (FLAGS_store.empty()) {
    *error = "--store=FILE is missing; see --help";
  } else if (!FLAGS_mend.empty() &&
             (FLAGS_once || FLAGS_overwrite ||
              !(FLAGS_output_dir + FLAGS_backfill).empty())) {
    *error =
        "--mend stores a decision and ends; leave out --output_dir, "
        "--overwrite, --once and --backfill";
  } else if (FLAGS_mend.empty() && !(FLAGS_by + FLAGS_why).empty()) {
    *error = "--by and --why need --mend=DECISION; see --help";
  } else if (FLAGS_interval_seconds < 1) {
    *error = "--interval_seconds=" + std::to_string(FLAGS_interval_seconds) +
             ", expected at least 1";
  } else if (FLAGS_output_dir.empty()) {
    if (!FLAGS_overwrite) return true;
    *error = "--overwrite needs --output_dir=FOLDER";
  } else {
    return CheckOutputFolder(FLAGS_output_dir, FLAGS_overwrite, false, error);
  }
  return false;
}

void PrintRecord(const StoredRecord& record) {
  if (!record.refusal.empty()) {
    Print("refused: %s\n", record.refusal.c_str());
    return;
  }
  Print("%s: %zu modes", record.name.c_str(), record.modes.size());
  for (const StoredChannel& channel : record.channels) {
    if (channel.fault.empty()) continue;
    Print("; channel '%s' left out: it %s", channel.name.c_str(),
          channel.fault.c_str());
  }
  Print("\n");
}

// Prints the events that the last run did not know: whoever is called by an
// alarm is called once.
void PrintEvents(const std::vector<StoredEvent>& known,
                 const WatchAnalysis& analysis) {
  for (const StoredEvent& event : analysis.events) {
    const bool is_known = std::any_of(
        known.begin(), known.end(), [&event](const StoredEvent& other) {
          return other.time == event.time && other.kind == event.kind;
        });
    if (is_known) continue;
    Print("%s %s: %s\n", DateText(event.time).c_str(), event.kind.c_str(),
          event.text.c_str());
  }
}

// Returns the exit status.
int WriteFolder(const WatchedStructure& structure,
                const WatchAnalysis& analysis, bool overwrite) {
  if (FLAGS_output_dir.empty()) return kExitDone;
  ResultFolder folder;
  std::string error;
  if (!folder.Open(FLAGS_output_dir, overwrite, false, &error)) {
    return Refuse(error);
  }
  HtmlReportOptions options;
  options.num_threads = DefaultThreads();
  if (!WriteWatchFiles(structure, analysis, options, folder.working_path(),
                       &error) ||
      !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }
  return kExitDone;
}

// Looks at the folder once, and tells what is new. False with one line if that
// was not possible.
bool Look(const WatchedStructure& structure, int64_t id, bool is_due, bool once,
          bool overwrite, Store* store, std::string* last_state,
          WatchCounts* counts, int* status, std::string* error) {
  WatchCalls calls;
  calls.stored = PrintRecord;
  calls.unreadable = [](const std::string& message) {
    PrintError("%s", message.c_str());
  };
  calls.interrupted = Interrupted;
  const std::string folder =
      FLAGS_backfill.empty() ? structure.records.folder : FLAGS_backfill;
  *status = kExitDone;
  if (!StoreNewRecords(structure, folder, !once, id, calls, store, counts,
                       error)) {
    return false;
  }
  std::vector<StoredMend> mends;
  if (!store->Mends(id, &mends, error)) return false;
  const std::string state =
      CovariateFilesState(structure) + std::to_string(mends.size());
  if (!is_due && counts->stored == 0 && state == *last_state) return true;
  std::vector<StoredEvent> known;
  WatchAnalysis analysis;
  if (!store->Events(id, &known, error) ||
      !AnalyseStore(structure, id, store, &analysis, error)) {
    return false;
  }
  PrintEvents(known, analysis);
  const std::string later =
      counts->growing == 0
          ? ""
          : ", " + std::to_string(counts->growing) + " left for later";
  Print("%d files, %d new%s. %s", counts->files, counts->stored, later.c_str(),
        WatchSummary(structure, analysis).c_str());
  // Events are known once they are printed. An alarm that nobody saw is printed
  // by the next run.
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    *error = "the events cannot be printed; standard output is closed or full";
    return false;
  }
  if (!store->SetEvents(id, analysis.events, HistoryColumns(analysis), error))
    return false;
  *last_state = state;
  *status = WriteFolder(structure, analysis, overwrite);
  return true;
}

// Sends what was not sent yet. Returns false after a line about it.
bool Notify(const WatchedStructure& structure, int64_t id, Store* store) {
  std::string error;
  if (SendNewEvents(structure, id, CouriersOf(structure.notify), store,
                    &error)) {
    return true;
  }
  PrintError("%s; the next look tries it again", error.c_str());
  return false;
}

// Stores a decision. A mistyped path must not make a store, nor a mistyped name
// a structure. Returns the exit status.
int StoreDecision(const WatchedStructure& structure) {
  StoredMend mend;
  mend.time = static_cast<double>(std::time(nullptr));
  std::unique_ptr<Store> store;
  int64_t id = 0;
  std::string message, error;
  if (!ParseDecision(FLAGS_mend, FLAGS_by, FLAGS_why, &mend, &error)) {
    return Refuse(error);
  }
  std::error_code ignored;
  if (!std::filesystem::exists(FLAGS_store, ignored)) {
    return Refuse(FLAGS_store +
                  ": no such store; run pinode_watch without --mend first");
  }
  if (!Store::Open(FLAGS_store, Store::Access::kReadAndWrite, &store, &error) ||
      !store->FindStructure(structure.name, &id, &error) ||
      !Mend(mend, id, store.get(), &message, &error)) {
    return Refuse(error);
  }
  Print("%s by %s. The next analysis takes it into account.\n", message.c_str(),
        FLAGS_by.c_str());
  return kExitDone;
}

// Looks at the folder once or until an interrupt. Returns the exit status.
int Watch(const WatchedStructure& structure, int64_t id, Store* store) {
  const bool once = FLAGS_once || !FLAGS_backfill.empty();
  // State of the covariates' own files and the decisions at the last analysis.
  std::string last_state;
  bool is_due = true;
  // Begins before the first look, so that no file falls between them.
  FolderNotice notice(structure.records.folder);
  for (bool first = true;; first = false) {
    WatchCounts counts;
    std::string error;
    int status = kExitDone;
    if (Look(structure, id, is_due, once, FLAGS_overwrite || !first, store,
             &last_state, &counts, &status, &error)) {
      // An alarm is told even if the page cannot be written.
      const bool notified = counts.interrupted || Notify(structure, id, store);
      if (status != kExitDone) return status;
      if (once && !notified) return kExitNotUsable;
      is_due = false;
    } else {
      if (first) return Refuse(error);
      // A share that is away for a moment does not end the watch.
      PrintError("%s", error.c_str());
      is_due = true;
    }
    if (counts.interrupted) return kExitInterrupted;
    if (once) return kExitDone;
    // A file that was still growing is due when it has been quiet.
    const std::chrono::seconds quiet(kQuietSeconds + 1);
    const std::chrono::seconds interval(FLAGS_interval_seconds);
    notice.Wait(counts.growing > 0 ? std::min(interval, quiet) : interval,
                quiet, Interrupted);
    // The way to end it.
    if (Interrupted()) return kExitDone;
  }
}

}  // namespace

int RunProgram(int argc, char** argv) {
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_watch --structure=FILE --store=FILE [--once] "
                  "[--output_dir=FOLDER]\n\n"
                  "Watches a structure: finds the modes of every new record, "
                  "joins them to histories,\nlearns how frequencies follow "
                  "temperature and the like, and raises alarms at a\nstated "
                  "rate of false ones.",
                  &status)) {
    return status;
  }
  if (NumLaunchedRanks() > 1) {
    return Refuse("pinode_watch runs in one process, expected no launcher");
  }
  if (FLAGS_keys) {
    std::printf("%s", StructureKeyReference().c_str());
    return kExitDone;
  }
  std::string error;
  WatchedStructure structure;
  if (!CheckFlags(&error) ||
      !ReadStructureFile(FLAGS_structure, &structure, &error)) {
    return Refuse(error);
  }
  if (!FLAGS_mend.empty()) return StoreDecision(structure);
  // Found now, not when the first alarm is due.
  if (!structure.notify.user.empty() &&
      std::getenv("PINODE_MAIL_PASSWORD") == nullptr) {
    return Refuse(FLAGS_structure +
                  ": [notify] names a user; set PINODE_MAIL_PASSWORD in the "
                  "environment");
  }
  std::unique_ptr<Store> store;
  int64_t id = 0;
  if (!Store::Open(FLAGS_store, Store::Access::kReadAndWrite, &store, &error) ||
      !store->OpenStructure(structure.name, ReadingSettings(structure), &id,
                            &error)) {
    return Refuse(error);
  }
  CatchInterrupts();
  return Watch(structure, id, store.get());
}

}  // namespace pinode
