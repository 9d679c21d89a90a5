#include "pinode/integrate/switched_step.h"

#include <cmath>

namespace pinode {
namespace {

// Shortest piece and accuracy of an instant, as shares of a step: rounding of
// the state is larger.
constexpr double kInstant = 1e-12;
// Roots closer than this are one event, as a share of the change over a piece.
constexpr double kSameEvent = 1e-9;
// Illinois converges in fewer than ten iterations on smooth functions.
constexpr int kMostIterations = 60;

// Computes the parabola through the nodes of a step.
void InputsAt(const IntegrationGrid& grid, Eigen::Index interval, int substep,
              double share, Vector* inputs) {
  const double* nodes[] = {grid.AtNode(interval, substep, 0),
                           grid.AtNode(interval, substep, 1),
                           grid.AtNode(interval, substep, 2)};
  const double weights[] = {(2.0 * share - 1.0) * (share - 1.0),
                            4.0 * share * (1.0 - share),
                            share * (2.0 * share - 1.0)};
  inputs->setZero(grid.num_inputs());
  for (int k = 0; k < 3; ++k) {
    for (Eigen::Index i = 0; i < inputs->size(); ++i) {
      (*inputs)[i] += weights[k] * nodes[k][i];
    }
  }
}

}  // namespace

SwitchedStep::SwitchedStep(const StructuralDynamics& dynamics)
    : dynamics_(dynamics),
      stage_(dynamics.MakeLinearization()),
      scratch_(dynamics.num_states()),
      branches_(static_cast<size_t>(dynamics.num_switches()), 0),
      switches_(Vector::Zero(dynamics.num_switches())),
      trial_(Vector::Zero(dynamics.num_states())),
      rate_(Vector::Zero(dynamics.num_states())),
      gradient_(Vector::Zero(dynamics.num_states())) {}

void SwitchedStep::TakeBranches() {
  for (size_t j = 0; j < branches_.size(); ++j) {
    branches_[j] = switches_[static_cast<Eigen::Index>(j)] > 0.0 ? 1 : 0;
  }
}

void SwitchedStep::Begin(const StructuralDynamics::Prepared& prepared,
                         double time, const double* input,
                         const double* state) {
  dynamics_.Switches(prepared, time, input, state, switches_.data());
  TakeBranches();
}

bool SwitchedStep::MayEndAt(const StructuralDynamics::Prepared& prepared,
                            double time, const double* input,
                            const Vector& state) {
  if (!state.allFinite()) return false;
  dynamics_.Switches(prepared, time, input, state.data(), switches_.data());
  return Agree();
}

bool SwitchedStep::Agree() const {
  for (int j = 0; j < dynamics_.num_switches(); ++j) {
    if (!Agrees(j, branches_)) return false;
  }
  return true;
}

void SwitchedStep::NodesOf(const IntegrationGrid& grid, Eigen::Index interval,
                           int substep, const Piece& piece, Nodes* nodes) {
  const double dt = grid.step();
  InputsAt(grid, interval, substep, piece.begin / dt, &nodes->begin);
  InputsAt(grid, interval, substep, (piece.begin + 0.5 * piece.duration) / dt,
           &nodes->middle);
  InputsAt(grid, interval, substep, (piece.begin + piece.duration) / dt,
           &nodes->end);
}

void SwitchedStep::Run(const Whole& whole, const Piece& piece, Vector* state) {
  NodesOf(whole.grid, whole.interval, whole.substep, piece, &nodes_);
  const Vector* nodes[] = {&nodes_.begin, &nodes_.middle, &nodes_.end};
  dynamics_.SetBranches(
      piece.branches.empty() ? nullptr : piece.branches.data(), &stage_);
  Rk4Step(
      [&](int node, double time, const double* h, double* rate) {
        dynamics_.Rate(whole.prepared, time, nodes[node]->data(), h, rate,
                       &stage_);
      },
      whole.time() + piece.begin, piece.duration, state->data(), &scratch_);
  dynamics_.Prescribe(nodes_.end.data(), state->data());
}

void SwitchedStep::SwitchesAt(const Whole& whole, const Piece& piece,
                              const Vector& state) {
  const double end = piece.begin + piece.duration;
  InputsAt(whole.grid, whole.interval, whole.substep, end / whole.grid.step(),
           &nodes_.end);
  dynamics_.Switches(whole.prepared, whole.time() + end, nodes_.end.data(),
                     state.data(), switches_.data());
}

bool SwitchedStep::FindEnd(const Whole& whole, int j, const Vector& state,
                           Piece* piece) {
  double low = 0.0;
  double high = piece->duration;
  double high_value = switches_[j];  // at the end of the piece
  Piece trial = *piece;
  trial.duration = 0.0;
  SwitchesAt(whole, trial, state);
  double low_value = switches_[j];
  if (!(low_value * high_value < 0.0)) return false;
  const double accuracy = kInstant * whole.grid.step();
  for (int i = 0; i < kMostIterations && high - low > accuracy; ++i) {
    trial.duration =
        high - high_value * (high - low) / (high_value - low_value);
    trial_ = state;
    Run(whole, trial, &trial_);
    SwitchesAt(whole, trial, trial_);
    const double value = switches_[j];
    if (value == 0.0 || !std::isfinite(value)) break;
    const bool is_low = value * low_value > 0.0;
    if (is_low) {
      // The other end stays: half its value (Illinois).
      if (trial.duration - low < accuracy) break;
      low = trial.duration;
      low_value = value;
      high_value *= 0.5;
    } else {
      if (high - trial.duration < accuracy) break;
      high = trial.duration;
      high_value = value;
      low_value *= 0.5;
    }
  }
  piece->duration = trial.duration;
  return true;
}

double SwitchedStep::SlopeOf(const Whole& whole, const Piece& piece, int j,
                             const std::vector<char>& branches,
                             const Vector& state) {
  const double dt = whole.grid.step();
  const double end = piece.begin + piece.duration;
  const double time = whole.time() + end;
  InputsAt(whole.grid, whole.interval, whole.substep, end / dt, &nodes_.end);
  dynamics_.SetBranches(branches.data(), &stage_);
  dynamics_.Rate(whole.prepared, time, nodes_.end.data(), state.data(),
                 rate_.data(), &stage_);
  dynamics_.SwitchGradient(j, whole.prepared, time, nodes_.end.data(),
                           state.data(), gradient_.data());
  // Switches may depend on the time or on inputs too.
  constexpr double kShare = 1e-3;
  double values[2];
  for (int side = 0; side < 2; ++side) {
    const double shift = (side == 0 ? -kShare : kShare) * dt;
    InputsAt(whole.grid, whole.interval, whole.substep, (end + shift) / dt,
             &nodes_.end);
    dynamics_.Switches(whole.prepared, time + shift, nodes_.end.data(),
                       state.data(), switches_.data());
    values[side] = switches_[j];
  }
  return gradient_.dot(rate_) + (values[1] - values[0]) / (2.0 * kShare * dt);
}

bool SwitchedStep::Switch(const Whole& whole, Piece* piece, Vector* state) {
  const Vector at_end = switches_;
  const Piece whole_piece = *piece;
  piece->switched = -1;
  for (int j = 0; j < dynamics_.num_switches(); ++j) {
    switches_ = at_end;
    if (Agrees(j, branches_)) continue;
    Piece found = whole_piece;
    if (!FindEnd(whole, j, *state, &found)) return false;
    if (piece->switched >= 0 && found.duration >= piece->duration) continue;
    *piece = found;
    piece->switched = j;
  }
  Run(whole, *piece, state);
  SwitchesAt(whole, *piece, *state);
  const Vector at_event = switches_;
  std::vector<char> next = branches_;
  for (int j = 0; j < dynamics_.num_switches(); ++j) {
    switches_ = at_end;
    if (Agrees(j, branches_)) continue;
    if (j != piece->switched &&
        std::abs(at_event[j]) > kSameEvent * std::abs(at_end[j])) {
      continue;
    }
    char& branch = next[static_cast<size_t>(j)];
    branch = branch != 0 ? 0 : 1;
  }
  piece->slope = SlopeOf(whole, *piece, piece->switched, branches_, *state);
  const double behind = SlopeOf(whole, *piece, piece->switched, next, *state);
  branches_ = next;
  return piece->slope * behind > 0.0;
}

void SwitchedStep::Step(const StructuralDynamics::Prepared& prepared,
                        const IntegrationGrid& grid, Eigen::Index interval,
                        int substep, Vector* state) {
  const Whole whole{prepared, grid, interval, substep};
  const double dt = grid.step();
  const Vector start = *state;
  pieces_.clear();
  double begin = 0.0;
  while (static_cast<int>(pieces_.size()) < kMostPieces) {
    Piece piece;
    piece.begin = begin;
    piece.duration = dt - begin;
    piece.branches = branches_;
    trial_ = *state;
    Run(whole, piece, &trial_);
    // A law may have no value beyond its switch: (x[u] - 1)^1.5 behind x[u]
    // > 1.
    if (!trial_.allFinite()) break;
    SwitchesAt(whole, piece, trial_);
    if (Agree()) {
      *state = trial_;
      pieces_.push_back(std::move(piece));
      return;
    }
    if (!Switch(whole, &piece, state)) break;
    begin = piece.begin + piece.duration;
    pieces_.push_back(std::move(piece));
  }
  // The motion sticks at a switch: a plain step.
  *state = start;
  Piece piece;
  piece.duration = dt;
  Run(whole, piece, state);
  SwitchesAt(whole, piece, *state);
  TakeBranches();
  pieces_.clear();
  pieces_.push_back(std::move(piece));
}

}  // namespace pinode
