// Arbitrary bytes as a matrix of Abaqus.

#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/structure/matrices/abaqus_matrix.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  pinode::DofMatrix matrix;
  std::string error;
  if (!pinode::ReadAbaqusMatrixText("fuzz.mtx", content, &matrix, &error)) {
    if (error.empty()) __builtin_trap();
    return 0;
  }
  // Asserts that every entry points to a DOF.
  const int dofs = static_cast<int>(matrix.dofs.size());
  pinode::SparseMatrix assembled;
  pinode::MatrixEntry twice;
  (void)pinode::AssembleMatrix(dofs, dofs, matrix.mirrored, &matrix.entries,
                               &assembled, &twice);
  return 0;
}
