#include "pinode/discover/smoothed_record.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/discover/smooth_motion.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {
namespace {

int DerivativeOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::kVelocity:
      return 1;
    case Quantity::kRelativeAcceleration:
    case Quantity::kAbsoluteAcceleration:
      return 2;
    case Quantity::kDisplacement:
    case Quantity::kAbsoluteDisplacement:
    case Quantity::kForce:
    case Quantity::kStrain:
      break;
  }
  return 0;
}

bool ShowsAlone(const MeasuredChannel& channel, int dof) {
  const Vector& weights = channel.observation.weights;
  return channel.fit && channel.observation.quantity != Quantity::kForce &&
         weights[dof] != 0.0 && (weights.array() != 0.0).count() == 1;
}

// Returns a channel that measures `dof` alone as a record of that DOF's own
// motion.
MotionChannel MotionOf(const IdentificationProblem& problem,
                       const IdentificationRecord& record,
                       const MeasuredChannel& channel, int dof) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const double weight = channel.observation.weights[dof];
  const double gain = problem.InitialGain(channel);
  MotionChannel motion;
  motion.derivative = DerivativeOf(channel.observation.quantity);
  motion.values = channel.values / gain;
  motion.sigma = channel.sigma / std::abs(gain * weight);
  // Subtracts the ground's own motion from absolute channels.
  const ObservationMap map(dynamics, {channel.observation});
  const Vector rest = Vector::Zero(dynamics.num_states());
  for (Eigen::Index i = 0; i < motion.values.size(); ++i) {
    const Vector input = record.excitation->samples().col(i);
    double ground = 0.0;
    map.Observe(rest.data(), rest.data(), input.data(), &ground);
    motion.values[i] = (motion.values[i] - ground) / weight;
  }
  return motion;
}

bool SmoothDof(const IdentificationProblem& problem,
               const IdentificationRecord& record, int dof,
               SmoothedRecord* result, std::string* error) {
  std::vector<MotionChannel> shown;
  std::vector<int> channels;
  for (size_t c = 0; c < record.channels.size(); ++c) {
    if (!ShowsAlone(record.channels[c], dof)) continue;
    shown.push_back(MotionOf(problem, record, record.channels[c], dof));
    channels.push_back(static_cast<int>(c));
  }
  SmoothedMotion motion;
  if (shown.empty()) {
    *error = "no displacement channel of it alone";
    return false;
  }
  if (!SmoothMotion(record.sampling_step(), shown, &motion, error)) {
    return false;
  }
  const int n = problem.dynamics->num_dofs();
  result->states.row(dof) = motion.motion.row(0);
  result->states.row(n + dof) = result->rates.row(dof) = motion.motion.row(1);
  result->rates.row(n + dof) = motion.motion.row(2);
  result->sigma.row(dof) = motion.sigma.row(2);
  for (size_t k = 0; k < channels.size(); ++k) {
    const MeasuredChannel& channel =
        record.channels[static_cast<size_t>(channels[k])];
    result->noise[channels[k]] =
        motion.noise[k] * std::abs(problem.InitialGain(channel) *
                                   channel.observation.weights[dof]);
  }
  return true;
}

}  // namespace

bool SmoothRecord(const IdentificationProblem& problem,
                  const IdentificationRecord& record, SmoothedRecord* result,
                  std::string* error) {
  constexpr double kShareOfSpread = 0.05;
  const StructuralDynamics& dynamics = *problem.dynamics;
  const int n = dynamics.num_dofs();
  const Eigen::Index samples = record.num_samples();
  result->states.resize(2 * n, samples);
  result->rates.resize(2 * n, samples);
  result->sigma.resize(n, samples);
  result->noise =
      Vector::Zero(static_cast<Eigen::Index>(record.channels.size()));
  for (int dof = 0; dof < n; ++dof) {
    if (!SmoothDof(problem, record, dof, result, error)) {
      *error = "record '" + record.name + "', DOF '" +
               dynamics.model().dof_names[static_cast<size_t>(dof)] +
               "': " + *error;
      return false;
    }
  }
  for (size_t c = 0; c < record.channels.size(); ++c) {
    double& noise = result->noise[static_cast<Eigen::Index>(c)];
    if (noise != 0.0) continue;
    const MeasuredChannel& channel = record.channels[c];
    noise = channel.sigma > 0.0
                ? channel.sigma
                : std::max(kShareOfSpread *
                               StandardDeviationOfPresent(channel.values),
                           1e-290);
  }
  return true;
}

std::vector<Eigen::Index> WellKnownSamples(const Matrix& sigma) {
  const Eigen::Index samples = sigma.cols();
  std::vector<Eigen::Index> kept(static_cast<size_t>(samples));
  for (size_t i = 0; i < kept.size(); ++i)
    kept[i] = static_cast<Eigen::Index>(i);
  for (Eigen::Index dof = 0; dof < sigma.rows(); ++dof) {
    Vector sorted = sigma.row(dof).transpose();
    std::nth_element(sorted.begin(), sorted.begin() + samples / 2,
                     sorted.end());
    const double limit = 2.0 * sorted[samples / 2];
    kept.erase(
        std::remove_if(kept.begin(), kept.end(),
                       [&](Eigen::Index i) { return sigma(dof, i) > limit; }),
        kept.end());
  }
  return kept;
}

}  // namespace pinode
