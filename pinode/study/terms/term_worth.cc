#include "pinode/study/terms/term_worth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pinode/study/terms/discovered_problem.h"

namespace pinode {

bool HasTerm(const DiscoveredEquation& equation, const std::string& basis) {
  return std::any_of(
      equation.terms.begin(), equation.terms.end(),
      [&](const DiscoveredTerm& term) { return term.basis == basis; });
}

int CountTerms(const std::vector<DiscoveredEquation>& equations) {
  int count = 0;
  for (const DiscoveredEquation& equation : equations) {
    count += static_cast<int>(equation.terms.size());
  }
  return count;
}

const ParameterEstimate* FindEstimate(const FitSummary& summary,
                                      const std::string& name) {
  for (const ParameterEstimate& estimate : summary.parameters) {
    if (estimate.name == name) return &estimate;
  }
  return nullptr;
}

Eigen::Index NumFittedValues(const IdentificationProblem& problem) {
  Eigen::Index count = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (const MeasuredChannel& channel : record.channels) {
      if (!channel.fit) continue;
      for (const double value : channel.values) count += std::isfinite(value);
    }
  }
  return count;
}

double Deviance(const IdentificationProblem& problem,
                const FitSummary& summary) {
  double deviance = 0.0;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (size_t c = 0; c < record.channels.size(); ++c) {
      const MeasuredChannel& channel = record.channels[c];
      if (!channel.fit) continue;
      const double present =
          static_cast<double>(channel.values.array().isFinite().count());
      const double mean_square =
          std::max(std::pow(summary.records[r].channels[c].rmse, 2.0), 1e-300);
      deviance += present * (channel.sigma > 0.0
                                 ? mean_square / std::pow(channel.sigma, 2.0)
                                 : std::log(mean_square));
    }
  }
  return deviance;
}

void TakeOver(const FitSummary& summary,
              std::vector<DiscoveredEquation>* equations) {
  for (DiscoveredEquation& equation : *equations) {
    for (DiscoveredTerm& term : equation.terms) {
      const ParameterEstimate* estimate =
          FindEstimate(summary, CoefficientName(equation, term.basis));
      if (estimate == nullptr) continue;
      term.coefficient = estimate->value;
      term.share = std::abs(term.coefficient) * term.basis_rms / equation.scale;
    }
  }
}

bool DropWeakest(const DiscoveryOptions& options, const FitSummary& summary,
                 const TermPrices& prices,
                 std::vector<DiscoveredEquation>* equations) {
  // Ratio of worth to price; below 1 the term is dropped.
  double weakest = 1.0;
  DiscoveredEquation* from = nullptr;
  size_t index = 0;
  for (DiscoveredEquation& equation : *equations) {
    for (size_t k = 0; k < equation.terms.size(); ++k) {
      const DiscoveredTerm& term = equation.terms[k];
      const ParameterEstimate* estimate =
          FindEstimate(summary, CoefficientName(equation, term.basis));
      if (term.given || estimate == nullptr) continue;
      double worth = std::numeric_limits<double>::infinity();
      if (options.prune_fraction > 0.0) {
        worth = term.share / (options.prune_fraction * options.tolerance);
      }
      // A coefficient at the bound that its sign sets is no term. A sigma that
      // is not finite is not evidence against the term.
      if (estimate->at_bound && term.sign != 0) worth = 0.0;
      if (estimate->sigma > 0.0) {
        worth = std::min(worth, std::abs(term.coefficient) /
                                    (std::sqrt(prices.Of(equation, term)) *
                                     estimate->sigma));
      }
      if (worth < weakest) {
        weakest = worth;
        from = &equation;
        index = k;
      }
    }
  }
  if (from == nullptr) return false;
  from->terms.erase(from->terms.begin() + static_cast<std::ptrdiff_t>(index));
  return true;
}

}  // namespace pinode
