#include "pinode/case/text/case_keys.h"

#include <algorithm>
#include <cctype>

namespace pinode {
namespace {

std::string Code(const std::string& text) { return "`" + text + "`"; }

// Returns a header as code, unless it is written in Markdown already.
std::string HeaderCell(const CaseTable& table) {
  const std::string header = table.header;
  return header.front() == '[' ? Code(header) : header;
}

// Returns a link to the heading of a shared table in the reference.
std::string SharedLink(const std::string& path) {
  std::string anchor = "value-" + path;
  std::replace(anchor.begin(), anchor.end(), ' ', '-');
  return "[" + path + "](#" + anchor + ")";
}

// Returns the type and the unit of a key in one cell.
std::string ValueCell(const CaseKey& key) {
  std::string cell;
  for (const std::string& type : TypesOf(key)) {
    const bool written =
        type.front() == '"' || type == "true" || type == "false";
    cell += (cell.empty() ? "" : " or ") + (written ? Code(type)
                                            : FindCaseTable(type) != nullptr
                                                ? SharedLink(type)
                                                : type);
  }
  const std::string unit = key.unit;
  return unit.empty() ? cell : cell + ", " + unit;
}

std::string KeyCell(const CaseKey& key) {
  return key.name == std::string("*") ? "any name" : Code(key.name);
}

}  // namespace

const CaseKey* CaseTable::Find(const std::string& name) const {
  for (const CaseKey& key : keys) {
    if (name == key.name || key.name == std::string("*")) return &key;
  }
  const CaseTable* shared = *also == '\0' ? nullptr : FindCaseTable(also);
  return shared == nullptr ? nullptr : shared->Find(name);
}

std::vector<std::string> CaseTable::Names() const {
  std::vector<std::string> names;
  for (const CaseKey& key : keys) names.emplace_back(key.name);
  if (*also == '\0') return names;
  const std::vector<std::string> shared = FindCaseTable(also)->Names();
  names.insert(names.end(), shared.begin(), shared.end());
  return names;
}

const std::vector<CaseTable>& CaseTables() {
  static const auto& tables = *[] {
    auto* all = new std::vector<CaseTable>(ModelCaseTables());
    for (const auto& part : {RecordCaseTables(), ProgramCaseTables()}) {
      all->insert(all->end(), part.begin(), part.end());
    }
    return all;
  }();
  return tables;
}

const CaseTable* FindCaseTable(const std::string& path) {
  const std::vector<CaseTable>& tables = CaseTables();
  const auto found =
      std::find_if(tables.begin(), tables.end(),
                   [&](const CaseTable& table) { return table.path == path; });
  return found == tables.end() ? nullptr : &*found;
}

std::vector<std::string> TypesOf(const CaseKey& key) {
  const std::string all = key.type;
  const std::string separator = " or ";
  std::vector<std::string> types;
  size_t begin = 0;
  while (true) {
    const size_t end = all.find(separator, begin);
    types.push_back(all.substr(begin, end - begin));
    if (end == std::string::npos) return types;
    begin = end + separator.size();
  }
}

bool HasLiteralDefault(const CaseKey& key) {
  const std::string absent = key.absent;
  if (absent == "true" || absent == "false") return true;
  if (absent.empty()) return false;
  if (absent.front() == '"') return true;
  return std::isdigit(static_cast<unsigned char>(absent.front())) != 0 &&
         absent.find(' ') == std::string::npos;
}

std::string KeyReference(const CaseTable& table) {
  std::string text = "| " + HeaderCell(table) +
                     " | value | default | meaning |\n|---|---|---|---|\n";
  for (const CaseKey& key : table.keys) {
    text += "| " + KeyCell(key) + " | " + ValueCell(key) + " | " +
            (HasLiteralDefault(key) ? Code(key.absent) : key.absent) + " | " +
            key.meaning + " |\n";
  }
  if (*table.also != '\0') {
    text += "| and the keys of " + SharedLink(table.also) + " | | | |\n";
  }
  return text;
}

std::string KeyReference() {
  std::string text;
  for (const CaseTable& table : CaseTables()) {
    text += (text.empty() ? "" : "\n") + KeyReference(table);
  }
  return text;
}

}  // namespace pinode
