// Regression step of discovery: finds equations from a trained network, or from
// records alone. Two other headers hold its parts: network_outputs.h computes
// the regressed values, output_regression.h regresses one output.

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

// Options of discovery.
struct DiscoveryOptions {
  // Source of the regressed values. kNetwork: outputs of the trained networks
  // along the predicted states. kDerivatives: forces that the networks would
  // have to supply, computed from smoothed records.
  enum class Source { kNetwork, kDerivatives };

  // Method that proposes sets of terms to choose from. kLasso: the path of the
  // LASSO (R. Tibshirani 1996). kStlsq: sequentially thresholded least squares
  // for a path of thresholds (S. L. Brunton, J. L. Proctor and J. N. Kutz
  // 2016).
  enum class Solver { kLasso, kStlsq };

  // Output that has its own library or constraints.
  struct Output {
    std::string name;  // name of the network's output: "u1" or "u1-u2"
    CandidateLibraryOptions library;  // candidates of this output
    // Constraints on coefficients, named by their basis function such as
    // "x[u1]^3". Equalities are not allowed.
    std::vector<CoefficientConstraint> constraints;
  };

  // Source of the regressed values, and method of the regression.
  Source source = Source::kNetwork;
  Solver solver = Solver::kLasso;

  // Names of the networks to replace by equations; empty: all.
  std::vector<std::string> networks;

  // Features (inputs) of the candidates; empty: the inputs of the network.
  std::vector<Feature> features;
  // Candidates of all outputs that are not listed in `outputs`.
  CandidateLibraryOptions library;
  std::vector<Output> outputs;

  // Accepted loss: increase of the RMS error against the best fit with all
  // candidates, as a fraction of DiscoveredEquation::scale. The equation with
  // the fewest terms within this loss is chosen. If
  // DiscoveredEquation::uncertainty is larger, it takes the place of
  // `tolerance`. A test that counts samples would not do: a network's error is
  // smooth, and so looks significant. Terms that this error hides are left to
  // the refit.
  double tolerance = 0.005;

  // Number of bags (resampled regressions) for inclusion probabilities, see
  // RunEnsemble (U. Fasel et al. 2022). 0: no ensemble.
  int num_bags = 0;
  // Fraction of the candidates that each bag is offered; 1: all.
  double library_fraction = 1.0;
  // Seed of the ensemble's random numbers, and number of threads. The result
  // does not depend on the number of threads.
  uint64_t seed = 1;
  int num_threads = 1;
  // Ranks that share the bags; nullptr: a single process.
  Communicator* communicator = nullptr;

  // Limit for dropping terms after the refit to the trajectories. A term is
  // dropped if its share is less than prune_fraction * tolerance. It is also
  // dropped if (xi / sigma_xi)^2 is not above its price (TermPrices), with xi
  // the coefficient and sigma_xi its standard deviation.
  double prune_fraction = 0.1;

  // True: the selected terms are fitted to the trajectories.
  bool refit = true;

  // True: the refit searches the candidates for terms that the regression has
  // missed. A term enters if it is worth its price.
  bool search = true;

  // Function that is called in every iteration of the refit, with the present
  // equations, so that a program can save them. It runs before the callback of
  // the fit's options. `fit` is the number of the refit's current fit, from 1.
  std::function<void(int fit, const std::vector<DiscoveredEquation>&)>
      on_equations;

  // Returns the entry of `outputs` with this name, or nullptr.
  const Output* Find(const std::string& output) const;

  // Returns false if an option is not allowed. *error then names the option and
  // the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// One term coefficient * basis of an equation, with results of its regression
// and refit.
struct DiscoveredTerm {
  // Text of the basis function, such as "x[u1]^3", and its coefficient.
  std::string basis;
  double coefficient = 0.0;
  // Share of the term: RMS of coefficient * basis over the samples, divided by
  // DiscoveredEquation::scale.
  double share = 0.0;
  // RMS of the basis function over the samples, in its own unit.
  double basis_rms = 0.0;
  // Fraction of the ensemble's bags that select the term, 0 to 1; NaN without
  // an ensemble.
  double inclusion_probability = 0.0;
  // Probability of the term among all sets of terms that describe the records
  // about as well, by the refit; NaN without a refit that searches.
  double probability = std::numeric_limits<double>::quiet_NaN();
  bool given = false;  // True if a constraint fixes the coefficient.
  int sign = 0;        // Sign that a constraint requires, 1 or -1. 0: either.

  // Results of the refit; defaults without a refit. `unit` is the unit of the
  // coefficient. `regressed` is the coefficient from the regression, 0 for a
  // term that the refit has added.
  std::string unit;
  double regressed = 0.0;
  // Standard deviation and 95 % interval of the coefficient; NaN without a
  // refit.
  double sigma = std::numeric_limits<double>::quiet_NaN();
  double lower95 = std::numeric_limits<double>::quiet_NaN();
  double upper95 = std::numeric_limits<double>::quiet_NaN();
};

// Candidate for a term whose coefficient is not given. `basis` is the text of
// its function.
struct DiscoveryCandidate {
  std::string basis;
  double rms = 0.0;            // RMS of the function over the samples
  int sign = 0;                // see DiscoveredTerm::sign
  int degree = kNotAMonomial;  // total degree; 0: constant
  // Probability that it is a term, see DiscoveredTerm::probability.
  double probability = std::numeric_limits<double>::quiet_NaN();
};

// One point of the Pareto curve: the best equation with this number of terms.
struct DiscoveryParetoPoint {
  int num_terms = 0;
  double residual = 0.0;  // RMS of the residual / scale
  // Bayesian information criterion (G. Schwarz 1978).
  double bic = 0.0;
};

// Equation g = sum_k xi_k f_k(q) that replaces one output g of one network. q
// are the features, f_k the basis functions, xi_k the coefficients.
struct DiscoveredEquation {
  // Source of the regressed values.
  DiscoveryOptions::Source source = DiscoveryOptions::Source::kNetwork;
  // Names of the network and of its output.
  std::string network;
  std::string output;
  // Unit of g: an acceleration or a force.
  ActsAs acts_as = ActsAs::kAcceleration;
  // Features q and their names.
  std::vector<Feature> features;
  std::vector<std::string> feature_names;
  std::vector<DiscoveredTerm> terms;  // largest share first
  // RMS of the acceleration of the output's DOFs over the samples, or of the
  // force that causes it if g is a force. Shares and residuals are relative to
  // it.
  double scale = 0.0;
  // RMS of the regressed values, and of the residual, divided by `scale`.
  double output_rms = 0.0;
  double residual = 0.0;
  // Standard deviation of the regressed values, as RMS over the samples,
  // divided by `scale`. For a network it is from the posterior of its weights.
  // 0: unknown.
  double uncertainty = 0.0;
  int num_candidates = 0;  // also counts given ones
  // Candidates that were offered, and the Pareto curve by number of terms.
  std::vector<DiscoveryCandidate> candidates;
  std::vector<DiscoveryParetoPoint> pareto;
  // Number of terms that the regression has chosen, without given ones.
  int num_regressed_terms = 0;
  // Values of the features, samples x features, and the regressed values, one
  // per sample, in the unit of g.
  Matrix sample_features;
  Vector sample_outputs;
};

// A set of terms that lacks a chosen one and describes the records nearly as
// well.
struct TermRival {
  // Terms that it leaves out and takes in, such as "u1: x[u1]^3".
  std::vector<std::string> without;
  std::vector<std::string> with;
  // Natural logarithm of its odds relative to the chosen terms. It allows for
  // the number of terms and the correlation of residuals from sample to sample.
  double log_odds = 0.0;
  // True: it was fitted to the trajectories. False: the odds follow from the
  // cost near the fit of the chosen terms.
  bool fitted = false;
};

// Probability below which a chosen term counts as uncertain.
inline constexpr double kCertainTerm = 0.95;

// Finds an equation for each output of each network of `problem`, as trained in
// `model`. The output along the predicted states of the training records is
// regressed on the candidates, and terms are selected (Z. Lai et al. 2021, eq.
// (7)).
//
// *equations has one entry per output, in the order of networks and outputs,
// also if no term was selected. The linear path of a network is part of its
// output, and so of the equation. A network under the gauge has no slope at
// rest (NetworkArchitecture), so plain features are no candidates for it.
//
// Returns false, with *error, for invalid options, a candidate that cannot be
// evaluated, a simulation that is not finite, or a problem without networks.
[[nodiscard]] bool DiscoverFromNetworks(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    const DiscoveryOptions& options, std::vector<DiscoveredEquation>* equations,
    std::string* error);

// Finds equations without a trained network (Z. Lai et al. 2021, eqs. (8) and
// (9)). The regressed values are accelerations of the smoothed training records
// (SmoothMotion) minus those of the model without networks. The parameters of
// this model have their initial values. The networks of `problem` only define
// the DOFs at which terms act and the features that terms may use. The
// accelerations must distinguish the networks.
//
// *model receives the initial model of a refit, with noise levels and initial
// states from the smoothed records. Returns false as DiscoverFromNetworks does.
// Also returns false for laws with internal states, and for a DOF whose motion
// the records do not determine (see SmoothMotion).
[[nodiscard]] bool DiscoverFromDerivatives(
    const IdentificationProblem& problem, const DiscoveryOptions& options,
    std::vector<DiscoveredEquation>* equations, IdentifiedModel* model,
    std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_DISCOVERY_H_
