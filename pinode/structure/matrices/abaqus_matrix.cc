#include "pinode/structure/matrices/abaqus_matrix.h"

#include <string_view>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

bool ParseDof(std::string_view node, std::string_view direction,
              NodeDirection* dof) {
  return ParseInt(node, &dof->node) && ParseInt(direction, &dof->direction) &&
         dof->direction >= 0;
}

}  // namespace

bool ReadAbaqusMatrixText(const std::string& path, const std::string& content,
                          DofMatrix* matrix, std::string* error) {
  CHECK(matrix != nullptr);
  CHECK(error != nullptr);
  LineReader lines(path, content);
  std::vector<DofEntry> named;
  std::string_view line;
  while (lines.NextContent('*', &line)) {
    std::vector<std::string_view> fields = Split(line, ',');
    // Abaqus often ends a line with a comma.
    if (fields.size() == 6 && fields.back().empty()) fields.pop_back();
    DofEntry entry;
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
  int at = 0;
  std::string what;
  if (!MakeDofMatrix(named, matrix, &at, &what)) {
    return lines.FailAt(at, what, error);
  }
  return true;
}

bool ReadAbaqusMatrix(const std::string& path, DofMatrix* matrix,
                      std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ReadAbaqusMatrixText(path, content, matrix, error);
}

}  // namespace pinode
