// TOML text as a plain tree that keeps the line of each value. The parser stays
// in the .cc file.

#ifndef PINODE_CASE_TEXT_TOML_VALUE_H_
#define PINODE_CASE_TEXT_TOML_VALUE_H_

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pinode {

// One value of a TOML document (v1.0.0): a scalar, an array or a table.
struct TomlValue {
  enum class Type {
    kString,
    kInteger,
    kFloat,
    kBoolean,
    kDate,  // dates and times; not used by pinode
    kArray,
    kTable
  };
  using Entry = std::pair<std::string, TomlValue>;

  static TomlValue String(std::string text);
  static TomlValue Integer(std::int64_t value);
  static TomlValue Float(double value);
  static TomlValue Boolean(bool value);
  static TomlValue Array(std::vector<TomlValue> elements);
  static TomlValue Numbers(const std::vector<double>& values);
  static TomlValue Strings(const std::vector<std::string>& values);
  static TomlValue Table();

  bool IsNumber() const {
    return type == Type::kInteger || type == Type::kFloat;
  }
  bool IsTable() const { return type == Type::kTable; }
  bool IsArrayOfTables() const;

  // Returns a text for messages: "the text 'abc'", "the number 3", "a table",
  // ...
  std::string Describe() const;

  // Tables only. Find returns nullptr if there is no such key. Set replaces the
  // value if the key exists and appends it if not.
  const TomlValue* Find(const std::string& key) const;
  TomlValue* Find(const std::string& key);
  void Set(const std::string& key, TomlValue value);
  void Erase(const std::string& key);

  Type type = Type::kTable;
  std::string text;                 // kString
  std::int64_t integer = 0;         // kInteger
  double number = 0.0;              // kInteger and kFloat
  bool boolean = false;             // kBoolean
  std::vector<TomlValue> elements;  // kArray
  std::vector<Entry> entries;       // kTable, in the order of the text

  // Line of the text on which the value begins, from 1; 0 if it was not read
  // from a text. For an entry of a table this is the line of its key.
  int line = 0;
};

// Reads the document in `text` (valid UTF-8). `path` serves messages only.
// On failure *root is untouched and *error reads `path:line: what, and what
// was expected`.
[[nodiscard]] bool ParseToml(const std::string& text, const std::string& path,
                             TomlValue* root, std::string* error);

// Returns the document as text, entries in their order. Numbers are written
// such that they are read back bit for bit. `root` is a table.
std::string FormatToml(const TomlValue& root);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_TOML_VALUE_H_
