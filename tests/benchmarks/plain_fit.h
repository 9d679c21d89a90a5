// The plain way to fit trajectories: multiple shooting as Ceres' documentation
// leads one to write it, without pinode.
//
// pinode/estimate/segment_cost.h is a block of the same shape. It is not used
// here: its tangents are what pinode is measured by, and the plain way is to
// have none of them.

#ifndef PINODE_TESTS_BENCHMARKS_PLAIN_FIT_H_
#define PINODE_TESTS_BENCHMARKS_PLAIN_FIT_H_

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/problem.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/benchmarks/measure.h"

namespace pinode {
namespace benchmarks {

// One segment's residuals, (simulated - measured) / sigma at its samples
// [first, last), at `last` itself where the record ends there, and otherwise
// the gap to the next segment's start over gap_sigma. Channels are the states,
// in their order. Parameter blocks: start, parameters, next start.
template <typename Chain>
struct PlainSegmentResidual {
  const Chain* chain;
  const IdentificationRecord* record;
  int first;
  int last;
  bool ends_record;
  Vector inverse_sigma;      // per state
  Vector inverse_gap_sigma;  // per state

  static constexpr int kStates = Chain::kStates;

  int num_residuals() const { return kStates * (last - first + 1); }

  template <typename T>
  bool operator()(T const* const* parameters, T* residuals) const {
    chain->Propagate(parameters[0], parameters[1], first, last, residuals);
    const int samples = last - first + (ends_record ? 1 : 0);
    for (int i = 0; i < samples; ++i) {
      for (int c = 0; c < kStates; ++c) {
        T& residual = residuals[i * kStates + c];
        residual = (residual - record->channels[c].values[first + i]) *
                   inverse_sigma[c];
      }
    }
    if (!ends_record) {
      for (int c = 0; c < kStates; ++c) {
        T& gap = residuals[samples * kStates + c];
        gap = (gap - parameters[2][c]) * inverse_gap_sigma[c];
      }
    }
    return true;
  }
};

// r_i = weight_i p_i, with its Jacobian by hand.
class WeightedZeroPrior final : public ceres::CostFunction {
 public:
  explicit WeightedZeroPrior(Vector weights) : weights_(std::move(weights)) {
    set_num_residuals(static_cast<int>(weights_.size()));
    mutable_parameter_block_sizes()->push_back(num_residuals());
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const int n = num_residuals();
    for (int i = 0; i < n; ++i) residuals[i] = weights_[i] * parameters[0][i];
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Matrix> jacobian(jacobians[0], n, n);
      jacobian.setZero();
      jacobian.diagonal() = weights_;
    }
    return true;
  }

 private:
  Vector weights_;
};

// The square roots of the decay's precision, one per free parameter.
inline Vector DecayWeights(const ParameterLayout& layout, double decay) {
  Vector weights = Vector::Zero(layout.num_free());
  for (int j = 0; j < layout.num_free(); ++j) {
    const int index = layout.free()[static_cast<size_t>(j)];
    if (layout.DecayGroupOf(index) >= 0) weights[j] = std::sqrt(decay);
  }
  return weights;
}

// A record, cut into segments: adds one residual block a segment, with
// `starts` (num_states x segments) and `parameters` as parameter blocks.
// `boundaries`: first samples of the segments, then the last sample.
template <typename Chain>
void AddPlainSegments(const Chain& chain, const IdentificationRecord& record,
                      const std::vector<int>& boundaries, const Vector& sigma,
                      const Vector& gap_sigma, Matrix* starts,
                      double* parameters, EvaluationTimes* times,
                      ceres::Problem* problem) {
  const int segments = static_cast<int>(boundaries.size()) - 1;
  for (int k = 0; k < segments; ++k) {
    auto* residual =
        new PlainSegmentResidual<Chain>{&chain,
                                        &record,
                                        boundaries[static_cast<size_t>(k)],
                                        boundaries[static_cast<size_t>(k) + 1],
                                        k + 1 == segments,
                                        sigma.cwiseInverse(),
                                        gap_sigma.cwiseInverse()};
    const int num_residuals = residual->num_residuals();
    auto cost = std::make_unique<
        ceres::DynamicAutoDiffCostFunction<PlainSegmentResidual<Chain>>>(
        residual);
    cost->AddParameterBlock(Chain::kStates);
    cost->AddParameterBlock(Chain::kParameters);
    std::vector<double*> blocks = {starts->col(k).data(), parameters};
    if (!residual->ends_record) {
      cost->AddParameterBlock(Chain::kStates);
      blocks.push_back(starts->col(k + 1).data());
    }
    cost->SetNumResiduals(num_residuals);
    problem->AddResidualBlock(new TimedCost(std::move(cost), times), nullptr,
                              blocks);
  }
}

// Boundaries of segments of nearly equal length, about `samples` samples each;
// as MultipleShooting::SetSegments cuts.
inline std::vector<int> CutSegments(int num_samples, int samples) {
  const int last = num_samples - 1;
  const int count =
      samples <= 0 ? 1 : std::max(1, (last + samples / 2) / samples);
  std::vector<int> boundaries;
  for (int k = 0; k <= count; ++k) {
    boundaries.push_back(static_cast<int>(int64_t{last} * k / count));
  }
  return boundaries;
}

}  // namespace benchmarks
}  // namespace pinode

#endif  // PINODE_TESTS_BENCHMARKS_PLAIN_FIT_H_
