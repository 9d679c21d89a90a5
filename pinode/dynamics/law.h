// Interface between a constitutive law and the identification.

#ifndef PINODE_DYNAMICS_LAW_H_
#define PINODE_DYNAMICS_LAW_H_

#include "pinode/dynamics/wide_jet.h"

namespace pinode {

// Force law with optional internal states,
//
//   force     = g(q, z; p)      one value per output
//   dz/dt     = r(q, z; p)      one value per internal state
//
// q are the features (see Feature), z the internal states of a hysteretic law,
// and p its parameters, all in the model's units. The law does not depend on
// these units. AutoDiffLaw (autodiff_law.h) makes a law from a functor on a
// template scalar. Laws have no mutable state, so all functions may be called
// from several threads.
class Law {
 public:
  virtual ~Law() = default;

  // Numbers of entries of q, z and p, and number of outputs. They are constant.
  virtual int num_features() const = 0;
  virtual int num_internal() const = 0;
  virtual int num_parameters() const = 0;
  virtual int num_outputs() const = 0;
  // True if the law has no internal states and its force is zero for all values
  // of its parameters.
  virtual bool IsIdle() const { return false; }
  // Numbers of rows and columns of the Jacobian of Linearize().
  int num_results() const { return num_outputs() + num_internal(); }
  int num_arguments() const {
    return num_features() + num_internal() + num_parameters();
  }

  // Computes `result`, num_results() entries: the outputs, then dz/dt. The
  // other arrays have as many entries as the functions above say.
  virtual void Evaluate(const double* features, const double* internal,
                        const double* parameters, double* result) const = 0;
  virtual void Evaluate(const WideJet* features, const WideJet* internal,
                        const WideJet* parameters, WideJet* result) const = 0;

  // Computes `result` as Evaluate() does, and its Jacobian, num_results() x
  // num_arguments(), row-major. Columns are the derivatives with respect to
  // features, internal states and parameters, in this order.
  virtual void Linearize(const double* features, const double* internal,
                         const double* parameters, double* result,
                         double* jacobian) const = 0;

  // Switching functions s_j(q) of the features: where one changes its sign, the
  // law jumps from one branch to another. Integrators cut their steps there.
  // Laws without jumps need none of these functions.
  virtual int num_switches() const { return 0; }
  // Computes all s_j, num_switches() entries.
  virtual void Switches(const double* /*features*/, double* /*values*/) const {}
  // Computes d s_j / d q, num_features() entries.
  virtual void SwitchGradient(int /*j*/, const double* /*features*/,
                              double* /*gradient*/) const {}
  // Evaluate as the functions above do, on the branch where s_j > 0 if
  // branches[j] is not 0, whatever the features say.
  virtual void EvaluateOn(const char* /*branches*/, const double* features,
                          const double* internal, const double* parameters,
                          double* result) const {
    Evaluate(features, internal, parameters, result);
  }
  virtual void LinearizeOn(const char* /*branches*/, const double* features,
                           const double* internal, const double* parameters,
                           double* result, double* jacobian) const {
    Linearize(features, internal, parameters, result, jacobian);
  }
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LAW_H_
