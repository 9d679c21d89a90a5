#include "pinode/modal/input_projection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/parallel_for.h"
#include "pinode/modal/windowed_correlations.h"

namespace pinode {
namespace {

// Samples that are stacked and multiplied together.
constexpr Eigen::Index kStackedSamples = 1024;
// Number of samples by which u_f extends beyond y_f.
constexpr int kInputMargin = 4;
// Limit relative to the mean diagonal of E[u_f u_f^T]. Below it the input
// contains no information.
constexpr double kSmallestInput = 1e-10;

// Stacked samples first + k, ... of `values`, for k in [begin, begin + size).
Eigen::Map<const Matrix, 0, Eigen::OuterStride<>> Stacked(const Matrix& values,
                                                          Eigen::Index first,
                                                          int count,
                                                          Eigen::Index begin,
                                                          Eigen::Index size) {
  const Eigen::Index rows = values.rows();
  return {values.data() + (first + begin) * rows, count * rows, size,
          Eigen::OuterStride<>(rows)};
}

class Projection {
 public:
  Projection(std::shared_ptr<const Matrix> outputs,
             std::shared_ptr<const Matrix> inputs,
             const std::vector<int>& references, int block_rows,
             int num_windows, int num_threads)
      : inputs_(std::move(inputs)),
        outputs_(std::move(outputs)),
        block_rows_(block_rows),
        num_windows_(num_windows) {
    // y(k + 1) ... y(k + p), u(k + 1 - margin) ... u(k + p + margin),
    // z(k - p + 1) ... z(k), k = begin_ ... begin_ + starts_ - 1.
    begin_ = std::max(block_rows - 1, kInputMargin - 1);
    starts_ = outputs_->cols() - begin_ - block_rows - kInputMargin;
    hop_ = starts_ / (num_windows + 1);
    CHECK_GT(hop_, 0) << "too few samples for " << num_windows << " windows";
    past_.resize(static_cast<Eigen::Index>(references.size()) + inputs_->rows(),
                 outputs_->cols());
    for (size_t i = 0; i < references.size(); ++i) {
      past_.row(static_cast<Eigen::Index>(i)) = outputs_->row(references[i]);
    }
    past_.bottomRows(inputs_->rows()) = *inputs_;
    FindGaps();
    Regress();
    mean_ = Mean(num_threads);
  }

  const Matrix& mean() const { return mean_; }
  Eigen::Index window_samples() const { return 2 * hop_; }
  int num_channels() const { return static_cast<int>(outputs_->rows()); }

  // Returns e_f z^T over a window, minus the mean.
  Matrix Change(int window) const {
    return Products(window * hop_, Hann(), 1.0) - mean_;
  }

 private:
  // Stretches that hold a missing sample have no weight.
  void FindGaps() {
    weights_ = Vector::Ones(starts_);
    if (!outputs_->hasNaN()) return;
    Eigen::Index last = -1;  // missing sample
    const Eigen::Index length = 2 * block_rows_;
    for (Eigen::Index k = 0; k < outputs_->cols(); ++k) {
      if (outputs_->col(k).hasNaN()) last = k;
      // The stretch that ends with y(k): begins at k - 2 p + 1.
      const Eigen::Index start = k - block_rows_ - begin_;
      if (start >= 0 && start < starts_ && last > k - length) {
        weights_[start] = 0.0;
      }
    }
    const auto filled = [](const Matrix& m) {
      return Matrix(m.unaryExpr([](double v) { return v == v ? v : 0.0; }));
    };
    outputs_ = std::make_shared<const Matrix>(filled(*outputs_));
    past_ = filled(past_);
  }

  Vector Hann() const {
    Vector h(2 * hop_);
    for (Eigen::Index k = 0; k < h.size(); ++k) {
      h[k] = 0.5 - 0.5 * std::cos(kTwoPi * (static_cast<double>(k) + 0.5) /
                                  static_cast<double>(h.size()));
    }
    return h;
  }

  // Returns the sum of all windows: one, with ramps at both ends.
  Vector AllWindows() const {
    Vector total = Vector::Ones((num_windows_ + 1) * hop_);
    const Vector h = Hann();
    total.head(hop_) = h.head(hop_);
    total.tail(hop_) = h.tail(hop_);
    return total;
  }

  auto FutureOutputs(Eigen::Index at, Eigen::Index size) const {
    return Stacked(*outputs_, begin_ + 1, block_rows_, at, size);
  }
  auto FutureInputs(Eigen::Index at, Eigen::Index size) const {
    return Stacked(*inputs_, begin_ + 1 - kInputMargin,
                   block_rows_ + 2 * kInputMargin, at, size);
  }
  auto Past(Eigen::Index at, Eigen::Index size) const {
    return Stacked(past_, begin_ - block_rows_ + 1, block_rows_, at, size);
  }

  void Regress() {
    const Eigen::Index us = inputs_->rows() * (block_rows_ + 2 * kInputMargin);
    const Eigen::Index ys = outputs_->rows() * block_rows_;
    const Eigen::Index zs = past_.rows() * block_rows_;
    Matrix uu = Matrix::Zero(us, us);
    Matrix uy = Matrix::Zero(us, ys);
    Matrix uz = Matrix::Zero(us, zs);
    const Vector h = AllWindows();
    for (Eigen::Index at = 0; at < h.size(); at += kStackedSamples) {
      const Eigen::Index size = std::min(kStackedSamples, h.size() - at);
      const Matrix weighed =
          FutureInputs(at, size) *
          (h.segment(at, size).cwiseProduct(weights_.segment(at, size)))
              .asDiagonal();
      uu.noalias() += weighed * FutureInputs(at, size).transpose();
      uy.noalias() += weighed * FutureOutputs(at, size).transpose();
      uz.noalias() += weighed * Past(at, size).transpose();
    }
    uu.diagonal().array() +=
        kSmallestInput * uu.trace() / static_cast<double>(us);
    const Eigen::LDLT<Matrix> factor(uu);
    on_outputs_ = factor.solve(uy);
    on_past_ = factor.solve(uz);
  }

  // Returns the sum of h e_f z^T from `first` on, divided by the weight of so
  // many windows.
  Matrix Products(Eigen::Index first, const Vector& h, double windows) const {
    Matrix sums = Matrix::Zero(outputs_->rows() * block_rows_,
                               past_.rows() * block_rows_);
    for (Eigen::Index at = 0; at < h.size(); at += kStackedSamples) {
      const Eigen::Index size = std::min(kStackedSamples, h.size() - at);
      const Eigen::Index from = first + at;
      const auto u = FutureInputs(from, size);
      Matrix e = FutureOutputs(from, size);
      e.noalias() -= on_outputs_.transpose() * u;
      Matrix z = Past(from, size);
      z.noalias() -= on_past_.transpose() * u;
      e *= h.segment(at, size)
               .cwiseProduct(weights_.segment(from, size))
               .asDiagonal();
      sums.noalias() += e * z.transpose();
    }
    // A window of two hops has the weight of one.
    return sums / (windows * static_cast<double>(hop_));
  }

  // The sum uses fixed groups, so it does not depend on the number of threads.
  Matrix Mean(int num_threads) const {
    constexpr int kGroups = 8;
    const Vector h = AllWindows();
    const Matrix none = Matrix::Zero(outputs_->rows() * block_rows_,
                                     past_.rows() * block_rows_);
    std::vector<Matrix> sums(kGroups, none);
    ParallelFor(kGroups, num_threads, [&](int group, int) {
      for (int part = group; part <= num_windows_; part += kGroups) {
        sums[static_cast<size_t>(group)] +=
            Products(part * hop_, h.segment(part * hop_, hop_), num_windows_);
      }
    });
    Matrix mean = none;
    for (const Matrix& sum : sums) mean += sum;
    return mean;
  }

  std::shared_ptr<const Matrix> inputs_;
  std::shared_ptr<const Matrix> outputs_;
  const int block_rows_;
  const int num_windows_;
  Eigen::Index begin_ = 0;
  Eigen::Index starts_ = 0;
  Eigen::Index hop_ = 0;
  Matrix past_;        // references, then inputs, by sample
  Vector weights_;     // of stretches
  Matrix on_outputs_;  // B^T
  Matrix on_past_;     // D^T
  Matrix mean_;
};

}  // namespace

HankelWindows ProjectInput(std::shared_ptr<const Matrix> outputs,
                           std::shared_ptr<const Matrix> inputs,
                           const std::vector<int>& references, int block_rows,
                           int num_windows, int num_threads,
                           Eigen::Index* window_samples) {
  const auto projection = std::make_shared<const Projection>(
      std::move(outputs), std::move(inputs), references, block_rows,
      num_windows, num_threads);
  HankelWindows hankel;
  hankel.num_channels = projection->num_channels();
  hankel.mean = projection->mean();
  hankel.num_windows = num_windows;
  hankel.change = [projection](int b) { return projection->Change(b); };
  *window_samples = projection->window_samples();
  return hankel;
}

}  // namespace pinode
