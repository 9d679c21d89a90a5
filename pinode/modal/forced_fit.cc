#include "pinode/modal/forced_fit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/modal/forced_shapes.h"
#include "pinode/modal/stabilisation.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Probability that noise is taken for a mode somewhere in the record.
constexpr double kFalseMode = 1e-3;
// Distance within which poles compensate each other: decay rates of both, and
// a fraction of the frequency.
constexpr double kNearbyInDecays = 2.0;
constexpr double kNearby = 0.01;
// Lines and decay rates around a pole, in which noise is measured (thrice
// these) and a peak may lie.
constexpr double kLines = 8.0;
constexpr double kNoiseWidth = 3.0;
// Ratio of the residual's power at a pole to that on either side, above which
// it has a peak there, and its smallest ratio to rounding.
constexpr double kPeak = 2.5;
constexpr double kAboveRounding = 10.0;
// Lines over which the noise is averaged for its weights, and the smallest
// ratio of its variances that counts as a change.
constexpr Eigen::Index kSmoothedLines = 32;
constexpr double kSmallestForcedChange = 4.0;

class PoleTest {
 public:
  PoleTest(const std::vector<ForcedCandidate>& candidates, ForcedModel* model)
      : candidates_(candidates), model_(*model) {}

  ForcedPoles Find() {
    kept_.resize(candidates_.size());
    std::iota(kept_.begin(), kept_.end(), size_t{0});
    needed_.assign(candidates_.size(), false);
    fit_ = model_.Solve(Centres());
    for (int pass = 0; pass < 2; ++pass) {
      WeighChannels();
      Refine(&fit_);
    }
    if (WeighLines()) Refine(&fit_);
    while (RemoveOne()) {
    }
    WeighChannels();
    Refine(&fit_);
    ForcedPoles poles;
    const Matrix spectrum = model_.Spectrum(fit_);
    for (const Complex s : fit_.s) {
      poles.has_peak = poles.has_peak || HasPeak(spectrum, s);
    }
    poles.kept = std::move(kept_);
    poles.fit = std::move(fit_);
    return poles;
  }

 private:
  std::vector<Complex> Centres() const {
    std::vector<Complex> s;
    for (const size_t i : kept_) s.push_back(candidates_[i].s);
    return s;
  }

  void Refine(ForcedFit* fit) const {
    std::vector<double> reach;
    for (const size_t i : kept_) reach.push_back(candidates_[i].reach);
    model_.Refine(Centres(), reach, fit);
  }

  // Makes the residuals of each channel as large as one, or larger where they
  // are rounding.
  void WeighChannels() {
    const Vector old = model_.channel_weights();
    const Vector squares = model_.Spectrum(fit_).colwise().mean().transpose();
    const double lines = model_.line_weights().cwiseAbs2().mean();
    model_.set_weights(squares.cwiseQuotient(old.cwiseAbs2())
                           .cwiseMax(lines * model_.rounding())
                           .cwiseSqrt()
                           .cwiseInverse(),
                       model_.line_weights());
    fit_ = model_.Solve(fit_.s);
  }

  // Weighs the lines by the noise, if it changes. Returns false if not.
  bool WeighLines() {
    const Vector power = model_.Spectrum(fit_).rowwise().mean();
    const Eigen::Index lines = power.size();
    Vector sums(lines + 1);
    sums[0] = 0.0;
    for (Eigen::Index l = 0; l < lines; ++l) sums[l + 1] = sums[l] + power[l];
    Vector smooth(lines);
    for (Eigen::Index l = 0; l < lines; ++l) {
      const Eigen::Index first =
          std::max<Eigen::Index>(0, l - kSmoothedLines / 2);
      const Eigen::Index last = std::min(lines, l + kSmoothedLines / 2 + 1);
      smooth[l] =
          (sums[last] - sums[first]) / static_cast<double>(last - first);
    }
    smooth =
        smooth.cwiseMax(std::max(Rounding().mean(), 1e-4 * smooth.maxCoeff()));
    if (smooth.maxCoeff() < kSmallestForcedChange * smooth.minCoeff())
      return false;
    model_.set_weights(model_.channel_weights(),
                       smooth.cwiseSqrt().cwiseInverse());
    fit_ = model_.Solve(fit_.s);
    return true;
  }

  // Removes a pole that is not needed, if there is one.
  bool RemoveOne() {
    if (RemoveTwin()) return true;
    const Matrix spectrum = model_.Spectrum(fit_);
    std::vector<ForcedModel::Gain> gains;
    std::vector<double> chances;
    for (size_t m = 0; m < kept_.size(); ++m) {
      gains.push_back(model_.GainOf(fit_, m));
      chances.push_back(
          Chance(gains[m].squares, gains[m].columns, m, spectrum));
    }
    std::vector<size_t> order(kept_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      return chances[a] > chances[b];
    });
    const ForcedFit with = fit_;
    for (const size_t m : order) {
      const bool explains_little = chances[m] > kFalseMode;
      if (!explains_little && !HasNeighbour(m)) continue;
      // One that was needed beside more poles still is.
      if (needed_[kept_[m]]) continue;
      const std::vector<size_t> before = kept_;
      ForcedFit without = Without(m);
      const Vector squares = (without.residuals.colwise().squaredNorm() -
                              with.residuals.colwise().squaredNorm())
                                 .transpose();
      const double chance = Chance(squares, gains[m].columns, m, spectrum);
      if ((explains_little || chance > kFalseMode) &&
          !HasPeak(model_.Spectrum(without), with.s[m])) {
        fit_ = std::move(without);
        return true;
      }
      kept_ = before;
      needed_[kept_[m]] = true;
    }
    return false;
  }

  // Returns the fit without pole m, and takes it from those that are kept.
  ForcedFit Without(size_t m) {
    std::vector<Complex> s = fit_.s;
    s.erase(s.begin() + static_cast<long>(m));
    kept_.erase(kept_.begin() + static_cast<long>(m));
    ForcedFit fit = model_.Solve(s);
    Refine(&fit);
    return fit;
  }

  // Removes one of two poles that are one mode, if there are such.
  bool RemoveTwin() {
    for (size_t a = 0; a < kept_.size(); ++a) {
      for (size_t b = a + 1; b < kept_.size(); ++b) {
        if (!IsOneMode(fit_.s[a], FindForcedShape(model_, fit_, a).shape,
                       fit_.s[b], FindForcedShape(model_, fit_, b).shape)) {
          continue;
        }
        const double first = model_.GainOf(fit_, a).squares.sum();
        const double second = model_.GainOf(fit_, b).squares.sum();
        fit_ = Without(first < second ? a : b);
        return true;
      }
    }
    return false;
  }

  // Returns true if another pole may take the place of pole m.
  bool HasNeighbour(size_t m) const {
    for (size_t i = 0; i < kept_.size(); ++i) {
      const double decays = -fit_.s[i].real() - fit_.s[m].real();
      if (i != m && std::abs(fit_.s[i].imag() - fit_.s[m].imag()) <
                        std::max(kNearbyInDecays * decays,
                                 kNearby * std::abs(fit_.s[m]))) {
        return true;
      }
    }
    return false;
  }

  double Width(Complex s) const {
    return std::max(-s.real(), kLines * model_.line_spacing());
  }

  // Rounding of the channels in their weights.
  Vector Rounding() const {
    return model_.rounding().cwiseProduct(model_.channel_weights().cwiseAbs2());
  }

  // Range of lines within `width` of the angular frequency w, one at least.
  std::pair<Eigen::Index, Eigen::Index> LinesAt(double w, double width) const {
    const Vector& at = model_.angular();
    const auto first =
        std::lower_bound(at.data(), at.data() + at.size() - 1, w - width);
    const auto last = std::upper_bound(first, at.data() + at.size(), w + width);
    return {first - at.data(), std::max<Eigen::Index>(1, last - first)};
  }

  // Probability that noise explains as much somewhere in the record.
  double Chance(const Vector& squares, Eigen::Index columns, size_t m,
                const Matrix& spectrum) const {
    const Complex s = fit_.s[m];
    const auto [first, lines] = LinesAt(s.imag(), kNoiseWidth * Width(s));
    Vector noise =
        spectrum.middleRows(first, lines).colwise().mean().transpose();
    // Against the scatter of the noise's own estimate.
    noise *= 1.0 + 2.0 / std::sqrt(static_cast<double>(lines));
    noise = noise.cwiseMax(ThroughResonance(spectrum, s));
    noise = noise.cwiseMax(
        Rounding() *
        model_.line_weights().segment(first, lines).cwiseAbs2().mean());
    const double degrees =
        static_cast<double>(columns * model_.num_channels() + 2);
    return static_cast<double>(model_.num_rows()) *
           ChiSquareProbability(squares.cwiseQuotient(noise).sum(), degrees);
  }

  // Mean over all lines, weighed by the gain of the resonance: what the pole
  // explains of motion at other frequencies, such as that of a near mode under
  // an unmeasured load.
  Vector ThroughResonance(const Matrix& spectrum, Complex s) const {
    Vector weights(spectrum.rows());
    for (Eigen::Index l = 0; l < weights.size(); ++l) {
      weights[l] = 1.0 / std::norm(Complex(0.0, model_.angular()[l]) - s);
    }
    return spectrum.transpose() * weights / weights.sum();
  }

  // Returns true if a spectrum has a peak at a pole.
  bool HasPeak(const Matrix& spectrum, Complex s) const {
    const double width = Width(s);
    const Vector unweighted = model_.line_weights().cwiseAbs2().cwiseInverse();
    const auto power = [&](double w) {
      const auto [first, lines] = LinesAt(w, width);
      return Vector(spectrum.middleRows(first, lines).transpose() *
                    unweighted.segment(first, lines) /
                    static_cast<double>(lines));
    };
    const Vector at = power(s.imag());
    const Vector below = power(s.imag() - 4.0 * width);
    const Vector above = power(s.imag() + 4.0 * width);
    const Vector rounding = Rounding();
    double peak = 0.0;
    double beside = 0.0;
    for (Eigen::Index c = 0; c < at.size(); ++c) {
      if (at[c] < kAboveRounding * rounding[c]) continue;
      peak += at[c];
      beside += std::sqrt(below[c] * above[c]);
    }
    return peak > kPeak * beside;
  }

  const std::vector<ForcedCandidate>& candidates_;
  ForcedModel& model_;
  std::vector<size_t> kept_;
  std::vector<bool> needed_;  // of the candidates, as far as known
  ForcedFit fit_;
};

}  // namespace

ForcedPoles FindForcedPoles(const std::vector<ForcedCandidate>& candidates,
                            ForcedModel* model) {
  return PoleTest(candidates, model).Find();
}

}  // namespace pinode
