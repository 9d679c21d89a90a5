// The fit of the unknown loads and noise of an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_LOAD_FIT_H_
#define PINODE_ESTIMATE_AMBIENT_LOAD_FIT_H_

#include "pinode/base/types.h"
#include "pinode/estimate/ambient/ambient_likelihood.h"
#include "pinode/estimate/ambient/ambient_loads.h"

namespace pinode {

// Finds the loads and noise of least cost for the present transfer functions,
// by Fisher scoring. No covariance may fall to zero in a step. The metric of
// relative changes holds the steps: a covariance that would vanish moves only
// part of the way, and all others move freely. (A step that is cut off
// afterwards would not lower the cost.)
class LoadFit {
 public:
  // `likelihood` must outlive this object.
  LoadFit(const AmbientLikelihood& likelihood, const LoadSpectrum& spectrum);

  const AmbientLoads& loads() const { return loads_; }
  // False until the first fit has succeeded.
  bool known() const { return known_; }

  // Fits the loads from the lines alone: first uncorrelated loads, which give
  // the prior and the start of the correlated ones. Needs the transfer
  // functions of all lines. False where the spectrum of the channels is not
  // positive definite.
  [[nodiscard]] bool FindFirst(double* cost);
  // Fits the loads from `start`, until a step would gain next to nothing. *cost
  // is what the last step would reach. False as in FindFirst.
  [[nodiscard]] bool FindFrom(const Vector& start, double* cost);

 private:
  // Sets white loads and the noise from the lines alone.
  void Start();
  [[nodiscard]] bool Improve(double* cost);
  // Takes a step that lowers *cost; `sums` are the derivatives before it. False
  // where no step lowers the cost. Sets *done where a step would gain less than
  // `left`.
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
