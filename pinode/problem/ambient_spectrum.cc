#include "pinode/problem/ambient_spectrum.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/smooth_number.h"
#include "pinode/base/statistics.h"
#include "pinode/record/prepare.h"

namespace pinode {
namespace {

// Tapered share of a record at either end.
constexpr double kTapered = 0.05;
// Length of the taper at a gap in cycles of the lowest frequency; smallest
// share of the squares that tapers keep; number of missing samples in a row
// that need no taper.
constexpr double kCyclesBesideGap = 8.0;
constexpr double kLeastKept = 0.75;
constexpr Eigen::Index kMostBridged = 4;

// Rises from 0 to 1 over an interval of length one.
double Rise(double x) {
  return 0.5 - 0.5 * std::cos(kPi * std::clamp(x, 0.0, 1.0));
}

// Returns each sample's distance from the next sample within a gap of any
// channel; infinite if there are no gaps.
Vector DistanceFromGaps(const Matrix& samples, Eigen::Index size) {
  Vector distance = Vector::Constant(size, kInfinity);
  for (Eigen::Index c = 0; c < samples.rows(); ++c) {
    Eigen::Index first = 0;  // of the samples missing in a row
    for (Eigen::Index k = 0; k <= size; ++k) {
      if (k < size && std::isnan(samples(c, k))) continue;
      if (k - first > kMostBridged) {
        distance.segment(first, k - first).setZero();
      }
      first = k + 1;
    }
  }
  for (Eigen::Index k = 1; k < size; ++k) {
    distance[k] = std::min(distance[k], distance[k - 1] + 1.0);
  }
  for (Eigen::Index k = size - 1; k > 0; --k) {
    distance[k - 1] = std::min(distance[k - 1], distance[k] + 1.0);
  }
  return distance;
}

// Returns the taper. `beside`: largest number of tapered samples at a gap's
// edge.
Vector Taper(const Matrix& samples, Eigen::Index size, double beside) {
  Vector ends(size);
  const double at_end =
      std::max(1.0, std::floor(kTapered * static_cast<double>(size)));
  for (Eigen::Index k = 0; k < size; ++k) {
    const double distance =
        static_cast<double>(std::min(k, size - 1 - k)) + 0.5;
    ends[k] = Rise(distance / at_end);
  }
  const Vector distance = DistanceFromGaps(samples, size);
  const Vector present = (distance.array() > 0.0).cast<double>();
  const double all = ends.cwiseProduct(present).squaredNorm();
  Vector taper = ends.cwiseProduct(present);
  for (double length = beside; length > 1.0; length *= 0.5) {
    const Vector shortened = ends.cwiseProduct(
        ((distance.array() - 0.5) / length).unaryExpr(&Rise).matrix());
    if (shortened.squaredNorm() < kLeastKept * all) continue;
    taper = shortened;
    break;
  }
  return taper;
}

// Returns L with L L^T = a a^T; `a` has at least as many columns as rows.
Matrix LowerFactor(const Matrix& a) {
  const Eigen::HouseholderQR<Matrix> qr(Matrix(a.transpose()));
  return Matrix(qr.matrixQR().topRows(a.rows()).triangularView<Eigen::Upper>())
      .transpose();
}

// Returns the number of samples that are transformed. Less than a hundredth
// remains at the end.
Eigen::Index FastSize(Eigen::Index size) {
  const Eigen::Index fast = SmoothNumberBelow(size);
  return fast > size - size / 100 ? fast : size;
}

}  // namespace

double ShareOutsideGaps(const Matrix& samples) {
  return (DistanceFromGaps(samples, samples.cols()).array() > 0.0)
      .cast<double>()
      .mean();
}

LineTransform::LineTransform(const Matrix& samples, double step, double lowest,
                             double highest) {
  const Eigen::Index size = FastSize(samples.cols());
  const double spacing = 1.0 / (static_cast<double>(size) * step);
  first_ = std::max<Eigen::Index>(
      1, static_cast<Eigen::Index>(std::ceil(lowest / spacing)));
  const Eigen::Index last = std::min<Eigen::Index>(
      (size - 1) / 2, static_cast<Eigen::Index>(std::floor(highest / spacing)));
  const Eigen::Index count = std::max<Eigen::Index>(0, last - first_ + 1);
  frequency_ = Vector::LinSpaced(count, static_cast<double>(first_) * spacing,
                                 static_cast<double>(last) * spacing);
  taper_ = Taper(samples, size,
                 kCyclesBesideGap / std::max(lowest * step, spacing * step));
  const double square = taper_.squaredNorm();
  scale_ = std::sqrt(2.0 * step / square);
  tied_ = static_cast<double>(size) * taper_.cwiseAbs2().squaredNorm() /
          (square * square);
  // The second moment of |H|^2 is the square of h's derivative.
  bandwidth_ = (taper_.tail(size - 1) - taper_.head(size - 1)).norm() /
               (kTwoPi * step * std::sqrt(square));
}

Eigen::MatrixXcd LineTransform::Values(const Matrix& samples) const {
  Eigen::MatrixXcd lines(samples.rows(), frequency_.size());
  const Vector weights = taper_ / taper_.sum();
  Eigen::FFT<double> fft;
  Eigen::VectorXcd transform;
  for (Eigen::Index c = 0; c < samples.rows(); ++c) {
    Vector values = FillMissing(samples.row(c).head(taper_.size()));
    values.array() -= weights.dot(values);
    values.array() *= scale_ * taper_.array();
    fft.fwd(transform, values);
    lines.row(c) = transform.segment(first_, frequency_.size()).transpose();
  }
  return lines;
}

SpectralLines LineTransform::Apply(const Matrix& samples) const {
  return {frequency_, Values(samples), tied_, bandwidth_};
}

SpectralLines FindSpectralLines(const Matrix& samples, double step,
                                double lowest, double highest) {
  return LineTransform(samples, step, lowest, highest).Apply(samples);
}

void LineGroups::SetProducts(const Eigen::MatrixXcd& values) {
  products.resize(static_cast<size_t>(size()));
  for (size_t k = 0; k < products.size(); ++k) {
    const Eigen::Index lines = first[k + 1] - first[k];
    const auto y = values.middleCols(first[k], lines);
    products[k].noalias() =
        y * y.adjoint() *
        (count[static_cast<Eigen::Index>(k)] / static_cast<double>(lines));
  }
}

LineGroups GroupLines(const SpectralLines& lines, double width) {
  LineGroups groups;
  std::vector<double> frequencies;
  std::vector<double> spreads;
  std::vector<double> counts;
  Eigen::Index first = 0;
  while (first < lines.frequency.size()) {
    Eigen::Index last = first + 1;
    while (last < lines.frequency.size() &&
           lines.frequency[last] - lines.frequency[first] <
               width * lines.frequency[first]) {
      ++last;
    }
    groups.first.push_back(first);
    const auto f = lines.frequency.segment(first, last - first);
    frequencies.push_back(f.mean());
    spreads.push_back(std::hypot(lines.bandwidth,
                                 (f.array() - f.mean()).matrix().norm() /
                                     std::sqrt(static_cast<double>(f.size()))));
    counts.push_back(static_cast<double>(last - first) / lines.tied);
    first = last;
  }
  groups.first.push_back(first);
  const Eigen::Index size = static_cast<Eigen::Index>(counts.size());
  groups.frequency = Eigen::Map<const Vector>(frequencies.data(), size);
  groups.spread = Eigen::Map<const Vector>(spreads.data(), size);
  groups.count = Eigen::Map<const Vector>(counts.data(), size);
  groups.SetProducts(lines.values);
  return groups;
}

LoadSpectrum::LoadSpectrum(double lowest, double highest, int knots, int areas,
                           bool correlated)
    : log_lowest_(std::log(lowest)),
      log_step_(knots > 1 ? std::log(highest / lowest) / (knots - 1) : 1.0),
      knots_(knots),
      areas_(areas),
      correlated_(correlated),
      powers_(Vector::Zero(knots)) {
  CHECK(knots > 0 && areas > 0 && lowest > 0.0 && highest > lowest)
      << knots << " knots of " << areas << " areas from " << lowest << " to "
      << highest;
  for (int j = 0; j < areas; ++j) {
    for (int i = j; i < (correlated ? areas : j + 1); ++i) {
      entries_.emplace_back(i, j);
    }
  }
}

int LoadSpectrum::Weigh(double frequency, double* below, double* above) const {
  *below = 1.0;
  *above = 0.0;
  if (knots_ == 1) return 0;
  const double place =
      std::clamp((std::log(frequency) - log_lowest_) / log_step_, 0.0,
                 static_cast<double>(knots_ - 1));
  const int knot = std::min(static_cast<int>(place), knots_ - 2);
  const double share = place - knot;
  const double power = powers_[knot] * log_step_;
  *below = (1.0 - share) * std::exp(power * share);
  *above = share * std::exp(power * (share - 1.0));
  return knot;
}

void LoadSpectrum::SetPowers(const Vector& unknowns) {
  // Powers steeper than any load's.
  constexpr double kSteepest = 4.0;
  for (int b = 0; b + 1 < knots_; ++b) {
    const double here = Root(unknowns, b).squaredNorm();
    const double next = Root(unknowns, b + 1).squaredNorm();
    powers_[b] = here > 0.0 && next > 0.0
                     ? std::clamp(std::log(next / here) / log_step_, -kSteepest,
                                  kSteepest)
                     : 0.0;
  }
}

Matrix LoadSpectrum::Root(const Vector& unknowns, int knot) const {
  Matrix root = Matrix::Zero(areas_, areas_);
  for (int e = 0; e < per_knot(); ++e) {
    const auto& [i, j] = entries_[static_cast<size_t>(e)];
    root(i, j) = unknowns[knot * per_knot() + e];
  }
  return root;
}

void LoadSpectrum::SetRoot(const Matrix& root, int knot,
                           Vector* unknowns) const {
  for (int e = 0; e < per_knot(); ++e) {
    const auto& [i, j] = entries_[static_cast<size_t>(e)];
    (*unknowns)[knot * per_knot() + e] = root(i, j);
  }
}

Vector LoadSpectrum::Moved(const Vector& unknowns, const Vector& step) const {
  constexpr double kMostFall = 0.1;
  Vector moved = unknowns;
  for (int b = 0; b < knots_; ++b) {
    const Matrix root = Root(unknowns, b);
    const Matrix half =
        root.triangularView<Eigen::Lower>().solve(Root(step, b));
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(
        Matrix(half + half.transpose()));
    if (!half.allFinite() || eigen.info() != Eigen::Success) return unknowns;
    const Vector scale =
        (1.0 + eigen.eigenvalues().array()).max(kMostFall).sqrt();
    SetRoot(LowerFactor(root * eigen.eigenvectors() * scale.asDiagonal()), b,
            &moved);
  }
  return moved;
}

double LoadSpectrum::LargestFall(const Vector& unknowns,
                                 const Vector& step) const {
  double fall = 0.0;
  for (int b = 0; b < knots_; ++b) {
    const Matrix half =
        Root(unknowns, b).triangularView<Eigen::Lower>().solve(Root(step, b));
    if (!half.allFinite()) return kInfinity;
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(
        Matrix(half + half.transpose()), Eigen::EigenvaluesOnly);
    fall = std::max(fall, -eigen.eigenvalues()[0]);
  }
  return fall;
}

LoadSpectrum LoadSpectrum::Uncorrelated() const {
  LoadSpectrum result = *this;
  result.correlated_ = false;
  result.entries_.clear();
  for (int j = 0; j < areas_; ++j) result.entries_.emplace_back(j, j);
  return result;
}

LoadSpectrum LoadSpectrum::Refined(const Vector& unknowns,
                                   Vector* refined) const {
  CHECK_GT(knots_, 1) << "there is nothing between knots";
  LoadSpectrum finer = *this;
  finer.knots_ = 2 * knots_ - 1;
  finer.log_step_ = 0.5 * log_step_;
  finer.powers_ = Vector::Zero(finer.knots_);
  *refined = Vector::Zero(finer.num_unknowns());
  Matrix both(areas_, 2 * areas_);
  for (int b = 0; b < knots_; ++b) {
    const Matrix root = Root(unknowns, b);
    finer.SetRoot(root, 2 * b, refined);
    if (b + 1 == knots_) break;
    finer.powers_.segment(2 * b, 2).setConstant(powers_[b]);
    // Half of each power, as Weigh has it in the middle.
    const double rise = 0.25 * powers_[b] * log_step_;
    both << std::sqrt(0.5) * std::exp(rise) * root,
        std::sqrt(0.5) * std::exp(-rise) * Root(unknowns, b + 1);
    finer.SetRoot(LowerFactor(both), 2 * b + 1, refined);
  }
  return finer;
}

Vector LoadSpectrum::Intensities(const Matrix& areas_by_knots) const {
  Vector unknowns = Vector::Zero(num_unknowns());
  for (int b = 0; b < knots_; ++b) {
    for (int e = 0; e < per_knot(); ++e) {
      const auto& [i, j] = entries_[static_cast<size_t>(e)];
      if (i == j) {
        unknowns[b * per_knot() + e] = std::sqrt(areas_by_knots(i, b));
      }
    }
  }
  return unknowns;
}

}  // namespace pinode
