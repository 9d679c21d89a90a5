#include "pinode/case/text/toml_table.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

const TomlValue& EmptyTable() {
  static const auto& empty = *new TomlValue();
  return empty;
}

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

TomlTable::TomlTable(CaseErrors* errors)
    : table_(&EmptyTable()), errors_(errors) {}

TomlTable::TomlTable(const TomlValue& table, std::string name,
                     CaseErrors* errors)
    : table_(&table), name_(std::move(name)), errors_(errors) {}

bool TomlTable::AllowKeys(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : table_->entries) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    return errors_->Fail(value.line, (name_.empty() ? "" : name_ + ": ") +
                                         "unknown key '" + key + "'" +
                                         NameHint(key, known));
  }
  return true;
}

int TomlTable::Line(const std::string& key) const {
  const TomlValue* value = Find(key);
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
  const TomlValue* value = Find(key);
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
  std::string text = String(key, absent);
  if (!Has(key) ||
      std::find(choices.begin(), choices.end(), text) != choices.end()) {
    return text;
  }
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
  const TomlValue* value = Find(key);
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
  const TomlValue* value = Find(key);
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
  const TomlValue* value = Find(key);
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
  const TomlValue* value = Find(key);
  if (value == nullptr) return absent;
  if (value->type != TomlValue::Type::kBoolean) {
    WrongType(key, *value, "true or false");
    return absent;
  }
  return value->boolean;
}

std::vector<std::string> TomlTable::Strings(const std::string& key) const {
  std::vector<std::string> texts;
  const TomlValue* value = Find(key);
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
  const TomlValue* value = Find(key);
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
  const TomlValue* value = Find(key);
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
  const TomlValue* value = Find(key);
  if (value == nullptr) {
    TomlTable absent(errors_);
    absent.set_name(table_name);
    return absent;
  }
  if (!value->IsTable()) {
    WrongType(key, *value, "a table");
    return TomlTable(errors_);
  }
  return TomlTable(*value, table_name, errors_);
}

std::vector<TomlTable> TomlTable::Tables(const std::string& key,
                                         const std::string& prefix) const {
  std::vector<TomlTable> tables;
  const TomlValue* value = Find(key);
  if (value == nullptr) return tables;
  const std::string header =
      "[[" + (prefix.empty() ? "" : prefix + ".") + key + "]]";
  if (!value->IsArrayOfTables()) {
    WrongType(key, *value, "tables, each under a header " + header);
    return tables;
  }
  for (const TomlValue& element : value->elements) {
    tables.emplace_back(
        element, header + " " + std::to_string(tables.size() + 1), errors_);
  }
  return tables;
}

Vector ToVector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(),
                                  static_cast<Eigen::Index>(values.size()));
}

}  // namespace pinode
