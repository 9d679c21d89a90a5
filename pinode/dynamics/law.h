// The interface between a user's constitutive law and the identification.

#ifndef PINODE_DYNAMICS_LAW_H_
#define PINODE_DYNAMICS_LAW_H_

#include "pinode/dynamics/wide_jet.h"

namespace pinode {

// A force law with optional internal states,
//
//   force     = g(q, z; p)      one value per output
//   dz/dt     = r(q, z; p)      one value per internal state
//
// where q are the features (see Feature), z the internal states of a hysteretic
// law and p its parameters. AutoDiffLaw (autodiff_law.h) makes implementations
// from a functor on a template scalar. No code above it is a template. Laws
// have no mutable state: all functions are safe to call from several threads.
class Law {
 public:
  virtual ~Law() = default;

  virtual int num_features() const = 0;
  virtual int num_internal() const = 0;
  virtual int num_parameters() const = 0;
  virtual int num_outputs() const = 0;
  // Returns true if the law gives no force and has no states for all values of
  // its parameters.
  virtual bool IsIdle() const { return false; }
  int num_results() const { return num_outputs() + num_internal(); }
  int num_arguments() const {
    return num_features() + num_internal() + num_parameters();
  }

  // Computes result: the outputs, then the rates of the internal states.
  virtual void Evaluate(const double* features, const double* internal,
                        const double* parameters, double* result) const = 0;
  virtual void Evaluate(const WideJet* features, const WideJet* internal,
                        const WideJet* parameters, WideJet* result) const = 0;

  // Does what Evaluate does, and computes jacobian (num_results x
  // num_arguments, row-major): the derivatives with respect to features,
  // internal states and parameters, in this order.
  virtual void Linearize(const double* features, const double* internal,
                         const double* parameters, double* result,
                         double* jacobian) const = 0;
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LAW_H_
