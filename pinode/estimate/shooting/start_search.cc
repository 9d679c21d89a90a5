#include "pinode/estimate/shooting/start_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pinode {
namespace {

constexpr double kMostDamping = 1e8;

}  // namespace

StartSearch::StartSearch(const StartTuning& tuning, ShootingRecord* record,
                         double mu, Matrix predicted, const Matrix* fallback)
    : tuning_(tuning),
      record_(record),
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
  record_->Assemble(mu_, best_, 0, &gradient_);
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
  while (!record_->system().Factor(damping_)) {
    damping_ = std::max(1e-12, 10.0 * damping_);
    if (damping_ > kMostDamping) return false;
  }
  Matrix step = gradient_;
  record_->system().SolveLower(&step);
  progress_.promise = 0.5 * step.squaredNorm();
  // Of a search that has come to a cost; less is too little to go on for.
  const auto least_promise = [&](double cost) {
    const double least = tuning_.tolerance * cost;
    return std::isfinite(linearized_cost)
               ? std::max(least, tuning_.change_tolerance *
                                     std::abs(cost - record_->linearized_cost))
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
  record_->system().SolveUpper(&step);
  trial_ =
      best_ - Eigen::Map<const Matrix>(step.data(), best_.rows(), best_.cols());
  return true;
}

bool StartSearch::Advance(bool finite, double linearized_cost) {
  const double cost = finite ? record_->Cost(mu_, trial_) : 0.0;
  finite = finite && std::isfinite(cost);
  if (!record_->HasFreeStarts()) {
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

}  // namespace pinode
