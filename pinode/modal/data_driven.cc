#include "pinode/modal/data_driven.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <memory>

namespace pinode {
namespace {

// Limit relative to the mean diagonal of T. Below it the past contains no
// information.
constexpr double kSmallestPart = 1e-7;

// Block (i, j) is R_(j - i) of the references.
Matrix ToeplitzMatrix(const WindowedCorrelations& correlations,
                      const std::vector<int>& references, int blocks) {
  const Eigen::Index size = correlations.num_references;
  Matrix lag(size, size);
  Matrix t(blocks * size, blocks * size);
  for (int l = 0; l < blocks; ++l) {
    if (l == 0) {
      lag = correlations.zero_lag;
    } else {
      for (Eigen::Index i = 0; i < size; ++i) {
        lag.row(i) = correlations.mean.row((l - 1) * correlations.num_channels +
                                           references[static_cast<size_t>(i)]);
      }
    }
    for (int i = 0; i + l < blocks; ++i) {
      t.block(i * size, (i + l) * size, size, size) = lag;
      t.block((i + l) * size, i * size, size, size) = lag.transpose();
    }
  }
  return t;
}

}  // namespace

HankelWindows DataDrivenHankel(const WindowedCorrelations& correlations,
                               const std::vector<int>& references,
                               int block_rows) {
  HankelWindows hankel = HankelOfCorrelations(correlations, block_rows);
  if (hankel.mean.size() == 0) return hankel;
  Matrix t = ToeplitzMatrix(correlations, references,
                            correlations.num_lags + 1 - block_rows);
  const double size = t.trace() / static_cast<double>(t.rows());
  // Estimated correlations need not belong to any process.
  auto factor = std::make_shared<Eigen::LLT<Matrix>>();
  double ridge = kSmallestPart * size;
  do {
    t.diagonal().array() += ridge;
    factor->compute(t);
    ridge *= 10.0;
  } while (factor->info() != Eigen::Success && ridge < size);
  // H L^-T.
  const auto weigh = [factor](const Matrix& h) {
    return Matrix(factor->matrixL().solve(h.transpose()).transpose());
  };
  hankel.mean = weigh(hankel.mean);
  const auto change = hankel.change;
  hankel.change = [weigh, change](int b) { return weigh(change(b)); };
  return hankel;
}

}  // namespace pinode
