#include "pinode/modal/frf/frf_model.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/parallel_for.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Smallest part of a column that the columns before it must leave. A column of
// which less remains gets no amplitude.
constexpr double kSmallestColumn = 1e-12;
// Smallest part of the noise at a line that is taken to remain.
constexpr double kLeastLeft = 0.05;

// Complex numbers are multiplied by hand: std::complex looks for infinite ones
// at each product.
Complex Product(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(),
          a.real() * b.imag() + a.imag() * b.real()};
}

// Returns i z.
Complex Turned(Complex z) { return {-z.imag(), z.real()}; }

// Returns 1 / (i w - s).
Complex Inverse(double w, Complex s) {
  const double real = -s.real();
  const double imaginary = w - s.imag();
  const double square = real * real + imaginary * imaginary;
  return {real / square, -imaginary / square};
}

// Returns (i w)^n for n = 0, 1, 2.
Complex Power(double w, int n) {
  return n == 0   ? Complex(1.0, 0.0)
         : n == 1 ? Complex(0.0, w)
                  : Complex(-w * w, 0.0);
}

}  // namespace

// Columns of the linear unknowns and slopes of one reference's rows. Rows are
// the real and the imaginary part of each line.
struct FrfModel::Basis {
  Matrix weights;              // lines x references
  Matrix q;                    // orthonormal, all rows
  Matrix inverse;              // of the triangle: columns = q * triangle
  std::vector<Matrix> slopes;  // per reference
  Matrix along;                // q^T slopes, all references side by side
  Matrix gram;                 // of what remains of the slopes
};

FrfModel::FrfModel(const FrfData& data, int num_threads)
    : data_(data),
      num_threads_(num_threads),
      variances_(Matrix::Ones(data.num_lines(), data.h.cols())) {}

void FrfModel::set_variances(Matrix variances, bool even) {
  variances_ = std::move(variances);
  even_ = even;
}

FrfModel::Basis FrfModel::MakeBasis(const std::vector<FrfMode>& modes,
                                    const Matrix& weights) const {
  const Index lines = data_.num_lines();
  const Index references = data_.references;
  const Index count = static_cast<Index>(modes.size());
  const Index own = references > 1 ? 4 : 2;  // slopes of a mode
  Basis basis;
  basis.weights = weights;
  const Index rests = complex_residuals_ ? 4 : 2;  // of a reference
  Matrix columns =
      Matrix::Zero(2 * lines * references, 2 * count + rests * references);
  for (Index j = 0; j < references; ++j) {
    Matrix slopes(2 * lines, own * count);
    const auto put = [](Complex value, Index row, Index column, Matrix* to) {
      (*to)(row, column) = value.real();
      (*to)(row + 1, column) = value.imag();
    };
    const Index first = 2 * lines * j;
    for (Index r = 0; r < count; ++r) {
      const FrfMode& mode = modes[static_cast<size_t>(r)];
      const Complex l = mode.participation[j];
      for (Index k = 0; k < lines; ++k) {
        const double w = data_.angular[k];
        const Complex f = weights(k, j) * Power(w, data_.derivative);
        const Complex up = Inverse(w, mode.s);
        const Complex down = Inverse(w, std::conj(mode.s));
        const Complex u = Product(f, up);
        const Complex v = Product(f, down);
        const Complex lu = Product(l, u);
        const Complex lv = Product(std::conj(l), v);
        put(lu + lv, first + 2 * k, 2 * r, &columns);
        put(Turned(lu - lv), first + 2 * k, 2 * r + 1, &columns);
        const Complex up2 = Product(u, up);
        const Complex down2 = Product(v, down);
        put(up2 + down2, 2 * k, own * r, &slopes);
        put(Turned(up2 - down2), 2 * k, own * r + 1, &slopes);
        if (own < 4) continue;
        put(u + v, 2 * k, own * r + 2, &slopes);
        put(Turned(u - v), 2 * k, own * r + 3, &slopes);
      }
    }
    const Index at = 2 * count + rests * j;
    for (Index k = 0; k < lines; ++k) {
      const double w = data_.angular[k];
      const Complex f = weights(k, j) * Power(w, data_.derivative);
      const Complex lower = -f / (w * w);
      put(lower, first + 2 * k, at, &columns);
      put(f, first + 2 * k, at + 1, &columns);
      if (rests < 4) continue;
      put(Turned(lower), first + 2 * k, at + 2, &columns);
      put(Turned(f), first + 2 * k, at + 3, &columns);
    }
    basis.slopes.push_back(std::move(slopes));
  }
  const Vector sizes =
      columns.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  columns *= sizes.asDiagonal();
  const Index width = columns.cols();
  const Eigen::HouseholderQR<Matrix> qr(columns);
  basis.q = qr.householderQ() * Matrix::Identity(columns.rows(), width);
  const Matrix triangle =
      qr.matrixQR().topRows(width).triangularView<Eigen::Upper>();
  basis.inverse = triangle.triangularView<Eigen::Upper>().solve(
      Matrix::Identity(width, width));
  for (Index c = 0; c < width; ++c) {
    if (std::abs(triangle(c, c)) > kSmallestColumn) continue;
    basis.inverse.row(c).setZero();
    basis.inverse.col(c).setZero();
  }
  if (!basis.inverse.allFinite()) {
    basis.inverse = basis.inverse.unaryExpr(
        [](double x) { return std::isfinite(x) ? x : 0.0; });
  }
  basis.inverse = sizes.asDiagonal() * basis.inverse;
  const Index moving = own * count;
  basis.along.resize(width, moving * references);
  basis.gram = Matrix::Zero(moving * references, moving * references);
  for (Index j = 0; j < references; ++j) {
    const Matrix& slopes = basis.slopes[static_cast<size_t>(j)];
    basis.along.middleCols(moving * j, moving) =
        basis.q.middleRows(2 * lines * j, 2 * lines).transpose() * slopes;
    basis.gram.block(moving * j, moving * j, moving, moving) =
        slopes.transpose() * slopes;
  }
  basis.gram -= basis.along.transpose() * basis.along;
  return basis;
}

// `scale`: weight of the output, in addition to those of the basis.
void FrfModel::SolveOutput(const Basis& basis, Index output, double scale,
                           FrfFit* fit, Matrix* normal, Vector* gradient,
                           double* cost) const {
  const Index lines = data_.num_lines();
  const Index references = data_.references;
  const Index count = static_cast<Index>(fit->modes.size());
  const Index own = references > 1 ? 4 : 2;
  const Index moving = own * count;
  Vector rows(2 * lines * references);
  for (Index j = 0; j < references; ++j) {
    for (Index k = 0; k < lines; ++k) {
      const Complex value =
          basis.weights(k, j) * data_.h(k, output + data_.outputs * j);
      rows[2 * (k + lines * j)] = value.real();
      rows[2 * (k + lines * j) + 1] = value.imag();
    }
  }
  const Vector products = basis.q.transpose() * rows;
  const Vector solution = basis.inverse * products;
  rows -= basis.q * products;
  rows -= basis.q * (basis.q.transpose() * rows);  // again, against rounding
  *cost = scale * scale * rows.squaredNorm();
  for (Index r = 0; r < count; ++r) {
    fit->shapes(r, output) = {solution[2 * r], solution[2 * r + 1]};
  }
  Vector turned(moving * references);
  for (Index j = 0; j < references; ++j) {
    const Index pair = output + data_.outputs * j;
    for (Index k = 0; k < lines; ++k) {
      const Index row = 2 * (k + lines * j);
      fit->residuals(k, pair) =
          Complex(rows[row], rows[row + 1]) / basis.weights(k, j);
    }
    turned.segment(moving * j, moving) =
        basis.slopes[static_cast<size_t>(j)].transpose() *
        rows.segment(2 * lines * j, 2 * lines);
  }
  // Slopes of the model by the nonlinear unknowns, as sums of basis.slopes.
  const Index unknowns = unknowns_of_mode();
  Matrix sums = Matrix::Zero(moving * references, unknowns * count);
  for (Index r = 0; r < count; ++r) {
    const FrfMode& mode = fit->modes[static_cast<size_t>(r)];
    const Complex shape = fit->shapes(r, output);
    Index at = unknowns * r + 2;
    for (Index j = 0; j < references; ++j) {
      const Index row = moving * j + own * r;
      const Complex c = shape * mode.participation[j];
      sums.block<2, 2>(row, unknowns * r) << c.real(), -c.imag(), c.imag(),
          c.real();
      if (j == mode.reference) continue;
      sums.block<2, 2>(row + 2, at) << shape.real(), -shape.imag(),
          shape.imag(), shape.real();
      at += 2;
    }
  }
  const double weight = scale * scale;
  *normal = weight * (sums.transpose() * (basis.gram * sums));
  *gradient = -weight * (sums.transpose() * turned);
  const Matrix inverse = basis.inverse.topRows(2 * count);
  const size_t o = static_cast<size_t>(output);
  fit->shape_slopes[o] = -inverse * (basis.along * sums);
  fit->shape_covariances[o] = inverse * inverse.transpose() / weight;
}

FrfFit FrfModel::Solve(const std::vector<FrfMode>& modes) const {
  const Index lines = data_.num_lines();
  const Index outputs = data_.outputs;
  const Index references = data_.references;
  const Index count = static_cast<Index>(modes.size());
  const Index unknowns = unknowns_of_mode() * count;
  FrfFit fit;
  fit.modes = modes;
  fit.shapes.resize(count, outputs);
  fit.residuals.resize(lines, outputs * references);
  fit.leverages.resize(lines, outputs * references);
  fit.normal = Matrix::Zero(unknowns, unknowns);
  fit.gradient = Vector::Zero(unknowns);
  fit.shape_slopes.resize(static_cast<size_t>(outputs));
  fit.shape_covariances.resize(static_cast<size_t>(outputs));
  std::vector<Matrix> normals(static_cast<size_t>(outputs));
  std::vector<Vector> gradients(static_cast<size_t>(outputs));
  std::vector<double> costs(static_cast<size_t>(outputs));
  // A real number has half the variance of its complex one.
  const auto solve = [&](const Basis& basis, Index output, double scale) {
    const size_t o = static_cast<size_t>(output);
    SolveOutput(basis, output, scale, &fit, &normals[o], &gradients[o],
                &costs[o]);
    for (Index j = 0; j < references; ++j) {
      const auto part = basis.q.middleRows(2 * lines * j, 2 * lines);
      const Vector squares = part.rowwise().squaredNorm();
      for (Index k = 0; k < lines; ++k) {
        fit.leverages(k, output + outputs * j) = std::min(
            1.0 - kLeastLeft, 0.5 * (squares[2 * k] + squares[2 * k + 1]));
      }
    }
  };
  if (even_) {
    const Basis basis = MakeBasis(modes, Matrix::Ones(lines, references));
    for (Index o = 0; o < outputs; ++o) {
      solve(basis, o, std::sqrt(2.0 / variances_(0, o)));
    }
  } else {
    ParallelFor(static_cast<int>(outputs), num_threads_, [&](int o, int) {
      Matrix weights(lines, references);
      for (Index j = 0; j < references; ++j) {
        weights.col(j) =
            (2.0 * variances_.col(o + outputs * j).cwiseInverse()).cwiseSqrt();
      }
      solve(MakeBasis(modes, weights), o, 1.0);
    });
  }
  for (size_t o = 0; o < costs.size(); ++o) {
    fit.cost += costs[o];
    fit.normal += normals[o];
    fit.gradient += gradients[o];
  }
  return fit;
}

double FrfModel::GainOf(const FrfFit& fit, size_t m) const {
  double gain = 0.0;
  const Index at = 2 * static_cast<Index>(m);
  for (Index o = 0; o < data_.outputs; ++o) {
    const Complex shape = fit.shapes(static_cast<Index>(m), o);
    const Eigen::Vector2d values(shape.real(), shape.imag());
    const Eigen::Matrix2d covariance =
        fit.shape_covariances[static_cast<size_t>(o)].block<2, 2>(at, at);
    if (!(covariance.determinant() > 0.0)) continue;
    gain += values.dot(covariance.inverse() * values);
  }
  return gain;
}

}  // namespace pinode
