// Arrays in place of files for a case made in memory.

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

// Arrays by the names that the case uses in place of file names: a record's
// `file`, a matrix, the export of a finite-element model. Such a name is no
// file name, for example "<record[0].file>".
struct CaseData {
  std::map<std::string, Table> tables;
  std::map<std::string, Matrix> matrices;
  std::map<std::string, std::shared_ptr<const SparseMatrix>> sparse_matrices;

  bool Has(const std::string& name) const;
};

// Checks that a table in memory has these columns (all if none is named),
// without an infinite number; else *error says what is wrong.
[[nodiscard]] bool CheckColumns(const Table& table,
                                const std::vector<std::string>& wanted,
                                std::string* error);

// Selects the columns `wanted` of a table in memory as ReadCsvTable does for a
// file: in that order, repeated names once, all if none is named. Returns
// false, with *error, for a missing column, or one with an infinite number.
[[nodiscard]] bool SelectColumns(const Table& table,
                                 const std::vector<std::string>& wanted,
                                 Table* selected, std::string* error);

// Selects the same from `path`: a table of `data`, or else a CSV file.
[[nodiscard]] bool ReadColumns(const CaseData& data, const std::string& path,
                               const std::vector<std::string>& wanted,
                               Table* selected, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_CASE_DATA_H_
