#include "pinode/structure/matrices/dof_matrix.h"

#include <algorithm>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/structure/matrices/calculix.h"

namespace pinode {
namespace {

void SortOnce(std::vector<NodeDirection>* dofs) {
  std::sort(dofs->begin(), dofs->end());
  dofs->erase(std::unique(dofs->begin(), dofs->end()), dofs->end());
}

int PositionOf(const std::vector<NodeDirection>& dofs,
               const NodeDirection& dof) {
  return static_cast<int>(std::lower_bound(dofs.begin(), dofs.end(), dof) -
                          dofs.begin());
}

}  // namespace

std::string NodeDirection::Name() const {
  return std::to_string(node) + "." + std::to_string(direction);
}

void DofMatrix::Renumber(const std::vector<NodeDirection>& all) {
  std::vector<int> position;
  for (const NodeDirection& dof : dofs) {
    position.push_back(PositionOf(all, dof));
  }
  for (MatrixEntry& entry : entries) {
    entry.row = position[static_cast<size_t>(entry.row)];
    entry.column = position[static_cast<size_t>(entry.column)];
  }
  dofs = all;
}

bool MakeDofMatrix(const std::vector<DofEntry>& given, DofMatrix* matrix,
                   int* line, std::string* what) {
  CHECK(!given.empty()) << "a matrix has entries";
  DofMatrix result;
  for (const DofEntry& entry : given) {
    result.dofs.push_back(entry.row);
    result.dofs.push_back(entry.column);
  }
  SortOnce(&result.dofs);
  if (result.dofs.size() > static_cast<size_t>(kMaxFiniteElementDofs)) {
    *line = given.back().line;
    *what = std::to_string(result.dofs.size()) + " DOFs, expected at most " +
            std::to_string(kMaxFiniteElementDofs);
    return false;
  }
  result.entries.reserve(given.size());
  for (const DofEntry& from : given) {
    MatrixEntry entry;
    entry.row = PositionOf(result.dofs, from.row);
    entry.column = PositionOf(result.dofs, from.column);
    entry.value = from.value;
    entry.line = from.line;
    result.entries.push_back(entry);
  }
  MatrixEntry at;
  if (!FindTriangle(&result.entries, &result.mirrored, &at, what)) {
    *line = at.line;
    *what = "the entry of " + result.dofs[static_cast<size_t>(at.row)].Name() +
            " and " + result.dofs[static_cast<size_t>(at.column)].Name() +
            ": " + *what;
    return false;
  }
  *matrix = std::move(result);
  return true;
}

std::vector<NodeDirection> AllDofs(
    const std::vector<const DofMatrix*>& matrices) {
  std::vector<NodeDirection> all;
  for (const DofMatrix* matrix : matrices) {
    all.insert(all.end(), matrix->dofs.begin(), matrix->dofs.end());
  }
  SortOnce(&all);
  return all;
}

}  // namespace pinode
