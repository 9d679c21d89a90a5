// Forces that nobody measured, as functions of time with unknown parameters.

#ifndef PINODE_DYNAMICS_UNKNOWN_FORCE_H_
#define PINODE_DYNAMICS_UNKNOWN_FORCE_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/term.h"
#include "pinode/dynamics/wide_jet.h"

namespace pinode {

// F(t; p). At any instant it depends on a few neighbouring parameters only,
// however many there are. No state: safe to call from several threads.
class ForceHistory {
 public:
  static constexpr int kMostLocal = 4;

  // Value at one instant, and its derivatives by the parameters
  // first ... first + count - 1; those by all others are zero.
  struct Local {
    double value = 0.0;
    int first = 0;
    int count = 0;
    double derivatives[kMostLocal] = {};
  };

  virtual ~ForceHistory() = default;
  virtual int num_parameters() const = 0;
  virtual Local Evaluate(double time, const double* parameters) const = 0;
  virtual WideJet Evaluate(double time, const WideJet* parameters) const = 0;
  // What it is, in words and numbers that tell it from any other.
  virtual std::string Description() const = 0;
};

// A spline with one coefficient per knot,
//
//   F(t) = scale sum_k p_k B((t - t_k) / spacing),   t_k = start + k spacing,
//
// B the B-spline of degree 1 (the coefficients are the force at the knots) or
// 3 (C. de Boor, A Practical Guide to Splines, 2001). Zero where no B reaches:
// one spacing beyond the outer knots, or two.
class SplineForce final : public ForceHistory {
 public:
  struct Options {
    int degree = 3;        // 1 or 3
    double start = 0.0;    // time of the first knot
    double spacing = 0.0;  // time between knots, positive
    int num_knots = 0;     // positive
    double scale = 1.0;    // force; makes the coefficients pure numbers
  };
  // The options must be valid, see AreValid.
  explicit SplineForce(const Options& options);
  [[nodiscard]] static bool AreValid(const Options& options,
                                     std::string* error);

  const Options& options() const { return options_; }
  int num_parameters() const override { return options_.num_knots; }
  Local Evaluate(double time, const double* parameters) const override;
  WideJet Evaluate(double time, const WideJet* parameters) const override;
  std::string Description() const override;

 private:
  // The derivatives by the coefficients, without the value.
  Local Basis(double time) const;

  Options options_;
};

// A hammer's blow: half a period of a sine,
//
//   F(t) = amplitude sin(pi (t - start) / duration)   within, zero outside.
//
// Parameters: start, duration (positive), amplitude. Where it begins and ends
// its slope jumps, and so do the derivatives by start and duration of a
// response that is integrated step by step: steps short against the duration
// keep that small.
class HalfSinePulse final : public ForceHistory {
 public:
  int num_parameters() const override { return 3; }
  Local Evaluate(double time, const double* parameters) const override;
  WideJet Evaluate(double time, const WideJet* parameters) const override;
  std::string Description() const override { return "half-sine pulse"; }
};

// A Gaussian prior on linear combinations of a term's parameters,
//
//   weights . (p_first, p_first+1, ...) ~ N(0, 1 / precision of its group).
//
// There are no more combinations than parameters and they are linearly
// independent. The determinant of the prior's precision (on the space that they
// span) then is that of the groups' precisions times a constant, so that
// MacKay's rule for choosing them by the evidence holds as it does for single
// parameters.
struct CombinationPrior {
  struct Combination {
    int group = 0;
    int first = 0;
    Vector weights;
  };
  std::vector<Combination> combinations;
  // Per group: negative asks for the evidence's choice of the precision.
  std::vector<double> precisions;

  int num_groups() const { return static_cast<int>(precisions.size()); }
  // Whether its groups exist, its combinations are of `num_parameters`, and,
  // where there are any, all of these are free or none. *error has no subject.
  [[nodiscard]] bool IsValid(int num_parameters, int num_free,
                             std::string* error) const;
  // Share of the combinations whose precision the evidence chooses.
  double ShareToBeChosen() const;
};

// Local smoothness: second differences
//
//   p_{k-1} - (2 + relaxation^2) p_k + p_{k+1},   zeros beyond both ends,
//
// are small, and the evidence says for each `neighbourhood` of so many knots
// how small. A blow is rough where it falls and the force stays smooth
// elsewhere, which one precision for all knots cannot express. With a
// relaxation (spacing of the knots over a time) a smooth force is not a
// straight line but falls to zero like exp(-t / time): without, a slow drift
// that the sensors do not see is as good as none.
CombinationPrior SmoothnessPrior(int num_knots, int neighbourhood,
                                 double relaxation);

// The force lives between two frequencies (cycles per unit of time, `spacing`
// in the same unit): of its cosine transform (DCT-II) what lies inside has one
// precision that the evidence chooses, what lies outside the precision
// `outside`.
CombinationPrior BandPrior(int num_knots, double spacing, double lowest,
                           double highest, double outside);

// A force that nobody measured: outputs * F(t) is added to the right-hand side.
struct UnknownForceTerm {
  std::string name;
  std::shared_ptr<const ForceHistory> history;
  Vector outputs;  // num_dofs
  // What happens in one record does not happen in another: an input that is
  // one in the force's record and zero in all others, by which the force is
  // multiplied. -1: the force acts in every record.
  int input = -1;
  ParameterBlock parameters;
  // Empty: none but the parameters' own. With one, all parameters are free or
  // none.
  CombinationPrior prior;
};

// At any instant it depends on few of its parameters, and so do its tangents.
std::unique_ptr<Term> MakeTerm(UnknownForceTerm force);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_UNKNOWN_FORCE_H_
