#include "pinode/estimate/shooting/start_equations.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/small_matrix.h"
#include "pinode/estimate/shooting/shooting_record.h"

namespace pinode {

StartEquations::StartEquations(const ShootingRecord& record, bool start_is_free,
                               double start_precision)
    : record_(record),
      num_states_(static_cast<int>(record.gaps().scales().size())),
      start_is_free_(start_is_free),
      start_precision_(start_precision),
      system_(record.num_segments(), num_states_) {}

bool StartEquations::HasFreeStarts() const { return record_.HasFreeStarts(); }

const Vector& StartEquations::scales() const { return record_.gaps().scales(); }

double StartEquations::Cost(double mu, const Matrix& starts) const {
  double sum = record_.gaps().Cost(mu, record_.results().ends, starts);
  for (const SegmentResult& result : record_.results().segments)
    sum += result.cost;
  if (start_is_free_) {
    sum += 0.5 * start_precision_ *
           starts.col(0).cwiseQuotient(scales()).squaredNorm();
  }
  return sum;
}

void StartEquations::Assemble(double mu, const Matrix& starts, int num_free,
                              Matrix* right) {
  const Eigen::Index ns = num_states_;
  const int segments = record_.num_segments();
  BlockTridiagonal& system = system_;
  system.SetZero();
  right->resize(num_free + 1, ns * segments);
  const auto gradient = [&](int k) {
    return right->middleCols(k * ns, ns).row(num_free).transpose();
  };
  const Vector precision = scales().cwiseAbs2().cwiseInverse();
  const Vector weight = mu * precision;
  Vector force = Vector::Zero(ns);  // of the gap before a segment
  Matrix weighted(ns, ns), coupling(ns, num_free);
  for (int k = 0; k < segments; ++k) {
    const SegmentResult& part = record_.results().of(k);
    system.diagonal(k) += part.start_hessian;
    gradient(k) = part.start_gradient - force;
    const bool has_gap = k + 1 < segments;
    if (has_gap) {
      const auto transition = part.end_sensitivity.leftCols(ns);
      weighted = weight.asDiagonal() * transition;
      force = record_.gaps().Force(mu, record_.results().ends, starts, k);
      system.diagonal(k).noalias() += transition.transpose() * weighted;
      system.coupling(k) = -weighted.transpose();
      system.diagonal(k + 1).diagonal() += weight;
      gradient(k).noalias() += transition.transpose() * force;
    }
    if (num_free == 0) continue;
    coupling.setZero();
    if (has_gap) {
      Multiply(weighted.transpose(), part.end_sensitivity.rightCols(num_free),
               coupling);
    }
    if (k > 0) {
      coupling -=
          weight.asDiagonal() *
          record_.results().of(k - 1).end_sensitivity.rightCols(num_free);
    }
    right->middleCols(k * ns, ns).topRows(num_free) =
        -part.cross - coupling.transpose();
  }
  if (start_is_free_) {
    system.diagonal(0).diagonal() += start_precision_ * precision;
    gradient(0) += start_precision_ * precision.cwiseProduct(starts.col(0));
  } else {
    // A start that is known takes no part.
    system.diagonal(0).setIdentity();
    if (segments > 1) system.coupling(0).setZero();
    right->leftCols(ns).setZero();
  }
}

void StartEquations::AddGaps(double mu, const Matrix& starts,
                             FreeEquations* equations) {
  // A few gaps at a time: each alone would read and write all of the sum.
  constexpr int kRows = 128;
  const int at_once = std::max(1, kRows / num_states_);
  const Vector weight = std::sqrt(mu) * scales().cwiseInverse();
  const Eigen::Index nf = equations->gradient.size();
  const int gaps = record_.num_segments() - 1;
  Matrix scaled;
  for (int first = 0; first < gaps; first += at_once) {
    const int count = std::min(at_once, gaps - first);
    scaled.resize(count * num_states_, nf);
    for (int k = 0; k < count; ++k) {
      const auto by_parameters =
          record_.results().of(first + k).end_sensitivity.rightCols(nf);
      scaled.middleRows(k * num_states_, num_states_) =
          weight.asDiagonal() * by_parameters;
      equations->gradient.noalias() +=
          by_parameters.transpose() *
          record_.gaps().Force(mu, record_.results().ends, starts, first + k);
    }
    equations->hessian.selfadjointView<Eigen::Lower>().rankUpdate(
        scaled.transpose());
  }
}

bool StartEquations::Eliminate(double mu, const Matrix& starts,
                               FreeEquations* equations) {
  const int nf = static_cast<int>(equations->gradient.size());
  if (!HasFreeStarts()) {
    right_ = Matrix::Zero(nf + 1, num_states_);
    return true;
  }
  Matrix& hessian = equations->hessian;
  Vector& gradient = equations->gradient;
  Assemble(mu, starts, nf, &right_);
  AddGaps(mu, starts, equations);
  double damping = 0.0;
  while (!system_.Factor(damping)) {
    damping = std::max(1e-12, 10.0 * damping);
    if (damping > 1.0) return false;
  }
  system_.SolveLower(&right_);
  const auto projected = right_.topRows(nf);
  // Of many columns at once Eigen's rank update takes half as long again.
  constexpr Eigen::Index kColumns = 160;
  for (Eigen::Index i = 0; i < projected.cols(); i += kColumns) {
    hessian.selfadjointView<Eigen::Lower>().rankUpdate(
        projected.middleCols(i, std::min(kColumns, projected.cols() - i)),
        -1.0);
  }
  gradient.noalias() += projected * right_.row(nf).transpose();
  system_.SolveUpper(&right_);
  return true;
}

double StartEquations::DataCurvature() const {
  double sum = 0.0;
  for (const SegmentResult& part : record_.results().segments) {
    sum +=
        part.start_hessian.diagonal().dot(scales().cwiseAbs2()) / num_states_;
  }
  return sum;
}

}  // namespace pinode
