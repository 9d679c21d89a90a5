#include "pinode/modal/frf/lscf.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/parallel_for.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Part added to the diagonal of the equations of the numerators, against
// rounding: lines over less than the half circle leave them ill-conditioned.
constexpr double kRidge = 1e-12;

// Sums over lines of products of signals with cos(d w T) and sin(d w T), d = 0
// ... order: columns are signals.
struct Sums {
  Matrix cosine_real, sine_imaginary;

  // Real part of the sum of signal * exp(i d w T), for any sign of d.
  double At(Index d, Index signal) const {
    const Index size = std::abs(d);
    const double sine = d < 0 ? -1.0 : 1.0;
    return cosine_real(size, signal) - sine * sine_imaginary(size, signal);
  }
};

class Lscf {
 public:
  Lscf(const FrfData& data, int max_order)
      : outputs_(data.outputs),
        references_(data.references),
        order_(max_order),
        step_(kPi / data.angular[data.num_lines() - 1]),
        scaled_(data.h) {
    Scale();
    FindSums(data.angular);
    Eliminate();
  }

  // Poles of one order with their participations.
  LscfPoles Poles(int order) const {
    const Index n = order;
    const Index width = (n + 1) * references_;
    Matrix m = products_.topLeftCorner(width, width);
    for (const Matrix& reduced : reduced_) {
      const auto part = reduced.topLeftCorner(n + 1, width);
      m.noalias() -= part.transpose() * part;
    }
    const Index rest = width - references_;
    // A_0 = I.
    const Matrix solution =
        Eigen::PartialPivLU<Matrix>(m.bottomRightCorner(rest, rest))
            .solve(-m.bottomLeftCorner(rest, references_));
    Matrix a(width, references_);
    a << Matrix::Identity(references_, references_), solution;
    return Roots(order, a);
  }

 private:
  // Makes references and outputs equally large.
  void Scale() {
    reference_scales_.resize(references_);
    for (Index j = 0; j < references_; ++j) {
      auto block = scaled_.middleCols(outputs_ * j, outputs_);
      const double size = block.norm();
      reference_scales_[j] = size > 0.0 ? size : 1.0;
      block /= reference_scales_[j];
    }
    output_scales_.resize(outputs_);
    for (Index o = 0; o < outputs_; ++o) {
      double square = 0.0;
      for (Index j = 0; j < references_; ++j) {
        square += scaled_.col(o + outputs_ * j).squaredNorm();
      }
      output_scales_[o] = square > 0.0 ? std::sqrt(square) : 1.0;
      for (Index j = 0; j < references_; ++j) {
        scaled_.col(o + outputs_ * j) /= output_scales_[o];
      }
    }
  }

  // Signals: the FRFs, then the products conj(H_oi) H_oj summed over outputs,
  // then 1.
  void FindSums(const Vector& angular) {
    const Index lines = angular.size();
    const Index pairs = outputs_ * references_;
    const Index squares = references_ * references_;
    ComplexMatrix signals(lines, pairs + squares + 1);
    signals.leftCols(pairs) = scaled_;
    for (Index i = 0; i < references_; ++i) {
      for (Index j = 0; j < references_; ++j) {
        signals.col(pairs + i * references_ + j) =
            (scaled_.middleCols(outputs_ * i, outputs_)
                 .conjugate()
                 .cwiseProduct(scaled_.middleCols(outputs_ * j, outputs_)))
                .rowwise()
                .sum();
      }
    }
    signals.rightCols(1).setOnes();
    const Vector powers =
        Vector::LinSpaced(order_ + 1, 0.0, static_cast<double>(order_));
    const Matrix angles = step_ * angular * powers.transpose();
    const Matrix real = signals.real();
    const Matrix imaginary = signals.imag();
    sums_.cosine_real = angles.array().cos().matrix().transpose() * real;
    sums_.sine_imaginary =
        angles.array().sin().matrix().transpose() * imaginary;
  }

  void Eliminate() {
    const Index pairs = outputs_ * references_;
    const Index size = order_ + 1;
    const Index one = pairs + references_ * references_;
    Matrix r(size, size);
    for (Index a = 0; a < size; ++a) {
      for (Index b = 0; b < size; ++b) r(a, b) = sums_.At(b - a, one);
    }
    r.diagonal() *= 1.0 + kRidge;
    triangle_ = r.llt().matrixL();
    for (Index o = 0; o < outputs_; ++o) {
      Matrix s(size, size * references_);
      for (Index a = 0; a < size; ++a) {
        for (Index b = 0; b < size; ++b) {
          for (Index j = 0; j < references_; ++j) {
            s(a, b * references_ + j) = -sums_.At(b - a, o + outputs_ * j);
          }
        }
      }
      triangle_.triangularView<Eigen::Lower>().solveInPlace(s);
      reduced_.push_back(std::move(s));
    }
    products_.resize(size * references_, size * references_);
    for (Index a = 0; a < size; ++a) {
      for (Index b = 0; b < size; ++b) {
        for (Index i = 0; i < references_; ++i) {
          for (Index j = 0; j < references_; ++j) {
            products_(a * references_ + i, b * references_ + j) =
                sums_.At(b - a, pairs + i * references_ + j);
          }
        }
      }
    }
  }

  // A left null vector w^T A(z) = 0 is a participation, a right one A(z) v = 0
  // leads to the shape (sum_r z^r b_or) v.
  LscfPoles Roots(int order, const Matrix& a) const {
    LscfPoles result;
    const Index p = references_;
    const Index size = static_cast<Index>(order) * p;
    const auto coefficient = [&](Index r) { return a.middleRows(r * p, p); };
    // With A_0 = I: companion matrix of 1 / z.
    Matrix companion = Matrix::Zero(size, size);
    for (Index r = 1; r <= order; ++r) {
      companion.block(0, (r - 1) * p, p, p) = -coefficient(r).transpose();
    }
    companion.bottomLeftCorner(size - p, size - p).setIdentity();
    const Eigen::EigenSolver<Matrix> solver(companion);
    if (solver.info() != Eigen::Success) return result;
    std::vector<Matrix> numerators;
    const auto triangle = triangle_.topLeftCorner(order + 1, order + 1);
    for (const Matrix& reduced : reduced_) {
      numerators.push_back(
          -triangle.transpose().triangularView<Eigen::Upper>().solve(
              Matrix(reduced.topLeftCorner(order + 1, a.rows()) * a)));
    }
    for (Index k = 0; k < size; ++k) {
      const Complex inverse = solver.eigenvalues()[k];
      if (!(std::abs(inverse) > 1.0) || !(inverse.imag() < 0.0)) continue;
      const Complex z = 1.0 / inverse;
      SubspacePole pole;
      pole.order = order;
      pole.s = std::log(z) / step_;
      ComplexMatrix at = ComplexMatrix::Zero(p, p);
      ComplexVector powers(order + 1);
      Complex power = 1.0;
      for (Index r = 0; r <= order; ++r, power *= z) {
        powers[r] = power;
        at += power * coefficient(r).cast<Complex>();
      }
      const Eigen::JacobiSVD<ComplexMatrix> svd(
          at, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const ComplexVector right = svd.matrixV().col(p - 1);
      pole.shape.resize(outputs_);
      for (Index o = 0; o < outputs_; ++o) {
        const ComplexVector row =
            numerators[static_cast<size_t>(o)].transpose() * powers;
        pole.shape[o] = output_scales_[o] * right.conjugate().dot(row);
      }
      ComplexVector left = svd.matrixU().col(p - 1).conjugate();
      left = left.cwiseProduct(reference_scales_.cast<Complex>());
      Index largest = 0;
      left.cwiseAbs().maxCoeff(&largest);
      if (!(pole.shape.norm() > 0.0) || !pole.shape.allFinite() ||
          !left.allFinite()) {
        continue;
      }
      result.poles.push_back(std::move(pole));
      result.participations.push_back(left / left[largest]);
    }
    return result;
  }

  const Index outputs_;
  const Index references_;
  const Index order_;
  const double step_;
  ComplexMatrix scaled_;
  Vector reference_scales_, output_scales_;
  Sums sums_;
  Matrix triangle_;              // of the numerators' equations
  std::vector<Matrix> reduced_;  // per output
  Matrix products_;
};

// Sets the influences of poles [begin, end) of one order.
void SetInfluences(const std::vector<LscfPoles>& by_order, size_t at,
                   LscfPoles* own) {
  for (SubspacePole& pole : own->poles) {
    double nearest = kInfinity;
    Complex difference;
    for (const size_t other : {at - 1, at + 1}) {
      if (other >= by_order.size()) continue;
      for (const SubspacePole& next : by_order[other].poles) {
        const double distance = std::abs(next.s - pole.s);
        if (distance < nearest) {
          nearest = distance;
          difference = next.s - pole.s;
        }
      }
    }
    if (!(nearest < kInfinity)) difference = std::abs(pole.s);
    pole.s_influence.resize(2);
    pole.s_influence << difference, -difference;
    pole.shape_influence = ComplexMatrix::Zero(pole.shape.size(), 2);
  }
}

}  // namespace

LscfPoles FindLscfPoles(const FrfData& data, int max_order, int num_threads) {
  const Lscf lscf(data, max_order);
  std::vector<LscfPoles> by_order(static_cast<size_t>(max_order / 2));
  ParallelFor(max_order / 2, num_threads, [&](int index, int) {
    // The largest orders first: they take longest.
    const int number = max_order / 2 - index;
    by_order[static_cast<size_t>(number - 1)] = lscf.Poles(2 * number);
  });
  LscfPoles all;
  for (size_t i = 0; i < by_order.size(); ++i) {
    LscfPoles own = by_order[i];
    SetInfluences(by_order, i, &own);
    for (size_t k = 0; k < own.poles.size(); ++k) {
      all.poles.push_back(std::move(own.poles[k]));
      all.participations.push_back(std::move(own.participations[k]));
    }
  }
  return all;
}

}  // namespace pinode
