#include "pinode/estimate/objective/noise_levels.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/problem/assumed_noise.h"

namespace pinode {

bool AreValidSigmas(const IdentificationProblem& problem,
                    const std::vector<Vector>& sigmas, std::string* error) {
  if (sigmas.empty()) return true;
  if (static_cast<int>(sigmas.size()) != problem.num_train_records()) {
    *error = "there are sigmas for " + std::to_string(sigmas.size()) +
             " training records of " +
             std::to_string(problem.num_train_records());
    return false;
  }
  size_t t = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const Vector& sigma = sigmas[t++];
    if (sigma.size() != static_cast<Eigen::Index>(record.channels.size()) ||
        !sigma.allFinite() || !(sigma.array() > 0.0).all()) {
      *error = "record '" + record.name + "': its sigmas must be " +
               std::to_string(record.channels.size()) +
               " positive numbers, one per channel";
      return false;
    }
  }
  return true;
}

const SeriesStatistics& NoiseLevels::Measured(size_t t, int c) const {
  return context_.objective.shooting()
      .record(t)
      .measured()[static_cast<size_t>(c)];
}

double NoiseLevels::Smallest(const SeriesStatistics& measured) const {
  const NoiseTuning& tuning = context_.tuning().noise;
  const double floor = tuning.smallest * std::max(measured.rms, kLeastNoise);
  return context_.HasNetworks()
             ? std::max(floor,
                        tuning.smallest_misfit * measured.StandardDeviation())
             : floor;
}

std::vector<Vector> NoiseLevels::First(const IdentifiedModel* initial) const {
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

double NoiseLevels::ShareLeft(const Evidence& evidence) const {
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

double NoiseLevels::ChannelShareLeft(size_t t, int c, const Vector& leverages,
                                     Change* change) const {
  const NoiseTuning& tuning = context_.tuning().noise;
  const IdentificationRecord& record = context_.train_record(t);
  const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
  const Eigen::Index channels =
      static_cast<Eigen::Index>(record.channels.size());
  double leverage = 0.0;
  for (Eigen::Index i = c; i < leverages.size(); i += channels) {
    leverage += leverages[i];
  }
  const double left =
      std::max(tuning.least_channel_left,
               1.0 - leverage / static_cast<double>(std::max<Eigen::Index>(
                                    1, Measured(t, c).count)));
  if (left < tuning.followed && change->followed_channel.empty()) {
    change->followed_channel = channel.observation.name;
    change->followed_record = record.name;
  }
  return left;
}

NoiseLevels::Change NoiseLevels::Update(const WeightedRows& rows,
                                        const Evidence& evidence,
                                        bool converged, Annealing* annealing,
                                        FitState* state) const {
  const NoiseTuning& tuning = context_.tuning().noise;
  const bool networks = context_.HasNetworks();
  const double shrink =
      networks ? 1.0 - tuning.network_step_down : tuning.shrink;
  const double growth = networks && !converged ? 1.0 : tuning.growth;
  state->share_left = ShareLeft(evidence);
  Change change;
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
      const double left = rows.jacobians.empty()
                              ? state->share_left
                              : ChannelShareLeft(t, c, leverages, &change);
      double mean_square =
          rows.squares[t][c] /
          static_cast<double>(std::max<Eigen::Index>(1, Measured(t, c).count)) /
          left;
      if (networks) {
        mean_square *= AutocorrelationTime(rows.residuals[t].row(c));
      }
      const double floor = Smallest(Measured(t, c));
      double& sigma = state->sigmas[t][c];
      const double wanted = annealing->Limit(
          t, c, floor, sigma, std::max(floor, std::sqrt(mean_square)));
      change.wanted = std::max(change.wanted, std::abs(wanted / sigma - 1.0));
      sigma = std::clamp(wanted, std::max(floor, shrink * sigma),
                         std::max(floor, growth * sigma));
    }
  }
  change.quiet = change.wanted < tuning.quiet;
  return change;
}

}  // namespace pinode
