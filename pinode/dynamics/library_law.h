// A sparse library term as a law, the result of a discovery.

#ifndef PINODE_DYNAMICS_LIBRARY_LAW_H_
#define PINODE_DYNAMICS_LIBRARY_LAW_H_

#include <string>
#include <vector>

#include "pinode/dynamics/law.h"
#include "pinode/dynamics/library_function.h"

namespace pinode {

// A combination of library functions with unknown coefficients xi,
//
//   g(q; xi) = sum_k xi_k f_k(q)
//
// (Theta(q) Xi of Lai et al. (2021), eqs. (7) to (9), for one output). The
// parameters are the coefficients, in the order of the functions.
class LibraryLaw final : public Law {
 public:
  // Largest number of features, more than any structure needs.
  static constexpr int kMaxFeatures = 256;

  // Checks that there is at least one function and that all functions have the
  // same `num_features` (1 to kMaxFeatures) features. On failure AreValid sets
  // *error, and the constructor aborts.
  [[nodiscard]] static bool AreValid(
      int num_features, const std::vector<LibraryFunction>& functions,
      std::string* error);
  LibraryLaw(int num_features, std::vector<LibraryFunction> functions);

  int num_features() const override { return num_features_; }
  int num_internal() const override { return 0; }
  int num_parameters() const override {
    return static_cast<int>(functions_.size());
  }
  int num_outputs() const override { return 1; }

  const std::vector<LibraryFunction>& functions() const { return functions_; }

  void Evaluate(const double* features, const double* internal,
                const double* parameters, double* result) const override;
  void Evaluate(const WideJet* features, const WideJet* internal,
                const WideJet* parameters, WideJet* result) const override;
  void Linearize(const double* features, const double* internal,
                 const double* parameters, double* result,
                 double* jacobian) const override;

  // The switches of all functions, one function after the other.
  int num_switches() const override { return num_switches_; }
  void Switches(const double* features, double* values) const override;
  void SwitchGradient(int j, const double* features,
                      double* gradient) const override;
  void EvaluateOn(const char* branches, const double* features,
                  const double* internal, const double* parameters,
                  double* result) const override;
  void LinearizeOn(const char* branches, const double* features,
                   const double* internal, const double* parameters,
                   double* result, double* jacobian) const override;

 private:
  int num_features_;
  std::vector<LibraryFunction> functions_;
  int num_switches_ = 0;
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LIBRARY_LAW_H_
