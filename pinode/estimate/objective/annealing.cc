#include "pinode/estimate/objective/annealing.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"

namespace pinode {
namespace {

using DecayGroup = ParameterLayout::DecayGroup;

}  // namespace

bool Annealing::SetFirstDecays(Vector* decays) const {
  const Tuning& tuning = context_.tuning();
  bool any = false;
  for (int g = 0; g < context_.layout.num_decay_groups(); ++g) {
    const DecayGroup& group =
        context_.layout.decay_groups()[static_cast<size_t>(g)];
    if (group.IsGiven() || group.network < 0) continue;
    any = true;
    const bool output = group.kind == DecayGroup::Kind::kOutput;
    (*decays)[g] = (output ? tuning.annealing.output_decay : 1.0) *
                   tuning.evidence.first_decay;
  }
  return any;
}

void Annealing::Redraw(const Vector& first_free, Vector* free) const {
  const ParameterLayout& layout = context_.layout;
  for (int j = 0; j < layout.num_free(); ++j) {
    const int g = layout.DecayGroupOf(layout.free()[static_cast<size_t>(j)]);
    if (g < 0) continue;
    const DecayGroup& group = layout.decay_groups()[static_cast<size_t>(g)];
    if (group.IsGiven() || !context_.problem.dynamics
                                ->networks()[static_cast<size_t>(group.network)]
                                .drawn) {
      continue;
    }
    const bool output = group.kind == DecayGroup::Kind::kOutput;
    (*free)[j] =
        (output ? 1.0 : context_.tuning().annealing.weights) * first_free[j];
  }
}

void Annealing::Begin(const Vector& first_free, const LeftOver* left_over,
                      FitState* state) {
  targets_.clear();
  ceilings_.clear();
  for (size_t t = 0; t < state->sigmas.size(); ++t) {
    const Eigen::Index channels = state->sigmas[t].size();
    targets_.push_back(Vector::Zero(channels));
    ceilings_.push_back(Vector::Constant(channels, kInfinity));
    if (left_over == nullptr) continue;
    ceilings_[t] = left_over->sigmas[t];
    if (left_over->residuals.empty()) continue;
    for (Eigen::Index c = 0; c < left_over->residuals[t].rows(); ++c) {
      targets_[t][c] =
          left_over->sigmas[t][c] *
          std::sqrt(MemorylessMeanSquare(left_over->residuals[t].row(c)) /
                    state->share_left);
    }
  }
  Redraw(first_free, &state->free);
  for (size_t t = 0; t < state->sigmas.size(); ++t) {
    const IdentificationRecord& record = context_.train_record(t);
    for (int c = 0; c < state->sigmas[t].size(); ++c) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      if (channel.sigma > 0.0) continue;
      double& sigma = state->sigmas[t][c];
      sigma = std::max(sigma, context_.tuning().annealing.noise *
                                  StandardDeviationOfPresent(channel.values));
    }
  }
}

double Annealing::Limit(size_t t, int c, double floor, double sigma,
                        double wanted) {
  if (!HasBegun()) return wanted;
  double& target = targets_[t][c];
  const double lowest = std::max(floor, target);
  if (sigma <= lowest) target = kInfinity;
  return std::max(
      floor, std::min(wanted, target == kInfinity ? ceilings_[t][c] : lowest));
}

}  // namespace pinode
