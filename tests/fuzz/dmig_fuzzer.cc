// Arbitrary bytes as DMIG entries.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pinode/structure/matrices/dmig.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  std::vector<pinode::DmigMatrix> matrices;
  std::string error;
  if (!pinode::ReadDmigText("fuzz.pch", content, &matrices, &error)) {
    if (error.empty()) __builtin_trap();
    return 0;
  }
  for (pinode::DmigMatrix& read : matrices) {
    if (!read.fault.empty()) continue;
    // Asserts that every entry points to a DOF.
    const int dofs = static_cast<int>(read.matrix.dofs.size());
    pinode::SparseMatrix assembled;
    pinode::MatrixEntry twice;
    (void)pinode::AssembleMatrix(dofs, dofs, read.matrix.mirrored,
                                 &read.matrix.entries, &assembled, &twice);
  }
  return 0;
}
