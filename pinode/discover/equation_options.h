// Options of discovered equations: candidates for terms, and constraints on
// coefficients.

#ifndef PINODE_DISCOVER_EQUATION_OPTIONS_H_
#define PINODE_DISCOVER_EQUATION_OPTIONS_H_

#include <string>
#include <vector>

namespace pinode {

// Candidates of a library. Features are named as in Feature::Name():
// displacement "x[u1]", velocity "v[u1]", relative displacement "d[u1,u2]",
// relative velocity "w[u1,u2]", time "t", and input "input[road]". The name of
// a candidate is the text that LibraryFunction reads, such as "x[u1]^3". The
// candidates come in the order of the members below, each once.
struct CandidateLibraryOptions {
  // True: includes the constant "1". A structure that rests at its origin needs
  // none.
  bool constant = false;

  // Largest total degree of the monomials, which begin with degree 1. 0: no
  // monomials.
  int polynomial_degree = 3;
  // True: includes monomials of several features, such as "x[u1]^2*v[u1]".
  bool products = true;
  // Features of the monomials; empty: all.
  std::vector<std::string> polynomial_features;

  // Features of the functions sin, cos, abs, sign and abs(x)*x: each feature
  // gives one candidate, such as "sin(x[u1])".
  std::vector<std::string> sine_features;
  std::vector<std::string> cosine_features;
  std::vector<std::string> absolute_features;       // "abs(v[u1])"
  std::vector<std::string> sign_features;           // "sign(v[u1])"
  std::vector<std::string> signed_square_features;  // "abs(x[u1])*x[u1]"

  // Other candidates, as text that LibraryFunction reads.
  std::vector<std::string> expressions;
};

// Value of DiscoveryCandidate::degree for a candidate that is not a monomial.
inline constexpr int kNotAMonomial = -1;

// Constraint on coefficients, which are named as in
// RegressionProblem::CoefficientNames().
struct CoefficientConstraint {
  // Kind of constraint; each has a function below that creates it.
  enum class Kind { kGiven, kSign, kEqual };

  // Fixes a coefficient. Its term stays in the equation with this value.
  static CoefficientConstraint Given(const std::string& coefficient,
                                     double value);
  // Require a coefficient >= 0, or <= 0.
  static CoefficientConstraint Positive(const std::string& coefficient);
  static CoefficientConstraint Negative(const std::string& coefficient);
  // Ties coefficients: coefficients[i] = factors[i] * c with one unknown c.
  // `factors` has one entry per coefficient; empty: all 1. Example: in m1 a1 =
  // ... + k x2 and m2 a2 = ... + k x1 both couplings are k. Equations for a1
  // and a2 then need the factors 1/m1 and 1/m2.
  static CoefficientConstraint Equal(
      const std::vector<std::string>& coefficients,
      const std::vector<double>& factors = {});

  Kind kind = Kind::kGiven;
  std::vector<std::string> coefficients;  // names: one, or several for kEqual
  double value = 0.0;                     // kGiven: value of the coefficient
  int sign = 1;                           // kSign: 1 or -1
  std::vector<double> factors;            // kEqual: ratios
};

}  // namespace pinode

#endif  // PINODE_DISCOVER_EQUATION_OPTIONS_H_
