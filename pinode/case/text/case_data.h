// What stands in for files in a case that was made in memory.

#ifndef PINODE_CASE_TEXT_CASE_DATA_H_
#define PINODE_CASE_TEXT_CASE_DATA_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/table.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Arrays by the names that a case has for them where it would name a file: a
// record's `file`, a matrix, the export of a finite-element model. A name is
// none of a file, such as "<record[0].file>".
struct CaseData {
  std::map<std::string, Table> tables;
  std::map<std::string, Matrix> matrices;
  std::map<std::string, std::shared_ptr<const SparseMatrix>> sparse_matrices;

  bool Has(const std::string& name) const;
};

// Whether a table in memory has these columns (all where none is named),
// without an infinite number; else *error says what is wrong.
[[nodiscard]] bool CheckColumns(const Table& table,
                                const std::vector<std::string>& wanted,
                                std::string* error);

// The columns `wanted` of a table in memory as ReadCsvTable has them of a file:
// in that order, a name twice once, all where none is named. False, with
// *error, for a column that is not there, or that holds an infinite number.
[[nodiscard]] bool SelectColumns(const Table& table,
                                 const std::vector<std::string>& wanted,
                                 Table* selected, std::string* error);

// The same of what `path` names: a table of `data`, or else a CSV file.
[[nodiscard]] bool ReadColumns(const CaseData& data, const std::string& path,
                               const std::vector<std::string>& wanted,
                               Table* selected, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_CASE_DATA_H_
