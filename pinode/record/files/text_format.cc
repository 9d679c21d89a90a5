#include "pinode/record/files/text_format.h"

namespace pinode {

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

}  // namespace pinode
