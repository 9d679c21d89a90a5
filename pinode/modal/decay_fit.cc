#include "pinode/modal/decay_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/modal/stabilisation.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Probability that noise looks like a decay somewhere in the record.
constexpr double kFalseDecay = 1e-3;
// Smallest noise of a channel relative to its root mean square: rounding of
// samples and of exp(s t).
constexpr double kRounding = 3e-13;
// Candidates that are refined in each step, and at most if those are refused.
constexpr size_t kTried = 2;
constexpr size_t kMostTried = 6;
constexpr size_t kMostTerms = 40;
// Stretches over which noise is measured, and the smallest ratio of its
// variances over time that counts as a change.
constexpr Eigen::Index kNoiseStretches = 16;
constexpr double kSmallestChange = 4.0;

class DecayFinder {
 public:
  DecayFinder(const std::vector<Complex>& candidates, DecayModel* model)
      : model_(*model) {
    const Eigen::Index channels = model_.num_channels();
    model_.set_row_weights(Vector::Ones(model_.num_samples()));
    model_.set_channel_weights(Vector::Ones(channels));
    const DecayFit none = model_.Solve({});
    floor_ = kRounding * none.residuals.colwise().norm().transpose() /
             std::sqrt(static_cast<double>(model_.num_samples()));
    floor_ = floor_.cwiseMax(1e-300);
    AddCandidates(candidates);
  }

  DecayFit Find(const std::vector<DecayTerm>& start) {
    fit_ = model_.Solve(start);
    model_.Refine(&fit_);
    Weigh();
    Grow();
    if (FollowNoise()) {
      fit_ = model_.Solve(fit_.terms);
      Weigh();
      Grow();
    }
    return std::move(fit_);
  }

 private:
  // Keeps one candidate of those that differ by a fraction of their decay.
  void AddCandidates(const std::vector<Complex>& candidates) {
    const double duration =
        model_.step() * static_cast<double>(model_.num_samples());
    for (const Complex& s : candidates) {
      const bool known = std::any_of(
          candidates_.begin(), candidates_.end(), [&](const DecayTerm& other) {
            return std::abs(other.s - s) <
                   0.2 * std::max(-s.real(), 1.0 / duration);
          });
      if (!known) candidates_.push_back({s});
    }
    for (double rate = 1.0 / duration; rate < 1.0 / model_.step();
         rate *= 2.0) {
      candidates_.push_back({Complex(-rate)});
    }
  }

  // Sets the channels' weights to the inverse of what is left.
  void Weigh() {
    const Vector old = model_.channel_weights();
    Vector weights(old.size());
    for (Eigen::Index c = 0; c < old.size(); ++c) {
      const double rms = fit_.residuals.col(c).norm() / old[c] /
                         std::sqrt(static_cast<double>(model_.num_samples()));
      weights[c] = 1.0 / std::max(rms, floor_[c]);
    }
    model_.set_channel_weights(weights);
    fit_ = model_.Solve(fit_.terms);
    model_.Refine(&fit_);
  }

  // Probability limit for the energy that one term explains.
  bool IsNeeded(const DecayFit& with, const DecayFit& without,
                const DecayTerm& term) const {
    const double floor =
        floor_.cwiseProduct(model_.channel_weights()).cwiseAbs2().mean();
    const double noise = std::max(model_.NoiseNear(with, term), floor);
    const double channels = static_cast<double>(model_.num_channels());
    const double degrees =
        term.vibrates() ? 2.0 * channels + 2.0 : channels + 1.0;
    const double trials = 2.0 * static_cast<double>(model_.num_samples());
    return trials * ChiSquareProbability((without.cost - with.cost) / noise,
                                         degrees) <
           kFalseDecay;
  }

  // Returns true if a vibration is another one's mode once more.
  static bool HasTwin(const DecayFit& fit, size_t term) {
    if (!fit.terms[term].vibrates()) return false;
    for (size_t i = 0; i < fit.terms.size(); ++i) {
      if (i != term && fit.terms[i].vibrates() &&
          IsOneMode(fit.terms[i].s, fit.Shape(i), fit.terms[term].s,
                    fit.Shape(term))) {
        return true;
      }
    }
    return false;
  }

  void Grow() {
    while (fit_.terms.size() < kMostTerms && AddBest()) {
      Weigh();
      Prune();
    }
    Prune();
  }

  bool AddBest() {
    std::vector<double> explained;
    std::vector<size_t> order(candidates_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    for (const DecayTerm& candidate : candidates_) {
      explained.push_back(model_.Explained(fit_, candidate));
    }
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return explained[a] > explained[b]; });
    DecayFit best;
    best.cost = kInfinity;
    size_t good = 0;
    const size_t most = std::min(kMostTried, order.size());
    for (size_t i = 0; i < most && good < kTried; ++i) {
      std::vector<DecayTerm> terms = fit_.terms;
      terms.push_back(candidates_[order[i]]);
      DecayFit next = model_.Solve(terms);
      model_.Refine(&next);
      const size_t last = next.terms.size() - 1;
      if (HasTwin(next, last) || !IsNeeded(next, fit_, next.terms[last])) {
        continue;
      }
      ++good;
      if (next.cost < best.cost) best = std::move(next);
    }
    if (good == 0) return false;
    fit_ = std::move(best);
    return true;
  }

  // Removes terms that the others, refined without them, make needless.
  void Prune() {
    while (!fit_.terms.empty()) {
      DecayFit best;
      best.cost = kInfinity;
      size_t removed = 0;
      for (size_t i = 0; i < fit_.terms.size(); ++i) {
        if (fit_.terms[i].is_fixed) continue;
        std::vector<DecayTerm> terms = fit_.terms;
        terms.erase(terms.begin() + static_cast<long>(i));
        DecayFit next = model_.Solve(terms);
        if (next.cost < best.cost) {
          best = std::move(next);
          removed = i;
        }
      }
      if (!std::isfinite(best.cost)) return;
      model_.Refine(&best);
      if (IsNeeded(fit_, best, fit_.terms[removed]) &&
          !HasTwin(fit_, removed)) {
        return;
      }
      fit_ = std::move(best);
    }
  }

  // Sets the weights over time if the noise changes. Returns false if not.
  bool FollowNoise() {
    const Eigen::Index size = model_.num_samples() / kNoiseStretches;
    if (size < 8) return false;
    Vector levels(kNoiseStretches);
    const double channels = static_cast<double>(model_.num_channels());
    for (Eigen::Index i = 0; i < kNoiseStretches; ++i) {
      // The fit has removed noise, as in DecayModel::NoiseNear.
      const double removed = (1.0 + 1.0 / channels) *
                             fit_.q.middleRows(i * size, size).squaredNorm();
      const double samples = static_cast<double>(size);
      levels[i] = fit_.residuals.middleRows(i * size, size).squaredNorm() /
                  (channels * std::max(0.05 * samples, samples - removed));
    }
    const double floor =
        floor_.cwiseProduct(model_.channel_weights()).cwiseAbs2().mean();
    levels = levels.cwiseMax(std::max(floor, 1e-4 * levels.maxCoeff()));
    if (levels.maxCoeff() < kSmallestChange * levels.minCoeff()) return false;
    const Vector logs = levels.array().log();
    Vector weights(model_.num_samples());
    for (Eigen::Index k = 0; k < weights.size(); ++k) {
      const double at = std::clamp(
          (static_cast<double>(k) + 0.5) / static_cast<double>(size) - 0.5, 0.0,
          static_cast<double>(kNoiseStretches - 1));
      const Eigen::Index i =
          std::min(static_cast<Eigen::Index>(at), kNoiseStretches - 2);
      const double part = at - static_cast<double>(i);
      weights[k] =
          std::exp(-0.5 * ((1.0 - part) * logs[i] + part * logs[i + 1]));
    }
    model_.set_row_weights(weights);
    return true;
  }

  DecayModel& model_;
  Vector floor_;
  std::vector<DecayTerm> candidates_;
  DecayFit fit_;
};

}  // namespace

DecayFit FindDecays(const std::vector<DecayTerm>& start,
                    const std::vector<std::complex<double>>& candidates,
                    DecayModel* model) {
  return DecayFinder(candidates, model).Find(start);
}

Matrix DecayResiduals(const DecayFit& fit, const DecayModel& model) {
  return (model.row_weights().cwiseInverse().asDiagonal() * fit.residuals *
          model.channel_weights().cwiseInverse().asDiagonal())
      .transpose();
}

}  // namespace pinode
