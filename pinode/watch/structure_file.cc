#include "pinode/watch/structure_file.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/modes_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/record/files/clock.h"
#include "pinode/watch/structure_keys.h"

namespace pinode {
namespace {

// Fewest records of a reference, from which a regression and its scatter can be
// estimated at all.
constexpr int kFewestReference = 30;
// False alarms per year times the days after which an alarm ends.
constexpr double kMostAlarmDays = 90.0;

bool ResolveDate(const ClockCell& cell, double* seconds) {
  ClockColumn column;
  int64_t bad_row = -1;
  std::string error;
  if (!cell.has_date || !ResolveClock({cell}, &column, &bad_row, &error) ||
      !column.is_dated || !column.is_order_certain) {
    return false;
  }
  *seconds = column.origin;
  return true;
}

class StructureFileReader {
 public:
  StructureFileReader(const TomlValue& source, const std::string& path,
                      std::string* error)
      : error_(error),
        errors_(path, error),
        // Paths of the tables are not those of a case, whose keys differ.
        root_(source, "", &errors_, "structure") {
    structure_.path = path;
    const size_t slash = path.find_last_of('/');
    base_ = slash == std::string::npos ? "" : path.substr(0, slash + 1);
  }

  bool Read(WatchedStructure* structure) {
    root_.AllowKeys(StructureKeys(""));
    structure_.name = root_.RequiredString("name");
    if (errors_.ok() && structure_.name.empty()) {
      root_.Fail("name", "the name is empty, expected a text");
    }
    ReadRecords();
    ReadCovariates();
    ReadReference();
    ReadTracking();
    ReadAlarm();
    ReadNotify();
    if (!errors_.ok() || !ReadModes()) return false;
    *structure = std::move(structure_);
    return true;
  }

 private:
  TomlTable Open(const std::string& key) {
    TomlTable table = root_.Table(key, "[" + key + "]");
    table.AllowKeys(StructureKeys(key));
    return table;
  }

  std::string Resolve(const std::string& path) const {
    return path.empty() || path.front() == '/' ? path : base_ + path;
  }

  void ReadRecords() {
    const TomlTable table = Open("records");
    WatchedRecords& records = structure_.records;
    records.folder = Resolve(table.String("folder", "."));
    records.pattern = table.String("pattern", records.pattern);
    if (table.Has("columns")) records.columns = table.Strings("columns");
    records.quantities = table.Strings("quantities");
    records.time_column = table.String("time");
    records.time_format = table.String("time_format");
    records.sampling_rate_hz = table.PositiveNumber("sampling_rate_hz", 0.0);
    records.time_in_name = table.String("time_in_name");
    if (!errors_.ok()) return;
    CheckQuantities(table);
    if (records.columns.empty()) {
      table.Fail("columns", "columns is empty, expected names of columns");
    }
    if (records.pattern.empty() ||
        records.pattern.find('/') != std::string::npos) {
      table.Fail("pattern", "pattern = \"" + records.pattern +
                                "\", expected names of files such as "
                                "\"*.csv\"; set the folder by `folder`");
    }
    if (records.sampling_rate_hz > 0.0 && !records.time_column.empty()) {
      table.Fail("sampling_rate_hz",
                 "time and sampling_rate_hz are both given, expected one of "
                 "them");
    }
    if (records.sampling_rate_hz > 0.0 && !records.time_format.empty()) {
      table.Fail("sampling_rate_hz",
                 "time_format and sampling_rate_hz are both given, expected "
                 "one of them");
    }
    // A file without a column of the time has no clock times either.
    if (records.sampling_rate_hz > 0.0 && records.time_in_name.empty()) {
      table.Fail("sampling_rate_hz",
                 "time_in_name is missing; with sampling_rate_hz the names of "
                 "the files must say when the records begin");
    }
  }

  // A store must not be filled with refusals of every record.
  void CheckQuantities(const TomlTable& table) {
    const WatchedRecords& records = structure_.records;
    for (const std::string& quantity : records.quantities) {
      if (quantity == "acceleration" || quantity == "velocity" ||
          quantity == "displacement" || quantity == "strain") {
        continue;
      }
      table.Fail("quantities", "the quantity '" + quantity +
                                   "' is not known, expected acceleration, "
                                   "velocity, displacement or strain");
    }
    const size_t count = records.quantities.size();
    if (count > 1 && table.Has("columns") && count != records.columns.size()) {
      table.Fail("quantities",
                 "quantities has " + std::to_string(count) +
                     " entries, expected one for all or one for each of the " +
                     std::to_string(records.columns.size()) + " columns");
    }
  }

  // A covariate is a column of histories.csv and of the records in Python.
  static void CheckName(const TomlTable& table, const std::string& name) {
    bool is_taken = StartsWithModeNumber(name);
    for (const char* column : {"time", "record", "light", "t2", "average"}) {
      is_taken = is_taken || name == column;
    }
    bool is_taken_in_python = false;
    for (const char* column : {"duration_s", "refusal", "rejected"}) {
      is_taken_in_python = is_taken_in_python || name == column;
    }
    if (!is_taken && !is_taken_in_python) return;
    table.Fail("name",
               "the name '" + name + "' is that of a column of " +
                   (is_taken ? "histories.csv" : "Store.records() in Python") +
                   ", expected another name");
  }

  // True for "mode_3_" and what follows.
  static bool StartsWithModeNumber(const std::string& name) {
    const std::string begin = "mode_";
    if (name.compare(0, begin.size(), begin) != 0) return false;
    const size_t end = name.find_first_not_of("0123456789", begin.size());
    return end != std::string::npos && end > begin.size() && name[end] == '_';
  }

  void ReadCovariates() {
    for (const TomlTable& table : root_.Tables("covariate")) {
      table.AllowKeys(StructureKeys("covariate"));
      WatchedCovariate covariate;
      covariate.name = table.RequiredString("name");
      covariate.column = table.String("column", covariate.name);
      if (table.Has("kink")) covariate.kink = table.Number("kink", 0.0);
      covariate.file = Resolve(table.String("file"));
      covariate.time_column = table.String("time");
      covariate.largest_gap_hours =
          table.PositiveNumber("largest_gap_hours", 3.0);
      if (!errors_.ok()) return;
      if (covariate.file.empty() == !covariate.time_column.empty()) {
        table.Fail("file", covariate.file.empty()
                               ? "time needs `file`"
                               : "time is missing, expected the column of the "
                                 "clock times in `file`");
      }
      CheckName(table, covariate.name);
      for (const WatchedCovariate& other : structure_.covariates) {
        if (other.name != covariate.name) continue;
        table.Fail("name", "the name '" + covariate.name +
                               "' occurs twice, expected different names");
      }
      structure_.covariates.push_back(std::move(covariate));
    }
  }

  void ReadReference() {
    const TomlTable table = Open("reference");
    ReferencePeriod& reference = structure_.reference;
    reference.num_records =
        table.Integer("records", 0, kFewestReference, 100000000);
    const auto read_date = [&](const char* key, double* seconds) {
      if (!table.Has(key)) return;
      const std::string text = table.String(key);
      if (!errors_.ok() || ParseDate(text, seconds)) return;
      table.Fail(key, std::string(key) + " = \"" + text +
                          "\", expected a date such as \"2024-03-01\" or "
                          "\"2024-03-01 12:00\"");
    };
    read_date("from", &reference.from);
    read_date("to", &reference.to);
    if (!errors_.ok()) return;
    if (table.Has("records") == table.Has("to")) {
      table.Fail(table.Has("to") ? "to" : "records",
                 std::string(table.Has("to") ? "records and to are both given"
                                             : "the reference has no end") +
                     ", expected either records = 500 or to = \"2025-03-01\"");
    } else if (!(reference.from < reference.to)) {
      table.Fail("to", "to is not after from");
    }
  }

  void ReadTracking() {
    const TomlTable table = Open("tracking");
    TrackingOptions& options = structure_.tracking;
    options.largest_step =
        Fraction(table, "largest_step", options.largest_step);
    options.least_mac = Fraction(table, "least_mac", options.least_mac);
    options.least_presence =
        Fraction(table, "least_presence", options.least_presence);
  }

  void ReadAlarm() {
    const TomlTable table = Open("alarm");
    ChartOptions& options = structure_.chart;
    options.false_alarms_per_year = table.PositiveNumber(
        "false_alarms_per_year", options.false_alarms_per_year);
    options.memory_days =
        table.PositiveNumber("memory_days", options.memory_days);
    options.clear_days = table.PositiveNumber("clear_days", options.clear_days);
    if (!errors_.ok()) return;
    if (options.false_alarms_per_year < 0.1 ||
        options.false_alarms_per_year > 50.0) {
      table.Fail("false_alarms_per_year",
                 "false_alarms_per_year = " +
                     FormatNumber(options.false_alarms_per_year) +
                     ", expected 0.1 to 50");
    }
    // With more, alarms merge: only 134 a year times a day have a gap of a day
    // between them (Poisson), and fewer of those that last.
    const double product = options.false_alarms_per_year * options.clear_days;
    if (errors_.ok() && product > kMostAlarmDays) {
      table.Fail(
          "false_alarms_per_year",
          "false_alarms_per_year times clear_days = " + FormatNumber(product) +
              ", expected at most " + FormatNumber(kMostAlarmDays) +
              ", or one alarm lasts into the next; lower one of them");
    }
    if (options.memory_days > 100.0 || options.clear_days > 100.0) {
      table.Fail("memory_days",
                 "memory_days and clear_days are at most 100 days");
    }
  }

  void ReadNotify() {
    const TomlTable table = Open("notify");
    NotifyOptions& options = structure_.notify;
    if (table.Has("kinds")) options.kinds = table.Strings("kinds");
    options.webhook = table.String("webhook");
    options.mail = table.String("mail");
    options.mail_tls = table.Boolean("mail_tls", options.mail_tls);
    options.user = table.String("user");
    options.from = table.String("from");
    options.to = table.Strings("to");
    if (!errors_.ok()) return;
    for (const std::string& kind : options.kinds) {
      if (kind == "alarm" || kind == "notice" || kind == "all-clear") continue;
      table.Fail("kinds", "the kind " + Quote(kind) +
                              " is not known, expected alarm, notice or "
                              "all-clear");
    }
    CheckAddress(table, "webhook", options.webhook, "http");
    CheckAddress(table, "mail", options.mail, "smtp");
    if (!errors_.ok() || !root_.Has("notify")) return;
    // Whoever writes this table expects to be told.
    if (options.kinds.empty()) {
      table.Fail("kinds",
                 "kinds is empty, expected alarm, notice or all-clear");
    } else if (options.mail.empty() && options.webhook.empty()) {
      table.Fail("webhook",
                 "[notify] has neither `webhook` nor `mail`, expected one of "
                 "them");
    } else {
      CheckMail(table);
    }
  }

  void CheckMail(const TomlTable& table) {
    const NotifyOptions& options = structure_.notify;
    if (options.mail.empty()) {
      for (const char* key : {"from", "to", "user", "mail_tls"}) {
        if (!table.Has(key)) continue;
        table.Fail(key, std::string(key) + " needs `mail`, the server");
        return;
      }
      return;
    }
    if (options.from.empty()) {
      table.Fail("mail", "from is missing, expected the sender");
    } else if (options.to.empty()) {
      table.Fail(table.Has("to") ? "to" : "mail",
                 "to is missing or empty, expected receivers");
    } else if (!options.user.empty() && !options.mail_tls &&
               options.mail.rfind("smtp://", 0) == 0) {
      table.Fail("user",
                 "user needs an encrypted server, expected smtps:// or "
                 "mail_tls = true; the password would be readable");
    }
    CheckPerson(table, "from", options.from);
    for (const std::string& person : options.to) {
      CheckPerson(table, "to", person);
    }
  }

  void CheckPerson(const TomlTable& table, const char* key,
                   const std::string& person) {
    if (!errors_.ok() || IsMailAddress(person)) return;
    table.Fail(key, Quote(person) +
                        " is not a mail address, expected one such as "
                        "\"engineer@example.org\"");
  }

  // An address would begin another line of a mail's head, or of the talk with
  // the server, if it held one.
  static bool IsMailAddress(const std::string& text) {
    const size_t at = text.find('@');
    return at != std::string::npos && at > 0 && at + 1 < text.size() &&
           std::all_of(text.begin(), text.end(), [](char c) {
             return c > ' ' && c < 0x7f && c != '<' && c != '>' && c != ',';
           });
  }

  void CheckAddress(const TomlTable& table, const char* key,
                    const std::string& address, const std::string& protocol) {
    if (address.empty()) return;
    const bool known = address.rfind(protocol + "://", 0) == 0 ||
                       address.rfind(protocol + "s://", 0) == 0;
    const bool is_line =
        std::all_of(address.begin(), address.end(),
                    [](char c) { return c > ' ' && c < 0x7f; });
    if (known && is_line) return;
    table.Fail(key, std::string(key) + " is no address that begins with " +
                        protocol + ":// or " + protocol + "s://");
  }

  double Fraction(const TomlTable& table, const std::string& key,
                  double absent) {
    const double value = table.PositiveNumber(key, absent);
    if (errors_.ok() && value >= 1.0) {
      table.Fail(key, key + " = " + FormatNumber(value) +
                          ", expected a number between 0 and 1");
    }
    return value;
  }

  // Reads [modes] by the reader of cases, so that it means the same here.
  bool ReadModes() {
    const TomlValue* modes = root_.Find("modes");
    structure_.modes.num_threads = DefaultThreads();
    if (modes == nullptr) return true;
    for (const char* key : {"references", "keep_harmonics", "frf"}) {
      const TomlValue* value = modes->Find(key);
      if (value == nullptr) continue;
      return errors_.Fail(value->line,
                          std::string("[modes] ") + key +
                              " is not for pinode_watch; leave it out");
    }
    TomlValue alone = TomlValue::Table();
    alone.Set("modes", *modes);
    alone.Find("modes")->line = modes->line;
    ModesCase c;
    std::string message;
    if (!ReadModesOptions(alone, structure_.path, &c, &message)) {
      *error_ = message;
      return false;
    }
    structure_.modes = c.options;
    // Results do not depend on the number of threads.
    alone.Find("modes")->Erase("threads");
    structure_.modes_text = FormatToml(alone);
    return true;
  }

  std::string* error_;
  CaseErrors errors_;
  const TomlTable root_;
  std::string base_;
  WatchedStructure structure_;
};

}  // namespace

bool ParseDate(const std::string& text, double* seconds) {
  ClockCell cell;
  if (ParseClock(text, &cell)) return ResolveDate(cell, seconds);
  // Two numbers of a time could be minutes and seconds in a file of a logger.
  // Here they are hours and minutes.
  for (const char* format : {"%Y-%m-%d", "%Y-%m-%d %H:%M"}) {
    if (ParseDateBy(format, text, seconds)) return true;
  }
  return false;
}

bool ParseDateBy(const std::string& format, const std::string& text,
                 double* seconds) {
  ClockCell cell;
  return ParseClockBy(format, text, &cell) && ResolveDate(cell, seconds);
}

bool ParseStructureFile(const std::string& text, const std::string& path,
                        WatchedStructure* structure, std::string* error) {
  TomlValue source;
  return ParseToml(text, path, &source, error) &&
         StructureFileReader(source, path, error).Read(structure);
}

bool ReadStructureFile(const std::string& path, WatchedStructure* structure,
                       std::string* error) {
  std::string text;
  return ReadTextFile(path, &text, error) &&
         ParseStructureFile(text, path, structure, error);
}

std::string ReadingSettings(const WatchedStructure& structure) {
  const WatchedRecords& records = structure.records;
  std::string text = "columns " + Join(records.columns, ",") + "; quantities " +
                     Join(records.quantities, ",") + "; time " +
                     records.time_column + "; rate " +
                     FormatNumber(records.sampling_rate_hz) +
                     "; time_in_name " + records.time_in_name;
  // Stores without the key keep their settings.
  if (!records.time_format.empty()) {
    text += "; time_format " + records.time_format;
  }
  for (const WatchedCovariate& covariate : structure.covariates) {
    if (covariate.file.empty()) {
      text += "; covariate " + covariate.name + " " + covariate.column;
    }
  }
  return text + "\n" + structure.modes_text;
}

}  // namespace pinode
