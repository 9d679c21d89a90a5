// The core of pinode: matrices and a neural network fitted to records by
// Ceres, then an equation in place of the network. Run it in the project's
// folder. Four masses swing freely, two records of 6 s. The model has 70 % of
// the springs and dampers, and lacks a cubic spring of 2 N/m^3 at the first:
//
//   M x'' + (C + sum c_i C_i) x' + (K + sum k_i K_i) x = M b N(x1, x1'; w)
//
// Unknown are k_i and c_i (0.3 in truth) and w, the weights of the network N.
#include <ceres/ceres.h>

#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "pinode/estimate/segment_cost.h"
#include "pinode/estimate/trajectory_cost.h"
#include "pinode/pinode.h"

using namespace pinode;

int main(int argc, char** argv) {
  // 1. Read matrices, unknowns and records.
  const char* file = "data/four_dof_free/scheme2_groups.toml";
  Case c;
  std::string error;
  const auto fail = [&] { return std::cerr << error << "\n", 2; };
  if (!ReadCase(argc > 1 ? argv[1] : file, &c, &error)) return fail();

  // 2. One parameter block holds all unknowns of the equation of motion.
  const ParameterLayout layout(c.problem);
  Vector free = layout.Free(layout.InitialValues());

  // 3. Multiple shooting in segments of 30 samples (1.5 s). A residual block is
  // a segment run by Runge-Kutta with Jets, against the measured states. Its
  // start is a parameter block, and the segment before must end there.
  SegmentCost::Options options;
  options.derivatives = DerivativeMethod::kJets;
  options.sigmas = options.gap_sigmas = Vector::Constant(8, 5e-3);  // m, m/s
  ceres::Problem problem;
  Matrix starts[2];
  for (int r = 0; r < 2; ++r) {
    if (!SegmentCost::AddRecord(c.problem, r, 30, options, free.data(),
                                &starts[r], &problem, &error)) {
      return fail();
    }
  }

  // 4. The weights are distributed normally about 0, with precision 0.1.
  const Vector decays = Vector::Constant(layout.num_decay_groups(), 0.1);
  problem.AddResidualBlock(MakePriorCost(layout, decays).release(), nullptr,
                           free.data());

  // 5. Solve by Levenberg-Marquardt; 150 steps give three digits.
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = 150;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  std::printf("%s\n", summary.BriefReport().c_str());
  for (const char* name : {"k1", "k2", "k3", "k4", "c1", "c2", "c3", "c4"}) {
    std::printf("%s = %.5f\n", name, free[layout.FreeIndex(name)]);
  }

  // 6. What has the network learned? The LASSO, with xi = p q again a problem
  // for Levenberg-Marquardt, picks terms among the monomials of x1 and x1'.
  IdentifiedModel model;
  model.parameters = layout.InitialValues();
  layout.SetFree(free, &model.parameters);
  model.starts = {starts[0].col(0), starts[1].col(0)};
  std::vector<DiscoveredEquation> found;
  if (!DiscoverFromNetworks(c.problem, model, c.discover, &found, &error)) {
    return fail();
  }
  for (const DiscoveredTerm& term : found[0].terms) {
    std::printf("N: %+.4f %s\n", term.coefficient, term.basis.c_str());
  }
  return summary.IsSolutionUsable() ? 0 : 1;
}
