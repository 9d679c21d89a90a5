// Products of powers: what most functions of a library are.

#ifndef PINODE_DYNAMICS_MONOMIAL_H_
#define PINODE_DYNAMICS_MONOMIAL_H_

#include <vector>

namespace pinode {

// c b_1^n_1 b_2^n_2 ... with positive whole n_i, where each b_i is a feature or
// its absolute value. The algebra of building one, and what it is worth.
class Monomial {
 public:
  static constexpr int kMaxFactors = 8;

  // The number `coefficient`, or the feature of this index.
  static Monomial Number(double coefficient);
  static Monomial Feature(int index);

  // Each turns this one into what its name says. False where that is none, or
  // has more than kMaxFactors factors; it is not to be used any more then.
  [[nodiscard]] bool Multiply(const Monomial& other);
  [[nodiscard]] bool Raise(int power);
  void TakeAbsolute();
  void Negate() { coefficient_ = -coefficient_; }

  bool IsNumber() const { return factors_.empty(); }
  double coefficient() const { return coefficient_; }

  double Evaluate(const double* q) const;
  // As Evaluate; adds the derivatives by the features to `gradient`. That of an
  // absolute value at 0 is 0.
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

// x^exponent by squaring; negative exponents too.
double IntegerPower(double x, int exponent);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_MONOMIAL_H_
