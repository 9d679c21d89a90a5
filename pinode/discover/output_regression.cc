#include "pinode/discover/output_regression.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/discover/candidate_library.h"
#include "pinode/discover/coefficient_map.h"
#include "pinode/discover/ensemble.h"
#include "pinode/discover/lasso.h"
#include "pinode/discover/least_squares_system.h"
#include "pinode/discover/regression_problem.h"
#include "pinode/discover/robust_fit.h"
#include "pinode/discover/selection.h"
#include "pinode/discover/stlsq.h"

namespace pinode {
namespace {

class OutputRegression {
 public:
  OutputRegression(const DiscoveryOptions& options, const Matrix& features,
                   DiscoveredEquation* equation)
      : options_(options), features_(features), equation_(*equation) {}

  bool Run(const Vector& y, const std::vector<Eigen::Index>& record_starts,
           bool without_slope, std::string* error) {
    problem_.record_starts = record_starts;
    problem_.outputs.resize(1);
    problem_.outputs[0].name = equation_.output;
    problem_.outputs[0].y = y;
    // Residuals are in units of the scale.
    problem_.outputs[0].sigma = equation_.scale;
    equation_.output_rms = RmsOfPresent(y) / equation_.scale;
    std::vector<std::vector<int>> supports;
    Selection selection;
    if (!AddCandidates(without_slope, error) || !AddConditions(error)) {
      return false;
    }
    DescribeProblem();
    if (!Propose(&supports, error) ||
        !SelectSupport(problem_, supports, SelectionOptions(), &selection,
                       error)) {
      return false;
    }
    AddParetoCurve(selection);
    const SelectionEntry& chosen = Choose(selection);
    equation_.num_regressed_terms = chosen.num_terms;
    AddTerms(chosen);
    return AddInclusionProbabilities(selection, error);
  }

 private:
  const RegressionOutput& output() const { return problem_.outputs[0]; }
  double num_samples() const { return static_cast<double>(output().y.size()); }

  // Adds columns of Theta, and their degrees.
  bool AddCandidates(bool without_slope, std::string* error) {
    const DiscoveryOptions::Output* own = options_.Find(equation_.output);
    const std::vector<std::string>& features = equation_.feature_names;
    CandidateLibrary library;
    Matrix theta;
    if (!CandidateLibrary::Create(
            features, own != nullptr ? own->library : options_.library,
            &library, error) ||
        !library.Evaluate(features_, &theta, error)) {
      return false;
    }
    std::vector<int> kept;
    RegressionOutput& regression = problem_.outputs[0];
    for (int k = 0; k < library.size(); ++k) {
      const std::string name = library.Names()[static_cast<size_t>(k)];
      const bool plain =
          std::find(features.begin(), features.end(), name) != features.end();
      if (without_slope && plain) continue;
      kept.push_back(k);
      regression.candidates.push_back(name);
      degrees_.push_back(library.degree(k));
    }
    if (kept.empty()) {
      *error =
          "the network has no slope at rest, but the library has only linear "
          "terms; set polynomial_degree above 1 or add functions";
      return false;
    }
    regression.theta = theta(Eigen::all, kept);
    return true;
  }

  bool AddConditions(std::string* error) {
    const DiscoveryOptions::Output* own = options_.Find(equation_.output);
    if (own != nullptr) problem_.constraints = own->constraints;
    return problem_.IsValid(error, &map_);
  }

  void DescribeProblem() {
    equation_.num_candidates = static_cast<int>(output().candidates.size());
    for (int k = 0; k < equation_.num_candidates; ++k) {
      if (map_.free(k) < 0) continue;
      DiscoveryCandidate candidate;
      candidate.basis = output().candidates[static_cast<size_t>(k)];
      candidate.rms = RmsOfPresent(output().theta.col(k));
      candidate.sign = map_.signs()[static_cast<size_t>(map_.free(k))];
      candidate.degree = degrees_[static_cast<size_t>(k)];
      equation_.candidates.push_back(std::move(candidate));
    }
    equation_.sample_features = features_;
    equation_.sample_outputs = output().y;
  }

  bool Propose(std::vector<std::vector<int>>* supports, std::string* error) {
    if (map_.num_free() == 0) return true;
    if (options_.solver == DiscoveryOptions::Solver::kStlsq) {
      std::vector<StlsqSolution> path;
      if (!SolveStlsqPath(problem_, StlsqOptions(), {}, &path, error)) {
        return false;
      }
      *supports = Supports(path);
      return true;
    }
    LassoPath path;
    if (!SolveLassoPath(problem_, LassoOptions(), &path, error)) return false;
    *supports = Supports(path);
    return true;
  }

  void AddParetoCurve(const Selection& selection) {
    for (const SelectionEntry& entry : selection.entries) {
      if (equation_.pareto.empty() ||
          entry.num_terms > equation_.pareto.back().num_terms) {
        equation_.pareto.push_back(
            {entry.num_terms, std::sqrt(entry.sum_of_squares / num_samples()),
             entry.bic});
      }
    }
  }

  // Returns the tolerance. It is not below the uncertainty of the regressed
  // values.
  double Tolerance() const {
    return std::max(options_.tolerance, std::min(equation_.uncertainty, 0.5));
  }

  // Returns the fewest terms that lose less than the tolerance against all
  // candidates.
  const SelectionEntry& Choose(const Selection& selection) const {
    const LeastSquaresSystem system = Condense(problem_, map_);
    std::vector<int> all(static_cast<size_t>(map_.num_free()));
    for (int i = 0; i < map_.num_free(); ++i) all[static_cast<size_t>(i)] = i;
    double least = system.SumOfSquares(FitSupport(system, map_, all));
    for (const SelectionEntry& entry : selection.entries) {
      least = std::min(least, entry.sum_of_squares);
    }
    for (const SelectionEntry& entry : selection.entries) {
      const double lost = std::sqrt(
          std::max(0.0, entry.sum_of_squares - least) / num_samples());
      if (lost <= Tolerance()) return entry;
    }
    // No entry reaches the tolerance if its support is too large for every
    // path.
    return selection.best();
  }

  void AddTerms(const SelectionEntry& entry) {
    const Vector coefficients = FitRobustly(problem_, map_, entry);
    equation_.residual = std::sqrt(entry.sum_of_squares / num_samples());
    for (int k = 0; k < equation_.num_candidates; ++k) {
      const bool given = map_.free(k) < 0;
      const double coefficient = coefficients[k];
      if (coefficient == 0.0 ||
          (!given && !std::binary_search(entry.support.begin(),
                                         entry.support.end(), k))) {
        continue;
      }
      DiscoveredTerm term;
      term.basis = output().candidates[static_cast<size_t>(k)];
      term.coefficient = coefficient;
      term.basis_rms = RmsOfPresent(output().theta.col(k));
      term.share = std::abs(coefficient) * term.basis_rms / equation_.scale;
      term.inclusion_probability = kNaN;
      term.given = given;
      if (!given) {
        term.sign = map_.signs()[static_cast<size_t>(map_.free(k))];
      }
      equation_.terms.push_back(std::move(term));
    }
    std::stable_sort(equation_.terms.begin(), equation_.terms.end(),
                     [](const DiscoveredTerm& a, const DiscoveredTerm& b) {
                       return a.share > b.share;
                     });
  }

  // Returns the learner for each bag: it fits the same share of the whole as in
  // the choice.
  SparseLearner Learner(const Selection& selection) const {
    if (options_.solver == DiscoveryOptions::Solver::kStlsq) {
      const double output_rms = std::max(equation_.output_rms, 1e-300);
      StlsqOptions stlsq;
      stlsq.threshold = std::clamp(Tolerance() / output_rms, 1e-6, 1.0);
      return StlsqLearner(stlsq);
    }
    const double fraction =
        std::clamp(selection.num_independent / num_samples(), 1e-6, 1.0);
    return LassoLearnerWithin(Tolerance(), LassoOptions(), SelectionOptions(),
                              fraction);
  }

  bool AddInclusionProbabilities(const Selection& selection,
                                 std::string* error) {
    if (options_.num_bags == 0 || map_.num_free() == 0) return true;
    EnsembleOptions ensemble_options;
    ensemble_options.num_bags = options_.num_bags;
    ensemble_options.library_fraction = options_.library_fraction;
    ensemble_options.seed = options_.seed;
    ensemble_options.num_threads = options_.num_threads;
    ensemble_options.communicator = options_.communicator;
    Ensemble ensemble;
    if (!RunEnsemble(problem_, Learner(selection), ensemble_options, &ensemble,
                     error)) {
      return false;
    }
    for (DiscoveredTerm& term : equation_.terms) {
      const auto& names = output().candidates;
      const auto k =
          std::find(names.begin(), names.end(), term.basis) - names.begin();
      term.inclusion_probability = ensemble.inclusion_probability[k];
    }
    return true;
  }

  const DiscoveryOptions& options_;
  const Matrix& features_;
  DiscoveredEquation& equation_;
  RegressionProblem problem_;
  std::vector<int> degrees_;  // of the candidates
  CoefficientMap map_;
};

}  // namespace

bool RegressOutput(const DiscoveryOptions& options, const Matrix& features,
                   const std::vector<Eigen::Index>& record_starts,
                   const Vector& y, bool without_slope,
                   DiscoveredEquation* equation, std::string* error) {
  if (OutputRegression(options, features, equation)
          .Run(y, record_starts, without_slope, error)) {
    return true;
  }
  *error = "network '" + equation->network + "', output '" + equation->output +
           "': " + *error;
  return false;
}

}  // namespace pinode
