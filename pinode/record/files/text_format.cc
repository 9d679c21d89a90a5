#include "pinode/record/files/text_format.h"

#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/base/units.h"

namespace pinode {
namespace {

bool ParseHeaderLines(const std::string& value, TextFormat* format,
                      std::string* error) {
  int lines = 0;
  if (ParseInt(value, &lines) && lines >= 0) {
    format->header_lines = lines;
    return true;
  }
  *error = Quote(value) + ", expected a number of lines";
  return false;
}

bool ParseDelimiter(const std::string& value, TextFormat* format,
                    std::string* error) {
  const std::string sign = value == "tab"     ? "\t"
                           : value == "blank" ? " "
                                              : value;
  if (sign.size() == 1 &&
      std::string(",;|\t ").find(sign) != std::string::npos) {
    format->delimiter = sign[0];
    return true;
  }
  *error = Quote(value) + ", expected one of , ; | tab blank";
  return false;
}

bool ParseDecimal(const std::string& value, TextFormat* format,
                  std::string* error) {
  if (value == "." || value == ",") {
    format->decimal = value[0];
    return true;
  }
  *error = Quote(value) + ", expected . or ,";
  return false;
}

bool ParseTimeUnit(const std::string& value, TextFormat* format,
                   std::string* error) {
  double factor = 0.0;
  format->time_unit = value;
  return UnitFactor(value, Dimension::kTime, UnitSystem(), &factor, error);
}

bool ParseTextKey(const std::string& key, const std::string& value,
                  TextFormat* format, std::string* error) {
  if (key == "header_lines") return ParseHeaderLines(value, format, error);
  if (key == "delimiter") return ParseDelimiter(value, format, error);
  if (key == "decimal") return ParseDecimal(value, format, error);
  if (key == "time_unit") return ParseTimeUnit(value, format, error);
  if (key == "time_format") {
    format->time_format = value;
  } else {
    CHECK(key == "encoding");
    format->encoding = value;
  }
  return true;
}

}  // namespace

std::string TextFormat::AsText() const {
  std::string text;
  for (const std::string& part : {encoding, std::to_string(header_lines),
                                  std::to_string(static_cast<int>(delimiter)),
                                  std::to_string(static_cast<int>(decimal)),
                                  time_format, time_column, time_unit}) {
    text += std::to_string(part.size()) + ":" + part;
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> TextFormat::Keys() const {
  std::vector<std::pair<std::string, std::string>> keys;
  const auto add = [&keys](const char* key, const std::string& value) {
    if (!value.empty()) keys.emplace_back(key, value);
  };
  add("encoding", encoding);
  add("header_lines", header_lines < 0 ? "" : std::to_string(header_lines));
  add("delimiter", delimiter == 0      ? ""
                   : delimiter == '\t' ? "tab"
                   : delimiter == ' '  ? "blank"
                                       : std::string(1, delimiter));
  add("decimal", decimal == 0 ? "" : std::string(1, decimal));
  add("time_format", time_format);
  return keys;
}

bool ParseTextFormat(
    const std::vector<std::pair<std::string, std::string>>& keys,
    TextFormat* format, std::string* key, std::string* error) {
  for (const auto& [name, value] : keys) {
    if (value.empty() || ParseTextKey(name, value, format, error)) continue;
    *key = name;
    return false;
  }
  if (format->delimiter == 0 || format->delimiter != format->decimal) {
    return true;
  }
  *key = "delimiter";
  *error = "it is the sign of `decimal` too, expected another one";
  return false;
}

}  // namespace pinode
