#include "apps/text_flags.h"

#include <gflags/gflags.h>

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
DEFINE_string(
    scale, "",
    "factor on the numbers of all columns except the time, such as "
    "0.001, or of some, such as \"acc_1=0.5,acc_2=2\"; the product is "
    "in the unit of the column");

namespace pinode {

std::vector<const char*> TextFlagNames() {
  return {"encoding",    "header_lines", "delimiter", "decimal",
          "time_format", "time_unit",    "scale"};
}

bool ReadTextFlags(TextFormat* format, std::string* error) {
  std::string key;
  if (ParseTextFormat(
          {{"encoding", FLAGS_encoding},
           {"header_lines",
            FLAGS_header_lines == -1 ? "" : std::to_string(FLAGS_header_lines)},
           {"delimiter", FLAGS_delimiter},
           {"decimal", FLAGS_decimal},
           {"time_format", FLAGS_time_format},
           {"time_unit", FLAGS_time_unit}},
          format, &key, error)) {
    return true;
  }
  *error = "--" + key + ": " + *error;
  return false;
}

bool ReadScaleFlag(ColumnScales* scales, std::string* error) {
  if (scales->Parse(FLAGS_scale, error)) return true;
  *error = "--scale: " + *error;
  return false;
}

}  // namespace pinode
