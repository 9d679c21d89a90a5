#include "pinode/study/explanations/refit_odds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/explanations/modes_search.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// Logarithm of the likelihood of ambient records, measured modes and FRFs. The
// variances of the lines of an ambient record are those that the fit `scale`
// leaves: its chi^2 per degree of freedom, at least 1. Correlated lines of FRFs
// count as fewer.
double LogLikelihood(const FitSummary& fit, const FitSummary& scale) {
  double sum = 0.0;
  for (size_t i = 0; i < fit.ambient.size(); ++i) {
    const AmbientScore& score = scale.ambient[i];
    const double freedom = static_cast<double>(score.degrees_of_freedom);
    const double likelihood = fit.ambient[i].evidence.log_likelihood;
    // Zero: the loads could not be judged, and nothing is known of the odds.
    if (likelihood == 0.0) return std::numeric_limits<double>::quiet_NaN();
    sum += likelihood /
           (freedom > 0.0 ? std::max(1.0, score.chi_square / freedom) : 1.0);
  }
  for (size_t i = 0; i < fit.frfs.size(); ++i) {
    sum += fit.frfs[i].log_likelihood / scale.frfs[i].memory;
  }
  return fit.modes.empty() ? sum : sum - fit.final_modal_cost;
}

// True unless a clock is among the suspects and the factors that it gives to
// stiffness and damping, the square of one number and that number, contradict
// each other: then something else has changed them.
bool ClockIsConsistent(const Refit& refit,
                       const std::vector<Suspect>& suspects) {
  for (const size_t i : refit.suspects) {
    const Suspect& suspect = suspects[i];
    if (suspect.kind != Suspect::Kind::kClockRate) continue;
    const std::vector<std::string> unknowns = suspect.Unknowns();
    const ParameterEstimate* stiffness = FindEstimate(refit.fit, unknowns[0]);
    const ParameterEstimate* damping = FindEstimate(refit.fit, unknowns[1]);
    constexpr double kDetermined = 0.2;
    constexpr double kRounding = 0.02;
    if (stiffness == nullptr || damping == nullptr ||
        !(stiffness->value > -1.0) || !(stiffness->sigma < kDetermined)) {
      return false;
    }
    const double expected = std::sqrt(1.0 + stiffness->value) - 1.0;
    const double deviation = std::hypot(damping->sigma, 0.5 * stiffness->sigma);
    if (std::abs(damping->value - expected) > kRounding + 3.0 * deviation) {
      return false;
    }
  }
  return true;
}

// True if a mass or stiffness has become so many times as large that the same
// of a group would be a finding: it stands for something else. A sensor turned
// in an ambient record, whose fit had lost itself, gave masses of 9 and 18
// times.
bool IsOutOfSize(const Refit& refit, const std::vector<Suspect>& suspects) {
  for (const size_t i : refit.suspects) {
    const Suspect& suspect = suspects[i];
    if (suspect.kind != Suspect::Kind::kMass &&
        suspect.kind != Suspect::Kind::kStiffness) {
      continue;
    }
    for (const std::string& unknown : suspect.Unknowns()) {
      const ParameterEstimate* estimate = FindEstimate(refit.fit, unknown);
      if (estimate != nullptr && 1.0 + estimate->value > limits::kGroupSize) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

double ResidualMemory(const IdentificationProblem& problem,
                      const FitSummary& fit) {
  double sum = 0.0;
  int count = 0;
  for (size_t r = 0; r < fit.records.size(); ++r) {
    const RecordScore& score = fit.records[r];
    const IdentificationRecord& record = problem.records[r];
    if (score.role != IdentificationRecord::Role::kTrain ||
        score.prediction.cols() != record.num_samples()) {
      continue;
    }
    for (size_t c = 0; c < record.channels.size(); ++c) {
      if (!record.channels[c].fit) continue;
      Vector residuals =
          record.channels[c].values -
          score.prediction.row(static_cast<Eigen::Index>(c)).transpose();
      residuals = residuals.array().isNaN().select(0.0, residuals);
      sum += AutocorrelationTime(residuals);
      ++count;
    }
  }
  return std::max(1.0, sum / std::max(count, 1));
}

RefitOdds::RefitOdds(const IdentificationProblem& problem,
                     const FitSummary& fit)
    : problem_(problem), fit_(fit) {
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (const MeasuredChannel& channel : record.channels) {
      if (channel.fit) {
        num_samples_ += static_cast<double>(CountPresent(channel.values));
      }
    }
  }
  for (const AmbientScore& score : fit.ambient) {
    // Real and imaginary parts.
    num_samples_ += 2.0 * static_cast<double>(score.num_lines) *
                    static_cast<double>(score.channels.size());
  }
  for (const FrfScore& score : fit.frfs) {
    num_samples_ += 2.0 * static_cast<double>(score.num_lines) *
                    static_cast<double>(score.pairs.size());
  }
  for (size_t i = 0; i < fit.modes.size(); ++i) {
    if (!fit.modes[i].InUse()) continue;
    num_samples_ += NumbersOf(problem.modal.modes[i]);
  }
}

double RefitOdds::Penalty(int num_unknowns, size_t num_suspects) const {
  return 0.5 * num_unknowns * std::log(std::max(num_samples_, 2.0)) +
         std::log(static_cast<double>(num_suspects));
}

double RefitOdds::LogOddsOf(const Refit& refit,
                            const std::vector<Suspect>& suspects) const {
  if (!ClockIsConsistent(refit, suspects) || IsOutOfSize(refit, suspects)) {
    return -kInfinity;
  }
  const double memory = ResidualMemory(refit.problem, refit.fit);
  double gain = 0.0;
  for (size_t r = 0; r < fit_.records.size(); ++r) {
    const RecordScore& before = fit_.records[r];
    const RecordScore& after = refit.fit.records[r];
    if (before.role != IdentificationRecord::Role::kTrain) continue;
    if (!after.finite) return -kInfinity;
    const IdentificationRecord& record = refit.problem.records[r];
    for (size_t c = 0; c < record.channels.size(); ++c) {
      if (!record.channels[c].fit) continue;
      const double count =
          static_cast<double>(CountPresent(record.channels[c].values));
      gain += count / memory *
              std::log(before.channels[c].rmse /
                       std::max(after.channels[c].rmse, 1e-300));
    }
  }
  gain += LogLikelihood(refit.fit, refit.fit) - LogLikelihood(fit_, refit.fit);
  int unknowns = 0;
  double candidates = 0.0;
  for (const size_t i : refit.suspects) {
    unknowns += static_cast<int>(suspects[i].Unknowns().size());
    // A gain of an ambient record is an unknown, its sign is not.
    for (const Suspect::AmbientScale& at : suspects[i].ambient_scales) {
      unknowns += at.factor > 0.0 ? 1 : 0;
    }
    for (const int mode : suspects[i].left_out_modes) {
      unknowns += NumbersOf(problem_.modal.modes[static_cast<size_t>(mode)]);
    }
    candidates += std::log(static_cast<double>(suspects.size()));
  }
  return gain -
         0.5 * unknowns * std::log(std::max(num_samples_ / memory, 2.0)) -
         candidates;
}

}  // namespace pinode
