#include "pinode/estimate/frf/frf_cost.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "pinode/base/parallel_for.h"
#include "pinode/base/statistics.h"

namespace pinode {
namespace {

// Pieces of the lines whose sums are added in their order, so that the result
// does not depend on the number of threads.
constexpr int kMostFrfPieces = 32;

int NumFrfPieces(const FrfRecord& record) {
  return static_cast<int>(
      std::min<Eigen::Index>(kMostFrfPieces, record.num_lines()));
}

Eigen::Index FirstFrfLine(const FrfRecord& record, int piece) {
  return record.num_lines() * piece / NumFrfPieces(record);
}

bool IsFrfPresent(const std::complex<double>& value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

}  // namespace

FrfCost::FrfCost(const FrfRecord& record, const StructuralDynamics& dynamics,
                 const ParameterLayout& layout, int num_threads)
    : record_(record),
      layout_(layout),
      num_threads_(num_threads),
      transfer_(record, dynamics, layout) {
  const Eigen::Index pairs = record.num_pairs();
  deviations_ = record.variances.size() > 0
                    ? Matrix(record.variances.cwiseSqrt())
                    : Matrix(Matrix::Ones(record.num_lines(), pairs));
  counts_ = Vector::Zero(pairs);
  least_noise_ = Vector::Zero(pairs);
  for (Eigen::Index p = 0; p < pairs; ++p) {
    for (Eigen::Index k = 0; k < record.num_lines(); ++k) {
      if (!IsFrfPresent(record.values(k, p))) continue;
      counts_[p] += 2.0;
      least_noise_[p] += std::norm(record.values(k, p) / deviations_(k, p));
    }
    least_noise_[p] = kLeastNoise * std::sqrt(least_noise_[p] / counts_[p]);
  }
}

bool FrfCost::SetPoint(const Vector& free) {
  if (at_.size() == free.size() && at_ == free) return true;
  at_.resize(0);
  if (!transfer_.SetPoint(free, &failure_)) return false;
  const Eigen::Index lines = record_.num_lines();
  modelled_.resize(lines, record_.num_pairs());
  ParallelFor(NumFrfPieces(record_), num_threads_, [&](int piece, int) {
    FrfTransfer::Line line;
    for (Eigen::Index k = FirstFrfLine(record_, piece);
         k < FirstFrfLine(record_, piece + 1); ++k) {
      transfer_.Compute(k, /*with_slopes=*/false, &line);
      modelled_.row(k) = line.values.transpose();
    }
  });
  if (!modelled_.allFinite()) {
    failure_ = "a frequency response of the model is not finite";
    return false;
  }
  residuals_ = (record_.values - modelled_).cwiseQuotient(deviations_);
  for (std::complex<double>& value : residuals_.reshaped()) {
    if (!IsFrfPresent(value)) value = 0.0;
  }
  squares_ = residuals_.colwise().squaredNorm().transpose();
  FindNoise();
  failure_.clear();
  at_ = free;
  return true;
}

void FrfCost::FindNoise() {
  sigma_ =
      record_.sigma.size() > 0
          ? record_.sigma
          : Vector((squares_.cwiseQuotient(counts_) + least_noise_.cwiseAbs2())
                       .cwiseSqrt());
}

bool FrfCost::Evaluate(const Vector& free, double* cost) {
  if (!SetPoint(free)) return false;
  *cost = 0.0;
  for (Eigen::Index p = 0; p < squares_.size(); ++p) {
    *cost += record_.sigma.size() > 0
                 ? 0.5 * squares_[p] / std::pow(sigma_[p], 2)
                 : 0.5 * counts_[p] *
                       std::log1p(squares_[p] / counts_[p] /
                                  std::pow(least_noise_[p], 2));
  }
  return std::isfinite(*cost);
}

bool FrfCost::Linearize(const Vector& free, CondensedSystem* system) {
  if (!Evaluate(free, &system->cost)) return false;
  const std::vector<int>& columns = transfer_.columns();
  const Eigen::Index own = static_cast<Eigen::Index>(columns.size());
  const int pieces = NumFrfPieces(record_);
  std::vector<Matrix> sums(static_cast<size_t>(pieces), Matrix::Zero(own, own));
  Matrix scores = Matrix::Zero(record_.num_lines(), own);
  ParallelFor(pieces, num_threads_, [&](int piece, int) {
    FrfTransfer::Line line;
    Matrix& sum = sums[static_cast<size_t>(piece)];
    for (Eigen::Index k = FirstFrfLine(record_, piece);
         k < FirstFrfLine(record_, piece + 1); ++k) {
      transfer_.Compute(k, /*with_slopes=*/true, &line);
      for (Eigen::Index p = 0; p < record_.num_pairs(); ++p) {
        if (!IsFrfPresent(record_.values(k, p))) {
          line.slopes.row(p).setZero();
        } else {
          line.slopes.row(p) /= deviations_(k, p) * sigma_[p];
        }
      }
      const ComplexVector weighted =
          residuals_.row(k).transpose().cwiseQuotient(sigma_);
      // Derivatives of the residuals have the opposite sign.
      scores.row(k) = -(line.slopes.adjoint() * weighted).real().transpose();
      sum += (line.slopes.adjoint() * line.slopes).real();
    }
  });
  Matrix information = Matrix::Zero(own, own);
  for (const Matrix& sum : sums) information += sum;
  const int num_free = layout_.num_free();
  system->gradient = Vector::Zero(num_free);
  system->hessian = Matrix::Zero(num_free, num_free);
  scores_ = Matrix::Zero(record_.num_lines(), num_free);
  for (Eigen::Index i = 0; i < own; ++i) {
    const int a = columns[static_cast<size_t>(i)];
    scores_.col(a) += scores.col(i);
    for (Eigen::Index j = 0; j < own; ++j) {
      system->hessian(a, columns[static_cast<size_t>(j)]) += information(i, j);
    }
  }
  system->gradient = scores_.colwise().sum().transpose();
  information_ = system->hessian;
  return system->gradient.allFinite() && system->hessian.allFinite();
}

double FrfCost::Memory() const {
  double time = 1.0;
  for (Eigen::Index p = 0; p < record_.num_pairs(); ++p) {
    time = std::max({time, AutocorrelationTime(residuals_.col(p).real()),
                     AutocorrelationTime(residuals_.col(p).imag())});
  }
  return time;
}

Matrix FrfCost::ScoreProducts() const {
  const Eigen::Index lines = record_.num_lines();
  const Eigen::Index length = std::clamp<Eigen::Index>(
      static_cast<Eigen::Index>(std::ceil(8.0 * Memory())), 5,
      std::max<Eigen::Index>(5, lines / 12));
  Matrix products = Matrix::Zero(scores_.cols(), scores_.cols());
  double count = 0.0;
  for (Eigen::Index first = 0; first < lines; first += length) {
    const Vector score =
        scores_.middleRows(first, std::min(length, lines - first))
            .colwise()
            .sum()
            .transpose();
    products += score * score.transpose();
    count += 1.0;
  }
  return count / std::max(1.0, count - 1.0) * products;
}

}  // namespace pinode
