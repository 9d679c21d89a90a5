#include "pinode/dynamics/term.h"

#include <algorithm>

namespace pinode {

std::vector<int> TangentColumns(const ParameterBlock& block) {
  std::vector<int> columns;
  int next = 0;
  for (const Parameter& parameter : block.parameters) {
    columns.push_back(parameter.free || parameter.IsTied() ? next++ : -1);
  }
  return columns;
}

int NumFree(const ParameterBlock& block) {
  return static_cast<int>(
      std::count_if(block.parameters.begin(), block.parameters.end(),
                    [](const Parameter& parameter) {
                      return parameter.free || parameter.IsTied();
                    }));
}

}  // namespace pinode
