// Options of discovered equations: their candidates, and constraints on their
// coefficients.

#ifndef PINODE_DISCOVER_EQUATION_OPTIONS_H_
#define PINODE_DISCOVER_EQUATION_OPTIONS_H_

#include <string>
#include <vector>

namespace pinode {

// Candidates of a library. Features are named as in Feature::Name(): "x[u1]",
// "v[u1]", "d[u1,u2]", "w[u1,u2]", "t", "input[road]". Each candidate is named
// by the text that LibraryFunction reads. The candidates come in the order of
// the members below, each once.
struct CandidateLibraryOptions {
  // The constant "1". A structure at rest in its origin has none.
  bool constant = false;

  // Monomials of total degree 1 up to this one, by degree: "x[u1]^3"; 0: none.
  int polynomial_degree = 3;
  // Includes monomials of several features: "x[u1]^2*v[u1]".
  bool products = true;
  // Features of the monomials; empty: all.
  std::vector<std::string> polynomial_features;

  // Features of "sin(x[u1])" and so on, one candidate each.
  std::vector<std::string> sine_features;
  std::vector<std::string> cosine_features;
  std::vector<std::string> absolute_features;       // "abs(v[u1])"
  std::vector<std::string> sign_features;           // "sign(v[u1])"
  std::vector<std::string> signed_square_features;  // "abs(x[u1])*x[u1]"

  // Other expressions that LibraryFunction reads.
  std::vector<std::string> expressions;
};

// Degree of a candidate that is no monomial.
inline constexpr int kNotAMonomial = -1;

// One constraint on coefficients, by their names (see
// RegressionProblem::CoefficientNames()).
struct CoefficientConstraint {
  enum class Kind { kGiven, kSign, kEqual };

  // Fixes a coefficient: it stays in the model at this value.
  static CoefficientConstraint Given(const std::string& coefficient,
                                     double value);
  // Require a coefficient not to be negative, or not to be positive.
  static CoefficientConstraint Positive(const std::string& coefficient);
  static CoefficientConstraint Negative(const std::string& coefficient);
  // Ties coefficients: coefficients[i] = factors[i] * c with one unknown c; no
  // factors: all equal. Symmetric coupling of two accelerations m1 a1 = ... + k
  // x2 and m2 a2 = ... + k x1 is the pair with the factors 1/m1 and 1/m2.
  static CoefficientConstraint Equal(
      const std::vector<std::string>& coefficients,
      const std::vector<double>& factors = {});

  Kind kind = Kind::kGiven;
  std::vector<std::string> coefficients;  // one, or several for kEqual
  double value = 0.0;                     // kGiven
  int sign = 1;                           // kSign: 1 or -1
  std::vector<double> factors;            // kEqual
};

}  // namespace pinode

#endif  // PINODE_DISCOVER_EQUATION_OPTIONS_H_
