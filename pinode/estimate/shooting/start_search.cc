#include "pinode/estimate/shooting/start_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pinode {
namespace {

// Damping of the steps, relative to the diagonal, at which a search gives up.
constexpr double kMostDamping = 1e8;

}  // namespace

StartSearch::StartSearch(const StartTuning& tuning, StartEquations* equations,
                         double mu, Matrix predicted, const Matrix* fallback)
    : tuning_(tuning),
      equations_(equations),
      mu_(mu),
      fallback_(fallback),
      trial_(std::move(predicted)) {}

void StartSearch::Accept(double cost) {
  const double gain = progress_.cost - cost;
  best_ = trial_;
  progress_.cost = cost;
  if (gain < 0.25 * progress_.promise) {
    damping_ = std::max(1e-3, 3.0 * damping_);
  } else if (gain > 0.75 * progress_.promise) {
    damping_ *= damping_ > 1e-6 ? 0.1 : 0.0;
  }
  equations_->Assemble(mu_, best_, 0, &gradient_);
}

bool StartSearch::Reject() {
  if (!found()) {
    // The tangent led astray: fall back on the starts themselves, once.
    if (failed_once_ || fallback_ == nullptr) return false;
    failed_once_ = true;
    trial_ = *fallback_;
    return true;
  }
  damping_ = std::max(1e-3, 10.0 * damping_);
  progress_.done = damping_ > kMostDamping;
  return true;
}

bool StartSearch::Step(bool improved, double linearized_cost) {
  while (!equations_->system().Factor(damping_)) {
    damping_ = std::max(1e-12, 10.0 * damping_);
    if (damping_ > kMostDamping) return false;
  }
  Matrix step = gradient_;
  equations_->system().SolveLower(&step);
  progress_.promise = 0.5 * step.squaredNorm();
  // Of a search that has come to a cost; less is too little to go on for.
  const auto least_promise = [&](double cost) {
    const double least = tuning_.tolerance * cost;
    return std::isfinite(linearized_cost)
               ? std::max(least,
                          tuning_.change_tolerance *
                              std::abs(cost - equations_->linearized_cost))
               : least;
  };
  progress_.last_promise = least_promise(progress_.cost - progress_.promise);
  const bool hopeless =
      iteration_ >= tuning_.hopeless_iterations &&
      progress_.cost - tuning_.hopeless_promises * progress_.promise >
          tuning_.hopeless_cost * linearized_cost;
  if ((improved && progress_.promise <= least_promise(progress_.cost)) ||
      hopeless) {
    progress_.done = true;
    return true;
  }
  equations_->system().SolveUpper(&step);
  trial_ =
      best_ - Eigen::Map<const Matrix>(step.data(), best_.rows(), best_.cols());
  return true;
}

bool StartSearch::Advance(bool finite, double linearized_cost) {
  const double cost = finite ? equations_->Cost(mu_, trial_) : 0.0;
  finite = finite && std::isfinite(cost);
  if (!equations_->HasFreeStarts()) {
    best_ = trial_;
    progress_.cost = cost;
    progress_.is_at_trial = true;
    progress_.done = true;
    return finite;
  }
  const bool improved = finite && cost < progress_.cost;
  progress_.is_at_trial = improved;
  if (improved) {
    Accept(cost);
  } else {
    if (!Reject()) return false;
    if (!found() || progress_.done) {
      ++iteration_;
      return true;
    }
  }
  const bool ok = Step(improved, linearized_cost);
  ++iteration_;
  return ok;
}

bool LookAhead::GoesAlong(int num_sweeps,
                          const std::vector<StartProgress>& searches,
                          double linearized_cost) const {
  if (num_sweeps == 0) return goes_first_;
  if (num_sweeps != 1 || promised_.empty() || bend_.size() != searches.size()) {
    return false;
  }
  // From one step of a fit to the next `bend_` changes by a factor of two or
  // so.
  constexpr double kCaution = 3.0;
  double cost = 0.0;
  for (size_t r = 0; r < searches.size(); ++r) {
    const StartProgress& search = searches[r];
    if (kCaution * bend_[r] * promised_[r] * promised_[r] >
        search.last_promise) {
      return false;
    }
    cost += search.cost - promised_[r];
  }
  // Steps of a fit that lead uphill are mostly rejected.
  return cost < linearized_cost;
}

void LookAhead::Learn(int num_sweeps,
                      const std::vector<StartProgress>& searches) {
  const auto all = [&searches](auto what) {
    return std::all_of(searches.begin(), searches.end(), what);
  };
  const bool at_trial =
      all([](const StartProgress& search) { return search.is_at_trial; });
  if (num_sweeps == 1) {
    promised_.clear();
    if (!at_trial ||
        !all([](const StartProgress& search) { return !search.done; })) {
      return;
    }
    for (const StartProgress& search : searches) {
      promised_.push_back(search.promise);
    }
  } else if (num_sweeps == 2 && at_trial && !promised_.empty()) {
    bend_.clear();
    for (size_t r = 0; r < searches.size(); ++r) {
      bend_.push_back(searches[r].promise / (promised_[r] * promised_[r]));
    }
  }
}

}  // namespace pinode
