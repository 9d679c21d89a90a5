#include "pinode/modal/forced_shapes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Size of a column outside of others, relative to its own, that is rounding.
constexpr double kSmallestForcedPart = 1e-10;
constexpr int kShapeIterations = 12;
// Size of a direction, relative to others, that counts for a first guess.
constexpr double kLargeDirection = 1e-3;
// Parts of the spectrum with a noise of their own, and fewest lines of each.
constexpr Eigen::Index kMostNoiseParts = 64;
constexpr Eigen::Index kFewestNoiseLines = 24;
// Deviations by which levels of white noise may differ.
constexpr double kMostForcedScatter = 5.0;
// Relative standard deviation of the sampling step, as in a decay.
constexpr double kForcedClock = 5e-13;
constexpr Eigen::Index kMostDegrees = 1000;

// Real and imaginary part of factor times (a, b).
Eigen::Matrix2d Product(Complex factor) {
  Eigen::Matrix2d m;
  m << factor.real(), -factor.imag(), factor.imag(), factor.real();
  return m;
}

// Rows: pairs of each participation. Columns: real, imaginary part of a shape.
Matrix TimesParticipation(const ComplexVector& participation) {
  Matrix m(2 * participation.size(), 2);
  for (Eigen::Index i = 0; i < participation.size(); ++i) {
    m.middleRows(2 * i, 2) = Product(participation[i]);
  }
  return m;
}

ComplexVector Paired(const Vector& pairs) {
  ComplexVector result(pairs.size() / 2);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    result[i] = {pairs[2 * i], pairs[2 * i + 1]};
  }
  return result;
}

// Splits the data's coordinates t_c (columns) into gain * (shape_c times
// participation): alternating least squares.
ComplexVector FindParticipation(const Matrix& gain, const Matrix& t) {
  Eigen::CompleteOrthogonalDecomposition<Matrix> free;
  free.setThreshold(kLargeDirection);
  free.compute(gain);
  Eigen::Index strongest = 0;
  t.colwise().squaredNorm().maxCoeff(&strongest);
  ComplexVector participation = Paired(free.solve(Vector(t.col(strongest))));
  const Eigen::Index own = gain.cols();
  for (int iteration = 0; iteration < kShapeIterations; ++iteration) {
    const double size = participation.norm();
    if (!(size > 0.0)) break;
    participation /= size;
    const Matrix columns = gain * TimesParticipation(participation);
    const Matrix shapes = columns.colPivHouseholderQr().solve(t);
    Matrix all(t.rows() * t.cols(), own);
    Vector values(t.rows() * t.cols());
    for (Eigen::Index c = 0; c < t.cols(); ++c) {
      const Eigen::Matrix2d turn = Product({shapes(0, c), shapes(1, c)});
      for (Eigen::Index j = 0; j < own; j += 2) {
        all.block(c * t.rows(), j, t.rows(), 2) = gain.middleCols(j, 2) * turn;
      }
      values.segment(c * t.rows(), t.rows()) = t.col(c);
    }
    participation = Paired(
        Eigen::CompleteOrthogonalDecomposition<Matrix>(all).solve(values));
  }
  return participation;
}

// Orthonormal columns of those of `columns` that are more than rounding
// relative to `sizes`.
Matrix OrthonormalPart(const Matrix& columns, const Vector& sizes) {
  const Eigen::Index most = std::min(columns.rows(), columns.cols());
  const Vector inverse = sizes.cwiseMax(1e-300).cwiseInverse();
  const Eigen::ColPivHouseholderQR<Matrix> qr(
      Matrix(columns * inverse.asDiagonal()));
  Eigen::Index rank = 0;
  while (rank < most &&
         std::abs(qr.matrixR()(rank, rank)) > kSmallestForcedPart) {
    ++rank;
  }
  return qr.householderQ() * Matrix::Identity(columns.rows(), rank);
}

// Mean of the residuals' products over parts of the spectrum.
class ForcedNoise {
 public:
  ForcedNoise(const ForcedModel& model, const ForcedFit& fit)
      : channels_(model.num_channels()) {
    const Eigen::Index lines = model.num_lines();
    const Eigen::Index parts =
        std::clamp<Eigen::Index>(lines / kFewestNoiseLines, 1, kMostNoiseParts);
    const Vector left = model.FractionsLeft(fit);
    const Vector rounding =
        model.rounding().cwiseProduct(model.channel_weights().cwiseAbs2());
    ComplexMatrix all = ComplexMatrix::Zero(channels_, channels_);
    for (Eigen::Index part = 0; part < parts; ++part) {
      const Eigen::Index first = part * lines / parts;
      const Eigen::Index last = (part + 1) * lines / parts;
      ComplexMatrix sum = ComplexMatrix::Zero(channels_, channels_);
      double level = 0.0;
      for (Eigen::Index l = first; l < last; ++l) {
        const ComplexVector e =
            (fit.residuals.row(2 * l).cast<Complex>() +
             Complex(0.0, 1.0) * fit.residuals.row(2 * l + 1).cast<Complex>())
                .transpose();
        sum += e * e.adjoint() / (2.0 * left[l]);
        level += std::pow(model.line_weights()[l], 2);
      }
      all += sum;
      const double count = static_cast<double>(last - first);
      firsts_.push_back(first);
      products_.push_back(sum / count);
      floors_.push_back(rounding * level / count);
    }
    firsts_.push_back(lines);
    all /= static_cast<double>(lines);
    is_white_ = IsWhite(all);
    for (size_t part = 0; part < products_.size(); ++part) {
      if (is_white_) products_[part] = all;
      for (Eigen::Index c = 0; c < channels_; ++c) {
        products_[part](c, c) =
            std::max(products_[part](c, c).real(), floors_[part][c]);
      }
    }
    const double degrees =
        2.0 * static_cast<double>(is_white_ ? lines : lines / parts);
    degrees_ = std::min(kMostDegrees, static_cast<Eigen::Index>(degrees));
  }

  Eigen::Index parts() const {
    return static_cast<Eigen::Index>(products_.size());
  }
  Eigen::Index degrees() const { return degrees_; }

  // Covariance of M^T e over all lines. Rows of it: all columns of M for the
  // first channel, and so on.
  Matrix CovarianceOf(const Matrix& m) const {
    const Eigen::Index width = m.cols();
    Matrix covariance = Matrix::Zero(channels_ * width, channels_ * width);
    for (size_t part = 0; part < products_.size(); ++part) {
      const Eigen::Index first = firsts_[part];
      const Eigen::Index count = firsts_[part + 1] - first;
      Matrix real(count, width);
      Matrix imaginary(count, width);
      for (Eigen::Index l = 0; l < count; ++l) {
        real.row(l) = m.row(2 * (first + l));
        imaginary.row(l) = m.row(2 * (first + l) + 1);
      }
      const Matrix gram =
          real.transpose() * real + imaginary.transpose() * imaginary;
      const Matrix half = imaginary.transpose() * real;
      const Matrix turned = half - half.transpose();
      for (Eigen::Index c = 0; c < channels_; ++c) {
        for (Eigen::Index d = 0; d < channels_; ++d) {
          const Complex product = products_[part](c, d);
          covariance.block(c * width, d * width, width, width) +=
              product.real() * gram + product.imag() * turned;
        }
      }
    }
    return covariance;
  }

 private:
  bool IsWhite(const ComplexMatrix& all) const {
    // Channels that move together count as fewer.
    const double trace = all.diagonal().real().sum();
    const double effective = trace * trace / all.squaredNorm();
    for (size_t part = 0; part < products_.size(); ++part) {
      const double count =
          static_cast<double>(firsts_[part + 1] - firsts_[part]);
      const double level = products_[part].diagonal().real().sum() / trace;
      if (std::abs(level - 1.0) >
          kMostForcedScatter / std::sqrt(effective * count)) {
        return false;
      }
    }
    return true;
  }

  Eigen::Index channels_;
  std::vector<Eigen::Index> firsts_;  // lines
  std::vector<ComplexMatrix> products_;
  std::vector<Vector> floors_;
  bool is_white_ = false;
  Eigen::Index degrees_ = 0;
};

// Turns a covariance of (Re s, Im s, real, imaginary parts of the shape) into
// influences.
void SetInfluences(const Matrix& covariance, Eigen::Index degrees,
                   SubspacePole* pole) {
  const Eigen::Index channels = pole->shape.size();
  const Vector scale =
      covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(
      Matrix(scale.asDiagonal() * covariance * scale.asDiagonal()));
  const Eigen::Index own = covariance.cols();
  const Eigen::Index count = std::max(degrees, own + 1);
  const Matrix root =
      std::sqrt(static_cast<double>(count)) *
      (scale.cwiseInverse().asDiagonal() * solver.eigenvectors() *
       solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal());
  pole->s_influence = ComplexVector::Zero(count);
  pole->shape_influence = ComplexMatrix::Zero(channels, count);
  for (Eigen::Index j = 0; j < own; ++j) {
    pole->s_influence[j] = {root(0, j), root(1, j)};
    for (Eigen::Index c = 0; c < channels; ++c) {
      pole->shape_influence(c, j) = {root(2 + 2 * c, j), root(3 + 2 * c, j)};
    }
  }
  pole->s_influence[own] =
      kForcedClock * std::sqrt(static_cast<double>(count)) * pole->s;
}

}  // namespace

ForcedShape FindForcedShape(const ForcedModel& model, const ForcedFit& fit,
                            size_t m) {
  const Eigen::Index own = model.own_columns();
  const Eigen::Index at = own * static_cast<Eigen::Index>(m);
  const Matrix& inside = fit.inside;
  const Eigen::Index rest = inside.cols() - at - own;
  Matrix others(inside.rows(), inside.cols() - own);
  others << inside.leftCols(at), inside.rightCols(rest);
  const Matrix mine = inside.middleCols(at, own);
  const Vector sizes = mine.colwise().norm();
  Matrix outside = mine;
  if (others.cols() > 0) {
    const Matrix explained =
        OrthonormalPart(others, others.colwise().norm().transpose());
    for (int pass = 0; pass < 2; ++pass) {
      outside -= explained * (explained.transpose() * outside);
    }
  }
  const Matrix directions = OrthonormalPart(outside, sizes);
  ForcedShape result;
  result.shape = ComplexVector::Zero(model.num_channels());
  result.functionals = Matrix::Zero(fit.q.rows(), 2);
  if (directions.cols() < 2) return result;
  const Matrix gain = directions.transpose() * mine;
  const Matrix q = fit.q * directions;
  const Matrix t = q.transpose() * model.data();
  const Matrix columns = gain * TimesParticipation(FindParticipation(gain, t));
  const Matrix inverse =
      Eigen::CompleteOrthogonalDecomposition<Matrix>(columns).pseudoInverse();
  result.functionals = q * inverse.transpose();
  const Matrix values = inverse * t;
  for (Eigen::Index c = 0; c < result.shape.size(); ++c) {
    result.shape[c] =
        Complex(values(0, c), values(1, c)) / model.channel_weights()[c];
  }
  return result;
}

std::vector<SubspacePole> EstimateForcedPoles(const ForcedModel& model,
                                              const ForcedFit& fit) {
  std::vector<SubspacePole> poles;
  if (fit.s.empty()) return poles;
  const Eigen::Index count = static_cast<Eigen::Index>(fit.s.size());
  const Eigen::Index channels = model.num_channels();
  const Matrix slopes = model.Slopes(fit);
  const Eigen::Index moving = slopes.cols();
  const Eigen::Index width = moving + 2 * count;
  // Functionals of the noise: for the poles, then for the shapes.
  Matrix functionals(slopes.rows(), width);
  functionals.leftCols(moving) = slopes - fit.q * (fit.q.transpose() * slopes);
  std::vector<ForcedShape> shapes;
  for (size_t m = 0; m < fit.s.size(); ++m) {
    shapes.push_back(FindForcedShape(model, fit, m));
    functionals.middleCols(moving + 2 * static_cast<Eigen::Index>(m), 2) =
        shapes[m].functionals;
  }
  const Matrix gram =
      functionals.leftCols(moving).transpose() * functionals.leftCols(moving);
  std::vector<Matrix> turns;
  Matrix normal = Matrix::Zero(2 * count, 2 * count);
  for (Eigen::Index c = 0; c < channels; ++c) {
    turns.push_back(model.SlopeAmplitudes(fit, c));
    normal += turns.back().transpose() * (gram * turns.back());
  }
  const Vector scale =
      normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Matrix inverse =
      scale.asDiagonal() *
      Eigen::CompleteOrthogonalDecomposition<Matrix>(
          Matrix(scale.asDiagonal() * normal * scale.asDiagonal()))
          .pseudoInverse() *
      scale.asDiagonal();
  Matrix to_poles = Matrix::Zero(2 * count, channels * width);
  for (Eigen::Index c = 0; c < channels; ++c) {
    to_poles.middleCols(c * width, moving) =
        inverse * turns[static_cast<size_t>(c)].transpose();
  }
  const ForcedNoise noise(model, fit);
  const Matrix covariance = noise.CovarianceOf(functionals);
  for (Eigen::Index m = 0; m < count; ++m) {
    Matrix own = Matrix::Zero(2 + 2 * channels, channels * width);
    own.topRows(2) = to_poles.middleRows(2 * m, 2);
    const ForcedShape& shape = shapes[static_cast<size_t>(m)];
    const Matrix moved = shape.functionals.transpose() * slopes;
    for (Eigen::Index c = 0; c < channels; ++c) {
      auto rows = own.middleRows(2 + 2 * c, 2);
      rows = -(moved * turns[static_cast<size_t>(c)]) * to_poles;
      rows(0, c * width + moving + 2 * m) += 1.0;
      rows(1, c * width + moving + 2 * m + 1) += 1.0;
      rows /= model.channel_weights()[c];
    }
    SubspacePole pole;
    pole.s = fit.s[static_cast<size_t>(m)];
    pole.shape = shape.shape;
    SetInfluences(own * covariance * own.transpose(), noise.degrees(), &pole);
    poles.push_back(std::move(pole));
  }
  return poles;
}

}  // namespace pinode
