// Arbitrary bytes as a text file with columns: with nothing given, with one of
// its columns as the time, and with a layout that a case gives. The text's
// length chooses column and layout.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/record/files/text_table.h"

namespace {

void ParseText(const std::string& text, const pinode::TextFormat& format) {
  pinode::Table table;
  std::string error;
  const bool is_read =
      pinode::ParseTextTable(text, "fuzzed", {}, format, &table, &error);
  if (is_read != error.empty()) __builtin_trap();
  if (!is_read) return;
  pinode::TextOutline outline;
  if (pinode::ParseTextOutline(text, "fuzzed", format, &outline, &error) &&
      outline.is_channel.size() != outline.columns.size()) {
    __builtin_trap();
  }
  if (table.values.cols() != static_cast<int>(table.columns.size()) ||
      table.num_rows() == 0) {
    __builtin_trap();
  }
  for (Eigen::Index i = 0; i < table.values.size(); ++i) {
    if (std::isinf(table.values.data()[i])) __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  pinode::TextFormat format;
  ParseText(text, format);
  pinode::TextLayout layout;
  std::string error;
  if (pinode::FindTextLayout(text, "fuzzed", format, &layout, &error)) {
    if (layout.columns.empty()) __builtin_trap();
    format.time_column = layout.columns[size % layout.columns.size()].name;
    ParseText(text, format);
  }
  format.header_lines = size % 2 == 0 ? -1 : static_cast<int>(size / 2 % 6);
  format.delimiter = std::string(1, '\0').append("\t;,| ")[size / 3 % 6];
  format.decimal = std::string(1, '\0').append(".,")[size / 5 % 3];
  if (size % 7 == 0) format.encoding = "ISO-8859-1";
  if (size % 3 == 1) format.time_format = "%d.%m.%Y %H:%M:%S.%f";
  ParseText(text, format);
  return 0;
}
