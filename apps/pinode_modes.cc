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
//   pinode_modes --frf=hammer.uff --output_dir=D

#include <gflags/gflags.h>

#include <chrono>
#include <string>
#include <vector>

#include "apps/fit_flags.h"
#include "apps/launcher.h"
#include "apps/print.h"
#include "apps/program.h"
#include "apps/text_flags.h"
#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/strings.h"
#include "pinode/case/results/case_picture.h"
#include "pinode/case/results/modes_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/run/find_frf_modes.h"
#include "pinode/case/run/find_modes.h"
#include "pinode/case/sections/modes_data_file.h"
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

DEFINE_string(
    frf, "",
    "files with frequency response functions, separated by commas, in "
    "place of --case: universal files, or text with frequency and "
    "real and imaginary part or magnitude and phase");
DEFINE_string(frf_responses, "",
              "with --frf: places of the responses, separated by commas; one "
              "for all or one for each; empty: those that the files state");
DEFINE_string(frf_references, "",
              "with --frf: places of the forces, separated by commas; one for "
              "all or one for each; empty: those that the files state");
DEFINE_string(frf_quantity, "",
              "with --frf: acceleration, velocity or displacement per force, "
              "if the files do not state it");
DEFINE_string(frf_band, "",
              "with --frf: lowest and highest frequency in Hz, as 10,500; "
              "empty: all lines");
DEFINE_string(frf_poles, "common",
              "with --frf: common, or per_file if the structure drifted "
              "between the files");

namespace pinode {
namespace {

using Clock = std::chrono::steady_clock;

bool CheckFlags(std::string* error) {
  if (FLAGS_case.empty() == FLAGS_frf.empty()) {
    *error = FLAGS_case.empty()
                 ? "--case=FILE or --frf=FILES is missing; see --help"
                 : "--case and --frf are both given, expected one of them";
    return false;
  }
  if (FLAGS_frf.empty()) {
    for (const char* name : {"frf_responses", "frf_references", "frf_quantity",
                             "frf_band", "frf_poles"}) {
      if (!gflags::GetCommandLineFlagInfoOrDie(name).is_default) {
        *error = "--" + std::string(name) + " needs --frf";
        return false;
      }
    }
  }
  if (FLAGS_output_dir.empty()) {
    if (!FLAGS_mat && !FLAGS_overwrite) return true;
    *error = std::string(FLAGS_mat ? "--mat" : "--overwrite") +
             " needs --output_dir=FOLDER";
    return false;
  }
  return CheckOutputFolder(FLAGS_output_dir, FLAGS_overwrite, false, error);
}

// Names of the flags that belong to --columns.
std::vector<const char*> ColumnFlags() {
  std::vector<const char*> names = {"quantities", "time", "sampling_rate_hz"};
  for (const char* name : TextFlagNames()) names.push_back(name);
  return names;
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
    for (const char* name : ColumnFlags()) {
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
  return ReadTextFlags(&file.format, error) &&
         ReadScaleFlag(&file.scales, error) &&
         ReadModesDataFile(file, c, error);
}

std::vector<std::string> Names(const std::string& flag) {
  std::vector<std::string> names;
  if (flag.empty()) return names;
  for (const std::string_view name : Split(flag, ',')) {
    names.emplace_back(name);
  }
  return names;
}

bool ReadFrfFlags(FrfSetup* setup, std::string* error) {
  setup->files = Names(FLAGS_frf);
  setup->responses = Names(FLAGS_frf_responses);
  setup->references = Names(FLAGS_frf_references);
  setup->quantity = FLAGS_frf_quantity;
  ModeIdentificationOptions& options = setup->options.identification;
  options.num_threads = DefaultThreads();
  const std::vector<std::string> band = Names(FLAGS_frf_band);
  if (!band.empty() &&
      (band.size() != 2 || !ParseDouble(band[0], &options.lowest_hz) ||
       !ParseDouble(band[1], &options.highest_hz) ||
       !(options.lowest_hz >= 0.0) ||
       !(options.highest_hz > options.lowest_hz))) {
    *error = "--frf_band=" + FLAGS_frf_band +
             ", expected two ascending frequencies in Hz, as 10,500";
    return false;
  }
  if (FLAGS_frf_poles != "common" && FLAGS_frf_poles != "per_file") {
    *error = "--frf_poles=" + FLAGS_frf_poles + ", expected common or per_file";
    return false;
  }
  setup->options.poles_per_file = FLAGS_frf_poles == "per_file";
  return true;
}

// Leaves one record of *c, with the name of the functions alone.
void NameFrfs(const FoundModes& found, ModesCase* c) {
  c->records.assign(1, ResponseRecord());
  c->records[0].name = found.result.setups[0];
}

// Reads the input and finds its modes. For frequency response functions, *c
// gets their name alone. *written: those that were estimated, as a file.
bool ReadAndFind(ModesCase* c, FoundModes* found,
                 std::vector<ModesOfFrfs>* frfs, std::string* written,
                 std::string* error) {
  if (FLAGS_frf.empty()) {
    if (!ReadInput(c, error)) return false;
    if (!c->frf.has_value()) return FindModes(*c, found, error);
    EstimatedFrfs estimated;
    frfs->resize(1);
    if (!FindModesOfEstimatedFrfs(*c, &estimated, &frfs->front(), found,
                                  error)) {
      return false;
    }
    *written = EstimatedFrfsAsFile(estimated, *c);
    NameFrfs(*found, c);
    return true;
  }
  std::vector<const char*> of_records = ColumnFlags();
  of_records.push_back("columns");
  for (const char* name : of_records) {
    if (!gflags::GetCommandLineFlagInfoOrDie(name).is_default) {
      *error = "--" + std::string(name) + " is for --case" +
               (name == std::string("columns") ? "" : " with --columns") +
               ", not for --frf";
      return false;
    }
  }
  FrfSetup setup;
  frfs->resize(1);
  if (!ReadFrfFlags(&setup, error) ||
      !FindModesOfFrfFiles(setup, &frfs->front(), found, error)) {
    return false;
  }
  c->path = FLAGS_frf;
  c->title = "Modes of " + found->result.setups[0];
  NameFrfs(*found, c);
  return true;
}

}  // namespace

int RunProgram(int argc, char** argv) {
  const auto begin = Clock::now();
  int status;
  if (!ParseFlags(argc, argv,
                  "pinode_modes --case=FILE [--output_dir=FOLDER]\n\n"
                  "Identifies the modes of a structure from records of its "
                  "vibration, or from frequency response functions (--frf). It "
                  "needs no model.",
                  &status)) {
    return status;
  }
  if (NumLaunchedRanks() > 1) {
    return Refuse("pinode_modes runs in one process, expected no launcher");
  }

  // 1. The modes of each record, and of all.
  std::string error;
  ModesCase c;
  FoundModes found;
  std::vector<ModesOfFrfs> frfs;
  std::string written_frfs;
  if (!CheckFlags(&error) ||
      !ReadAndFind(&c, &found, &frfs, &written_frfs, &error)) {
    return Refuse(error);
  }
  const ModesResult& result = found.result;

  // 2. The folder, with a report, unless the modes are printed alone.
  if (FLAGS_output_dir.empty()) return PrintModes(result);
  const double seconds =
      std::chrono::duration<double>(Clock::now() - begin).count();
  ModesReportInput report;
  report.title = c.title;
  report.origin = {c.path, CommandLine(argc, argv), seconds};
  report.records = &c.records;
  report.by_record = &found.by_record;
  report.merged = &result.merged;
  if (!frfs.empty()) report.frfs = &frfs;
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
      (!frfs.empty() &&
       !WriteFrfFiles(frfs.front(), folder.working_path(), &error)) ||
      (!written_frfs.empty() &&
       !WriteFileAtomically(folder.working_path() + "/frfs.uff", written_frfs,
                            &error)) ||
      !WriteVtu(found.picture, folder.working_path(), &error) ||
      !WriteModesReport(report, report_options,
                        folder.working_path() + "/report.html", &error) ||
      !WriteForMatlab(folder, &error) || !folder.Commit(&error)) {
    return CannotWrite(error, folder);
  }

  // 3. Output on the console.
  status = PrintModes(result);
  Print("Results: %s\n", folder.final_path().c_str());
  return status;
}

}  // namespace pinode
