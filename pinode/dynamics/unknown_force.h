// Unmeasured forces, as functions of time with unknown parameters.

#ifndef PINODE_DYNAMICS_UNKNOWN_FORCE_H_
#define PINODE_DYNAMICS_UNKNOWN_FORCE_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/term.h"
#include "pinode/dynamics/wide_jet.h"

namespace pinode {

// A force F(t; p). At any instant it depends on a few neighbouring parameters
// only. It has no mutable state: safe to call from several threads.
class ForceHistory {
 public:
  static constexpr int kMostLocal = 4;

  // Value at one instant, and its derivatives with respect to the parameters
  // first ... first + count - 1. All other derivatives are zero.
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
  // Returns a unique description in words and numbers.
  virtual std::string Description() const = 0;
};

// A spline with one coefficient per knot,
//
//   F(t) = scale sum_k p_k B((t - t_k) / spacing),   t_k = start + k spacing.
//
// B is the B-spline of degree 1 (the coefficients are the force at the knots)
// or 3 (C. de Boor, A Practical Guide to Splines, 2001). The force is zero
// beyond the reach of all B: one spacing outside the outer knots, or two.
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
  // Computes the derivatives with respect to the coefficients, without the
  // value.
  Local Basis(double time) const;

  Options options_;
};

// The blow of a hammer: half a period of a sine,
//
//   F(t) = amplitude sin(pi (t - start) / duration)   within, zero outside.
//
// Parameters: start, duration (positive), amplitude. The slope jumps at both
// ends. So do the derivatives, with respect to start and duration, of a
// response that is integrated step by step. Steps that are short against the
// duration keep the jumps small.
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
// The combinations are linearly independent and at most as many as parameters.
// The determinant of the prior's precision (on the space that they span) is
// then that of the groups' precisions times a constant. MacKay's rule for
// choosing them by the evidence therefore holds as for single parameters.
struct CombinationPrior {
  struct Combination {
    int group = 0;
    int first = 0;
    Vector weights;
  };
  std::vector<Combination> combinations;
  // Precision of each group. Negative: the evidence chooses it.
  std::vector<double> precisions;

  int num_groups() const { return static_cast<int>(precisions.size()); }
  // Checks that its groups exist and that its combinations fit
  // `num_parameters`. If there are any combinations, all of these parameters
  // must be free, or none. The sentence in *error has no subject.
  [[nodiscard]] bool IsValid(int num_parameters, int num_free,
                             std::string* error) const;
  // Returns the share of the combinations whose precision the evidence chooses.
  double ShareToBeChosen() const;
};

// Returns a prior for local smoothness. The second differences
//
//   p_{k-1} - (2 + relaxation^2) p_k + p_{k+1},   zeros beyond both ends,
//
// are small. The evidence chooses their size for each `neighbourhood` of so
// many knots. A force is rough at a blow and smooth elsewhere, which one
// precision for all knots cannot express. With a relaxation (spacing of the
// knots over a time) a smooth force decays to zero like exp(-t / time) instead
// of being a straight line. Without it, the prior hardly limits a slow drift
// that the sensors do not measure.
CombinationPrior SmoothnessPrior(int num_knots, int neighbourhood,
                                 double relaxation);

// Returns a prior for a force between two frequencies (cycles per unit of time,
// `spacing` in the same unit). It acts on the force's cosine transform
// (DCT-II). The part inside the band has one precision that the evidence
// chooses. The part outside has the precision `outside`.
CombinationPrior BandPrior(int num_knots, double spacing, double lowest,
                           double highest, double outside);

// A force that nobody measured: outputs * F(t) is added to the right-hand side.
struct UnknownForceTerm {
  std::string name;
  std::shared_ptr<const ForceHistory> history;
  Vector outputs;  // num_dofs
  // Index of an input that is one in the force's record and zero in all others.
  // The force is multiplied by it. -1: the force acts in every record.
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
