#include "pinode/record/files/text_sentences.h"

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/clock.h"
#include "pinode/record/files/text_thousands.h"

namespace pinode {
namespace {

// Returns the text of a delimiter for messages.
std::string DelimiterName(char delimiter) {
  switch (delimiter) {
    case '\t':
      return "tabs";
    case ' ':
      return "blanks";
    case ';':
      return "semicolons";
    case '|':
      return "bars";
    case ',':
      return "commas";
    default:
      return "one column";
  }
}

}  // namespace

std::string DescribeLayout(const TextLayout& layout) {
  std::string text = DelimiterName(layout.delimiter) + " between columns";
  if (layout.decimal == ',') text += ", decimal comma";
  text += layout.names_line > 0
              ? ", names in line " + std::to_string(layout.names_line)
              : ", no names";
  if (layout.units_line > 0) {
    text += ", units in line " + std::to_string(layout.units_line);
  }
  text += ", first row in line " + std::to_string(layout.first_row_line);
  if (!layout.doubtful_units.empty()) {
    text += ", no unit for '" + Join(layout.doubtful_units, "', '") +
            "': the name and the row of units differ";
  }
  return text;
}

std::string WhyWrapped(std::string_view line, size_t num_cells,
                       int64_t first_row) {
  const std::string lower = LowerCase(line);
  const bool is_peer = line[0] != '#' &&
                       lower.find("npts") != std::string::npos &&
                       lower.find("dt") != std::string::npos;
  const bool is_list = line.substr(0, 11) == "TIMESERIES " &&
                       line.find(", SLIST,") != std::string_view::npos;
  if (!is_peer && !is_list) return "";
  return Quote(line) + " says that the lines below are the samples of one " +
         "motion, " + std::to_string(num_cells) + " a line. " +
         (is_peer ? "A case reads them as the `file` of a motion in g, if the "
                    "name of the file ends in .at2"
                  : "Write one sample a line") +
         ". If they are rows of channels, set `header_lines = " +
         std::to_string(first_row - 1) + "`";
}

std::string WhyNoNumber(std::string_view cell, char decimal, bool is_time,
                        bool is_text) {
  double value = 0.0;
  ClockCell clock;
  if (decimal == '.' && ParseCell(cell, ',', &value)) {
    return Quote(cell) +
           " has a decimal comma, other rows have a decimal point; set "
           "`decimal`";
  }
  if (ParseClock(cell, &clock)) {
    return Quote(cell) +
           " is a clock time, expected a number; name this column as `time` "
           "to read clock times";
  }
  if (is_time && is_text) {
    return Quote(cell) +
           " is neither a number nor a known form of clock times; set "
           "`time_format`, such as \"%Hh%Mm%S.%f\" for 12h30m05.25, or give "
           "`sampling_rate_hz`";
  }
  if (IsLakhNumber(cell)) return WhyNoLakh(cell);
  return Quote(cell) + " is not a number" +
         (is_time
              ? "; delete the line if it is no row, set `time_format`, or give "
                "`sampling_rate_hz`"
              : ". Write nan for a missing value, and delete lines that are no "
                "rows. If pinode misread the file, set `decimal`, `delimiter` "
                "or `header_lines`");
}

std::string WhyRagged(size_t num_cells, const TextLayout& layout) {
  return std::to_string(num_cells) + (num_cells == 1 ? " cell" : " cells") +
         ", expected " + std::to_string(layout.num_cells) +
         " as in the first row (line " + std::to_string(layout.first_row_line) +
         "); delete the line if it is no row";
}

}  // namespace pinode
