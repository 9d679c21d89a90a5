#include "pinode/estimate/objective/evidence.h"

#include <algorithm>

#include "pinode/estimate/solver/square_root.h"

namespace pinode {

bool MeasureEvidence(const ParameterLayout& layout, const Matrix& hessian,
                     const Vector& decays, const Vector& free,
                     Evidence* evidence) {
  const int n = layout.num_free();
  Matrix root;
  if (!SquareRoot(hessian, &root)) return false;
  evidence->inverse_root =
      root.triangularView<Eigen::Upper>().solve(Matrix::Identity(n, n));
  const Matrix& inverse_root = evidence->inverse_root;
  // Diagonal of H^-1: uncertainty of each entry from data and priors.
  const Vector variance = inverse_root.rowwise().squaredNorm();
  evidence->effective = n;
  evidence->determined = Vector::Zero(decays.size());
  evidence->squares = Vector::Zero(decays.size());
  for (int j = 0; j < n; ++j) {
    const Parameter& parameter =
        layout.parameter(layout.free()[static_cast<size_t>(j)]);
    if (!parameter.HasPrior()) continue;
    const double precision =
        1.0 / (parameter.prior_sigma * parameter.prior_sigma);
    evidence->effective -= std::min(1.0, precision * variance[j]);
  }
  for (const ParameterLayout::DecayRow& row : layout.decay_rows()) {
    const double known =
        decays[row.group] *
        (inverse_root.middleRows(row.first, row.weights.size()).transpose() *
         row.weights)
            .squaredNorm();
    const double value = row.Value(free);
    evidence->determined[row.group] += 1.0 - std::min(1.0, known);
    evidence->squares[row.group] += value * value;
    evidence->effective -= std::min(1.0, known);
  }
  return true;
}

Vector FirstDecays(const ParameterLayout& layout, const EvidenceTuning& tuning,
                   const IdentifiedModel* initial) {
  if (initial != nullptr &&
      initial->decays.size() == layout.num_decay_groups()) {
    return initial->decays;
  }
  Vector decays(layout.num_decay_groups());
  for (int g = 0; g < layout.num_decay_groups(); ++g) {
    const auto& group = layout.decay_groups()[static_cast<size_t>(g)];
    decays[g] = group.IsGiven() ? group.given : tuning.first_decay;
  }
  return decays;
}

void UpdateDecays(const ParameterLayout& layout, const EvidenceTuning& tuning,
                  const Evidence& evidence, Vector* decays) {
  for (int g = 0; g < layout.num_decay_groups(); ++g) {
    if (layout.decay_groups()[static_cast<size_t>(g)].IsGiven()) continue;
    double& decay = (*decays)[g];
    const double wanted =
        std::max(evidence.determined[g], tuning.least_determined) /
        std::max(evidence.squares[g], tuning.least_squares);
    decay = std::clamp(wanted, 1.0 / tuning.most_change * decay,
                       std::min(tuning.most_decay, tuning.most_change * decay));
  }
}

}  // namespace pinode
