// Equations as a user asks for them: their candidates, and conditions on their
// coefficients.

#ifndef PINODE_DISCOVER_EQUATION_OPTIONS_H_
#define PINODE_DISCOVER_EQUATION_OPTIONS_H_

#include <string>
#include <vector>

namespace pinode {

// Which candidates a library has. Features are named as in
// Feature::Name(): "x[u1]", "v[u1]", "d[u1,u2]", "w[u1,u2]", "t",
// "input[road]"; so are the candidates, each by the text that LibraryFunction
// reads. The candidates come in the order of the members below, none twice.
struct CandidateLibraryOptions {
  // "1". A structure at rest in its origin has none.
  bool constant = false;

  // Monomials of total degree 1 up to this one, by degree: "x[u1]^3"; 0:
  // none.
  int polynomial_degree = 3;
  // Also those of several features: "x[u1]^2*v[u1]".
  bool products = true;
  // The features that monomials are made of; empty: all.
  std::vector<std::string> polynomial_features;

  // "sin(x[u1])" and so on, one for each feature named.
  std::vector<std::string> sine_features;
  std::vector<std::string> cosine_features;
  std::vector<std::string> absolute_features;       // "abs(v[u1])"
  std::vector<std::string> sign_features;           // "sign(v[u1])"
  std::vector<std::string> signed_square_features;  // "abs(x[u1])*x[u1]"

  // Whatever else LibraryFunction reads.
  std::vector<std::string> expressions;
};

// Degree of a candidate that is no monomial.
inline constexpr int kNotAMonomial = -1;

// One condition, on coefficients by their names (see
// RegressionProblem::CoefficientNames()).
struct CoefficientConstraint {
  enum class Kind { kGiven, kSign, kEqual };

  // The coefficient is known: it stays in the model at this value.
  static CoefficientConstraint Given(const std::string& coefficient,
                                     double value);
  // The coefficient is not negative, or not positive.
  static CoefficientConstraint Positive(const std::string& coefficient);
  static CoefficientConstraint Negative(const std::string& coefficient);
  // coefficients[i] = factors[i] * c with one unknown c; no factors: all
  // equal. Symmetric coupling of two accelerations m1 a1 = ... + k x2 and
  // m2 a2 = ... + k x1 is the pair with the factors 1/m1 and 1/m2.
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
