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

// Force F(t; p) with parameters p. At any instant it depends on at most
// kMostLocal neighbouring parameters. It has no mutable state, so all functions
// may be called from several threads.
class ForceHistory {
 public:
  static constexpr int kMostLocal = 4;

  // Value at one instant, and its derivatives with respect to the parameters
  // first, ..., first + count - 1. All other derivatives are zero.
  struct Local {
    double value = 0.0;
    int first = 0;
    int count = 0;
    double derivatives[kMostLocal] = {};
  };

  virtual ~ForceHistory() = default;
  // Number of parameters p.
  virtual int num_parameters() const = 0;
  // Computes F at `time`, both in the model's units. `parameters` has
  // num_parameters() entries.
  virtual Local Evaluate(double time, const double* parameters) const = 0;
  virtual WideJet Evaluate(double time, const WideJet* parameters) const = 0;
  // Returns a description in words and numbers, different for different forces.
  virtual std::string Description() const = 0;
};

// Spline with one coefficient p_k per knot,
//
//   F(t) = scale sum_k p_k B((t - t_k) / spacing),   t_k = start + k spacing.
//
// B is the B-spline of degree 1 or 3 (C. de Boor, A Practical Guide to Splines,
// 2001). With degree 1, scale * p_k is the force at knot k. The force is zero
// from one spacing (degree 1) or two spacings (degree 3) outside the outer
// knots.
class SplineForce final : public ForceHistory {
 public:
  struct Options {
    int degree = 3;        // 1 or 3
    double start = 0.0;    // time t_0 of the first knot
    double spacing = 0.0;  // time between knots, positive
    int num_knots = 0;     // positive
    double scale = 1.0;    // unit of F, so that p_k has none
  };
  // Creates the force. The options must be valid, see AreValid.
  explicit SplineForce(const Options& options);
  // Checks the options. On failure returns false, and *error names the option
  // and the violated constraint.
  [[nodiscard]] static bool AreValid(const Options& options,
                                     std::string* error);

  const Options& options() const { return options_; }
  int num_parameters() const override { return options_.num_knots; }
  Local Evaluate(double time, const double* parameters) const override;
  WideJet Evaluate(double time, const WideJet* parameters) const override;
  std::string Description() const override;

 private:
  // Computes the derivatives with respect to the coefficients, not the value.
  Local Basis(double time) const;

  Options options_;
};

// Blow of a hammer: half a period of a sine,
//
//   F(t) = amplitude sin(pi (t - start) / duration)   within, zero outside.
//
// The parameters are start, duration (positive) and amplitude, in the model's
// units. The slope of F jumps at both ends. A response integrated step by step
// therefore has derivatives with respect to start and duration that jump too.
// Steps that are short compared with the duration keep these jumps small.
class HalfSinePulse final : public ForceHistory {
 public:
  int num_parameters() const override { return 3; }
  Local Evaluate(double time, const double* parameters) const override;
  WideJet Evaluate(double time, const WideJet* parameters) const override;
  std::string Description() const override { return "half-sine pulse"; }
};

// Gaussian prior on linear combinations of a term's parameters,
//
//   weights . (p_first, p_first+1, ...) ~ N(0, 1 / precision of its group).
//
// The combinations must be linearly independent, so there are at most as many
// as parameters. The determinant of the prior's precision is then a constant
// times the product of the precisions of all combinations. MacKay's rule (1992)
// for choosing precisions by the evidence therefore holds as for single
// parameters.
struct CombinationPrior {
  // One combination: the index of its group, its first parameter, and one
  // weight for this and each following parameter.
  struct Combination {
    int group = 0;
    int first = 0;
    Vector weights;
  };
  std::vector<Combination> combinations;
  // Precision of each group. Negative: the evidence chooses it.
  std::vector<double> precisions;

  int num_groups() const { return static_cast<int>(precisions.size()); }
  // Checks that groups exist and that the combinations fit `num_parameters`.
  // With combinations, `num_free` must be 0 or num_parameters. On failure
  // returns false; the sentence in *error has no subject, so that the caller
  // can name it.
  [[nodiscard]] bool IsValid(int num_parameters, int num_free,
                             std::string* error) const;
  // Returns the fraction of the combinations whose precision the evidence
  // chooses, 0 to 1.
  double ShareToBeChosen() const;
};

// Returns a prior for local smoothness: the second differences of the
// coefficients,
//
//   p_{k-1} - (2 + relaxation^2) p_k + p_{k+1},   zeros beyond both ends,
//
// are small. The evidence chooses their size, one for each group of
// `neighbourhood` neighbouring knots. A single size would not do, because a
// force is rough at a blow and smooth elsewhere.
//
// `relaxation` is the spacing of the knots divided by a decay time T. With it a
// smooth force decays to zero like exp(-t / T). With relaxation = 0 a smooth
// force is a straight line, and the prior hardly limits a slow drift that the
// sensors do not measure.
CombinationPrior SmoothnessPrior(int num_knots, int neighbourhood,
                                 double relaxation);

// Returns a prior for a force with frequencies between `lowest` and `highest`,
// in cycles per unit of time. `spacing` is the time between knots. The prior
// acts on the cosine transform (DCT-II) of the coefficients. The part inside
// the band has one precision, which the evidence chooses. The part outside has
// the precision `outside`.
CombinationPrior BandPrior(int num_knots, double spacing, double lowest,
                           double highest, double outside);

// Unmeasured force as a term: outputs * F(t) is added to the right-hand side of
// M dv/dt = ...
struct UnknownForceTerm {
  std::string name;
  // Function F.
  std::shared_ptr<const ForceHistory> history;
  Vector outputs;  // one per DOF, dimensionless
  // Index of the input that the force is multiplied by. It is 1 in the force's
  // record and 0 in all others. -1: the force acts in every record.
  int input = -1;
  ParameterBlock parameters;
  // Prior on combinations of the parameters. Empty: each parameter has only its
  // own prior. If it is not empty, either all parameters are free or none.
  CombinationPrior prior;
};

// Creates the term. Term::IsValid checks sizes, input and prior.
std::unique_ptr<Term> MakeTerm(UnknownForceTerm force);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_UNKNOWN_FORCE_H_
