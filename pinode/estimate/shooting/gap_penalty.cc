#include "pinode/estimate/shooting/gap_penalty.h"

#include <algorithm>

namespace pinode {

GapPenalty::GapPenalty(int num_states, int num_segments)
    : scales_(Vector::Ones(num_states)) {
  ResetMultipliers(num_segments);
}

void GapPenalty::ResetMultipliers(int num_segments) {
  multipliers_ = Matrix::Zero(scales_.size(), num_segments - 1);
}

Vector GapPenalty::Scaled(const Matrix& ends, const Matrix& starts,
                          int gap) const {
  return (ends.col(gap) - starts.col(gap + 1)).cwiseQuotient(scales_);
}

double GapPenalty::Cost(double mu, const Matrix& ends,
                        const Matrix& starts) const {
  double cost = 0.0;
  for (int k = 0; k < multipliers_.cols(); ++k) {
    cost += 0.5 * mu *
            (Scaled(ends, starts, k) + multipliers_.col(k)).squaredNorm();
  }
  return cost;
}

Vector GapPenalty::Force(double mu, const Matrix& ends, const Matrix& starts,
                         int gap) const {
  return mu * (Scaled(ends, starts, gap) + multipliers_.col(gap))
                  .cwiseQuotient(scales_);
}

void GapPenalty::UpdateMultipliers(const Matrix& ends, const Matrix& starts) {
  for (int k = 0; k < multipliers_.cols(); ++k) {
    multipliers_.col(k) += Scaled(ends, starts, k);
  }
}

double GapPenalty::LargestGap(const Matrix& ends, const Matrix& starts) const {
  double largest = 0.0;
  for (int k = 0; k < multipliers_.cols(); ++k) {
    largest = std::max(largest, Scaled(ends, starts, k).cwiseAbs().maxCoeff());
  }
  return largest;
}

}  // namespace pinode
