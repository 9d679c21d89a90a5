#include "pinode/case/text/toml_value.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/case/text/toml_depth.h"

namespace pinode {
namespace {

int LineOf(const toml::source_region& source) {
  return static_cast<int>(source.begin.line);
}

TomlValue Convert(const toml::node& node) {
  TomlValue value;
  if (const toml::table* table = node.as_table()) {
    // toml++ sorts by key; the order of the text is that of the positions.
    std::vector<
        std::tuple<toml::source_index, toml::source_index, TomlValue::Entry>>
        found;
    for (const auto& [key, child] : *table) {
      const toml::source_position begin = key.source().begin;
      TomlValue converted = Convert(child);
      // [[name]] leaves the first header's line in the key, which is right.
      if (LineOf(key.source()) > 0) converted.line = LineOf(key.source());
      found.emplace_back(
          begin.line, begin.column,
          TomlValue::Entry(std::string(key.str()), std::move(converted)));
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) {
                       return std::tie(std::get<0>(a), std::get<1>(a)) <
                              std::tie(std::get<0>(b), std::get<1>(b));
                     });
    for (auto& entry : found) {
      value.entries.push_back(std::move(std::get<2>(entry)));
    }
    value.type = TomlValue::Type::kTable;
  } else if (const toml::array* array = node.as_array()) {
    value.type = TomlValue::Type::kArray;
    for (const toml::node& element : *array) {
      value.elements.push_back(Convert(element));
    }
  } else if (const auto* text = node.as_string()) {
    value = TomlValue::String(text->get());
  } else if (const auto* integer = node.as_integer()) {
    value = TomlValue::Integer(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    value = TomlValue::Float(number->get());
  } else if (const auto* boolean = node.as_boolean()) {
    value = TomlValue::Boolean(boolean->get());
  } else {
    value.type = TomlValue::Type::kDate;
  }
  value.line = LineOf(node.source());
  return value;
}

bool IsBareKey(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

std::string Quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    switch (c) {
      case '"':
        result += "\\\"";
        break;
      case '\\':
        result += "\\\\";
        break;
      case '\n':
        result += "\\n";
        break;
      case '\r':
        result += "\\r";
        break;
      case '\t':
        result += "\\t";
        break;
      default: {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7f) {
          constexpr char kHex[] = "0123456789ABCDEF";
          result += "\\u00";
          result += kHex[byte >> 4];
          result += kHex[byte & 15];
        } else {
          result += c;
        }
      }
    }
  }
  return result + "\"";
}

std::string FormatKey(const std::string& key) {
  return IsBareKey(key) ? key : Quoted(key);
}

std::string FormatFloat(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  std::string text = FormatNumber(value);
  // A TOML float has a point or an exponent.
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string FormatInline(const TomlValue& value) {
  switch (value.type) {
    case TomlValue::Type::kString:
      return Quoted(value.text);
    case TomlValue::Type::kInteger:
      return std::to_string(value.integer);
    case TomlValue::Type::kFloat:
      return FormatFloat(value.number);
    case TomlValue::Type::kBoolean:
      return value.boolean ? "true" : "false";
    case TomlValue::Type::kDate:
      LOG(FATAL) << "dates are not kept; remove them before writing";
      return "";
    case TomlValue::Type::kArray: {
      std::vector<std::string> parts;
      for (const TomlValue& element : value.elements) {
        parts.push_back(FormatInline(element));
      }
      return "[" + Join(parts, ", ") + "]";
    }
    case TomlValue::Type::kTable: {
      std::vector<std::string> parts;
      for (const auto& [key, child] : value.entries) {
        parts.push_back(FormatKey(key) + " = " + FormatInline(child));
      }
      return "{" + Join(parts, ", ") + "}";
    }
  }
  return "";
}

// Sub-tables get a header of their own at the first level, and arrays of
// tables at every level; other tables are written inline.
void FormatTable(const TomlValue& table, const std::string& prefix,
                 const std::string& indent, std::string* text) {
  const auto has_header = [&](const TomlValue& value) {
    return value.IsArrayOfTables() || (value.IsTable() && prefix.empty());
  };
  for (const auto& [key, value] : table.entries) {
    if (has_header(value)) continue;
    *text += indent + FormatKey(key) + " = " + FormatInline(value) + "\n";
  }
  for (const auto& [key, value] : table.entries) {
    if (!has_header(value)) continue;
    const std::string name =
        prefix.empty() ? FormatKey(key) : prefix + "." + FormatKey(key);
    const std::string inner = prefix.empty() ? "" : indent + "  ";
    if (value.IsTable()) {
      *text += "\n[" + name + "]\n";
      FormatTable(value, name, inner, text);
      continue;
    }
    for (const TomlValue& element : value.elements) {
      if (prefix.empty()) *text += "\n";
      *text += inner + "[[" + name + "]]\n";
      FormatTable(element, name, inner, text);
    }
  }
}

}  // namespace

TomlValue TomlValue::String(std::string text) {
  TomlValue value;
  value.type = Type::kString;
  value.text = std::move(text);
  return value;
}

TomlValue TomlValue::Integer(std::int64_t integer) {
  TomlValue value;
  value.type = Type::kInteger;
  value.integer = integer;
  value.number = static_cast<double>(integer);
  return value;
}

TomlValue TomlValue::Float(double number) {
  TomlValue value;
  value.type = Type::kFloat;
  value.number = number;
  return value;
}

TomlValue TomlValue::Boolean(bool boolean) {
  TomlValue value;
  value.type = Type::kBoolean;
  value.boolean = boolean;
  return value;
}

TomlValue TomlValue::Array(std::vector<TomlValue> elements) {
  TomlValue value;
  value.type = Type::kArray;
  value.elements = std::move(elements);
  return value;
}

TomlValue TomlValue::Numbers(const std::vector<double>& values) {
  TomlValue array = Array({});
  for (const double value : values) array.elements.push_back(Float(value));
  return array;
}

TomlValue TomlValue::Strings(const std::vector<std::string>& values) {
  TomlValue array = Array({});
  for (const std::string& value : values) {
    array.elements.push_back(String(value));
  }
  return array;
}

TomlValue TomlValue::Table() { return TomlValue(); }

bool TomlValue::IsArrayOfTables() const {
  return type == Type::kArray && !elements.empty() &&
         std::all_of(
             elements.begin(), elements.end(),
             [](const TomlValue& element) { return element.IsTable(); });
}

std::string TomlValue::Describe() const {
  switch (type) {
    case Type::kString:
      return "the text '" + text + "'";
    case Type::kInteger:
      return "the number " + std::to_string(integer);
    case Type::kFloat:
      return "the number " + FormatNumber(number);
    case Type::kBoolean:
      return boolean ? "true" : "false";
    case Type::kDate:
      return "a date";
    case Type::kArray:
      return "an array";
    case Type::kTable:
      return "a table";
  }
  return "";
}

const TomlValue* TomlValue::Find(const std::string& key) const {
  for (const Entry& entry : entries) {
    if (entry.first == key) return &entry.second;
  }
  return nullptr;
}

TomlValue* TomlValue::Find(const std::string& key) {
  return const_cast<TomlValue*>(std::as_const(*this).Find(key));
}

void TomlValue::Set(const std::string& key, TomlValue value) {
  CHECK(IsTable()) << "'" << key << "' set in what is not a table";
  if (TomlValue* existing = Find(key)) {
    *existing = std::move(value);
  } else {
    entries.emplace_back(key, std::move(value));
  }
}

void TomlValue::Erase(const std::string& key) {
  entries.erase(
      std::remove_if(entries.begin(), entries.end(),
                     [&](const Entry& entry) { return entry.first == key; }),
      entries.end());
}

bool ParseToml(const std::string& text, const std::string& path,
               TomlValue* root, std::string* error) {
  const int too_deep = LineOfTooDeepToml(text);
  if (too_deep > 0) {
    *error = path + ":" + std::to_string(too_deep) + ": more than " +
             std::to_string(kDeepestToml) +
             " levels of keys, arrays and tables within each other, expected a "
             "case file: use fewer";
    return false;
  }
  // The installed library has only the parser with exceptions.
  try {
    *root = Convert(toml::parse(std::string_view(text)));
    return true;
  } catch (const toml::parse_error& failure) {
    // Without the words that every message of the library begins with.
    const std::string begin = "Error while parsing ";
    std::string what(failure.description());
    if (what.rfind(begin, 0) == 0) what = what.substr(begin.size());
    *error = path + ":" + std::to_string(LineOf(failure.source())) +
             ": not valid TOML; " + what;
    return false;
  }
}

std::string FormatToml(const TomlValue& root) {
  CHECK(root.IsTable());
  std::string text;
  FormatTable(root, "", "", &text);
  return text;
}

}  // namespace pinode
