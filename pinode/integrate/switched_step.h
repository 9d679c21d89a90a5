// Runge-Kutta steps that are cut where the dynamics jump.

#ifndef PINODE_INTEGRATE_SWITCHED_STEP_H_
#define PINODE_INTEGRATE_SWITCHED_STEP_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/rk4.h"

namespace pinode {

// Performs RK4 steps of dynamics with switches (StructuralDynamics::Switches).
// A step over which a switch s_j changes its sign is cut at the instant tau
// with s_j = 0:
//
// 1. The branches of all switches are held, so that no stage of a step sees a
//    jump, and the step keeps its order.
// 2. If a sign at the end of the step does not agree with its branch, the
//    earliest tau is found by regula falsi on the length of the step.
// 3. The switch changes its branch, and the rest of the step follows.
//
// The length of a piece depends on the state and the parameters, so
// sensitivities S = d h / d (start, theta) jump too (P. C. Mueller, Chaos,
// Solitons and Fractals 5, 1995; "saltation"): with the rates f- and f+ on both
// sides
//
//   S+ = S- + (f+ - f-) (ds_j/dh S-) / slope,   slope = ds_j/dt on the old
//   side.
//
// TangentStep applies this. A step is not cut if the motion does not go through
// the switch, because the new branch leads back (dry friction that sticks), if
// it comes back through it within the same step, if a law has no value behind
// its switch, or after kMostPieces pieces. It is then a plain RK4 step without
// held branches.
//
// Use one object per thread.
class SwitchedStep {
 public:
  // Largest number of pieces of a step.
  static constexpr int kMostPieces = 8;

  // Part of a step with the same branches.
  struct Piece {
    double begin = 0.0;  // from the beginning of the step
    double duration = 0.0;
    std::vector<char> branches;  // empty: not held
    int switched = -1;           // switch at the end; -1: none
    double slope = 0.0;          // of its function before the end
  };

  // Inputs at the nodes of a piece.
  struct Nodes {
    Vector begin, middle, end;
  };

  explicit SwitchedStep(const StructuralDynamics& dynamics);

  // Takes the branches at a state, the first one of a trajectory.
  void Begin(const StructuralDynamics::Prepared& prepared, double time,
             const double* input, const double* state);

  // Branches at the beginning of the next step, one entry per switch.
  const std::vector<char>& branches() const { return branches_; }
  // Returns true if a step on these branches may end in `state`: no switch has
  // changed its sign.
  bool MayEndAt(const StructuralDynamics::Prepared& prepared, double time,
                const double* input, const Vector& state);

  // Advances *state by one step and lists its pieces.
  void Step(const StructuralDynamics::Prepared& prepared,
            const IntegrationGrid& grid, Eigen::Index interval, int substep,
            Vector* state);
  const std::vector<Piece>& pieces() const { return pieces_; }

  // Computes the inputs of a piece: those of the parabola through the nodes of
  // the step.
  static void NodesOf(const IntegrationGrid& grid, Eigen::Index interval,
                      int substep, const Piece& piece, Nodes* nodes);

 private:
  // Step that is being cut.
  struct Whole {
    const StructuralDynamics::Prepared& prepared;
    const IntegrationGrid& grid;
    Eigen::Index interval;
    int substep;
    double time() const { return grid.step_time(interval, substep); }
  };

  // Advances *state over a piece.
  void Run(const Whole& whole, const Piece& piece, Vector* state);
  // Computes switches_ at the end of a piece.
  void SwitchesAt(const Whole& whole, const Piece& piece, const Vector& state);
  // Finds the duration of the piece from `state` until switch j is zero, below
  // the present one. Returns false if it is zero from the beginning.
  bool FindEnd(const Whole& whole, int j, const Vector& state, Piece* piece);
  // Advances *state to the first switch in the piece and changes branches_.
  // Returns false if the motion does not go through it.
  bool Switch(const Whole& whole, Piece* piece, Vector* state);
  // Returns d s_j / dt at the end of a piece with these branches.
  double SlopeOf(const Whole& whole, const Piece& piece, int j,
                 const std::vector<char>& branches, const Vector& state);
  bool Agrees(int j, const std::vector<char>& branches) const {
    // A value that is not a number has no branch.
    const double value = switches_[j];
    return branches[static_cast<size_t>(j)] != 0 ? !(value < 0.0)
                                                 : !(value > 0.0);
  }
  // True if all signs in switches_ agree with branches_.
  bool Agree() const;
  void TakeBranches();

  const StructuralDynamics& dynamics_;
  StructuralDynamics::Linearization stage_;
  Rk4Scratch<double> scratch_;
  Nodes nodes_;
  std::vector<char> branches_;
  std::vector<Piece> pieces_;
  Vector switches_, trial_, rate_, gradient_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_SWITCHED_STEP_H_
