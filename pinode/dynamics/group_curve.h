// Groups that depend on a covariate by a table, as terms of the equation of
// motion.

#ifndef PINODE_DYNAMICS_GROUP_CURVE_H_
#define PINODE_DYNAMICS_GROUP_CURVE_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/term.h"
#include "pinode/dynamics/unknown_force.h"

namespace pinode {

// Change of the alpha of a group with a covariate u. The group has the value
// alpha at the reference, and becomes
//
//   (alpha + sum_k p_k N_k(u)) matrix.
//
// N_k is one at knot k, zero at all other knots, linear between them, and
// constant beyond the outer knots. The reference is one of the knots and has no
// p.
struct GroupCurve {
  std::string name;   // of the group
  MatrixGroup group;  // stiffness or damping, its matrix that of the group
  int input = -1;     // the covariate
  std::vector<double> knots;  // ascending, at least two, in its unit
  int reference = 0;          // index of the reference
  // Change of alpha at each knot except the reference, in their order.
  ParameterBlock parameters;
  // Prior on combinations of the parameters. Empty: only the parameters' own
  // priors. If not empty, all parameters are free or none.
  CombinationPrior prior;
};

std::unique_ptr<Term> MakeTerm(GroupCurve curve);

// Returns "stiff.temperature[-10]", the name of the change at a knot of the
// covariate.
std::string KnotName(const std::string& group, const std::string& covariate,
                     double knot);

// Returns a prior on neighbouring knots. The first differences of alpha, or the
// differences of its slopes, have the given standard deviation, in units of
// alpha, at the average distance of knots. Across a wider gap alpha may change
// more, as in a random walk. `sigma` 0: the evidence chooses it. differences:
// 1, or 2 for three knots or more.
CombinationPrior CurvePrior(const std::vector<double>& knots, int reference,
                            int differences, double sigma);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_GROUP_CURVE_H_
