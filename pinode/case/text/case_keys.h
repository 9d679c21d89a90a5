// Table of the keys of a case file. The reader accepts what it lists, and the
// reference in pinode/case/README.md is printed from it.

#ifndef PINODE_CASE_TEXT_CASE_KEYS_H_
#define PINODE_CASE_TEXT_CASE_KEYS_H_

#include <string>
#include <vector>

namespace pinode {

// One key. TomlTable reads a key only as one of its types, and with the default
// that stands here.
struct CaseKey {
  // "*" stands for any name.
  const char* name;
  // Types of the value, joined by " or ": text, number, whole number, true,
  // false, texts, numbers, whole numbers, table, tables, array, a choice in
  // quotes, or the path of a shared table, such as unknown.
  const char* type;
  // Unit or shape of the value; "": none.
  const char* unit;
  // Value of an absent key, as it is written in a case; otherwise words, such
  // as needed or none.
  const char* absent;
  const char* meaning;
};

// The keys of one table of a case.
struct CaseTable {
  // Keys from the root to the table, such as "record.channel"; "": the root. A
  // path without a place in a case, such as "unknown", is a shared table.
  const char* path;
  // The table as messages and documents call it, such as
  // "[[record.channel]]".
  const char* header;
  // Path of a shared table whose keys this one takes too; "": none.
  const char* also;
  std::vector<CaseKey> keys;

  // Returns the key, also of the shared table, or nullptr.
  const CaseKey* Find(const std::string& name) const;
  // Returns all names in the order of the reference, also those of the shared
  // table.
  std::vector<std::string> Names() const;
};

const std::vector<CaseTable>& CaseTables();

// Returns the table at `path`, or nullptr: its keys are free names, such as
// those of DOFs.
const CaseTable* FindCaseTable(const std::string& path);

// Returns the alternatives of a type.
std::vector<std::string> TypesOf(const CaseKey& key);

// Returns whether `absent` is a value and not words.
bool HasLiteralDefault(const CaseKey& key);

// Returns the keys of one table in Markdown.
std::string KeyReference(const CaseTable& table);

// Returns those of all tables.
std::string KeyReference();

// Parts of CaseTables().
std::vector<CaseTable> ModelCaseTables();
std::vector<CaseTable> RecordCaseTables();
std::vector<CaseTable> ProgramCaseTables();

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_CASE_KEYS_H_
