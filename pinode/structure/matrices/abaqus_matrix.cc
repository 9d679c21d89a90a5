#include "pinode/structure/matrices/abaqus_matrix.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/calculix.h"

namespace pinode {
namespace {

struct NamedEntry {
  NodeDirection row;
  NodeDirection column;
  double value = 0.0;
  int line = 0;
};

bool ParseDof(std::string_view node, std::string_view direction,
              NodeDirection* dof) {
  return ParseInt(node, &dof->node) && ParseInt(direction, &dof->direction) &&
         dof->direction >= 0;
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

bool ReadAbaqusMatrixText(const std::string& path, const std::string& content,
                          AbaqusMatrix* matrix, std::string* error) {
  CHECK(matrix != nullptr);
  CHECK(error != nullptr);
  LineReader lines(path, content);
  std::vector<NamedEntry> named;
  std::string_view line;
  while (lines.NextContent('*', &line)) {
    std::vector<std::string_view> fields = Split(line, ',');
    // Abaqus often ends a line with a comma.
    if (fields.size() == 6 && fields.back().empty()) fields.pop_back();
    NamedEntry entry;
    if (fields.size() != 5 || !ParseDof(fields[0], fields[1], &entry.row) ||
        !ParseDof(fields[2], fields[3], &entry.column)) {
      return lines.Fail("the line is " + Quote(line) +
                            ", expected 'node, direction, node, direction, "
                            "value' (*MATRIX OUTPUT, FORMAT=MATRIX INPUT)",
                        error);
    }
    double value = 0.0;
    if (!ParseEntry(lines, fields[4], 0, 0, &value, error)) {
      return lines.Fail(
          "the value is " + Quote(fields[4]) + ", expected a finite number",
          error);
    }
    entry.value = value;
    entry.line = lines.number();
    named.push_back(entry);
  }
  if (named.empty()) {
    return lines.Fail("the file has no entries, expected a matrix", error);
  }
  AbaqusMatrix result;
  for (const NamedEntry& entry : named) {
    result.dofs.push_back(entry.row);
    result.dofs.push_back(entry.column);
  }
  std::sort(result.dofs.begin(), result.dofs.end());
  result.dofs.erase(std::unique(result.dofs.begin(), result.dofs.end()),
                    result.dofs.end());
  if (result.dofs.size() > static_cast<size_t>(kMaxFiniteElementDofs)) {
    return lines.Fail(std::to_string(result.dofs.size()) +
                          " DOFs, expected at most " +
                          std::to_string(kMaxFiniteElementDofs),
                      error);
  }
  result.entries.reserve(named.size());
  for (const NamedEntry& from : named) {
    MatrixEntry entry;
    entry.row = PositionOf(result.dofs, from.row);
    entry.column = PositionOf(result.dofs, from.column);
    entry.value = from.value;
    entry.line = from.line;
    result.entries.push_back(entry);
  }
  MatrixEntry at;
  std::string what;
  if (!FindTriangle(&result.entries, &result.mirrored, &at, &what)) {
    return lines.FailAt(at.line, what, error);
  }
  *matrix = std::move(result);
  return true;
}

bool ReadAbaqusMatrix(const std::string& path, AbaqusMatrix* matrix,
                      std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ReadAbaqusMatrixText(path, content, matrix, error);
}

}  // namespace pinode
