// Second learning of a network.

#ifndef PINODE_ESTIMATE_OBJECTIVE_ANNEALING_H_
#define PINODE_ESTIMATE_OBJECTIVE_ANNEALING_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/fit_state.h"

namespace pinode {

// Anneals networks. A network whose decay the evidence chooses is learned
// twice. The first learning, at the smallest noise, soon finds a good fit, but
// one of the many that use all inputs. Then the network is drawn again, close
// to a linear map, and the noise decreases step by step from a share of each
// channel's spread. The evidence first grants what the data require most, and
// unneeded inputs stay out.
//
// The noise decreases to the uncorrelated part of the first fit's residuals.
// The rest may be learnable; afterwards the noise does not exceed it.
class Annealing {
 public:
  // Keeps a reference to `context`, which must outlive this object.
  explicit Annealing(const FitContext& context) : context_(context) {}

  // Sets the initial decays of annealed networks. Returns false, with nothing
  // changed, if there is no such network.
  bool SetFirstDecays(Vector* decays) const;

  // Residuals of the first fit, per training record: the levels that it would
  // estimate, and its residuals weighted by them (see
  // MultipleShooting::WeightedResiduals; empty if not available). Without a
  // first fit the noise decreases to its lower limit.
  struct LeftOver {
    std::vector<Vector> sigmas;
    std::vector<Matrix> residuals;
  };

  // Draws the networks again from `first_free`, the values at the beginning of
  // the run, and raises the noise. `left_over`: nullptr without a first fit.
  void Begin(const Vector& first_free, const LeftOver* left_over,
             FitState* state);
  bool HasBegun() const { return !targets_.empty(); }

  // Returns the new value of level `sigma` of training record t, channel c, if
  // the residuals ask for `wanted`. `floor`: lower limit of all levels.
  double Limit(size_t t, int c, double floor, double sigma, double wanted);

 private:
  void Redraw(const Vector& first_free, Vector* free) const;

  const FitContext& context_;
  // Targets of the decreasing noise, infinity once it has reached them, and its
  // upper limits afterwards, per training record.
  std::vector<Vector> targets_;
  std::vector<Vector> ceilings_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_ANNEALING_H_
