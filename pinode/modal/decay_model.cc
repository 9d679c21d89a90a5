#include "pinode/modal/decay_model.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

constexpr int kMostIterations = 40;
// Reduction of the cost, in variances of one sample, below which the fit has
// converged.
constexpr double kSmallestGain = 1e-3;
// Frequencies on either side at which noise is measured.
constexpr int kNoiseNeighbours = 12;

}  // namespace

std::vector<Eigen::Index> DecayFit::Columns() const {
  std::vector<Eigen::Index> columns;
  Eigen::Index next = 0;
  for (const DecayTerm& term : terms) {
    columns.push_back(next);
    next += term.vibrates() ? 2 : 1;
  }
  columns.push_back(next);
  return columns;
}

ComplexVector DecayFit::Shape(size_t term) const {
  const Eigen::Index column = Columns()[term];
  ComplexVector shape = ComplexVector::Zero(amplitudes.cols());
  shape.real() = amplitudes.row(column).transpose();
  if (terms[term].vibrates()) {
    shape.imag() = -amplitudes.row(column + 1).transpose();
  }
  return shape;
}

// Derivatives of the basis by the poles: t exp(s t), weighted, columns as those
// of the terms. The part outside of the span of the basis, and its Gram matrix.
struct DecayModel::Slopes {
  // First column, and first parameter, of each term, and their number.
  std::vector<Eigen::Index> columns;
  Matrix all;
  Matrix outside;
  Matrix gram;
};

DecayModel::DecayModel(const Matrix& samples, double step)
    : data_(samples.transpose()),
      samples_(data_),
      step_(step),
      row_weights_(Vector::Ones(data_.rows())),
      channel_weights_(Vector::Ones(data_.cols())) {}

void DecayModel::set_channel_weights(const Vector& weights) {
  channel_weights_ = weights;
  samples_ = row_weights_.asDiagonal() * data_ * channel_weights_.asDiagonal();
}

void DecayModel::set_row_weights(const Vector& weights) {
  row_weights_ = weights;
  set_channel_weights(channel_weights_);
}

bool DecayModel::IsAllowed(const DecayTerm& term) const {
  const double duration = step_ * static_cast<double>(num_samples());
  if (term.s.real() > 1.0 / duration) return false;
  // Shorter decays are single samples.
  if (term.s.real() < -2.0 / step_) return false;
  return term.s.imag() >= 0.0 && term.s.imag() < kPi / step_;
}

void DecayModel::AppendColumns(const DecayTerm& term, Matrix* basis,
                               Eigen::Index column) const {
  for (Eigen::Index k = 0; k < num_samples(); ++k) {
    const double t = step_ * static_cast<double>(k);
    const double size = row_weights_[k] * std::exp(term.s.real() * t);
    if (!term.vibrates()) {
      (*basis)(k, column) = size;
      continue;
    }
    (*basis)(k, column) = size * std::cos(term.s.imag() * t);
    (*basis)(k, column + 1) = size * std::sin(term.s.imag() * t);
  }
}

DecayFit DecayModel::Solve(const std::vector<DecayTerm>& terms) const {
  DecayFit fit;
  fit.terms = terms;
  const std::vector<Eigen::Index> columns = fit.Columns();
  const Eigen::Index width = columns.back() + 1;
  fit.basis.resize(num_samples(), width);
  for (size_t i = 0; i < terms.size(); ++i) {
    AppendColumns(terms[i], &fit.basis, columns[i]);
  }
  fit.basis.col(width - 1) = row_weights_;
  const Vector sizes = fit.basis.colwise().norm().transpose().cwiseMax(1e-300);
  const Eigen::ColPivHouseholderQR<Matrix> qr(
      Matrix(fit.basis * sizes.cwiseInverse().asDiagonal()));
  fit.q = qr.householderQ() * Matrix::Identity(num_samples(), qr.rank());
  fit.amplitudes = sizes.cwiseInverse().asDiagonal() * qr.solve(samples_);
  fit.residuals = samples_ - fit.q * (fit.q.transpose() * samples_);
  // Once more, against rounding.
  fit.residuals -= fit.q * (fit.q.transpose() * fit.residuals);
  fit.cost = fit.residuals.squaredNorm();
  return fit;
}

DecayModel::Slopes DecayModel::FindSlopes(const DecayFit& fit) const {
  Slopes slopes;
  slopes.columns = fit.Columns();
  const Vector times =
      step_ * Vector::LinSpaced(num_samples(), 0.0,
                                static_cast<double>(num_samples() - 1));
  slopes.all = times.asDiagonal() * fit.basis.leftCols(slopes.columns.back());
  slopes.outside = slopes.all - fit.q * (fit.q.transpose() * slopes.all);
  slopes.gram = slopes.outside.transpose() * slopes.outside;
  return slopes;
}

// A channel's model moves by d/d(Re s) = t (Re e Re a - Im e Im a) and by
// d/d(Im s) = -t (Re e Im a + Im e Re a), e = exp(s t).
namespace {

// Coefficients of the two columns of slopes for the parameters of a term.
Eigen::Matrix2d Coefficients(const DecayFit& fit, Eigen::Index column,
                             Eigen::Index channel) {
  const double re = fit.amplitudes(column, channel);         // Re a
  const double minus = fit.amplitudes(column + 1, channel);  // -Im a
  Eigen::Matrix2d u;
  u << re, minus, minus, -re;
  return u;
}

// Returns U, columns of slopes x parameters, for a channel.
Matrix Combination(const DecayFit& fit,
                   const std::vector<Eigen::Index>& columns,
                   Eigen::Index channel) {
  const Eigen::Index count = columns.back();
  Matrix u = Matrix::Zero(count, count);
  for (size_t i = 0; i < fit.terms.size(); ++i) {
    const Eigen::Index at = columns[i];
    if (fit.terms[i].vibrates()) {
      u.block<2, 2>(at, at) = Coefficients(fit, at, channel);
    } else {
      u(at, at) = fit.amplitudes(at, channel);
    }
  }
  return u;
}

}  // namespace

Matrix DecayModel::NormalMatrix(const DecayFit& fit,
                                const Slopes& slopes) const {
  const Eigen::Index count = slopes.columns.back();
  Matrix normal = Matrix::Zero(count, count);
  for (Eigen::Index c = 0; c < num_channels(); ++c) {
    const Matrix u = Combination(fit, slopes.columns, c);
    normal += u.transpose() * slopes.gram * u;
  }
  return normal;
}

Vector DecayModel::Gradient(const DecayFit& fit, const Slopes& slopes,
                            const Matrix& residuals) const {
  const Matrix products = slopes.outside.transpose() * residuals;
  Vector gradient = Vector::Zero(slopes.columns.back());
  for (Eigen::Index c = 0; c < num_channels(); ++c) {
    gradient +=
        Combination(fit, slopes.columns, c).transpose() * products.col(c);
  }
  return gradient;
}

std::vector<DecayTerm> DecayModel::Moved(const std::vector<DecayTerm>& terms,
                                         const Vector& change) const {
  std::vector<DecayTerm> moved = terms;
  Eigen::Index next = 0;
  for (DecayTerm& term : moved) {
    if (term.vibrates()) {
      const Complex s = term.s + Complex(change[next], change[next + 1]);
      // A pair that meets at the real axis turns back.
      term.s = {s.real(), std::max(s.imag(), 0.1 * term.s.imag())};
      next += 2;
    } else {
      term.s += change[next];
      next += 1;
    }
  }
  return moved;
}

void DecayModel::Refine(DecayFit* fit) const {
  if (fit->terms.empty()) return;
  double damping = 1e-6;
  const double degrees = static_cast<double>(num_samples() * num_channels());
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const Slopes slopes = FindSlopes(*fit);
    const Matrix normal = NormalMatrix(*fit, slopes);
    const Vector gradient = Gradient(*fit, slopes, fit->residuals);
    const Vector diagonal = normal.diagonal().cwiseMax(1e-300);
    const Vector scale = diagonal.cwiseSqrt().cwiseInverse();
    bool better = false;
    double gain = 0.0;
    for (int trial = 0; trial < 12 && !better; ++trial) {
      Matrix system = scale.asDiagonal() * normal * scale.asDiagonal();
      system.diagonal().array() += damping;
      const Vector change =
          scale.cwiseProduct(system.ldlt().solve(scale.cwiseProduct(gradient)));
      const std::vector<DecayTerm> terms = Moved(fit->terms, change);
      const bool allowed =
          change.allFinite() &&
          std::all_of(terms.begin(), terms.end(),
                      [this](const DecayTerm& t) { return IsAllowed(t); });
      if (allowed) {
        DecayFit next = Solve(terms);
        if (next.cost < fit->cost) {
          gain = fit->cost - next.cost;
          *fit = std::move(next);
          better = true;
          damping = std::max(1e-12, 0.1 * damping);
          break;
        }
      }
      damping *= 10.0;
    }
    if (!better || gain < kSmallestGain * fit->cost / degrees) return;
  }
}

double DecayModel::Explained(const DecayFit& fit, const DecayTerm& term) const {
  Matrix columns(num_samples(), term.vibrates() ? 2 : 1);
  AppendColumns(term, &columns, 0);
  columns -= fit.q * (fit.q.transpose() * columns);
  const Matrix gram = columns.transpose() * columns;
  const Matrix products = columns.transpose() * fit.residuals;
  if (!(gram.diagonal().minCoeff() > 0.0)) return 0.0;
  return std::max(0.0,
                  products.cwiseProduct(gram.ldlt().solve(products)).sum());
}

double DecayModel::NoiseNear(const DecayFit& fit, const DecayTerm& term) const {
  const double duration = step_ * static_cast<double>(num_samples());
  const double spacing = std::max(kTwoPi / duration, kPi * -term.s.real());
  const double channels = static_cast<double>(num_channels());
  double energy = 0.0;
  double free = 0.0;
  double count = 0.0;
  Matrix columns(num_samples(), 2);
  for (int j = -kNoiseNeighbours; j <= kNoiseNeighbours; ++j) {
    const double w = term.s.imag() + static_cast<double>(j) * spacing;
    if (w <= 0.5 * spacing || w >= kPi / step_ - 0.5 * spacing) continue;
    AppendColumns({{term.s.real(), w}}, &columns, 0);
    energy += (columns.transpose() * fit.residuals).squaredNorm();
    // The fit has removed noise: amplitudes of each channel and, shared by the
    // channels, as many unknowns of poles.
    const double all = columns.squaredNorm();
    const double removed = (fit.q.transpose() * columns).squaredNorm();
    const double rest =
        std::max(0.05 * all, all - (1.0 + 1.0 / channels) * removed);
    free += channels * rest;
    count += 2.0 * channels * rest / all;
  }
  const double overall =
      fit.cost / (static_cast<double>(num_samples()) * channels);
  if (count < 8.0) return overall;
  return energy / free * (1.0 + 2.0 * std::sqrt(2.0 / count));
}

DecayModel::Influences DecayModel::FindInfluences(
    const DecayFit& fit, int count,
    const std::function<Matrix(int)>& series) const {
  const Slopes slopes = FindSlopes(fit);
  const Matrix normal = NormalMatrix(fit, slopes);
  const Vector scale =
      normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Matrix scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::CompleteOrthogonalDecomposition<Matrix> solver(scaled);
  const Vector sizes = fit.basis.colwise().norm().transpose().cwiseMax(1e-300);
  const Eigen::ColPivHouseholderQR<Matrix> qr(
      Matrix(fit.basis * sizes.cwiseInverse().asDiagonal()));
  const size_t terms = fit.terms.size();
  Influences influences;
  influences.s.resize(static_cast<Eigen::Index>(terms), count);
  influences.shapes.assign(terms, ComplexMatrix(num_channels(), count));
  const double unknowns =
      static_cast<double>(fit.basis.cols() * num_channels() + normal.cols());
  const double degrees = std::max(
      1.0, static_cast<double>(num_samples() * num_channels()) - unknowns);
  const Matrix bound = fit.cost / degrees *
                       (scale.asDiagonal() * Matrix(solver.pseudoInverse()) *
                        scale.asDiagonal());
  for (size_t i = 0; i < terms; ++i) {
    const Eigen::Index at = slopes.columns[i];
    Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
    const Eigen::Index size = fit.terms[i].vibrates() ? 2 : 1;
    own.topLeftCorner(size, size) = bound.block(at, at, size, size);
    influences.bounds.push_back(own);
  }
  for (int b = 0; b < count; ++b) {
    Matrix noise = row_weights_.asDiagonal() * series(b).transpose() *
                   channel_weights_.asDiagonal();
    const Vector change = scale.cwiseProduct(Vector(solver.solve(
        Vector(scale.cwiseProduct(Gradient(fit, slopes, noise))))));
    for (Eigen::Index c = 0; c < num_channels(); ++c) {
      noise.col(c).noalias() -=
          slopes.all * (Combination(fit, slopes.columns, c) * change);
    }
    const Matrix moved = sizes.cwiseInverse().asDiagonal() * qr.solve(noise) *
                         channel_weights_.cwiseInverse().asDiagonal();
    for (size_t i = 0; i < terms; ++i) {
      const Eigen::Index at = slopes.columns[i];
      const bool vibrates = fit.terms[i].vibrates();
      influences.s(static_cast<Eigen::Index>(i), b) =
          vibrates ? Complex(change[at], change[at + 1]) : Complex(change[at]);
      influences.shapes[i].col(b).real() = moved.row(at).transpose();
      if (vibrates) {
        influences.shapes[i].col(b).imag() = -moved.row(at + 1).transpose();
      } else {
        influences.shapes[i].col(b).imag().setZero();
      }
    }
  }
  return influences;
}

}  // namespace pinode
