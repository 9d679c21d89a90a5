// From a trained network, or from records alone, to equations: the regression
// half of discovery. What is regressed is in network_outputs.h, how one output
// is regressed in output_regression.h.

#ifndef PINODE_DISCOVER_DISCOVERY_H_
#define PINODE_DISCOVER_DISCOVERY_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/discover/equation_options.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

struct DiscoveredEquation;

struct DiscoveryOptions {
  // What is regressed: the networks along the predicted states; or, of what
  // networks would have to supply, what smoothed records say.
  enum class Source { kNetwork, kDerivatives };

  // What proposes the supports among which one is chosen: the LASSO's path or
  // that of thresholds in sequentially thresholded least squares.
  enum class Solver { kLasso, kStlsq };

  // One output that has a library, or conditions, of its own.
  struct Output {
    std::string name;  // as the network's output: "u1", or "u1-u2"
    CandidateLibraryOptions library;
    // On coefficients by their basis: "x[u1]^3". No equalities.
    std::vector<CoefficientConstraint> constraints;
  };

  Source source = Source::kNetwork;
  Solver solver = Solver::kLasso;

  // Names of the networks to replace; empty: all.
  std::vector<std::string> networks;

  // What candidates are made of; empty: the inputs of the network.
  std::vector<Feature> features;
  CandidateLibraryOptions library;
  std::vector<Output> outputs;

  // Of the RMS of the output DOF's acceleration (of the force that causes it,
  // for networks that act as forces): the fewest terms are chosen that lose
  // less than this, or than the uncertainty of what is regressed if that is
  // more (DiscoveredEquation::uncertainty), against the best fit of all
  // candidates. A network's own error is no noise; it is smooth and looks
  // significant to every test that counts samples. What it hides below this is
  // left to the refit.
  double tolerance = 0.005;

  // Bags of RunEnsemble for inclusion probabilities; 0: none.
  int num_bags = 0;
  double library_fraction = 1.0;
  uint64_t seed = 1;
  int num_threads = 1;
  // Ranks that share the bags; nullptr: a single process.
  Communicator* communicator = nullptr;

  // After the refit through the ODE a term is dropped if it adds less than
  // this fraction of `tolerance`, or is not worth its price, (xi /
  // sigma_xi)^2 <= TermPrices.
  double prune_fraction = 0.1;

  // Whether the selected terms are fitted to the trajectories.
  bool refit = true;

  // Whether the refit looks among the candidates for what the regression has
  // missed, by the same price.
  bool search = true;

  // Called in every iteration of the refit, before the callback of the fit's
  // options, with the equations as they are, what a program saves, and which of
  // the refit's fits it is, from 1.
  std::function<void(int fit, const std::vector<DiscoveredEquation>&)>
      on_equations;

  const Output* Find(const std::string& output) const;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// One term of an equation, from its regression to what is reported of it.
struct DiscoveredTerm {
  std::string basis;
  double coefficient = 0.0;
  // RMS of coefficient * basis over the samples, over the scale of the
  // equation.
  double share = 0.0;
  // RMS of the basis over the samples.
  double basis_rms = 0.0;
  // In the ensemble; NaN without one.
  double inclusion_probability = 0.0;
  bool given = false;  // by a constraint
  int sign = 0;        // asked for by a constraint: 1, -1; 0: either

  // What the refit adds, or what stands in for it.
  std::string unit;        // of the coefficient
  double regressed = 0.0;  // the coefficient before; 0: it was no term then
  // Of the coefficient; NaN without a refit.
  double sigma = std::numeric_limits<double>::quiet_NaN();
  double lower95 = std::numeric_limits<double>::quiet_NaN();
  double upper95 = std::numeric_limits<double>::quiet_NaN();
};

// What could be a term: a coefficient that is not given.
struct DiscoveryCandidate {
  std::string basis;
  double rms = 0.0;            // of the basis over the samples
  int sign = 0;                // as DiscoveredTerm::sign
  int degree = kNotAMonomial;  // of a monomial, 0 of the constant
};

// One point of the Pareto curve.
struct DiscoveryParetoPoint {
  int num_terms = 0;
  double residual = 0.0;  // RMS over the equation's scale
  double bic = 0.0;
};

// g = sum_k xi_k f_k(q) in place of one output of one network.
struct DiscoveredEquation {
  // What was regressed.
  DiscoveryOptions::Source source = DiscoveryOptions::Source::kNetwork;
  std::string network;
  std::string output;
  ActsAs acts_as = ActsAs::kAcceleration;
  std::vector<Feature> features;
  std::vector<std::string> feature_names;
  std::vector<DiscoveredTerm> terms;  // by descending share
  // RMS of the acceleration (force) of the output's DOFs, what shares and
  // residuals refer to.
  double scale = 0.0;
  // RMS over the scale of the network's output, and of what the terms leave.
  double output_rms = 0.0;
  double residual = 0.0;
  // Standard deviation of what is regressed, RMS over the samples, over the
  // scale: for a network that of its posterior. 0: not known.
  double uncertainty = 0.0;
  int num_candidates = 0;  // given ones included
  std::vector<DiscoveryCandidate> candidates;
  std::vector<DiscoveryParetoPoint> pareto;
  int num_regressed_terms = 0;  // free ones, of the point that was chosen
  // What was regressed on what: samples x features, and the output.
  Matrix sample_features;
  Vector sample_outputs;
};

// Regresses each output of each network of `problem`, as trained in `model`, on
// its candidates along the predicted states of the training records (Lai et al.
// (2021), eq. (7)), and selects terms; equations in the order of networks and
// outputs, also those without terms. The linear path of a network next to known
// stiffness and damping is part of its output and so of the equation. A
// network under the gauge has no slope at rest: candidates that are features as
// they stand are left out there. False for invalid options, a candidate that
// cannot be evaluated, a run that is not finite, or no network.
[[nodiscard]] bool DiscoverFromNetworks(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    const DiscoveryOptions& options, std::vector<DiscoveredEquation>* equations,
    std::string* error);

// The same without a trained network (eqs. (8) and (9) there): what the
// networks would have to supply is the difference between the accelerations of
// the smoothed training records (SmoothMotion) and those of the model without
// networks, its parameters at their initial values. The networks of `problem`
// say where terms act and what they may look at; together they must be told
// apart by the accelerations. *model: what a refit begins with, noise levels
// and starts from the smoothed records. False, besides, for a DOF that the
// records do not show (see there), and for laws with internal states.
[[nodiscard]] bool DiscoverFromDerivatives(
    const IdentificationProblem& problem, const DiscoveryOptions& options,
    std::vector<DiscoveredEquation>* equations, IdentifiedModel* model,
    std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_DISCOVERY_H_
