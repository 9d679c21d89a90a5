// The second learning of a network.

#ifndef PINODE_ESTIMATE_OBJECTIVE_ANNEALING_H_
#define PINODE_ESTIMATE_OBJECTIVE_ANNEALING_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/fit_state.h"

namespace pinode {

// A network whose decay the evidence chooses is learned twice. First at the
// smallest noise, which finds a good fit soon, but one of the many that bring
// in all inputs. Then it is drawn anew, close to a linear map, and the noise
// comes down from a share of each channel's spread step by step: the evidence
// grants what the data ask for most before the rest, and inputs that are not
// needed stay out.
//
// It comes down to what the first fit has left over without a memory. The rest
// may be there to be learned, and is what the noise does not exceed afterwards.
class Annealing {
 public:
  // `context` must outlive this object.
  explicit Annealing(const FitContext& context) : context_(context) {}

  // Sets the decays that annealed networks begin with. False, with nothing
  // changed, where there is none.
  bool SetFirstDecays(Vector* decays) const;

  // What the first fit leaves over, per training record: the levels that it
  // would estimate, and its residuals weighted by them (see
  // MultipleShooting::WeightedResiduals; none where they cannot be had).
  // Without a first fit noise comes down as far as it may.
  struct LeftOver {
    std::vector<Vector> sigmas;
    std::vector<Matrix> residuals;
  };

  // Draws the networks anew from `first_free`, as the run began, and raises the
  // noise. `left_over`: nullptr where there was no first fit.
  void Begin(const Vector& first_free, const LeftOver* left_over,
             FitState* state);
  bool HasBegun() const { return !targets_.empty(); }

  // What a level `sigma` of training record t, channel c, is to be moved to
  // where the residuals want `wanted`; `floor`: no level is below.
  double Limit(size_t t, int c, double floor, double sigma, double wanted);

 private:
  void Redraw(const Vector& first_free, Vector* free) const;

  const FitContext& context_;
  // What noise comes down to, infinity once it has been there, and what it does
  // not exceed afterwards, per training record.
  std::vector<Vector> targets_;
  std::vector<Vector> ceilings_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_ANNEALING_H_
