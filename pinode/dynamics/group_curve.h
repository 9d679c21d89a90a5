// Groups that follow a covariate by a table, as terms of the equation of
// motion.

#ifndef PINODE_DYNAMICS_GROUP_CURVE_H_
#define PINODE_DYNAMICS_GROUP_CURVE_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/term.h"
#include "pinode/dynamics/unknown_force.h"

namespace pinode {

// How the alpha of a group changes with a covariate u: to the group, which has
// the value alpha at the reference,
//
//   (alpha + sum_k p_k N_k(u)) matrix,
//
// N_k being one at knot k, zero at all others and linear between them; constant
// beyond the outer knots. The reference is one of the knots and has no p.
struct GroupCurve {
  std::string name;   // of the group
  MatrixGroup group;  // stiffness or damping, its matrix that of the group
  int input = -1;     // the covariate
  std::vector<double> knots;  // ascending, at least two, in its unit
  int reference = 0;          // place of the reference among them
  // The change of alpha at each knot but the reference, in their order.
  ParameterBlock parameters;
  // Empty: none but the parameters' own. With one, all parameters are free or
  // none.
  CombinationPrior prior;
};

std::unique_ptr<Term> MakeTerm(GroupCurve curve);

// "stiff.temperature[-10]": the change at a knot of the covariate.
std::string KnotName(const std::string& group, const std::string& covariate,
                     double knot);

// A prior on neighbouring knots: the first differences of alpha, or the
// differences of its slopes, have the given standard deviation, in units of
// alpha, where knots are as far apart as on the average; a wider gap lets alpha
// change more, as of a random walk. `sigma` 0: the evidence chooses it.
// differences: 1 or 2, the latter of three knots and more.
CombinationPrior CurvePrior(const std::vector<double>& knots, int reference,
                            int differences, double sigma);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_GROUP_CURVE_H_
