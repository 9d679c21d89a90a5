// Parameters that follow others: one unknown that is used several times.

#ifndef PINODE_BASE_PARAMETER_TIE_H_
#define PINODE_BASE_PARAMETER_TIE_H_

#include <string>
#include <vector>

#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"

namespace pinode {

// A parameter that is `factor` times another one. The indices count over all
// blocks.
struct ParameterTie {
  int parameter = -1;
  int source = -1;
  double factor = 1.0;
};

// Returns the ties of these blocks, see Parameter::tie. A tie to a name that no
// block has, or to a parameter that is itself tied, is left out: the parameter
// then stays at its value. AreTiesValid() refuses both.
std::vector<ParameterTie> FindTies(
    const std::vector<const ParameterBlock*>& blocks);

// Checks that each tied parameter names a parameter of these blocks that is
// free or fixed by itself, and that the factor is finite and not zero. On
// failure returns false. *error then says what to do, and *parameter is the
// name of the tied parameter.
[[nodiscard]] bool AreTiesValid(
    const std::vector<const ParameterBlock*>& blocks, std::string* parameter,
    std::string* error);

// Sets the tied entries of `values`, which has one entry per parameter.
template <typename T>
void ApplyTies(const std::vector<ParameterTie>& ties, T* values) {
  for (const ParameterTie& tie : ties) {
    values[tie.parameter] = tie.factor * values[tie.source];
  }
}

}  // namespace pinode

#endif  // PINODE_BASE_PARAMETER_TIE_H_
