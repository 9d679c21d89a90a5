#include "pinode/modal/forced_model.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/smooth_number.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Samples on either side by which a load acts without poles, and samples at
// either end of the stretch that do not count.
constexpr Eigen::Index kLoadReach = 24;
constexpr Eigen::Index kEdge = 16;
// Fewest rows for each column.
constexpr Eigen::Index kRowsPerColumn = 3;
// Size of a column, relative to others, that is rounding.
constexpr double kSmallestColumn = 1e-13;
// Size of a direction, relative to others, below which amplitudes are left at
// zero: a direction in which loads and the decay from the start do almost the
// same holds almost nothing, and would have amplitudes of noise without limit.
constexpr double kSmallestDirection = 1e-7;
// Smallest residual of a channel relative to its root mean square: rounding of
// samples, transforms and columns.
constexpr double kForcedRounding = 1e-12;
// Part of a column that is left by an orthogonal projection, below which the
// projection is repeated.
constexpr double kLittleLeft = 0.1;
constexpr int kMostForcedIterations = 10;
// Reduction of the cost, in variances of one row, below which the fit has
// converged.
constexpr double kSmallestForcedGain = 1e-2;
// Smallest part of the noise that a fit leaves at a line.
constexpr double kLeastLeft = 0.05;

struct Orthonormal {
  Matrix q;         // rows x rank
  Matrix triangle;  // columns = (orthonormal columns) * triangle
  Matrix products;  // those columns' products with `data`
  Matrix solution;  // of least squares
  Matrix inside;    // columns = q * inside, up to rounding
};

// Blocked Householder first: pivots are then those of a small triangle.
Orthonormal Orthonormalise(const Matrix& columns, const Matrix& data) {
  const Eigen::Index width = columns.cols();
  const Vector sizes =
      columns.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const Eigen::HouseholderQR<Matrix> tall(Matrix(columns * sizes.asDiagonal()));
  Orthonormal result;
  result.triangle =
      tall.matrixQR().topRows(width).triangularView<Eigen::Upper>();
  Matrix turned = data;
  turned.applyOnTheLeft(tall.householderQ().adjoint());
  result.products = turned.topRows(width);
  Eigen::ColPivHouseholderQR<Matrix> small(result.triangle);
  small.setThreshold(kSmallestColumn);
  Eigen::CompleteOrthogonalDecomposition<Matrix> large;
  large.setThreshold(kSmallestDirection);
  large.compute(result.triangle);
  result.solution = sizes.asDiagonal() * large.solve(result.products);
  const Matrix inner =
      small.householderQ() * Matrix::Identity(width, small.rank());
  result.q = Matrix::Zero(columns.rows(), inner.cols());
  result.q.topRows(width) = inner;
  result.q.applyOnTheLeft(tall.householderQ());
  result.triangle = result.triangle * sizes.cwiseInverse().asDiagonal();
  result.inside = inner.transpose() * result.triangle;
  return result;
}

// Transform of a stretch: its lines, so that white noise keeps its variance in
// real and imaginary parts.
ComplexVector Transform(const Vector& stretch) {
  Eigen::FFT<double> fft;
  ComplexVector lines;
  fft.fwd(lines, stretch);
  return std::sqrt(2.0 / static_cast<double>(stretch.size())) * lines;
}

void PutLine(Complex value, Eigen::Index line, Eigen::Index column,
             Matrix* rows) {
  (*rows)(2 * line, column) = value.real();
  (*rows)(2 * line + 1, column) = value.imag();
}

}  // namespace

ForcedModel::ForcedModel(const Matrix& outputs, const Matrix& inputs,
                         double step, const Band& band)
    : step_(step) {
  begin_ = kLoadReach;
  const Eigen::Index room = outputs.cols() - 2 * kLoadReach;
  length_ = room > 0 ? SmoothNumberBelow(room) : 0;
  ChooseLines(band, length_);
  const Eigen::Index lines = num_lines();
  const auto line_of = [this](Eigen::Index l) {
    return static_cast<Eigen::Index>(std::lround(angular_[l] / line_spacing()));
  };
  z_.resize(lines);
  for (Eigen::Index l = 0; l < lines; ++l) {
    z_[l] = std::polar(1.0, angular_[l] * step_);
  }
  raw_.resize(2 * lines, outputs.rows());
  rounding_.resize(outputs.rows());
  for (Eigen::Index c = 0; c < outputs.rows(); ++c) {
    const Vector stretch = outputs.row(c).segment(begin_, length_);
    const ComplexVector all = Transform(stretch);
    for (Eigen::Index l = 0; l < lines; ++l) {
      PutLine(all[line_of(l)], l, c, &raw_);
    }
    rounding_[c] = std::max(
        1e-300, kForcedRounding * kForcedRounding * stretch.squaredNorm() /
                    static_cast<double>(std::max<Eigen::Index>(1, length_)));
  }
  inputs_.resize(lines, inputs.rows());
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    const ComplexVector all = Transform(inputs.row(i).segment(begin_, length_));
    for (Eigen::Index l = 0; l < lines; ++l) inputs_(l, i) = all[line_of(l)];
  }
  FindCommon(inputs, length_);
  set_weights(Vector::Ones(outputs.rows()), Vector::Ones(lines));
}

// Lines next to the centres are those fewest half-widths away.
void ForcedModel::ChooseLines(const Band& band, Eigen::Index length) {
  const double spacing = line_spacing();
  std::vector<Eigen::Index> lines;
  const Eigen::Index first = std::max<Eigen::Index>(
      1,
      static_cast<Eigen::Index>(std::ceil(kTwoPi * band.lowest_hz / spacing)));
  for (Eigen::Index k = first;
       2 * k < length &&
       static_cast<double>(k) * spacing <= kTwoPi * band.highest_hz;
       ++k) {
    lines.push_back(k);
  }
  const size_t most = static_cast<size_t>(band.most_lines);
  if (lines.size() > most && !band.centres.empty()) {
    const auto distance = [&](Eigen::Index k) {
      double nearest = kInfinity;
      for (const Complex s : band.centres) {
        nearest = std::min(
            nearest, std::abs(spacing * static_cast<double>(k) - s.imag()) /
                         std::max(-s.real(), spacing));
      }
      return nearest;
    };
    std::vector<std::pair<double, Eigen::Index>> order;
    for (const Eigen::Index k : lines) order.emplace_back(distance(k), k);
    std::nth_element(order.begin(), order.begin() + band.most_lines,
                     order.end());
    lines.clear();
    for (size_t i = 0; i < most; ++i) lines.push_back(order[i].second);
    std::sort(lines.begin(), lines.end());
  }
  angular_.resize(static_cast<Eigen::Index>(lines.size()));
  for (size_t i = 0; i < lines.size(); ++i) {
    angular_[static_cast<Eigen::Index>(i)] =
        spacing * static_cast<double>(lines[i]);
  }
}

// U of a stretch that begins a sample later is z (U - (first - next)), because
// z^length = 1.
void ForcedModel::FindCommon(const Matrix& inputs, Eigen::Index length) {
  const Eigen::Index lines = num_lines();
  const Eigen::Index each = 2 * kLoadReach + 1;
  constexpr Eigen::Index kEdgePowers = 2 * kEdge;
  all_common_ = Matrix::Zero(2 * lines, kEdgePowers + inputs.rows() * each);
  const double size =
      std::sqrt(2.0 / static_cast<double>(std::max<Eigen::Index>(1, length)));
  for (Eigen::Index l = 0; l < lines; ++l) {
    Complex power = size * std::polar(1.0, -angular_[l] * step_ *
                                               static_cast<double>(kEdge));
    for (Eigen::Index j = 0; j < kEdgePowers; ++j) {
      PutLine(power, l, j, &all_common_);
      power *= z_[l];
    }
  }
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    for (Eigen::Index l = 0; l < lines; ++l) {
      const Eigen::Index middle = kEdgePowers + i * each + kLoadReach;
      PutLine(inputs_(l, i), l, middle, &all_common_);
      Complex later = inputs_(l, i);
      Complex earlier = inputs_(l, i);
      for (Eigen::Index j = 0; j < kLoadReach; ++j) {
        later = z_[l] * (later + size * (inputs(i, begin_ + j + length) -
                                         inputs(i, begin_ + j)));
        earlier = earlier / z_[l] + size * (inputs(i, begin_ - 1 - j) -
                                            inputs(i, begin_ - 1 - j + length));
        PutLine(later, l, middle + 1 + j, &all_common_);
        PutLine(earlier, l, middle - 1 - j, &all_common_);
      }
    }
  }
}

Eigen::Index ForcedModel::FewestLines(size_t poles, Eigen::Index inputs) {
  const Eigen::Index columns =
      2 * kEdge + inputs * (2 * kLoadReach + 1) +
      2 * (1 + inputs) * static_cast<Eigen::Index>(poles);
  return (kRowsPerColumn * columns + 1) / 2;
}

double ForcedModel::line_spacing() const {
  return kTwoPi /
         (step_ * static_cast<double>(std::max<Eigen::Index>(1, length_)));
}

void ForcedModel::set_weights(const Vector& channel_weights,
                              const Vector& line_weights) {
  const bool same = line_weights_.size() == line_weights.size() &&
                    line_weights_ == line_weights;
  channel_weights_ = channel_weights;
  line_weights_ = line_weights;
  const auto weighted = [&](const Matrix& rows) {
    Matrix result = rows;
    for (Eigen::Index l = 0; l < num_lines(); ++l) {
      result.middleRows(2 * l, 2) *= line_weights_[l];
    }
    return result;
  };
  const Matrix data = weighted(raw_);
  if (!same && data.rows() > all_common_.cols()) {
    common_ = Orthonormalise(weighted(all_common_), data).q;
  }
  data_ = WithoutCommon(data) * channel_weights_.asDiagonal();
}

Matrix ForcedModel::States(Complex s, bool derivatives) const {
  const Complex lambda = std::exp(s * step_);
  Matrix states(2 * num_lines(), own_columns());
  for (Eigen::Index l = 0; l < num_lines(); ++l) {
    const double weight = line_weights_[l];
    const Complex up = 1.0 / (z_[l] - lambda);
    const Complex down = 1.0 / (z_[l] - std::conj(lambda));
    for (Eigen::Index i = 0; i <= num_inputs(); ++i) {
      const Complex load = weight * (i == 0 ? z_[l] : inputs_(l, i - 1));
      Complex own = load * up;
      Complex other = load * down;
      if (derivatives) {
        own *= step_ * lambda * up;
        other *= step_ * std::conj(lambda) * down;
      }
      PutLine(own + other, l, 2 * i, &states);
      PutLine(Complex(0.0, 1.0) * (own - other), l, 2 * i + 1, &states);
    }
  }
  return states;
}

Matrix ForcedModel::WithoutCommon(Matrix columns) const {
  if (common_.cols() == 0) return columns;
  const Vector sizes = columns.colwise().norm();
  columns -= common_ * (common_.transpose() * columns);
  // Again, against rounding, where little is left.
  const Vector left = columns.colwise().norm();
  if ((left.array() < kLittleLeft * sizes.array()).any()) {
    columns -= common_ * (common_.transpose() * columns);
  }
  return columns;
}

Matrix ForcedModel::ColumnsOf(Complex s) const {
  const Matrix states = States(s, /*derivatives=*/false);
  Matrix columns = WithoutCommon(states);
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    if (columns.col(j).norm() < kSmallestColumn * states.col(j).norm()) {
      columns.col(j).setZero();
    }
  }
  return columns;
}

ForcedFit ForcedModel::Solve(const std::vector<Complex>& s) const {
  ForcedFit fit;
  fit.s = s;
  fit.residuals = data_;
  const Eigen::Index own = own_columns();
  Matrix basis(num_rows(), own * static_cast<Eigen::Index>(s.size()));
  for (size_t m = 0; m < s.size(); ++m) {
    basis.middleCols(own * static_cast<Eigen::Index>(m), own) = ColumnsOf(s[m]);
  }
  if (basis.cols() > 0) {
    Orthonormal parts = Orthonormalise(basis, data_);
    fit.q = std::move(parts.q);
    fit.triangle = std::move(parts.triangle);
    fit.products = std::move(parts.products);
    fit.amplitudes = std::move(parts.solution);
    fit.inside = std::move(parts.inside);
    for (int pass = 0; pass < 2; ++pass) {
      fit.residuals -= fit.q * (fit.q.transpose() * fit.residuals);
    }
  } else {
    fit.q = Matrix::Zero(num_rows(), 0);
  }
  fit.cost = fit.residuals.squaredNorm();
  return fit;
}

Matrix ForcedModel::Slopes(const ForcedFit& fit) const {
  const Eigen::Index own = own_columns();
  Matrix slopes(num_rows(), own * static_cast<Eigen::Index>(fit.s.size()));
  for (size_t m = 0; m < fit.s.size(); ++m) {
    slopes.middleCols(own * static_cast<Eigen::Index>(m), own) =
        States(fit.s[m], /*derivatives=*/true);
  }
  return WithoutCommon(std::move(slopes));
}

// A pair of columns with amplitudes (a, b) moves by d/d(Re s) = a x' + b x''
// and by d/d(Im s) = a x'' - b x', with x' and x'' the derivatives of its two
// columns by Re s.
Matrix ForcedModel::SlopeAmplitudes(const ForcedFit& fit,
                                    Eigen::Index channel) const {
  const Eigen::Index own = own_columns();
  const Eigen::Index poles = static_cast<Eigen::Index>(fit.s.size());
  Matrix u = Matrix::Zero(own * poles, 2 * poles);
  for (Eigen::Index j = 0; j < own * poles; j += 2) {
    const Eigen::Index at = 2 * (j / own);
    const double a = fit.amplitudes(j, channel);
    const double b = fit.amplitudes(j + 1, channel);
    u.block<2, 2>(j, at) << a, -b, b, a;
  }
  return u;
}

void ForcedModel::Refine(const std::vector<Complex>& centre,
                         const std::vector<double>& reach,
                         ForcedFit* fit) const {
  if (fit->s.empty()) return;
  const Eigen::Index poles = static_cast<Eigen::Index>(fit->s.size());
  const double degrees = static_cast<double>(num_rows() * num_channels());
  double damping = 1e-6;
  for (int iteration = 0; iteration < kMostForcedIterations; ++iteration) {
    Matrix outside = Slopes(*fit);
    outside -= fit->q * (fit->q.transpose() * outside);
    const Matrix gram = outside.transpose() * outside;
    const Matrix products = outside.transpose() * fit->residuals;
    Matrix normal = Matrix::Zero(2 * poles, 2 * poles);
    Vector gradient = Vector::Zero(2 * poles);
    for (Eigen::Index c = 0; c < num_channels(); ++c) {
      const Matrix u = SlopeAmplitudes(*fit, c);
      normal += u.transpose() * (gram * u);
      gradient += u.transpose() * products.col(c);
    }
    const Vector scale =
        normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    double gain = 0.0;
    for (int trial = 0; trial < 6 && !(gain > 0.0); ++trial) {
      Matrix system = scale.asDiagonal() * normal * scale.asDiagonal();
      system.diagonal().array() += damping;
      const Vector change = scale.cwiseProduct(
          Vector(system.ldlt().solve(scale.cwiseProduct(gradient))));
      damping *= 10.0;
      if (!change.allFinite()) continue;
      std::vector<Complex> s = fit->s;
      for (size_t m = 0; m < s.size(); ++m) {
        const Eigen::Index at = 2 * static_cast<Eigen::Index>(m);
        const Complex moved =
            s[m] + Complex(change[at], change[at + 1]) - centre[m];
        s[m] =
            centre[m] +
            moved * std::min(1.0, reach[m] / std::max(std::abs(moved), 1e-300));
        s[m] = {
            std::min(0.0, s[m].real()),
            std::clamp(s[m].imag(), 1e-3 * std::abs(centre[m]), kPi / step_)};
      }
      ForcedFit next = Solve(s);
      if (next.cost < fit->cost) {
        gain = fit->cost - next.cost;
        *fit = std::move(next);
      }
    }
    damping = std::max(1e-12, 1e-2 * damping);
    if (!(gain > kSmallestForcedGain * fit->cost / degrees)) return;
  }
}

ForcedModel::Gain ForcedModel::GainOf(const ForcedFit& fit, size_t m) const {
  const Eigen::Index own = own_columns();
  const Eigen::Index at = own * static_cast<Eigen::Index>(m);
  const Eigen::Index width = fit.triangle.cols();
  const auto rank_and_rest = [&fit](const Matrix& columns, Matrix* rest) {
    *rest = fit.products;
    if (columns.cols() == 0) return Eigen::Index{0};
    const Vector sizes =
        columns.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
    Eigen::ColPivHouseholderQR<Matrix> qr(Matrix(columns * sizes.asDiagonal()));
    qr.setThreshold(kSmallestColumn);
    const Matrix q =
        qr.householderQ() * Matrix::Identity(columns.rows(), qr.rank());
    *rest -= q * (q.transpose() * *rest);
    return qr.rank();
  };
  Matrix others(fit.triangle.rows(), width - own);
  others << fit.triangle.leftCols(at), fit.triangle.rightCols(width - at - own);
  Matrix rest_of_all;
  Matrix rest;
  const Eigen::Index rank = rank_and_rest(fit.triangle, &rest_of_all);
  Gain gain;
  gain.columns = rank - rank_and_rest(others, &rest);
  gain.squares =
      (rest.colwise().squaredNorm() - rest_of_all.colwise().squaredNorm())
          .transpose()
          .cwiseMax(0.0);
  return gain;
}

Vector ForcedModel::FractionsLeft(const ForcedFit& fit) const {
  // The channels share the unknowns of the poles, which are as many as the
  // decay's amplitudes of one channel.
  const double shared =
      1.0 + 1.0 / static_cast<double>(num_channels() * (1 + num_inputs()));
  const Vector common = common_.rowwise().squaredNorm();
  const Vector own = fit.q.rowwise().squaredNorm();
  Vector left(num_lines());
  for (Eigen::Index l = 0; l < left.size(); ++l) {
    const double removed = 0.5 * (common[2 * l] + common[2 * l + 1] +
                                  shared * (own[2 * l] + own[2 * l + 1]));
    left[l] = std::max(kLeastLeft, 1.0 - removed);
  }
  return left;
}

Matrix ForcedModel::Spectrum(const ForcedFit& fit) const {
  const Vector left = FractionsLeft(fit);
  Matrix spectrum(num_lines(), num_channels());
  for (Eigen::Index l = 0; l < num_lines(); ++l) {
    spectrum.row(l) =
        fit.residuals.middleRows(2 * l, 2).colwise().squaredNorm() /
        (2.0 * left[l]);
  }
  return spectrum;
}

}  // namespace pinode
