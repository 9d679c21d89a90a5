// Arbitrary bytes as a .sti or .mas file of CalculiX.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pinode/structure/matrices/calculix.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  std::vector<pinode::MatrixEntry> entries;
  bool mirrored = false;
  int dofs = 0;
  std::string error;
  if (!pinode::ReadIndexedEntriesText("fuzz.sti", content, &entries, &mirrored,
                                      &dofs, &error)) {
    if (error.empty()) __builtin_trap();
    return 0;
  }
  if (dofs < 1 || dofs > pinode::kMaxFiniteElementDofs) __builtin_trap();
  if (dofs > 10000) return 0;
  pinode::SparseMatrix matrix;
  pinode::MatrixEntry twice;
  (void)pinode::AssembleMatrix(dofs, dofs, mirrored, &entries, &matrix, &twice);
  return 0;
}
