// AutoDiffLaw turns a functor on a template scalar into a Law. Include this
// header only where a law is defined, because it includes Ceres' Jets.

#ifndef PINODE_DYNAMICS_AUTODIFF_LAW_H_
#define PINODE_DYNAMICS_AUTODIFF_LAW_H_

#include <ceres/jet.h>

#include <utility>

#include "pinode/dynamics/law.h"

namespace pinode {

// Law from a functor, differentiated automatically. The functor must have
//
//   template <typename T>
//   void operator()(const T* features, const T* internal,
//                   const T* parameters, T* result) const;
//
// The template arguments give the number of features, internal states,
// parameters and outputs. `result` holds kOutputs outputs, then kInternal rates
// of the internal states. Law describes these arrays and their units. Jets are
// as wide as the law has arguments, kFeatures + kInternal + kParameters.
template <typename Functor, int kFeatures, int kInternal, int kParameters,
          int kOutputs>
class AutoDiffLaw final : public Law {
 public:
  explicit AutoDiffLaw(Functor functor = Functor())
      : functor_(std::move(functor)) {}

  int num_features() const override { return kFeatures; }
  int num_internal() const override { return kInternal; }
  int num_parameters() const override { return kParameters; }
  int num_outputs() const override { return kOutputs; }

  void Evaluate(const double* features, const double* internal,
                const double* parameters, double* result) const override {
    functor_(features, internal, parameters, result);
  }

  void Evaluate(const WideJet* features, const WideJet* internal,
                const WideJet* parameters, WideJet* result) const override {
    functor_(features, internal, parameters, result);
  }

  void Linearize(const double* features, const double* internal,
                 const double* parameters, double* result,
                 double* jacobian) const override {
    constexpr int kArguments = kFeatures + kInternal + kParameters;
    constexpr int kResults = kOutputs + kInternal;
    using NarrowJet = ceres::Jet<double, kArguments>;
    NarrowJet arguments[kArguments];
    for (int i = 0; i < kArguments; ++i) {
      const double value = i < kFeatures ? features[i]
                           : i < kFeatures + kInternal
                               ? internal[i - kFeatures]
                               : parameters[i - kFeatures - kInternal];
      arguments[i] = NarrowJet(value, i);
    }
    NarrowJet results[kResults];
    functor_(arguments, arguments + kFeatures,
             arguments + kFeatures + kInternal, results);
    for (int r = 0; r < kResults; ++r) {
      result[r] = results[r].a;
      for (int i = 0; i < kArguments; ++i) {
        jacobian[r * kArguments + i] = results[r].v[i];
      }
    }
  }

 private:
  Functor functor_;
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_AUTODIFF_LAW_H_
