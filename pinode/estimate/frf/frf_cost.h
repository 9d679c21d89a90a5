// The cost of frequency response functions.

#ifndef PINODE_ESTIMATE_FRF_FRF_COST_H_
#define PINODE_ESTIMATE_FRF_FRF_COST_H_

#include <string>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/frf/frf_transfer.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Minus the logarithm of the likelihood of a record's FRFs, up to a constant.
// With r = (measured - model) / v^(1/2) of a pair's lines, v the relative
// variances, S = sum |r|^2 and N twice the number of lines,
//
//   sum over pairs of  S / (2 sigma^2)                         (sigma given)
//                      N / 2 log(1 + S / (N sigma_0^2))        (unknown).
//
// The second is the likelihood at the noise that makes it largest, sigma^2 = S
// / N + sigma_0^2. The least noise sigma_0 is kLeastNoise times the root mean
// square of the pair: it keeps the cost of exact data finite. Gauss-Newton
// Hessian and gradient are those of S / (2 sigma^2) at this sigma.
class FrfCost final : public CostPart {
 public:
  static constexpr double kLeastNoise = 1e-5;

  // `record` is valid; it and `layout` must outlive this object.
  FrfCost(const FrfRecord& record, const StructuralDynamics& dynamics,
          const ParameterLayout& layout, int num_threads);

  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;
  std::string Failure() const override { return failure_; }

  const FrfRecord& record() const { return record_; }
  // Number of real residuals.
  Eigen::Index num_residuals() const {
    return static_cast<Eigen::Index>(counts_.sum());
  }

  // At the last Evaluate or Linearize:
  //
  // - the model's FRFs, lines x pairs;
  // - residuals r, lines x pairs, not over sigma; 0 where nothing was measured;
  // - sigma of each pair.
  const ComplexMatrix& modelled() const { return modelled_; }
  const ComplexMatrix& residuals() const { return residuals_; }
  const Vector& sigma() const { return sigma_; }
  // Roots of the relative variances, lines x pairs.
  const Matrix& deviations() const { return deviations_; }

  // Information on the free parameters at the last Linearize.
  const Matrix& information() const { return information_; }
  // Sum of score score' over blocks of lines at the last Linearize, in the
  // place of the information: the middle of a sandwich covariance. A block is
  // long compared with the memory of the residuals from line to line.
  Matrix ScoreProducts() const;
  // Largest autocorrelation time of the residuals of any pair, in lines.
  double Memory() const;

 private:
  [[nodiscard]] bool SetPoint(const Vector& free);
  void FindNoise();

  const FrfRecord& record_;
  const ParameterLayout& layout_;
  const int num_threads_;
  FrfTransfer transfer_;
  Matrix deviations_;
  Vector counts_;       // real residuals of each pair
  Vector least_noise_;  // of each pair
  Vector at_;
  ComplexMatrix modelled_, residuals_;
  Vector squares_, sigma_;  // S, and sigma
  Matrix information_;
  Matrix scores_;  // lines x num_free
  std::string failure_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FRF_FRF_COST_H_
