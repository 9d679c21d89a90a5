// Steps that bend with the valley they lie in.

#ifndef PINODE_ESTIMATE_SOLVER_BENT_COST_H_
#define PINODE_ESTIMATE_SOLVER_BENT_COST_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/solver/cost_part.h"

namespace pinode {

// A cost of x as a cost of y, in whose coordinates a straight step of
// Levenberg-Marquardt is a bent one of x. With a step d of y from the point of
// the last linearisation, where x is x0, H the Gauss-Newton Hessian, D its
// diagonal, and r'' the second derivative of the residuals along d,
//
//   x = x0 + d + a/2,    (H + D / radius) a = -J'r''
//
// which is the geodesic acceleration of M. K. Transtrum, B. B. Machta and J. P.
// Sethna (Phys. Rev. E 83 (2011) 036701) and M. K. Transtrum and J. P. Sethna
// (arXiv:1201.5885): the residuals along the path are straight up to the second
// order. Where a cost's valley is narrow and bends, as that of a network, a
// straight step must be as short as the valley is straight. Where |a| exceeds
// 3/8 of |d|, in units of D, the path says nothing any more, and a is shortened
// to that.
//
// To first order x and y move alike, so that gradient and Hessian are those by
// x. The path is for unknowns without bounds.
class BentCost final : public CostPart {
 public:
  // J'r'' along a step from the point of the part's last linearisation. False:
  // it cannot be had, and the step stays straight.
  using Bend = std::function<bool(const Vector& step, Vector* projected)>;

  // `part` and `radius`, which Levenberg-Marquardt uses for its next step, must
  // outlive the object. Steps do not move unknown `held` (-1: all move), nor do
  // their bends.
  BentCost(CostPart* part, Bend bend, const double* radius, int held = -1);

  // x of a y that was evaluated or linearised.
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

  // nullptr: not known.
  const Place* Find(const Vector& flat) const;
  // Sets trial_ to what is at `flat`.
  void Go(const Vector& flat);
  Vector Bent(const Vector& step) const;

  CostPart* part_;
  Bend bend_;
  const double* radius_;
  int held_;
  // Where the cost was linearised, the newest last: the end of a fit may be any
  // of them.
  std::vector<Place> centers_;
  Matrix hessian_;  // at the newest
  Place trial_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_BENT_COST_H_
