// Functions of named features, the parts of closed-form laws.

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
// muParser reads the text. The parsed text becomes a short list of operations.
// This class evaluates the list, and differentiates it by a backward sweep (the
// reverse mode of Griewank and Walther, "Evaluating Derivatives", 2008). Value
// and gradient are exact up to rounding for every function, including those of
// users. No memory is allocated. Unlike muParser's own evaluation, all const
// methods are safe to call from several threads.
//
// At points without a derivative: that of abs and sign at 0 is 0, comparisons
// and && || have the derivative 0 everywhere, min and max of equal arguments
// follow the first. An infinite derivative (sqrt at 0) is returned as infinite.
class LibraryFunction {
 public:
  // Largest number of operations, including features and numbers.
  static constexpr int kMaxOperations = 256;

  // Creates the function that is 0 everywhere, without features.
  LibraryFunction() = default;

  // Parses a function. `feature_names` are the entries of q, such as "x[u1]" or
  // "d[u1,u2]". `text` may have blanks around the parts of such a name. On
  // failure returns false, *function is unchanged, and *error is "'x[u1]^^2',
  // column 7: error, expected ...".
  [[nodiscard]] static bool Parse(const std::string& text,
                                  const std::vector<std::string>& feature_names,
                                  LibraryFunction* function,
                                  std::string* error);

  // Text as parsed, without blanks outside names.
  const std::string& text() const { return text_; }
  int num_features() const { return num_features_; }
  bool DependsOn(int feature) const;

  // Returns the value at q, num_features() entries. It is not finite outside
  // the function's domain. `branches` holds the branch of each switch, see
  // below. nullptr: those at q.
  double Evaluate(const double* q, const char* branches = nullptr) const;

  // Does what Evaluate does, and computes gradient (num_features() entries):
  // dg/dq.
  double Linearize(const double* q, double* gradient,
                   const char* branches = nullptr) const;

  // Switches are the comparisons < <= > >= and the signs, at which the function
  // may jump. A switch is on its positive branch where a - b > 0 for the two
  // sides of a comparison, or where the argument of sign is positive.
  int num_switches() const { return static_cast<int>(switches_.size()); }
  // Computes a - b, or the argument, of each switch at q.
  void Switches(const double* q, double* values) const;
  // Computes the gradient of switch j by q, num_features() entries.
  void SwitchGradient(int j, const double* q, double* gradient) const;

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

  // One operation. Its operands are earlier operations.
  struct Operation {
    Code code = Code::kNumber;
    int index = 0;        // kFeature: which; kIntegerPower: the exponent
    double number = 0.0;  // kNumber
    int first = -1;
    int second = -1;
    int third = -1;     // kSelect: first ? second : third
    int switched = -1;  // number of the switch
  };

  static double Apply(const Operation& operation, const double* values);
  // Sign of a switch's value, first minus second operand. At zero the branch
  // below then has the value that the comparison has for equal operands.
  static double Orientation(const Operation& operation);
  // Returns the value of a switch on a branch.
  static double OnBranch(const Operation& operation, bool positive);
  // Computes the derivatives of an operation's value with respect to its first
  // two operands, a and b. Returns false if it has none, or if they are zero.
  static bool Differentiate(const Operation& operation, double a, double b,
                            double value, double* by_first, double* by_second);
  // Sets monomial_ if the operations form a monomial.
  void FindMonomial();
  // Numbers the switches among operations_.
  void FindSwitches();
  // Fills `values`, one per operation, and returns the last one.
  double Forward(const double* q, const char* branches, double* values) const;
  // Adds the gradient of sum_i adjoints_i values_i, summed over operations, to
  // `gradient`. Uses up `adjoints`.
  void Backward(const double* values, double* adjoints, double* gradient) const;

  std::string text_ = "0";
  int num_features_ = 0;
  std::vector<Operation> operations_ = {Operation()};
  std::vector<int> switches_;  // operations
  // The same function without a list of operations, if it is a monomial.
  std::optional<Monomial> monomial_;
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LIBRARY_FUNCTION_H_
