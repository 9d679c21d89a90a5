#include "apps/text_flags.h"

#include <gflags/gflags.h>

#include "pinode/base/units.h"

DEFINE_string(encoding, "",
              "encoding of a text file, such as WINDOWS-1251, GB18030 or "
              "SHIFT_JIS; empty: found");
DEFINE_int32(header_lines, -1,
             "number of lines above the first row of numbers in a text file; "
             "-1: found");
DEFINE_string(delimiter, "",
              "sign between the columns of a text file: a comma, a semicolon, "
              "a bar, tab or blank; empty: found");
DEFINE_string(decimal, "",
              "decimal sign of a text file, a point or a comma; empty: found");
DEFINE_string(time_format, "",
              "form of clock times in a text file, as strptime has it, such as "
              "\"%d/%m/%Y %H:%M:%S.%f\"; empty: found");
DEFINE_string(time_unit, "",
              "unit of the times, if the files do not state it: s, ms, us, ns, "
              "min, h or day");

namespace pinode {

std::vector<const char*> TextFlagNames() {
  return {"encoding", "header_lines", "delimiter",
          "decimal",  "time_format",  "time_unit"};
}

bool ReadTextFlags(TextFormat* format, std::string* error) {
  format->encoding = FLAGS_encoding;
  format->time_format = FLAGS_time_format;
  format->time_unit = FLAGS_time_unit;
  format->header_lines = FLAGS_header_lines;
  if (FLAGS_header_lines < -1) {
    *error = "--header_lines=" + std::to_string(FLAGS_header_lines) +
             ", expected a number of lines";
    return false;
  }
  if (FLAGS_decimal != "" && FLAGS_decimal != "." && FLAGS_decimal != ",") {
    *error = "--decimal=" + FLAGS_decimal + ", expected . or ,";
    return false;
  }
  if (!FLAGS_decimal.empty()) format->decimal = FLAGS_decimal[0];
  std::string delimiter = FLAGS_delimiter;
  if (delimiter == "tab") delimiter = "\t";
  if (delimiter == "blank") delimiter = " ";
  const bool is_known =
      delimiter.size() == 1 &&
      std::string(",;|\t ").find(delimiter[0]) != std::string::npos;
  if (!delimiter.empty() && !is_known) {
    *error =
        "--delimiter=" + FLAGS_delimiter + ", expected one of , ; | tab blank";
    return false;
  }
  if (!delimiter.empty()) format->delimiter = delimiter[0];
  if (!delimiter.empty() && delimiter == FLAGS_decimal) {
    *error = "--decimal=" + FLAGS_decimal + " and --delimiter=" + delimiter +
             " are the same sign, expected two";
    return false;
  }
  double factor = 0.0;
  std::string what;
  if (!FLAGS_time_unit.empty() && !UnitFactor(FLAGS_time_unit, Dimension::kTime,
                                              UnitSystem(), &factor, &what)) {
    *error = "--time_unit: " + what;
    return false;
  }
  return true;
}

}  // namespace pinode
