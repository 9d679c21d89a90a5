#include "pinode/structure/matrices/matrix_variable.h"

#include <filesystem>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/mat_file.h"
#include "pinode/structure/matrices/matrix_container.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/matrices/npz.h"
#include "pinode/structure/matrices/op4.h"

namespace pinode {
namespace {

std::string ExtensionOf(const std::string& path) {
  return LowerCase(std::filesystem::path(path).extension().string());
}

bool ReadContainer(const std::string& path, MatrixContainer* container,
                   std::string* error) {
  const std::string extension = ExtensionOf(path);
  return extension == ".mat"   ? ReadMatFile(path, container, error)
         : extension == ".npz" ? ReadNpz(path, container, error)
                               : ReadOp4(path, container, error);
}

}  // namespace

bool HoldsMatricesByName(const std::string& path) {
  const std::string extension = ExtensionOf(path);
  return extension == ".mat" || extension == ".npz" || extension == ".op4";
}

bool ReadMatrixVariable(const std::string& path, const std::string& variable,
                        Matrix* matrix, std::string* error) {
  MatrixContainer container;
  if (!ReadContainer(path, &container, error)) return false;
  const NamedMatrix* chosen = nullptr;
  int count = 0;
  std::vector<std::string> names;
  const auto choose = [&](const auto& fits) {
    for (const NamedMatrix& candidate : container.matrices) {
      if (!fits(candidate.name)) continue;
      chosen = &candidate;
      ++count;
    }
  };
  for (const NamedMatrix& candidate : container.matrices) {
    names.push_back("'" + candidate.name + "'");
  }
  choose([&variable](const std::string& name) {
    return variable.empty() || name == variable;
  });
  if (count == 0) {
    choose([&variable](const std::string& name) {
      return LowerCase(name) == LowerCase(variable);
    });
  }
  if (count != 1) {
    *error = path + ": " +
             (variable.empty() ? std::to_string(count) + " matrices"
              : count == 0
                  ? "no matrix '" + variable + "'"
                  : std::to_string(count) + " matrices '" + variable + "'") +
             ", expected 'variable' with one of " +
             (names.empty() ? "(the file has none)" : Join(names, ", "));
    return false;
  }
  const std::string where = path + ": matrix '" + chosen->name + "' ";
  if (!chosen->fault.empty()) {
    *error = where + "cannot be used: " + chosen->fault;
    return false;
  }
  if (chosen->matrix.rows() > kMaxMatrixDimension ||
      chosen->matrix.cols() > kMaxMatrixDimension) {
    *error = where + "has more than " + std::to_string(kMaxMatrixDimension) +
             " rows or columns, expected a condensed model";
    return false;
  }
  *matrix = Matrix(chosen->matrix);
  return true;
}

}  // namespace pinode
