#include "pinode/case/text/toml_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/case/text/case_keys.h"

namespace pinode {
namespace {

const TomlValue& EmptyTable() {
  static const auto& empty = *new TomlValue();
  return empty;
}

// Mistakes that are kept for one message.
constexpr size_t kMostMistakes = 100;

std::mutex& MistakesMutex() {
  static auto& mutex = *new std::mutex();
  return mutex;
}

std::vector<std::string>& Mistakes() {
  static auto& mistakes = *new std::vector<std::string>();
  return mistakes;
}

bool IsIn(const std::vector<std::string>& texts, const std::string& text) {
  return std::find(texts.begin(), texts.end(), text) != texts.end();
}

std::string InQuotes(const std::string& text) { return '"' + text + '"'; }

bool IsQuoted(const std::string& text) { return text.front() == '"'; }

}  // namespace

const CaseData& CaseErrors::data() const {
  static const auto& none = *new CaseData();
  return data_ == nullptr ? none : *data_;
}

bool CaseErrors::Fail(int line, const std::string& message) {
  if (path_.empty()) return FailAsIs(message);
  return FailAsIs(path_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                  message);
}

bool CaseErrors::FailAsIs(const std::string& message) {
  if (ok_) {
    *error_ = message;
    ok_ = false;
  }
  return false;
}

TomlTable::TomlTable(CaseErrors* errors, std::string path)
    : TomlTable(EmptyTable(), "", errors, std::move(path)) {}

TomlTable::TomlTable(const TomlValue& table, std::string name,
                     CaseErrors* errors, std::string path)
    : table_(&table),
      name_(std::move(name)),
      path_(std::move(path)),
      known_(FindCaseTable(path_)),
      errors_(errors) {}

bool TomlTable::AllowKeys() const {
  if (known_ != nullptr) return AllowKeys(known_->Names());
  Mistake("", "a table with listed keys");
  return true;
}

bool TomlTable::Takes(const std::string& key) const {
  return known_ != nullptr && known_->Find(key) != nullptr;
}

bool TomlTable::AllowKeys(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : table_->entries) {
    if (IsIn(known, key)) continue;
    return errors_->Fail(value.line, (name_.empty() ? "" : name_ + ": ") +
                                         "unknown key '" + key + "'" +
                                         NameHint(key, known));
  }
  return true;
}

void TomlTable::Mistake(const std::string& key,
                        const std::string& message) const {
  const std::lock_guard<std::mutex> lock(MistakesMutex());
  if (Mistakes().size() >= kMostMistakes) return;
  Mistakes().push_back("'" + path_ + "': '" + key + "' is read as " + message);
}

std::vector<std::string> TakeKeyMistakes() {
  const std::lock_guard<std::mutex> lock(MistakesMutex());
  return std::exchange(Mistakes(), {});
}

const CaseKey* TomlTable::Listed(const std::string& key) const {
  const CaseKey* listed = known_ == nullptr ? nullptr : known_->Find(key);
  if (known_ != nullptr && listed == nullptr) Mistake(key, "a key");
  return listed;
}

const TomlValue* TomlTable::Find(const std::string& key) const {
  Listed(key);
  return table_->Find(key);
}

const TomlValue* TomlTable::FindAs(const std::vector<std::string>& types,
                                   const std::string& key,
                                   const std::string& absent) const {
  const TomlValue* value = table_->Find(key);
  const CaseKey* listed = Listed(key);
  if (listed == nullptr) return value;
  const std::vector<std::string> possible = TypesOf(*listed);
  for (const std::string& type : types) {
    if (!IsIn(possible, type)) Mistake(key, type);
  }
  if (value == nullptr && !absent.empty() && HasLiteralDefault(*listed) &&
      absent != listed->absent) {
    Mistake(key, absent + " where it is absent");
  }
  return value;
}

std::string TomlTable::PathOf(const std::string& key) const {
  const std::string path = (path_.empty() ? "" : path_ + ".") + key;
  const CaseKey* listed = Listed(key);
  if (listed == nullptr || FindCaseTable(path) != nullptr) return path;
  const std::vector<std::string> types = TypesOf(*listed);
  for (const std::string& type : types) {
    if (FindCaseTable(type) != nullptr) return type;
  }
  if (!IsIn(types, "table")) Mistake(key, "a table");
  return path;
}

int TomlTable::Line(const std::string& key) const {
  const TomlValue* value = table_->Find(key);
  return value != nullptr && value->line > 0 ? value->line : table_->line;
}

bool TomlTable::Fail(const std::string& key, const std::string& message) const {
  // Messages of lower layers may begin with the name already.
  const bool named = message.compare(0, name_.size(), name_) == 0;
  return errors_->Fail(Line(key), (named ? "" : name_ + ": ") + message);
}

bool TomlTable::RequireKey(const std::string& key,
                           const std::string& expected) const {
  if (Has(key)) return true;
  return Fail(key, "'" + key + "' is missing, expected " + expected);
}

bool TomlTable::WrongType(const std::string& key, const TomlValue& value,
                          const std::string& expected) const {
  return errors_->Fail(value.line > 0 ? value.line : Line(key),
                       (name_.empty() ? "" : name_ + ": ") + "'" + key +
                           "' is " + value.Describe() + ", expected " +
                           expected);
}

std::string TomlTable::String(const std::string& key,
                              const std::string& absent) const {
  const CaseKey* listed = Listed(key);
  // A choice is a text too.
  const bool is_choice = listed != nullptr && IsQuoted(listed->type);
  const TomlValue* value = FindAs(
      is_choice ? std::vector<std::string>{} : std::vector<std::string>{"text"},
      key, absent.empty() ? "" : InQuotes(absent));
  if (value == nullptr) return absent;
  if (value->type != TomlValue::Type::kString) {
    WrongType(key, *value, "a text in quotes");
    return absent;
  }
  return value->text;
}

std::string TomlTable::RequiredString(const std::string& key) const {
  if (!RequireKey(key, "a text")) return "";
  std::string text = String(key);
  if (errors_->ok() && text.empty()) {
    Fail(key, "'" + key + "' is empty, expected a text");
  }
  return text;
}

std::string TomlTable::Choice(const std::string& key,
                              const std::vector<std::string>& choices,
                              const std::string& absent) const {
  const CaseKey* listed = Listed(key);
  if (listed != nullptr && !IsIn(TypesOf(*listed), "text")) {
    std::vector<std::string> types;
    for (const std::string& choice : choices) types.push_back(InQuotes(choice));
    FindAs(types, key);
    for (const std::string& type : TypesOf(*listed)) {
      if (IsQuoted(type) && !IsIn(types, type)) Mistake(key, "never " + type);
    }
  }
  std::string text = String(key, absent);
  if (!Has(key) || IsIn(choices, text)) return text;
  Fail(key, "'" + key + "' is '" + text + "', expected one of " +
                Join(choices, ", "));
  return absent;
}

bool TomlTable::NumberOf(const std::string& key, const TomlValue& value,
                         double* number) const {
  if (!value.IsNumber() || !std::isfinite(value.number)) {
    return WrongType(key, value, "a finite number");
  }
  if (std::abs(value.number) > kLargestNumber) {
    return WrongType(
        key, value,
        "a number of at most " + FormatNumber(kLargestNumber) + " in size");
  }
  *number = value.number;
  return true;
}

double TomlTable::Number(const std::string& key, double absent) const {
  const TomlValue* value = FindAs({"number"}, key, FormatNumber(absent));
  double number = absent;
  return value != nullptr && NumberOf(key, *value, &number) ? number : absent;
}

double TomlTable::PositiveNumber(const std::string& key, double absent) const {
  const double number = Number(key, absent);
  if (!Has(key) || number >= kSmallestNumber) return number;
  WrongType(key, *Find(key),
            number > 0.0
                ? "a number of at least " + FormatNumber(kSmallestNumber)
                : "a positive number");
  return absent;
}

double TomlTable::NonNegativeNumber(const std::string& key,
                                    double absent) const {
  const double number = Number(key, absent);
  if (!Has(key) || number >= 0.0) return number;
  WrongType(key, *Find(key), "zero or a positive number");
  return absent;
}

double TomlTable::ExtendedNumber(const std::string& key, double absent) const {
  const TomlValue* value = FindAs({"number"}, key, FormatNumber(absent));
  if (value == nullptr) return absent;
  if (!value->IsNumber() || std::isnan(value->number)) {
    WrongType(key, *value, "a number");
    return absent;
  }
  return value->number;
}

int TomlTable::Integer(const std::string& key, int absent, int minimum,
                       int maximum) const {
  return static_cast<int>(IntegerUpTo(maximum, key, absent, minimum));
}

int64_t TomlTable::LongInteger(const std::string& key, int64_t absent,
                               int64_t minimum) const {
  constexpr int64_t kMost = 1000000000000;
  return IntegerUpTo(kMost, key, absent, minimum);
}

int64_t TomlTable::IntegerUpTo(int64_t maximum, const std::string& key,
                               int64_t absent, int64_t minimum) const {
  const TomlValue* value =
      FindAs({"whole number"}, key, std::to_string(absent));
  if (value == nullptr) return absent;
  if (value->type != TomlValue::Type::kInteger || value->integer < minimum) {
    WrongType(key, *value,
              "a whole number of at least " + std::to_string(minimum));
    return absent;
  }
  if (value->integer > maximum) {
    WrongType(key, *value,
              "a whole number of at most " + std::to_string(maximum));
    return absent;
  }
  return value->integer;
}

bool TomlTable::Boolean(const std::string& key, bool absent) const {
  const TomlValue* value =
      FindAs({"true", "false"}, key, absent ? "true" : "false");
  if (value == nullptr) return absent;
  if (value->type != TomlValue::Type::kBoolean) {
    WrongType(key, *value, "true or false");
    return absent;
  }
  return value->boolean;
}

std::vector<std::string> TomlTable::Strings(const std::string& key) const {
  std::vector<std::string> texts;
  const TomlValue* value = FindAs({"texts"}, key);
  if (value == nullptr) return texts;
  if (value->type != TomlValue::Type::kArray) {
    WrongType(key, *value, "an array of texts");
    return texts;
  }
  for (const TomlValue& element : value->elements) {
    if (element.type != TomlValue::Type::kString) {
      WrongType(key + "[" + std::to_string(texts.size()) + "]", element,
                "a text in quotes");
      return {};
    }
    texts.push_back(element.text);
  }
  return texts;
}

std::vector<double> TomlTable::Numbers(const std::string& key) const {
  std::vector<double> numbers;
  const TomlValue* value = FindAs({"numbers"}, key);
  if (value == nullptr) return numbers;
  if (value->type != TomlValue::Type::kArray) {
    WrongType(key, *value, "an array of numbers");
    return numbers;
  }
  for (const TomlValue& element : value->elements) {
    double number = 0.0;
    if (!NumberOf(key + "[" + std::to_string(numbers.size()) + "]", element,
                  &number)) {
      return {};
    }
    numbers.push_back(number);
  }
  return numbers;
}

std::vector<double> TomlTable::Numbers(const std::string& key, int size,
                                       const std::string& what) const {
  std::vector<double> numbers = Numbers(key);
  if (!Has(key) || !errors_->ok() || static_cast<int>(numbers.size()) == size) {
    return numbers;
  }
  Fail(key, "'" + key + "' has " + std::to_string(numbers.size()) +
                " entries, expected " + std::to_string(size) + ", one per " +
                what);
  return {};
}

std::vector<int> TomlTable::Integers(const std::string& key, int minimum,
                                     int maximum) const {
  std::vector<int> numbers;
  const TomlValue* value = FindAs({"whole numbers"}, key);
  if (value == nullptr) return numbers;
  const std::string expected = "whole numbers from " + std::to_string(minimum) +
                               " to " + std::to_string(maximum);
  if (value->type != TomlValue::Type::kArray) {
    WrongType(key, *value, "an array of " + expected);
    return numbers;
  }
  for (const TomlValue& element : value->elements) {
    if (element.type != TomlValue::Type::kInteger ||
        element.integer < minimum || element.integer > maximum) {
      WrongType(key + "[" + std::to_string(numbers.size()) + "]", element,
                expected);
      return {};
    }
    numbers.push_back(static_cast<int>(element.integer));
  }
  return numbers;
}

TomlTable TomlTable::Table(const std::string& key,
                           const std::string& table_name) const {
  const std::string path = PathOf(key);
  const TomlValue* value = Find(key);
  if (value == nullptr) {
    return TomlTable(EmptyTable(), table_name, errors_, path);
  }
  if (!value->IsTable()) {
    WrongType(key, *value, "a table");
    return TomlTable(errors_, path);
  }
  return TomlTable(*value, table_name, errors_, path);
}

std::vector<TomlTable> TomlTable::Tables(const std::string& key,
                                         const std::string& prefix) const {
  std::vector<TomlTable> tables;
  const TomlValue* value = FindAs({"tables"}, key);
  if (value == nullptr) return tables;
  const std::string header =
      "[[" + (prefix.empty() ? "" : prefix + ".") + key + "]]";
  if (!value->IsArrayOfTables()) {
    WrongType(key, *value, "tables, each under a header " + header);
    return tables;
  }
  const std::string path = PathOf(key);
  for (const TomlValue& element : value->elements) {
    tables.emplace_back(element,
                        header + " " + std::to_string(tables.size() + 1),
                        errors_, path);
  }
  return tables;
}

Vector ToVector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(),
                                  static_cast<Eigen::Index>(values.size()));
}

}  // namespace pinode
