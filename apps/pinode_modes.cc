// Modes of a structure from records of its vibration, without a model and
// without its loads: frequencies, damping ratios and shapes with intervals.
//
// Reads the records of a case and identifies the modes of each by the method
// for its kind: subspace identification over many orders, with the loads if
// they were measured; ERA of a free decay. Merges the modes of several set-ups
// of sensors.
//
// Sample run:
//   pinode_modes --case=C.toml --output_dir=D
//   pinode_modes --case=wind.csv --columns=all
//   pinode_modes --case=wind.csv --columns=a1,a2 --output_dir=D

#include <gflags/gflags.h>

#include <chrono>
#include <string>

#include "apps/fit_flags.h"
#include "apps/launcher.h"
#include "apps/print.h"
#include "apps/program.h"
#include "pinode/base/file_text.h"
#include "pinode/base/parallel_for.h"
#include "pinode/case/results/case_picture.h"
#include "pinode/case/results/modes_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/run/find_modes.h"
#include "pinode/case/sections/modes_section.h"
#include "pinode/report/modes_report.h"

DEFINE_string(columns, "",
              "columns of the channels, separated by commas, if --case is a "
              "data file (CSV, universal file, ...); 'all': every column of "
              "numbers except time and row numbers");
DEFINE_string(quantities, "acceleration",
              "with --columns: acceleration, velocity, displacement or strain; "
              "one for all columns or one for each");
DEFINE_string(time, "",
              "with --columns: column of the time, in seconds or in the unit "
              "that the file states; empty, without a sampling rate: found by "
              "its name or clock times");
DEFINE_double(sampling_rate_hz, 0.0,
              "with --columns: sampling rate of files without a time column");

namespace pinode {
namespace {

using Clock = std::chrono::steady_clock;

bool CheckFlags(std::string* error) {
  if (FLAGS_case.empty()) {
    *error = "--case=FILE is missing; see --help";
    return false;
  }
  if (FLAGS_output_dir.empty()) {
    if (!FLAGS_mat && !FLAGS_overwrite) return true;
    *error = std::string(FLAGS_mat ? "--mat" : "--overwrite") +
             " needs --output_dir=FOLDER";
    return false;
  }
  return CheckOutputFolder(FLAGS_output_dir, FLAGS_overwrite, false, error);
}

// Prints the modes of all records.
int PrintModes(const ModesResult& result) {
  Print("%s\n", ModesAsText(result.merged).c_str());
  for (const std::string& remark : result.remarks) {
    Print("%s\n", remark.c_str());
  }
  return result.merged.modes.empty() ? kExitNotUsable : kExitDone;
}

// Reads a case, or a single data file.
bool ReadInput(ModesCase* c, std::string* error) {
  if (FLAGS_columns.empty()) {
    for (const char* name : {"quantities", "time", "sampling_rate_hz"}) {
      if (!gflags::GetCommandLineFlagInfoOrDie(name).is_default) {
        *error = "--" + std::string(name) + " needs --columns";
        return false;
      }
    }
    return ReadModesCase(FLAGS_case, c, error);
  }
  ModesDataFile file;
  file.path = FLAGS_case;
  for (const std::string_view column : Split(FLAGS_columns, ',')) {
    file.columns.emplace_back(column);
  }
  for (const std::string_view quantity : Split(FLAGS_quantities, ',')) {
    file.quantities.emplace_back(quantity);
  }
  file.time_column = FLAGS_time;
  file.sampling_rate_hz = FLAGS_sampling_rate_hz;
  return ReadModesDataFile(file, c, error);
}

}  // namespace

int RunProgram(int argc, char** argv) {
  const auto begin = Clock::now();
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_modes --case=FILE [--output_dir=FOLDER]\n\n"
                  "Identifies the modes of a structure from records of its "
                  "vibration. It needs no model.",
                  &status)) {
    return status;
  }
  if (NumLaunchedRanks() > 1) {
    return Refuse("pinode_modes runs in one process, expected no launcher");
  }

  // 1. All checks of the input, before any work.
  std::string error;
  ModesCase c;
  if (!CheckFlags(&error) || !ReadInput(&c, &error)) {
    return Refuse(error);
  }

  // 2. The modes of each record, and of all.
  FoundModes found;
  if (!FindModes(c, &found, &error)) return Refuse(error);
  const ModesResult& result = found.result;

  // 3. The folder, with a report, unless the modes are printed alone.
  if (FLAGS_output_dir.empty()) return PrintModes(result);
  const double seconds =
      std::chrono::duration<double>(Clock::now() - begin).count();
  ModesReportInput report;
  report.title = c.title;
  report.origin = {c.path, CommandLine(argc, argv), seconds};
  report.records = &c.records;
  report.by_record = &found.by_record;
  report.merged = &result.merged;
  report.remarks = result.remarks;
  if (found.picture.has_value()) report.structure = &*found.picture;
  HtmlReportOptions report_options;
  report_options.num_threads = DefaultThreads();
  ResultFolder folder;
  CatchInterrupts();
  if (!folder.Open(FLAGS_output_dir, FLAGS_overwrite, false, &error)) {
    return Refuse(error);
  }
  if (!WriteModesFiles(result, folder.working_path(), &error) ||
      !WriteVtu(found.picture, folder.working_path(), &error) ||
      !WriteModesReport(report, report_options,
                        folder.working_path() + "/report.html", &error) ||
      !WriteForMatlab(folder, &error) || !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }

  // 4. Output on the console.
  status = PrintModes(result);
  Print("Results: %s\n", folder.final_path().c_str());
  return status;
}

}  // namespace pinode
