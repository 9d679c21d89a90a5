#include "pinode/estimate/start/initial_states.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "pinode/base/logging.h"
#include "pinode/base/power_of_two.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/trajectory_outline.h"

namespace pinode {
namespace {

// Returns the typical circular frequency of the motion: from channels that
// measure a quantity and its derivative, else the model's lowest.
double TypicalFrequency(const IdentificationProblem& problem, double x,
                        double v, double a) {
  if (x > 0.0 && v > 0.0) return v / x;
  if (v > 0.0 && a > 0.0) return a / v;
  if (x > 0.0 && a > 0.0) return std::sqrt(a / x);
  const std::vector<double> frequencies = ModelFrequencies(problem);
  return frequencies.empty() ? 1.0 : frequencies.front();
}

// Returns the size of the internal states after a quarter of a cycle at the
// velocities `scales`, by their own laws from zero, in their units. A
// dissipated energy does not grow at zero: its size comes from its rate at the
// sizes of the other states. If a law gives none there either, returns the
// largest displacement.
Vector InternalScales(const StructuralDynamics& dynamics, const Vector& scales,
                      double omega) {
  const int n = dynamics.num_dofs();
  Vector internal =
      Vector::Constant(dynamics.num_internal(), scales.head(n).maxCoeff());
  StructuralDynamics::Prepared prepared;
  std::string error;
  if (internal.size() == 0 ||
      !dynamics.Prepare(dynamics.Parameters(), &prepared, &error)) {
    return internal;
  }
  auto scratch = dynamics.MakeLinearization();
  Vector input = Vector::Zero(dynamics.num_inputs());
  for (const PrescribedDof& p : dynamics.prescribed()) {
    input[p.velocity] = scales[n + p.dof];
  }
  const auto is_size = [](double value) {
    return value > 0.0 && std::isfinite(value);
  };
  Vector sizes = Vector::Zero(internal.size());
  for (const bool from_zero : {true, false}) {
    Vector largest = Vector::Zero(internal.size());
    for (int i = 0; i < n; ++i) {
      Vector state = Vector::Zero(dynamics.num_states());
      Vector rate(dynamics.num_states());
      state[n + i] = scales[n + i];
      if (!from_zero) state.tail(internal.size()) = sizes;
      dynamics.Rate(prepared, 0.0, input.data(), state.data(), rate.data(),
                    &scratch);
      largest = largest.cwiseMax(rate.tail(internal.size()).cwiseAbs() / omega);
    }
    for (int i = 0; i < internal.size(); ++i) {
      if (sizes[i] == 0.0 && is_size(largest[i])) sizes[i] = largest[i];
    }
    if ((sizes.array() > 0.0).all()) break;
  }
  return (sizes.array() > 0.0).select(sizes, internal);
}

// Seeks the starts of whole records from `known` and from rest, where they are
// now. Leaves those with the smaller cost.
void SeekFromKnown(const Vector& free, const std::vector<Vector>& known,
                   MultipleShooting* shooting) {
  shooting->SetWholeRecords(known);
  double from_known = 0.0;
  if (!shooting->Evaluate(free, &from_known)) {
    SetSegmentsAtRest(0, shooting);
    return;
  }
  std::vector<Vector> found;
  for (const Matrix& starts : shooting->starts()) {
    found.push_back(starts.col(0));
  }
  SetSegmentsAtRest(0, shooting);
  double from_rest = 0.0;
  if (!shooting->Evaluate(free, &from_rest) || !(from_rest < from_known)) {
    shooting->SetWholeRecords(found);
  }
}

}  // namespace

std::vector<double> ModelFrequencies(const IdentificationProblem& problem) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  StructuralDynamics::Prepared prepared;
  std::string error;
  std::vector<double> frequencies;
  if (!dynamics.Prepare(dynamics.Parameters(), &prepared, &error)) {
    return frequencies;
  }
  const Matrix& mass = prepared.linear.mass;
  const Matrix& stiffness = prepared.linear.stiffness;
  const double unit = PowerOfTwoBelow(mass.diagonal().maxCoeff());
  const double other = PowerOfTwoBelow(stiffness.diagonal().maxCoeff());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(
      stiffness / other, mass / unit, Eigen::EigenvaluesOnly);
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  for (double value : solver.eigenvalues()) {
    if (value > 1e-12 * largest) {
      frequencies.push_back(std::sqrt(value * (other / unit)));
    }
  }
  return frequencies;
}

Vector GuessStateScales(const IdentificationProblem& problem,
                        const IdentificationRecord& record) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  double x = 0.0, v = 0.0, a = 0.0;
  for (const MeasuredChannel& channel : record.channels) {
    const double weight = std::abs(problem.InitialGain(channel)) *
                          channel.observation.weights.cwiseAbs().maxCoeff();
    if (!(weight > 0.0)) continue;
    const double size = StandardDeviationOfPresent(channel.values) / weight;
    switch (channel.observation.quantity) {
      case Quantity::kDisplacement:
      case Quantity::kAbsoluteDisplacement:
      case Quantity::kStrain:
        x = std::max(x, size);
        break;
      case Quantity::kVelocity:
        v = std::max(v, size);
        break;
      case Quantity::kRelativeAcceleration:
      case Quantity::kAbsoluteAcceleration:
        a = std::max(a, size);
        break;
      case Quantity::kForce:
        break;
    }
  }
  for (const PrescribedDof& p : dynamics.prescribed()) {
    const auto size = [&record](int input) {
      return StandardDeviationOfPresent(
          record.excitation->samples().row(input).transpose());
    };
    x = std::max(x, size(p.displacement));
    v = std::max(v, size(p.velocity));
  }
  const double omega = TypicalFrequency(problem, x, v, a);
  if (v == 0.0) v = x > 0.0 ? x * omega : a / omega;
  if (x == 0.0) x = v / omega;
  const int n = dynamics.num_dofs();
  Vector scales(dynamics.num_states());
  scales.head(n).setConstant(std::max(x, 1e-290));
  scales.segment(n, n).setConstant(std::max(v, 1e-290));
  scales.tail(dynamics.num_internal()) =
      InternalScales(dynamics, scales, omega);
  return scales;
}

Vector StateScales(const IdentificationProblem& problem, const Matrix& states) {
  return StateScalesOf(problem, states.rowwise().squaredNorm() /
                                    static_cast<double>(states.cols()));
}

Vector StateScalesOf(const IdentificationProblem& problem,
                     const Vector& mean_squares) {
  const int n = problem.dynamics->num_dofs();
  Vector scales = mean_squares.cwiseSqrt();
  const auto lift = [&scales](int first, int count) {
    if (count == 0) return;
    const double largest = scales.segment(first, count).maxCoeff();
    scales.segment(first, count) =
        scales.segment(first, count).cwiseMax(std::max(1e-3 * largest, 1e-290));
  };
  lift(0, n);
  lift(n, n);
  lift(2 * n, problem.dynamics->num_internal());
  return scales;
}

bool InitialTrajectories(const IdentificationProblem& problem,
                         Eigen::Index segment_samples, const Vector& free,
                         const StageTuning& tuning, MultipleShooting* shooting,
                         TrajectoryOutlines* trajectories,
                         const std::vector<Vector>& known) {
  std::vector<Vector> scales;
  for (int r : shooting->train_records()) {
    scales.push_back(
        GuessStateScales(problem, problem.records[static_cast<size_t>(r)]));
  }
  // Two passes: the second uses the scales of the unmeasured states.
  for (int pass = 0; pass < 2; ++pass) {
    if (pass == 0) {
      SetSegmentsAtRest(segment_samples, shooting);
    } else if (!SetSegmentsAlong(segment_samples, *trajectories, shooting)) {
      return false;
    }
    shooting->SetStateScales(scales);
    shooting->SetGapPenalty(tuning.first_gap_penalty);
    if (pass == 0 && segment_samples == 0 && !known.empty()) {
      SeekFromKnown(free, known, shooting);
    }
    double cost = 0.0;
    if (!shooting->Evaluate(free, &cost) ||
        !OutlineTrajectories(*shooting, free, trajectories)) {
      return false;
    }
    for (size_t r = 0; r < scales.size(); ++r) {
      scales[r] = StateScalesOf(problem, trajectories->records[r].mean_squares);
    }
    // Scales do not affect trajectories whose starts are all given.
    if (pass == 0 && !HasFreeStarts(*shooting)) {
      shooting->SetStateScales(scales);
      break;
    }
  }
  return true;
}

}  // namespace pinode
