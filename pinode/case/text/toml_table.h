// Typed access to the tables of a case file, with one message for the first
// error.

#ifndef PINODE_CASE_TEXT_TOML_TABLE_H_
#define PINODE_CASE_TEXT_TOML_TABLE_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/case/text/case_data.h"
#include "pinode/case/text/toml_value.h"

namespace pinode {

struct CaseKey;
struct CaseTable;
class SharedTables;

// Largest number of a case file. Squares and products of three stay finite.
inline constexpr double kLargestNumber = 1e100;
// Smallest positive number, where one is asked for. Its reciprocal is finite.
inline constexpr double kSmallestNumber = 1e-300;

// First error of a case file, and the place of its files. Readers continue with
// defaults after a failure and check ok() before they use their values.
class CaseErrors {
 public:
  // `path` is empty for a case in memory. `error` receives the message; it and
  // `data` (nullptr: none) must outlive this object.
  CaseErrors(std::string path, std::string* error,
             const CaseData* data = nullptr)
      : path_(std::move(path)), error_(error), data_(data) {}

  bool ok() const { return ok_; }
  const std::string& path() const { return path_; }
  // Arrays in place of files.
  const CaseData& data() const;
  // Tables shared with other ranks; nullptr: not shared. Must outlive this
  // object.
  SharedTables* shared_tables() const { return shared_tables_; }
  void set_shared_tables(SharedTables* tables) { shared_tables_ = tables; }

  // Line where an unknown is tied to another one, for checks after all unknowns
  // were read; 0 if it was not noted.
  void NoteTie(const std::string& unknown, int line) { ties_[unknown] = line; }
  int LineOfTie(const std::string& unknown) const {
    const auto found = ties_.find(unknown);
    return found == ties_.end() ? 0 : found->second;
  }

  // Return false, so that callers can return it. Fail writes `path:line:
  // message`, without parts that are empty or 0.
  bool Fail(int line, const std::string& message);
  // Reports a message that names its own file; returns false.
  bool FailAsIs(const std::string& message);

 private:
  std::string path_;
  std::string* error_;
  const CaseData* data_;
  SharedTables* shared_tables_ = nullptr;
  std::map<std::string, int> ties_;
  bool ok_ = true;
};

// Table of a case file. Every getter returns the default for an absent key. For
// a value of the wrong type it reports `file:line: [table] key is ..., expected
// ...` and returns the default as well.
//
// A table knows its path in the case. If CaseTables() has the path, readers ask
// only for keys that it lists, as one of their types and with their defaults. A
// reader that does otherwise is noted for TakeKeyMistakes().
class TomlTable {
 public:
  // Makes an absent table at `path`, without keys.
  explicit TomlTable(CaseErrors* errors, std::string path = "");
  // Makes a table that messages call `name`, such as "[units]" or "[[group]]
  // 'k1'". `path` is that of CaseTable; "": the root.
  TomlTable(const TomlValue& table, std::string name, CaseErrors* errors,
            std::string path = "");

  const std::string& name() const { return name_; }
  void set_name(std::string name) { name_ = std::move(name); }
  CaseErrors* errors() const { return errors_; }
  const std::vector<TomlValue::Entry>& entries() const {
    return table_->entries;
  }

  // Refuses every key that CaseTables() does not list for this table, and
  // suggests the nearest one.
  bool AllowKeys() const;
  // Returns whether CaseTables() lists the key for this table.
  bool Takes(const std::string& key) const;
  // Refuses every key that is not in `known`.
  bool AllowKeys(const std::vector<std::string>& known) const;

  bool Has(const std::string& key) const { return Find(key) != nullptr; }
  const TomlValue* Find(const std::string& key) const;
  // Line of the key, or of the table if the key is absent.
  int Line(const std::string& key) const;
  int line() const { return table_->line; }

  // Reports `file:line: name: message`, at the key's line. The name is not
  // repeated if the message begins with it.
  bool Fail(const std::string& key, const std::string& message) const;
  bool RequireKey(const std::string& key, const std::string& expected) const;

  std::string String(const std::string& key,
                     const std::string& absent = "") const;
  std::string RequiredString(const std::string& key) const;
  // Returns one of `choices`.
  std::string Choice(const std::string& key,
                     const std::vector<std::string>& choices,
                     const std::string& absent) const;
  // Returns a finite number of at most kLargestNumber in size.
  double Number(const std::string& key, double absent) const;
  // Returns a number from kSmallestNumber on.
  double PositiveNumber(const std::string& key, double absent) const;
  double NonNegativeNumber(const std::string& key, double absent) const;
  // Returns a number that may be infinite, as bounds are.
  double ExtendedNumber(const std::string& key, double absent) const;
  // Returns an integer within limits. `maximum` is what the key can mean at the
  // most, so that sums and products of such numbers stay in their types and
  // arrays of that size in memory.
  int Integer(const std::string& key, int absent, int minimum,
              int maximum) const;
  // Returns an integer that grows with the length of a record, up to 1e12.
  int64_t LongInteger(const std::string& key, int64_t absent,
                      int64_t minimum) const;
  bool Boolean(const std::string& key, bool absent) const;
  std::vector<std::string> Strings(const std::string& key) const;
  // Returns finite numbers, any number of them.
  std::vector<double> Numbers(const std::string& key) const;
  // Returns `size` finite numbers, one per `what`; empty if the key is absent.
  std::vector<double> Numbers(const std::string& key, int size,
                              const std::string& what) const;
  std::vector<int> Integers(const std::string& key, int minimum,
                            int maximum) const;

  // Returns the table under the key, or an absent table.
  TomlTable Table(const std::string& key, const std::string& table_name) const;
  // Returns the tables of [[key]]; messages call them `[[prefix.key]]` and a
  // number.
  std::vector<TomlTable> Tables(const std::string& key,
                                const std::string& prefix = "") const;

 private:
  int64_t IntegerUpTo(int64_t maximum, const std::string& key, int64_t absent,
                      int64_t minimum) const;
  bool WrongType(const std::string& key, const TomlValue& value,
                 const std::string& expected) const;
  bool NumberOf(const std::string& key, const TomlValue& value,
                double* number) const;
  // Returns the key as CaseTables() has it, or nullptr. Notes a mistake if it
  // should be there and is not.
  const CaseKey* Listed(const std::string& key) const;
  // Finds a value that is read as all of `types`. A key that is absent must
  // have the default `absent`, as a case writes it, if CaseTables() has a value
  // there.
  const TomlValue* FindAs(const std::vector<std::string>& types,
                          const std::string& key,
                          const std::string& absent = "") const;
  void Mistake(const std::string& key, const std::string& message) const;
  // Returns the path of a table under the key.
  std::string PathOf(const std::string& key) const;

  const TomlValue* table_;
  std::string name_;
  std::string path_;
  const CaseTable* known_;
  CaseErrors* errors_;
};

// Returns reads since the last call that differ from CaseTables(), at most a
// hundred. They are mistakes in pinode, for tests to find.
std::vector<std::string> TakeKeyMistakes();

Vector ToVector(const std::vector<double>& values);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_TOML_TABLE_H_
