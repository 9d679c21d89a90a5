#include "pinode/modal/subspace.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "pinode/base/parallel_for.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Block (i, j) is R_(i + j + 1).
Matrix HankelMatrix(const Matrix& correlations, int channels, int block_rows,
                    int block_columns) {
  const Eigen::Index references = correlations.cols();
  Matrix h(block_rows * channels, block_columns * references);
  for (int j = 0; j < block_columns; ++j) {
    h.middleCols(j * references, references) =
        correlations.middleRows(j * channels, block_rows * channels);
  }
  return h;
}

// Data shared by all orders.
struct Decomposition {
  Matrix u;  // rows x rows
  Matrix v;  // columns x max_order, and further columns
  Vector s;  // rows; zero behind the last one
  int channels = 0;
  int max_order = 0;
  // Q R of U without its last block row, first max_order columns.
  Matrix r;               // max_order x max_order, upper triangle
  Matrix q_later;         // Q^T times U without its first block row
  Matrix q_earlier;       // Q^T times U without its last block row
  std::vector<Matrix> w;  // per block: rows x max_order, see the header

  Eigen::Index rows() const { return u.rows(); }
};

// Returns (s_j M_kj + s_k M_jk) / (s_j^2 - s_k^2) of M = U^T dH V.
Matrix Turn(const Decomposition& d, const Matrix& change) {
  const int n = d.max_order;
  const Matrix left =
      d.u.transpose() * (change * d.v.leftCols(n));  // M_kj, j < n
  const Matrix right = (d.u.leftCols(n).transpose() * change) * d.v;  // M_jk
  Matrix w = Matrix::Zero(d.rows(), n);
  for (int j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < d.rows(); ++k) {
      if (k == j) continue;
      const double back = k < right.cols() ? right(j, k) : 0.0;
      const double gap = (d.s[j] - d.s[k]) * (d.s[j] + d.s[k]);
      if (gap == 0.0) continue;
      w(k, j) = (d.s[j] * left(k, j) + d.s[k] * back) / gap;
    }
  }
  return w;
}

Decomposition Decompose(const HankelWindows& hankel, int max_order,
                        int num_threads) {
  Decomposition d;
  d.channels = hankel.num_channels;
  d.max_order = max_order;
  const Matrix& h = hankel.mean;
  const Eigen::BDCSVD<Matrix> svd(h, Eigen::ComputeFullU | Eigen::ComputeThinV);
  d.u = svd.matrixU();
  d.v = svd.matrixV();
  d.s = Vector::Zero(h.rows());
  d.s.head(svd.singularValues().size()) = svd.singularValues();
  const Eigen::Index shifted = h.rows() - d.channels;
  const Eigen::HouseholderQR<Matrix> qr(
      Matrix(d.u.topLeftCorner(shifted, d.max_order)));
  const Matrix q = qr.householderQ() * Matrix::Identity(shifted, d.max_order);
  d.r = qr.matrixQR().topRows(d.max_order).triangularView<Eigen::Upper>();
  d.q_later = q.transpose() * d.u.bottomRows(shifted);
  d.q_earlier = q.transpose() * d.u.topRows(shifted);
  d.w.resize(static_cast<size_t>(hankel.num_windows));
  ParallelFor(hankel.num_windows, num_threads, [&](int b, int) {
    d.w[static_cast<size_t>(b)] = Turn(d, hankel.change(b));
  });
  return d;
}

// The poles of one order.
class OrderPoles {
 public:
  OrderPoles(const Decomposition& d, int order, double step,
             const SubspaceOptions& options)
      : d_(d), n_(order), step_(step), options_(options) {}

  std::vector<SubspacePole> Find() {
    const auto r = d_.r.topLeftCorner(n_, n_).triangularView<Eigen::Upper>();
    const Matrix a = r.solve(d_.q_later.topLeftCorner(n_, n_));
    const Eigen::EigenSolver<Matrix> solver(a);
    if (solver.info() != Eigen::Success) return {};
    lambda_ = solver.eigenvalues();
    phi_ = solver.eigenvectors();
    inverse_ = phi_.partialPivLu().inverse();
    if (!inverse_.allFinite()) return {};
    for (int i = 0; i < n_; ++i) {
      if (IsOfInterest(lambda_[i])) kept_.push_back(i);
    }
    if (kept_.empty()) return {};
    Perturb();
    std::vector<SubspacePole> poles;
    for (size_t i = 0; i < kept_.size(); ++i) poles.push_back(Pole(i));
    std::sort(poles.begin(), poles.end(),
              [](const SubspacePole& x, const SubspacePole& y) {
                return std::abs(x.s) < std::abs(y.s);
              });
    return poles;
  }

 private:
  Complex Continuous(Complex lambda) const { return std::log(lambda) / step_; }

  bool IsOfInterest(Complex lambda) const {
    if (lambda.imag() <= 0.0) return false;
    const Complex s = Continuous(lambda);
    const double hz = std::abs(s) / 6.283185307179586;
    const double ratio = -s.real() / std::abs(s);
    return ratio > 0.0 && ratio <= options_.max_damping_ratio &&
           hz >= options_.lowest_hz && hz <= options_.highest_hz;
  }

  // dA phi and U W phi (first block row) of the kept poles for each block.
  void Perturb() {
    const Eigen::Index m = static_cast<Eigen::Index>(kept_.size());
    const Eigen::Index rest = d_.rows() - n_;
    const auto r = d_.r.topLeftCorner(n_, n_).triangularView<Eigen::Upper>();
    const Eigen::Index shifted = d_.rows() - d_.channels;
    Matrix parts(n_, 2 * m);  // real and imaginary parts of phi
    ComplexVector lambda(m);
    ComplexMatrix phi(n_, m);
    for (Eigen::Index i = 0; i < m; ++i) {
      phi.col(i) = phi_.col(kept_[static_cast<size_t>(i)]);
      lambda[i] = lambda_[kept_[static_cast<size_t>(i)]];
    }
    parts << phi.real(), phi.imag();
    // Residual of the shift equation for the model of this order. It is not
    // zero, because there are more equations than unknowns.
    const ComplexMatrix residual =
        d_.u.bottomRows(shifted).leftCols(n_) * phi -
        (d_.u.topRows(shifted).leftCols(n_) * phi) * lambda.asDiagonal();
    const ComplexMatrix h =
        d_.u.topRows(shifted).rightCols(rest).transpose() * residual;
    Matrix h_parts(rest, 2 * m);
    h_parts << h.real(), h.imag();
    const Matrix later = r.solve(d_.q_later.topRightCorner(n_, rest));
    const Matrix earlier = r.solve(d_.q_earlier.topRightCorner(n_, rest));
    const Matrix first = d_.u.topRows(d_.channels).rightCols(rest);
    const Eigen::Index blocks = static_cast<Eigen::Index>(d_.w.size());
    da_phi_.assign(kept_.size(), ComplexMatrix(n_, blocks));
    dc_phi_.assign(kept_.size(), ComplexMatrix(d_.channels, blocks));
    for (Eigen::Index b = 0; b < blocks; ++b) {
      const auto w = d_.w[static_cast<size_t>(b)].block(n_, 0, rest, n_);
      const Matrix moved = w * parts;
      const Matrix back = r.solve(d_.r.topLeftCorner(n_, n_)
                                      .transpose()
                                      .triangularView<Eigen::Lower>()
                                      .solve(w.transpose() * h_parts));
      const Matrix by_later = later * moved + back;
      const Matrix by_earlier = earlier * moved;
      const Matrix c_moved = first * moved;
      for (Eigen::Index i = 0; i < m; ++i) {
        const size_t pole = static_cast<size_t>(i);
        for (Eigen::Index k = 0; k < n_; ++k) {
          da_phi_[pole](k, b) =
              Complex(by_later(k, i), by_later(k, m + i)) -
              lambda[i] * Complex(by_earlier(k, i), by_earlier(k, m + i));
        }
        for (Eigen::Index c = 0; c < d_.channels; ++c) {
          dc_phi_[pole](c, b) = Complex(c_moved(c, i), c_moved(c, m + i));
        }
      }
    }
  }

  SubspacePole Pole(size_t place) const {
    const int i = kept_[place];
    SubspacePole pole;
    pole.order = n_;
    pole.s = Continuous(lambda_[i]);
    const ComplexMatrix shapes = d_.u.topRows(d_.channels).leftCols(n_) * phi_;
    pole.shape = shapes.col(i);
    // The change of A phi in the basis of the eigenvectors.
    ComplexMatrix coefficients = inverse_ * da_phi_[place];
    pole.s_influence = coefficients.row(i).transpose() / (lambda_[i] * step_);
    for (int k = 0; k < n_; ++k) {
      if (k == i) {
        coefficients.row(k).setZero();
      } else {
        coefficients.row(k) /= lambda_[i] - lambda_[k];
      }
    }
    pole.shape_influence = dc_phi_[place] + shapes * coefficients;
    return pole;
  }

  const Decomposition& d_;
  const int n_;
  const double step_;
  const SubspaceOptions& options_;
  ComplexVector lambda_;
  ComplexMatrix phi_;
  ComplexMatrix inverse_;
  std::vector<int> kept_;
  std::vector<ComplexMatrix> da_phi_;  // per kept pole: order x blocks
  std::vector<ComplexMatrix> dc_phi_;  // per kept pole: channels x blocks
};

bool IsPossible(const HankelWindows& hankel, const SubspaceOptions& options,
                std::string* error) {
  const Eigen::Index largest = std::min<Eigen::Index>(
      hankel.mean.rows() - hankel.num_channels, hankel.mean.cols());
  if (options.block_rows >= 2 && options.max_order <= largest) return true;
  *error = "models of order " + std::to_string(options.max_order) + " need " +
           "more than " + std::to_string(options.block_rows) +
           " block rows of " + std::to_string(hankel.num_channels) +
           " channels";
  return false;
}

}  // namespace

HankelWindows HankelOfCorrelations(const WindowedCorrelations& correlations,
                                   int block_rows) {
  HankelWindows hankel;
  hankel.num_channels = correlations.num_channels;
  hankel.num_windows = correlations.num_windows();
  const int columns = correlations.num_lags + 1 - block_rows;
  if (columns < 1) return hankel;
  hankel.mean = HankelMatrix(correlations.mean, correlations.num_channels,
                             block_rows, columns);
  hankel.change = [&correlations, block_rows, columns](int b) {
    return HankelMatrix(
        correlations.windows[static_cast<size_t>(b)] - correlations.mean,
        correlations.num_channels, block_rows, columns);
  };
  return hankel;
}

bool IdentifySubspace(const WindowedCorrelations& correlations,
                      double sampling_step, const SubspaceOptions& options,
                      int num_threads, std::vector<SubspacePole>* poles,
                      std::string* error) {
  return IdentifySubspace(
      HankelOfCorrelations(correlations, options.block_rows), sampling_step,
      options, num_threads, poles, error);
}

bool IdentifySubspace(const HankelWindows& hankel, double sampling_step,
                      const SubspaceOptions& options, int num_threads,
                      std::vector<SubspacePole>* poles, std::string* error) {
  if (!IsPossible(hankel, options, error)) return false;
  const Decomposition d = Decompose(hankel, options.max_order, num_threads);
  const int count = options.max_order / 2;
  std::vector<std::vector<SubspacePole>> by_order(static_cast<size_t>(count));
  // The highest orders, which cost most, first.
  ParallelFor(count, num_threads, [&](int index, int) {
    const size_t place = static_cast<size_t>(count - 1 - index);
    by_order[place] =
        OrderPoles(d, 2 * static_cast<int>(place + 1), sampling_step, options)
            .Find();
  });
  poles->clear();
  for (std::vector<SubspacePole>& order : by_order) {
    for (SubspacePole& pole : order) poles->push_back(std::move(pole));
  }
  return true;
}

Eigen::VectorXcd FindEigenvalues(const HankelWindows& hankel, int order) {
  HankelWindows alone;
  alone.num_channels = hankel.num_channels;
  alone.mean = hankel.mean;
  const Decomposition d = Decompose(alone, order, 1);
  const auto r = d.r.triangularView<Eigen::Upper>();
  const Matrix a = r.solve(d.q_later.leftCols(order));
  return Eigen::EigenSolver<Matrix>(a, /*computeEigenvectors=*/false)
      .eigenvalues();
}

}  // namespace pinode
