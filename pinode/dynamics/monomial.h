// Products of powers, the form of most library functions.

#ifndef PINODE_DYNAMICS_MONOMIAL_H_
#define PINODE_DYNAMICS_MONOMIAL_H_

#include <vector>

namespace pinode {

// A product c b_1^n_1 b_2^n_2 ... with positive integers n_i, where each b_i is
// a feature or its absolute value. Includes the algebra to build one, and its
// evaluation.
class Monomial {
 public:
  static constexpr int kMaxFactors = 8;

  // Return the number `coefficient`, or the feature of this index.
  static Monomial Number(double coefficient);
  static Monomial Feature(int index);

  // Apply the named operation to this monomial. Return false if the result is
  // not a monomial or has more than kMaxFactors factors. The monomial must not
  // be used then.
  [[nodiscard]] bool Multiply(const Monomial& other);
  [[nodiscard]] bool Raise(int power);
  void TakeAbsolute();
  void Negate() { coefficient_ = -coefficient_; }

  bool IsNumber() const { return factors_.empty(); }
  double coefficient() const { return coefficient_; }

  double Evaluate(const double* q) const;
  // Does what Evaluate does, and adds the derivatives with respect to the
  // features to `gradient`. The derivative of an absolute value at 0 is 0.
  double Linearize(const double* q, double* gradient) const;

 private:
  struct Factor {
    int feature = 0;
    int power = 1;
    bool is_absolute = false;
  };

  double coefficient_ = 1.0;
  std::vector<Factor> factors_;
};

// Returns x^exponent by squaring. The exponent may be negative.
double IntegerPower(double x, int exponent);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_MONOMIAL_H_
