#include "pinode/dynamics/term_results.h"

namespace pinode {

Matrix AccelerationMap(ActsAs acts_as, const Matrix& outputs,
                       const Matrix& mass_inverse) {
  if (acts_as == ActsAs::kAcceleration) return outputs;
  return -mass_inverse * outputs;
}

}  // namespace pinode
