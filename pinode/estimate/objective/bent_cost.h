// Steps that bend with their valley, and the conditions for them.

#ifndef PINODE_ESTIMATE_OBJECTIVE_BENT_COST_H_
#define PINODE_ESTIMATE_OBJECTIVE_BENT_COST_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/solver/bounded_cost.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// A cost of x as a cost of y. A straight Levenberg-Marquardt step in y is a
// bent step in x. With a step d of y from the point of the last linearisation,
// where x is x0, H the Gauss-Newton Hessian, D its diagonal, and r'' the second
// derivative of the residuals along d,
//
//   x = x0 + d + a/2,    (H + D / radius) a = -J'r''
//
// which is the geodesic acceleration of M. K. Transtrum, B. B. Machta and J. P.
// Sethna (Phys. Rev. E 83 (2011) 036701) and M. K. Transtrum and J. P. Sethna
// (arXiv:1201.5885): the residuals along the path are straight up to the second
// order. In a narrow, bent valley, as a network's, a straight step can only be
// as short as the valley is straight. If |a| exceeds 3/8 of |d|, in units of D,
// the path is no longer valid, and a is shortened to that.
//
// To first order x and y move alike, so that gradient and Hessian are those by
// x. The path is for unknowns without bounds.
class BentCost final : public CostPart {
 public:
  // Computes J'r'' along a step from the point of the part's last
  // linearisation. False: it is not available, and the step stays straight.
  using Bend = std::function<bool(const Vector& step, Vector* projected)>;

  // Keeps references to `part` and to `radius`, which Levenberg-Marquardt uses
  // for its next step. Both must outlive the object. Steps and their bends do
  // not move unknown `held` (-1: all move).
  BentCost(CostPart* part, Bend bend, const double* radius, int held = -1);

  // Returns x for a y that was evaluated or linearised.
  Vector PointOf(const Vector& flat) const;

  [[nodiscard]] bool Evaluate(const Vector& flat, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& flat,
                               CondensedSystem* system) override;
  std::string Failure() const override { return part_->Failure(); }

 private:
  struct Place {
    Vector flat;   // y
    Vector point;  // x
  };

  // Returns the place of `flat`; nullptr: not known.
  const Place* Find(const Vector& flat) const;
  // Sets trial_ to the place of `flat`.
  void Go(const Vector& flat);
  Vector Bent(const Vector& step) const;

  CostPart* part_;
  Bend bend_;
  const double* radius_;
  int held_;
  // Points of linearisation, the newest last: the end of a fit may be any of
  // them.
  std::vector<Place> centers_;
  Matrix hessian_;  // at the newest
  Place trial_;
};

// True if there are networks of the state. Networks of time alone do not count:
// their hidden units hardly move, and such a fit is nearly linear.
bool HasNetworksOfState(const IdentificationProblem& problem,
                        const ParameterLayout& layout);

// True if steps bend, as valleys of networks do. With bounds Ceres searches
// along straight lines.
bool BendsSteps(const IdentificationProblem& problem,
                const ParameterLayout& layout);

// Returns the bend of the trajectories, whose rows are kept, by the unknowns of
// `bounded`. Both must outlive it.
BentCost::Bend BendOf(Objective* objective, const BoundedCost* bounded);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_BENT_COST_H_
