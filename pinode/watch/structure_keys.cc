#include "pinode/watch/structure_keys.h"

#include "pinode/base/logging.h"

namespace pinode {
namespace {

CaseTable RecordsKeys() {
  return {
      "records",
      "[records]",
      "",
      {
          {"folder", "text", "a folder", "\".\"",
           "Folder of the records, relative to the structure file."},
          {"pattern", "text", "a shell pattern", "\"*.csv\"",
           "Names of the records in the folder."},
          {"columns", "texts", "", "all but the time and the covariates",
           "Columns of the sensors. Name them if a file has other "
           "columns."},
          {"quantities", "texts", "one for all or one for each",
           "`[\"acceleration\"]`",
           "`acceleration`, `velocity`, `displacement` or `strain`."},
          {"time", "text", "a column", "found by its name",
           "Column of the time."},
          {"time_format", "text", "as strptime has it", "found from the text",
           "Form of the clock times, such as `%d.%m.%y %H:%M:%S`, with "
           "`%f` for a fraction. Needed where day, month or year may come "
           "first."},
          {"sampling_rate_hz", "number", "Hz", "that of the times",
           "Rate of files without a column of the time."},
          {"time_in_name", "text", "as strptime has it",
           "clock times in the file",
           "Form of the names without their extension, such as "
           "`girder_%Y%m%d_%H%M`. The time is that of the first sample, in "
           "UTC."},
      }};
}

CaseTable CovariateKeys() {
  return {
      "covariate",
      "[[covariate]]",
      "",
      {
          {"name", "text", "", "needed",
           "Name of the covariate, other than the columns of `histories.csv` "
           "and of `records()` in Python."},
          {"column", "text", "a column", "its name", "Column of its values."},
          {"kink", "number", "unit of the column", "no kink",
           "Value at which the slope may change, such as 0 degrees Celsius."},
          {"file", "text", "", "the record's file",
           "Table with values by clock time, for all records."},
          {"time", "text", "a column", "needed with `file`",
           "Column of the clock times in `file`."},
          {"largest_gap_hours", "number", "h", "3",
           "Rows of `file` that are farther apart leave a gap, which is not "
           "filled."},
      }};
}

CaseTable NotifyKeys() {
  return {"notify",
          "[notify]",
          "",
          {
              {"kinds", "texts", "", "`[\"alarm\", \"all-clear\"]`",
               "Events that are told: `alarm`, `notice`, `all-clear`."},
              {"webhook", "text", "http(s)://", "none",
               "Address that gets each message as JSON: `structure`, `text` "
               "and `events`. Slack and Mattermost show `text`."},
              {"mail", "text", "smtp(s)://", "none",
               "Server that gets each message as a mail, such as "
               "`\"smtps://mail.example.org\"`."},
              {"mail_tls", "true or false", "", "true",
               "False: `smtp://` may go unencrypted, to a server of the same "
               "machine."},
              {"user", "text", "", "the server asks for none",
               "User of the mail server. The password comes from the "
               "environment: `PINODE_MAIL_PASSWORD`."},
              {"from", "text", "an address", "needed with `mail`",
               "Sender of the mail."},
              {"to", "texts", "addresses", "needed with `mail`",
               "Receivers of the mail."},
          }};
}

}  // namespace

const std::vector<CaseTable>& StructureTables() {
  static const auto& tables = *new std::vector<CaseTable>{
      {"",
       "the structure",
       "",
       {
           {"name", "text", "", "needed",
            "Name of the structure in the store."},
           {"records", "table", "", "see its keys", "Files of the records."},
           {"covariate", "tables", "", "none",
            "Quantities that the frequencies depend on."},
           {"modes", "table", "", "see [modes] of a case",
            "Search for the modes of a record, as `pinode_modes` has it. "
            "`references`, `keep_harmonics` and `frf` are not for "
            "`pinode_watch`."},
           {"reference", "table", "", "needed",
            "Period of the normal behaviour."},
           {"tracking", "table", "", "see its keys",
            "How modes are joined to histories."},
           {"alarm", "table", "", "see its keys", "Chart and its alarms."},
           {"notify", "table", "", "no messages", "Messages about alarms."},
       }},
      RecordsKeys(),
      CovariateKeys(),
      {"reference",
       "[reference]",
       "",
       {
           {"records", "whole number", "from 30", "this or `from` and `to`",
            "Number of records, from the first one or from `from` on."},
           {"from", "text", "a date", "the first record",
            "Begin, such as `\"2024-03-01\"` or `\"2024-03-01 12:00\"`, UTC."},
           {"to", "text", "a date", "this or `records`",
            "End. The record that begins then is not in the reference."},
       }},
      {"tracking",
       "[tracking]",
       "",
       {
           {"largest_step", "number", "a fraction", "0.1",
            "Largest change of a frequency between a mode and the recent mean "
            "of its history."},
           {"least_mac", "number", "0 to 1", "0.6",
            "Smallest MAC between a mode and its history."},
           {"least_presence", "number", "0 to 1", "0.5",
            "Share of the reference records in which a mode is found, if its "
            "frequency is to be watched."},
       }},
      {"alarm",
       "[alarm]",
       "",
       {
           {"false_alarms_per_year", "number", "0.1 to 50", "1",
            "Expected false alarms per year. They set the threshold. Times "
            "`clear_days` it is at most 90."},
           {"memory_days", "number", "days, to 100", "3",
            "Memory of the moving average. A longer one finds smaller changes, "
            "later."},
           {"clear_days", "number", "days, to 100", "7",
            "An alarm ends after this time below the threshold."},
       }},
      NotifyKeys()};
  return tables;
}

std::vector<std::string> StructureKeys(const std::string& path) {
  for (const CaseTable& table : StructureTables()) {
    if (path == table.path) return table.Names();
  }
  LOG(FATAL) << "no table '" << path << "' in a structure file";
}

std::string StructureKeyReference() {
  std::string text;
  for (const CaseTable& table : StructureTables()) {
    text += (text.empty() ? "" : "\n") + KeyReference(table);
  }
  return text;
}

}  // namespace pinode
