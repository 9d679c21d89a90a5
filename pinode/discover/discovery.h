// Regression step of discovery: from a trained network, or from records alone,
// to equations. network_outputs.h computes the regressed values,
// output_regression.h regresses one output.

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
  // Source of the regressed values: the networks along the predicted states, or
  // smoothed records, from which the forces to be supplied by networks follow.
  enum class Source { kNetwork, kDerivatives };

  // Method that proposes the supports to choose from: the LASSO's path, or that
  // of thresholds in sequentially thresholded least squares.
  enum class Solver { kLasso, kStlsq };

  // Output that has a library, or constraints, of its own.
  struct Output {
    std::string name;  // as the network's output: "u1", or "u1-u2"
    CandidateLibraryOptions library;
    // Constraints on coefficients by their basis: "x[u1]^3". No equalities.
    std::vector<CoefficientConstraint> constraints;
  };

  Source source = Source::kNetwork;
  Solver solver = Solver::kLasso;

  // Names of the networks to replace; empty: all.
  std::vector<std::string> networks;

  // Features of the candidates; empty: the inputs of the network.
  std::vector<Feature> features;
  CandidateLibraryOptions library;
  std::vector<Output> outputs;

  // Accepted loss against the best fit of all candidates. It is a share of the
  // RMS of the output DOF's acceleration (of the force that causes it, for
  // networks that act as forces). The fewest terms are chosen that lose less
  // than this, or than the uncertainty of the regressed values if that is
  // larger (DiscoveredEquation::uncertainty). A network's own error is not
  // noise: it is smooth and looks significant to every test that counts
  // samples. Terms hidden by an error below this limit are left to the refit.
  double tolerance = 0.005;

  // Number of bags of RunEnsemble for inclusion probabilities; 0: none.
  int num_bags = 0;
  double library_fraction = 1.0;
  uint64_t seed = 1;
  int num_threads = 1;
  // Ranks that share the bags; nullptr: a single process.
  Communicator* communicator = nullptr;

  // Pruning after the refit through the ODE. A term is dropped if it adds less
  // than this fraction of `tolerance`, or is not worth its price, (xi /
  // sigma_xi)^2 <= TermPrices.
  double prune_fraction = 0.1;

  // True: the selected terms are fitted to the trajectories.
  bool refit = true;

  // True: the refit searches the candidates for terms that the regression has
  // missed, by the same price.
  bool search = true;

  // Called in every iteration of the refit, before the callback of the fit's
  // options, with the present equations, for a program to save. `fit` is the
  // number of the refit's current fit, from 1.
  std::function<void(int fit, const std::vector<DiscoveredEquation>&)>
      on_equations;

  const Output* Find(const std::string& output) const;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// One term of an equation, with results of its regression and refit.
struct DiscoveredTerm {
  std::string basis;
  double coefficient = 0.0;
  // Share of the term: RMS of coefficient * basis over the samples, over the
  // scale of the equation.
  double share = 0.0;
  // RMS of the basis over the samples.
  double basis_rms = 0.0;
  // Inclusion probability in the ensemble; NaN without one.
  double inclusion_probability = 0.0;
  bool given = false;  // by a constraint
  int sign = 0;        // required by a constraint: 1, -1; 0: either

  // Results of the refit, or defaults without one.
  std::string unit;        // of the coefficient
  double regressed = 0.0;  // from the regression; 0: no term there
  // Standard deviation and 95 % interval of the coefficient; NaN without a
  // refit.
  double sigma = std::numeric_limits<double>::quiet_NaN();
  double lower95 = std::numeric_limits<double>::quiet_NaN();
  double upper95 = std::numeric_limits<double>::quiet_NaN();
};

// Candidate for a term: a coefficient that is not given.
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

// Equation g = sum_k xi_k f_k(q) in place of one output of one network.
struct DiscoveredEquation {
  // Source of the regressed values.
  DiscoveryOptions::Source source = DiscoveryOptions::Source::kNetwork;
  std::string network;
  std::string output;
  ActsAs acts_as = ActsAs::kAcceleration;
  std::vector<Feature> features;
  std::vector<std::string> feature_names;
  std::vector<DiscoveredTerm> terms;  // by descending share
  // RMS of the acceleration (force) of the output's DOFs. Shares and residuals
  // are relative to it.
  double scale = 0.0;
  // RMS of the network's output, and of the residual, over the scale.
  double output_rms = 0.0;
  double residual = 0.0;
  // Standard deviation of the regressed values, RMS over the samples, over the
  // scale. For a network it is that of its posterior. 0: unknown.
  double uncertainty = 0.0;
  int num_candidates = 0;  // given ones included
  std::vector<DiscoveryCandidate> candidates;
  std::vector<DiscoveryParetoPoint> pareto;
  int num_regressed_terms = 0;  // free ones, of the chosen point
  // Regressed values: samples x features, and the output.
  Matrix sample_features;
  Vector sample_outputs;
};

// Regresses each output of each network of `problem`, as trained in `model`, on
// its candidates along the predicted states of the training records (Lai et al.
// (2021), eq. (7)), and selects terms. The equations are in the order of
// networks and outputs; those without terms are included. The linear path of a
// network next to known stiffness and damping is part of its output, and so of
// the equation. A network under the gauge has no slope at rest: candidates that
// are plain features are left out there. Returns false for invalid options, a
// candidate that cannot be evaluated, a run that is not finite, or no network.
[[nodiscard]] bool DiscoverFromNetworks(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    const DiscoveryOptions& options, std::vector<DiscoveredEquation>* equations,
    std::string* error);

// Finds equations without a trained network (eqs. (8) and (9) there). The
// regressed values are differences of accelerations: those of the smoothed
// training records (SmoothMotion) less those of the model without networks, its
// parameters at their initial values. The networks of `problem` define where
// terms act and which features they may use. The accelerations must distinguish
// the networks. *model: initial model of a refit, with noise levels and starts
// from the smoothed records. Also returns false for a DOF that the records do
// not determine (see SmoothMotion), and for laws with internal states.
[[nodiscard]] bool DiscoverFromDerivatives(
    const IdentificationProblem& problem, const DiscoveryOptions& options,
    std::vector<DiscoveredEquation>* equations, IdentifiedModel* model,
    std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_DISCOVERY_H_
