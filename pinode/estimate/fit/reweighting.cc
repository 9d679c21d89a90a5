#include "pinode/estimate/fit/reweighting.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/logging.h"
#include "pinode/estimate/shooting/residual_statistics.h"
#include "pinode/problem/assumed_noise.h"

namespace pinode {

const SeriesStatistics& Reweighting::Measured(size_t t, int c) const {
  return context_.objective.shooting()
      .record(t)
      .measured()[static_cast<size_t>(c)];
}

double Reweighting::Smallest(const SeriesStatistics& measured) const {
  const NoiseTuning& tuning = context_.tuning().noise;
  const double floor = tuning.smallest * std::max(measured.rms, kLeastNoise);
  return context_.HasNetworks()
             ? std::max(floor,
                        tuning.smallest_misfit * measured.StandardDeviation())
             : floor;
}

std::vector<Vector> Reweighting::FirstSigmas(
    const IdentifiedModel* initial) const {
  const NoiseTuning& tuning = context_.tuning().noise;
  const double share =
      context_.HasNetworks() ? tuning.smallest_misfit : tuning.first_share;
  std::vector<Vector> sigmas;
  for (size_t t = 0; t < context_.train_records().size(); ++t) {
    const IdentificationRecord& record = context_.train_record(t);
    Vector sigma(static_cast<int>(record.channels.size()));
    for (int c = 0; c < sigma.size(); ++c) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      const SeriesStatistics& measured = Measured(t, c);
      sigma[c] = channel.sigma > 0.0
                     ? channel.sigma
                     : std::max(share * measured.StandardDeviation(),
                                Smallest(measured));
    }
    const size_t r = static_cast<size_t>(context_.train_records()[t]);
    if (initial != nullptr && r < initial->sigmas.size() &&
        initial->sigmas[r].size() == sigma.size() &&
        initial->sigmas[r].minCoeff() > 0.0) {
      sigma = initial->sigmas[r];
    }
    sigmas.push_back(sigma);
  }
  return sigmas;
}

double Reweighting::ShareLeft(const Evidence& evidence) const {
  double samples = 0.0;
  double used = evidence.effective;
  const Matrix& others = context_.objective.other_information();
  if (others.size() > 0) {
    // Part of modes and ambient records, which the channels do not pay for.
    used -= (evidence.inverse_root.transpose() * others * evidence.inverse_root)
                .trace();
  }
  for (size_t t = 0; t < context_.train_records().size(); ++t) {
    const IdentificationRecord& record = context_.train_record(t);
    for (size_t c = 0; c < record.channels.size(); ++c) {
      if (!record.channels[c].fit) continue;
      samples += static_cast<double>(Measured(t, static_cast<int>(c)).count);
    }
    // Closed gaps leave only the first start free.
    if (record.start == IdentificationRecord::Start::kFree) {
      used += context_.problem.dynamics->num_states();
    }
  }
  return std::clamp(1.0 - used / std::max(1.0, samples),
                    context_.tuning().noise.least_share_left, 1.0);
}

double Reweighting::ChannelShareLeft(size_t t, int c,
                                     const Vector& leverages) const {
  const auto channels =
      static_cast<Eigen::Index>(context_.train_record(t).channels.size());
  double leverage = 0.0;
  for (Eigen::Index i = c; i < leverages.size(); i += channels) {
    leverage += leverages[i];
  }
  return std::max(context_.tuning().noise.least_channel_left,
                  1.0 - leverage / static_cast<double>(std::max<Eigen::Index>(
                                       1, Measured(t, c).count)));
}

bool Reweighting::MeasureRows(const Vector& free, Rows* rows) const {
  // A force acts on some channels directly and can follow their noise: its
  // used-up share must be counted per channel.
  const bool by_channel = !context_.problem.dynamics->unknown_forces().empty();
  MultipleShooting& shooting = context_.objective.shooting();
  const std::vector<Vector>* squares = shooting.state().SquaresAt(free);
  CHECK(squares != nullptr) << "just linearised";
  rows->squares = *squares;
  return !(by_channel || context_.HasNetworks()) ||
         WeightedResiduals(free, by_channel, &shooting, &rows->residuals,
                           &rows->jacobians);
}

double Reweighting::UpdateSigmas(const Rows& rows, const Evidence& evidence,
                                 bool converged, FitState* state) {
  const NoiseTuning& tuning = context_.tuning().noise;
  const bool networks = context_.HasNetworks();
  const double shrink =
      networks ? 1.0 - tuning.network_step_down : tuning.shrink;
  const double growth = networks && !converged ? 1.0 : tuning.growth;
  state->share_left = ShareLeft(evidence);
  std::string followed_record, followed_channel;
  double most_wanted = 0.0;
  for (size_t t = 0; t < rows.squares.size(); ++t) {
    const IdentificationRecord& record = context_.train_record(t);
    Vector leverages;  // of each residual, channels fastest
    if (!rows.jacobians.empty()) {
      leverages =
          (rows.jacobians[t] * evidence.inverse_root).rowwise().squaredNorm();
    }
    for (int c = 0; c < rows.squares[t].size(); ++c) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      if (channel.sigma > 0.0 || !channel.fit) continue;
      double left = state->share_left;
      if (!rows.jacobians.empty()) {
        left = ChannelShareLeft(t, c, leverages);
        if (left < tuning.followed && followed_channel.empty()) {
          followed_channel = channel.observation.name;
          followed_record = record.name;
        }
      }
      double mean_square =
          rows.squares[t][c] /
          static_cast<double>(std::max<Eigen::Index>(1, Measured(t, c).count)) /
          left;
      if (networks) {
        mean_square *= AutocorrelationTime(rows.residuals[t].row(c));
      }
      const double floor = Smallest(Measured(t, c));
      double& sigma = state->sigmas[t][c];
      const double wanted = annealing_->Limit(
          t, c, floor, sigma, std::max(floor, std::sqrt(mean_square)));
      most_wanted = std::max(most_wanted, std::abs(wanted / sigma - 1.0));
      sigma = std::clamp(wanted, std::max(floor, shrink * sigma),
                         std::max(floor, growth * sigma));
    }
  }
  log_->SetFollowedChannel(followed_record, followed_channel);
  context_.objective.shooting().SetSigmas(state->sigmas);
  return most_wanted;
}

Reweighting::Outcome Reweighting::Update(bool converged, FitState* state) {
  Objective& objective = context_.objective;
  const EvidenceTuning& tuning = context_.tuning().evidence;
  Outcome outcome;
  outcome.noise_is_quiet = noise_is_quiet_;
  CondensedSystem system;
  Rows rows;
  Evidence evidence;
  if (!objective.Linearize(state->free, &system) ||
      !MeasureRows(state->free, &rows) ||
      !MeasureEvidence(context_.layout, system.hessian, state->decays,
                       state->free, &evidence)) {
    return outcome;
  }
  const double before = context_.summary.effective_parameters;
  const double after = evidence.effective;
  log_->SetEffectiveParameters(after);
  UpdateDecays(context_.layout, tuning, evidence, &state->decays);
  objective.priors().SetDecays(state->decays);
  const double wanted = UpdateSigmas(rows, evidence, converged, state);
  VLOG(1) << "noise to change by " << wanted << ", well-determined "
          << "parameters " << before << " -> " << after;
  noise_is_quiet_ = wanted < context_.tuning().noise.quiet;
  outcome.noise_is_quiet = noise_is_quiet_;
  outcome.is_quiet =
      noise_is_quiet_ && std::abs(after - before) <
                             tuning.quiet_share * context_.layout.num_free() +
                                 tuning.quiet_parameters;
  outcome.evidence_change = std::abs(after / before - 1.0);
  return outcome;
}

}  // namespace pinode
