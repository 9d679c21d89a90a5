// The fit of the unknown loads and noise of an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_LOAD_FIT_H_
#define PINODE_ESTIMATE_AMBIENT_LOAD_FIT_H_

#include "pinode/base/types.h"
#include "pinode/estimate/ambient/ambient_likelihood.h"
#include "pinode/estimate/ambient/ambient_loads.h"

namespace pinode {

// Finds the loads and noise of least cost for the transfer functions as they
// are, by Fisher scoring. Covariances may not fall by all of themselves in a
// step: those that would move only a part of the way, held by the metric of
// relative changes, and all others as far as they want. (A step that is cut off
// afterwards does not lower the cost.)
class LoadFit {
 public:
  // `likelihood` must outlive this object.
  LoadFit(const AmbientLikelihood& likelihood, const LoadSpectrum& spectrum);

  const AmbientLoads& loads() const { return loads_; }
  // False until the first fit has succeeded.
  bool known() const { return known_; }

  // Fits the loads from nothing: first without correlation, which gives the
  // prior of the correlated ones. Needs the transfer functions of all lines.
  // False where the spectrum of the channels is not positive definite; so too
  // below.
  [[nodiscard]] bool FindFirst(double* cost);
  // Fits the loads from `start`, until a step promises next to nothing of the
  // cost. *cost is without that rest.
  [[nodiscard]] bool FindFrom(const Vector& start, double* cost);

 private:
  // Sets white loads and the noise from the lines alone.
  void Start();
  [[nodiscard]] bool Improve(double* cost);
  // Steps from where `sums` and *cost are the derivatives and the cost, to a
  // lower cost. False where no step lowers it. *done: none needs to.
  [[nodiscard]] bool Step(const LikelihoodSums& sums, double left, double* cost,
                          bool* done);

  const AmbientLikelihood& likelihood_;
  AmbientLoads loads_;
  bool known_ = false;
  // Weight of the metric in the last step, in lines that have seen the loads.
  double firmness_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_LOAD_FIT_H_
