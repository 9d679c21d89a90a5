// Groups whose matrices follow a covariate by a table, as terms of the equation
// of motion.

#ifndef PINODE_DYNAMICS_GROUP_CURVE_H_
#define PINODE_DYNAMICS_GROUP_CURVE_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/term.h"
#include "pinode/dynamics/unknown_force.h"

namespace pinode {

// Dependence of a group's factor alpha on a covariate u, such as a temperature.
// The group has the factor alpha at the reference. At u it contributes
//
//   (alpha + sum_k p_k N_k(u)) matrix.
//
// N_k is 1 at knot k, 0 at all other knots, linear between them, and constant
// beyond the outer knots. The reference is one of the knots and has no p_k.
struct GroupCurve {
  std::string name;  // name of the group
  // Matrix of the group; its target is the stiffness or the damping.
  MatrixGroup group;
  int input = -1;  // index of the covariate among the inputs
  // Values of the covariate at the knots, ascending, at least two, in its unit.
  std::vector<double> knots;
  int reference = 0;  // index of the reference knot
  // Change p_k of alpha at each knot except the reference, in ascending order.
  // Dimensionless, as many as knots less one.
  ParameterBlock parameters;
  // Prior on combinations of the parameters. Empty: each parameter has only its
  // own prior. If it is not empty, either all parameters are free or none.
  CombinationPrior prior;
};

// Creates the term. Term::IsValid checks sizes, knots and prior.
std::unique_ptr<Term> MakeTerm(GroupCurve curve);

// Returns the name of the change at a knot of the covariate, such as
// "stiff.temperature[-10]".
std::string KnotName(const std::string& group, const std::string& covariate,
                     double knot);

// Returns a prior that keeps the curve smooth. With `differences` = 1 the
// change of alpha from knot to knot has the standard deviation `sigma`, in
// units of alpha. With `differences` = 2, for three knots or more, the change
// of slope has it. `sigma` holds for the average distance of knots; across a
// wider gap alpha may change more, as in a random walk. 0: the evidence chooses
// `sigma`.
CombinationPrior CurvePrior(const std::vector<double>& knots, int reference,
                            int differences, double sigma);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_GROUP_CURVE_H_
