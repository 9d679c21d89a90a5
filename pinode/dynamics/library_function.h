// Functions of named features, of which closed-form laws are made.

#ifndef PINODE_DYNAMICS_LIBRARY_FUNCTION_H_
#define PINODE_DYNAMICS_LIBRARY_FUNCTION_H_

#include <optional>
#include <string>
#include <vector>

#include "pinode/dynamics/monomial.h"

namespace pinode {

// One function g(q) of a vector q of features, written as text, for example
//
//   x[u1]^3        d[u1,u2]*v[u1]        abs(v[u1])*v[u1]
//
// with these parts, strongest binding first:
//
//   numbers, pi, features by name, (...), and the functions
//       sin cos tan asin acos atan sinh cosh tanh exp ln log10 sqrt abs sign
//       min(a, b) max(a, b)
//   a ^ b          right to left: a^b^c is a^(b^c), and -a^2 is -(a^2)
//   - a   a * b   a / b
//   a + b   a - b
//   < <= > >= == !=    1 where true, 0 where not
//   && and then ||     of "not 0"
//   a ? b : c
//
// muParser reads the text. What it read becomes a short list of operations
// that is evaluated here, and differentiated by a backward sweep (the reverse
// mode of Griewank and Walther, "Evaluating Derivatives", 2008): value and
// gradient are exact up to rounding for every function, those that users write
// included; nothing is allocated; and, unlike muParser's own evaluation, all
// const methods are safe to call from several threads.
//
// Where a function has no derivative: that of abs and sign at 0 is 0,
// comparisons and && || have none anywhere (0), min and max of equal arguments
// follow the first. A derivative that is infinite (sqrt at 0) comes out so.
class LibraryFunction {
 public:
  // The longest list of operations, features and numbers included.
  static constexpr int kMaxOperations = 256;

  // The function that is 0 everywhere, of no feature.
  LibraryFunction() = default;

  // `feature_names`: the entries of q, such as "x[u1]" or "d[u1,u2]"; blanks
  // around the parts of such a name do no harm in `text`. On failure returns
  // false, *function is untouched, and *error reads
  // "'x[u1]^^2', column 7: what, and what was expected".
  [[nodiscard]] static bool Parse(const std::string& text,
                                  const std::vector<std::string>& feature_names,
                                  LibraryFunction* function,
                                  std::string* error);

  // As parsed, without blanks outside names.
  const std::string& text() const { return text_; }
  int num_features() const { return num_features_; }
  bool DependsOn(int feature) const;

  // q: num_features() entries. Not finite outside the function's domain.
  double Evaluate(const double* q) const;

  // As Evaluate, and gradient (num_features() entries): dg/dq.
  double Linearize(const double* q, double* gradient) const;

 private:
  friend class LibraryFunctionBuilder;

  enum class Code {
    kNumber,
    kFeature,
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kPower,
    kIntegerPower,
    kNegate,
    kLess,
    kLessEqual,
    kGreater,
    kGreaterEqual,
    kEqual,
    kNotEqual,
    kAnd,
    kOr,
    kSelect,
    kSin,
    kCos,
    kTan,
    kAsin,
    kAcos,
    kAtan,
    kSinh,
    kCosh,
    kTanh,
    kExp,
    kLn,
    kLog10,
    kSqrt,
    kAbs,
    kSign,
    kMin,
    kMax,
  };

  // The operands are earlier operations.
  struct Operation {
    Code code = Code::kNumber;
    int index = 0;        // kFeature: which; kIntegerPower: the exponent
    double number = 0.0;  // kNumber
    int first = -1;
    int second = -1;
    int third = -1;  // kSelect: first ? second : third
  };

  static double Apply(const Operation& operation, const double* values);
  // The derivatives of an operation's value by its first two operands, a and b.
  // False where it has none, or is flat wherever it has one.
  static bool Differentiate(const Operation& operation, double a, double b,
                            double value, double* by_first, double* by_second);
  // Sets monomial_ where the operations are one.
  void FindMonomial();
  // Fills `values`, one an operation, and returns the last.
  double Forward(const double* q, double* values) const;

  std::string text_ = "0";
  int num_features_ = 0;
  std::vector<Operation> operations_ = {Operation()};
  // The same without a list of operations to go through, where there is one.
  std::optional<Monomial> monomial_;
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LIBRARY_FUNCTION_H_
