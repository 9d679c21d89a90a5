// A logger's file before there is a case for it: its columns and their samples.

#ifndef PINODE_CASE_DRAFT_LOG_FILE_H_
#define PINODE_CASE_DRAFT_LOG_FILE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/record/column_scales.h"
#include "pinode/record/files/text_format.h"

namespace pinode {

// Question that a user has to answer before a case can be written.
struct DraftQuestion {
  std::string flag;     // that answers it, without dashes; empty: no question
  std::string text;     // "Which column is the base?"
  std::string example;  // of an answer

  // Returns the question as one line of an error, with the flag to give.
  std::string AsError() const;
};

// One column of numbers.
struct LogColumn {
  // Name by which a case calls it, without a unit behind it.
  std::string name;
  // Unit that the file states; empty: none.
  std::string unit;
  // Numbers of the file times `scale`; NaN: missing.
  Vector samples;
  double scale = 1.0;
  // Name in the file, perhaps with a unit behind it.
  std::string file_name = {};

  // Returns the dimension of `unit`. False if there is none.
  [[nodiscard]] bool FindUnitDimension(Dimension* dimension) const;
};

struct LogOptions {
  // Column of time, its unit, or the sampling rate; empty, 0: found.
  std::string time;
  std::string time_unit;
  double sampling_rate_hz = 0.0;
  // Form of text files; what is not set is found. Its time and unit are those
  // above.
  TextFormat format;
  // Factors of the columns except the time.
  ColumnScales scales;
  // Columns that are not read.
  std::vector<std::string> ignored;
};

struct LogFile {
  std::string path;
  // As a case has it: a column and, if the user gave it, its unit; or a rate.
  std::string time_column;
  std::string time_unit;
  double sampling_rate_hz = 0.0;
  // True if neither the file nor the user states the unit of numbers of time.
  bool is_time_unit_assumed = false;
  std::vector<LogColumn> columns;
  // Columns that are left out, because they are called as times are.
  std::vector<std::string> unused_times;
  double step = 0.0;  // s
  // Sentence of the reader on what was assumed; empty for plain files.
  std::string reading;

  Eigen::Index num_samples() const {
    return columns.empty() ? 0 : columns[0].samples.size();
  }
  double duration() const { return step * static_cast<double>(num_samples()); }
  // Returns the column of this name, nullptr if there is none.
  const LogColumn* Find(const std::string& name) const;
  std::vector<std::string> ColumnNames() const;
};

// Shortest record that is worth a case, in samples.
inline constexpr int kFewestLogSamples = 64;

// Reads a file with all its columns of numbers: text, or any other that
// ReadTable() reads, whose time is "t" or "time". If the time is not clear,
// returns false with a question.
[[nodiscard]] bool ReadLogFile(const std::string& path,
                               const LogOptions& options, LogFile* log,
                               DraftQuestion* question, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_LOG_FILE_H_
