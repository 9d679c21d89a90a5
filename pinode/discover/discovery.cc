#include "pinode/discover/discovery.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/discover/ensemble.h"
#include "pinode/discover/least_squares_system.h"
#include "pinode/discover/regression_problem.h"
#include "pinode/estimate/score.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/rk4.h"
#include "pinode/network/network.h"

namespace pinode {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double Rms(const Vector& values) {
  return values.norm() / std::sqrt(static_cast<double>(values.size()));
}

// samples x features.
Matrix FeatureValues(const std::vector<Feature>& features, int num_dofs,
                     const TrajectorySamples& samples) {
  Matrix values(samples.num_samples(),
                static_cast<Eigen::Index>(features.size()));
  for (size_t f = 0; f < features.size(); ++f) {
    const Feature& feature = features[f];
    auto column = values.col(static_cast<Eigen::Index>(f));
    if (feature.kind == Feature::Kind::kTime) {
      column = samples.times;
    } else if (feature.kind == Feature::Kind::kInput) {
      column = samples.inputs.row(feature.input).transpose();
    } else {
      column = (feature.Selector(num_dofs) *
                samples.states.middleRows(feature.OnVelocity() ? num_dofs : 0,
                                          num_dofs))
                   .transpose();
    }
  }
  return values;
}

const double* Weights(const StructuralDynamics& dynamics,
                      const IdentifiedModel& model, const std::string& name) {
  for (size_t b = 0; b < dynamics.blocks().size(); ++b) {
    const ParameterBlock& block = dynamics.blocks()[b];
    if (!block.named && block.name == name) {
      return model.parameters.data() +
             dynamics.block_offset(static_cast<int>(b));
    }
  }
  LOG(FATAL) << "network '" << name << "' has no weights";
  return nullptr;
}

// One output of one network.
class EquationFinder {
 public:
  EquationFinder(const DiscoveryOptions& options, const Matrix& features,
                 const std::vector<int>& record_starts,
                 DiscoveredEquation* equation)
      : options_(options), features_(features), equation_(*equation) {
    problem_.record_starts = record_starts;
  }

  // y: the network's output. without_slope: see DiscoverFromNetworks.
  bool Run(const Vector& y, bool without_slope, std::string* error) {
    equation_.output_rms = Rms(y) / equation_.scale;
    if (!MakeProblem(y, without_slope, error)) return false;
    std::vector<std::vector<int>> supports;
    Selection selection;
    if (!Propose(&supports, error) ||
        !SelectSupport(problem_, supports, SelectionOptions(), &selection,
                       error)) {
      *error = Place() + *error;
      return false;
    }
    const SelectionEntry& chosen = Choose(selection);
    AddTerms(chosen);
    return AddInclusionProbabilities(selection, error);
  }

 private:
  std::string Place() const {
    return "network '" + equation_.network + "', output '" + equation_.output +
           "': ";
  }
  const RegressionOutput& output() const { return problem_.outputs[0]; }

  bool MakeProblem(const Vector& y, bool without_slope, std::string* error) {
    const DiscoveryOptions::Output* own = options_.Find(equation_.output);
    CandidateLibrary library;
    if (!CandidateLibrary::Create(
            equation_.feature_names,
            own != nullptr ? own->library : options_.library, &library,
            error)) {
      *error = Place() + *error;
      return false;
    }
    RegressionOutput regression;
    regression.name = equation_.output;
    Matrix theta;
    if (!library.Evaluate(features_, &theta, error)) {
      *error = Place() + *error;
      return false;
    }
    for (int k = 0; k < library.size(); ++k) {
      const std::string name = library.Names()[static_cast<size_t>(k)];
      const bool plain = std::find(equation_.feature_names.begin(),
                                   equation_.feature_names.end(),
                                   name) != equation_.feature_names.end();
      if (without_slope && plain) continue;
      regression.candidates.push_back(name);
      const Eigen::Index column = regression.theta.cols();
      regression.theta.conservativeResize(theta.rows(), column + 1);
      regression.theta.col(column) = theta.col(k);
    }
    if (regression.candidates.empty()) {
      *error = Place() +
               "the network has no slope at rest, and the library holds "
               "nothing but its inputs as they stand; expected a "
               "polynomial_degree above 1 or further functions";
      return false;
    }
    equation_.num_candidates = static_cast<int>(regression.candidates.size());
    regression.y = y;
    regression.sigma = equation_.scale;
    problem_.outputs = {std::move(regression)};
    if (own != nullptr) problem_.constraints = own->constraints;
    if (!problem_.IsValid(error, &map_)) {
      *error = Place() + *error;
      return false;
    }
    return true;
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

  // The fewest terms that lose less than the tolerance against all candidates.
  const SelectionEntry& Choose(const Selection& selection) {
    const double n = static_cast<double>(output().y.size());
    const LeastSquaresSystem system = Condense(problem_, map_);
    std::vector<int> all(static_cast<size_t>(map_.num_free()));
    for (int i = 0; i < map_.num_free(); ++i) all[static_cast<size_t>(i)] = i;
    double least = system.SumOfSquares(FitSupport(system, map_, all));
    for (const SelectionEntry& entry : selection.entries) {
      least = std::min(least, entry.sum_of_squares);
    }
    const SelectionEntry* chosen = nullptr;
    for (const SelectionEntry& entry : selection.entries) {
      // Residuals are in units of the scale.
      const double lost =
          std::sqrt(std::max(0.0, entry.sum_of_squares - least) / n);
      if (chosen == nullptr && lost <= options_.tolerance) chosen = &entry;
      const double residual = std::sqrt(entry.sum_of_squares / n);
      if (equation_.pareto.empty() ||
          entry.num_terms > equation_.pareto.back().num_terms) {
        equation_.pareto.push_back({entry.num_terms, residual, entry.bic});
      }
    }
    // None reaches it where a support is too large for every path.
    return chosen != nullptr ? *chosen : selection.best();
  }

  // Coefficients of the chosen terms by Huber's M-estimator (P. J. Huber,
  // Annals of Mathematical Statistics 35 (1964) 73). A network is most wrong
  // where the trajectories pass once, at their largest displacements, and
  // least squares would follow it there most of all.
  Vector FitRobustly(const SelectionEntry& entry) const {
    constexpr double kHuber = 1.345;
    constexpr double kMedianToSigma = 1.4826;
    constexpr int kMaxNumIterations = 100;
    constexpr double kTolerance = 1e-10;
    Vector coefficients = entry.coefficients;
    if (entry.support.empty()) return coefficients;
    const std::vector<int> support = map_.ReduceSupport(entry.support);
    const RegressionOutput& original = output();
    RegressionProblem weighted = problem_;
    for (int iteration = 0; iteration < kMaxNumIterations; ++iteration) {
      const Vector residual = original.y - original.theta * coefficients;
      Vector sorted = residual.cwiseAbs();
      std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2,
                       sorted.end());
      const double limit = kHuber * kMedianToSigma * sorted[sorted.size() / 2];
      if (!(limit > 0.0)) break;
      for (Eigen::Index i = 0; i < residual.size(); ++i) {
        const double weight =
            std::sqrt(std::min(1.0, limit / std::abs(residual[i])));
        weighted.outputs[0].y[i] = weight * original.y[i];
        weighted.outputs[0].theta.row(i) = weight * original.theta.row(i);
      }
      const Vector next =
          map_.Expand(FitSupport(Condense(weighted, map_), map_, support));
      const double moved = (next - coefficients).norm();
      coefficients = next;
      if (moved <= kTolerance * coefficients.norm()) break;
    }
    return coefficients;
  }

  void AddTerms(const SelectionEntry& entry) {
    const Vector coefficients = FitRobustly(entry);
    equation_.residual = std::sqrt(entry.sum_of_squares /
                                   static_cast<double>(output().y.size()));
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
      term.basis_rms = Rms(output().theta.col(k));
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

  bool AddInclusionProbabilities(const Selection& selection,
                                 std::string* error) {
    if (options_.num_bags == 0 || map_.num_free() == 0) return true;
    EnsembleOptions ensemble_options;
    ensemble_options.num_bags = options_.num_bags;
    ensemble_options.library_fraction = options_.library_fraction;
    ensemble_options.seed = options_.seed;
    ensemble_options.num_threads = options_.num_threads;
    StlsqOptions stlsq;
    const double output_rms = std::max(equation_.output_rms, 1e-300);
    // The same share of the whole as in the choice above.
    stlsq.threshold = std::clamp(options_.tolerance / output_rms, 1e-6, 1.0);
    const double fraction = std::clamp(
        selection.num_independent / static_cast<double>(output().y.size()),
        1e-6, 1.0);
    Ensemble ensemble;
    if (!RunEnsemble(
            problem_,
            options_.solver == DiscoveryOptions::Solver::kStlsq
                ? StlsqLearner(stlsq)
                : LassoLearner(LassoOptions(), SelectionOptions(), fraction),
            ensemble_options, &ensemble, error)) {
      *error = Place() + *error;
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
  CoefficientMap map_;
};

}  // namespace

const DiscoveryOptions::Output* DiscoveryOptions::Find(
    const std::string& output) const {
  for (const Output& candidate : outputs) {
    if (candidate.name == output) return &candidate;
  }
  return nullptr;
}

bool DiscoveryOptions::IsValid(std::string* error) const {
  const auto fail = [error](const std::string& message) {
    *error = message;
    return false;
  };
  if (!(tolerance > 0.0) || !(tolerance < 1.0)) {
    return fail("tolerance is " + FormatNumber(tolerance, 6) +
                ", expected more than 0 and less than 1");
  }
  if (!(prune_fraction >= 0.0) || !(prune_fraction <= 1.0)) {
    return fail("prune_fraction is " + FormatNumber(prune_fraction, 6) +
                ", expected 0 to 1");
  }
  if (num_bags < 0) {
    return fail("num_bags is " + std::to_string(num_bags) +
                ", expected 0 or more");
  }
  if (num_bags > 0) {
    EnsembleOptions ensemble;
    ensemble.num_bags = num_bags;
    ensemble.library_fraction = library_fraction;
    ensemble.num_threads = num_threads;
    if (!ensemble.IsValid(error)) return false;
  }
  for (const Output& output : outputs) {
    for (const CoefficientConstraint& constraint : output.constraints) {
      if (constraint.kind == CoefficientConstraint::Kind::kEqual) {
        return fail("output '" + output.name +
                    "': equal coefficients are not among the conditions here");
      }
    }
  }
  return true;
}

bool SampleTrajectories(const IdentificationProblem& problem,
                        const IdentifiedModel& model,
                        TrajectorySamples* samples, std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const int ns = dynamics.num_states();
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(model.parameters.head(dynamics.num_parameters()),
                        &prepared, error)) {
    return false;
  }
  int total = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    total += (record.num_samples() - 1) * record.substeps + 1;
  }
  TrajectorySamples result;
  result.states.resize(ns, total);
  result.rates.resize(ns, total);
  result.inputs.resize(dynamics.num_inputs(), total);
  result.times.resize(total);
  auto stage = dynamics.MakeStage();
  Rk4Scratch<double> scratch(ns);
  int column = 0;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    result.record_starts.push_back(column);
    Vector state;
    if (r < model.starts.size() && model.starts[r].size() == ns) {
      state = model.starts[r];
    } else {
      const Vector sigmas =
          r < model.sigmas.size() && model.sigmas[r].size() > 0
              ? model.sigmas[r]
              : Vector(Vector::Ones(
                    static_cast<Eigen::Index>(record.channels.size())));
      FreeRunStart(problem, static_cast<int>(r), model.parameters, sigmas,
                   &state);
    }
    const IntegrationGrid grid(*record.excitation, record.substeps);
    const int last = record.num_samples() - 1;
    for (int i = 0; i <= last; ++i) {
      for (int s = 0; s < (i < last ? grid.substeps() : 1); ++s) {
        if (!state.allFinite()) {
          *error = "the free run of record '" + record.name +
                   "' with the identified model is not finite from t = " +
                   FormatNumber(grid.time(i), 6) + " on";
          return false;
        }
        const double* input = s == 0 ? grid.AtSample(i) : grid.AtNode(i, s, 0);
        const double time = i < last ? grid.step_time(i, s) : grid.time(i);
        result.times[column] = time;
        result.states.col(column) = state;
        result.inputs.col(column) =
            Eigen::Map<const Vector>(input, dynamics.num_inputs());
        dynamics.Rate(prepared, time, input, state.data(),
                      result.rates.col(column).data(), &stage);
        ++column;
        if (i == last) break;
        Rk4Step(
            [&](int node, double t, const double* h, double* rate) {
              dynamics.Rate(prepared, t, grid.AtNode(i, s, node), h, rate,
                            &stage);
            },
            time, grid.step(), state.data(), &scratch);
      }
    }
  }
  CHECK_EQ(column, total);
  *samples = std::move(result);
  return true;
}

bool DiscoverFromNetworks(const IdentificationProblem& problem,
                          const IdentifiedModel& model,
                          const DiscoveryOptions& options,
                          std::vector<DiscoveredEquation>* equations,
                          std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (!options.IsValid(error)) return false;
  if (dynamics.networks().empty()) {
    *error = "the model has no network to take equations from";
    return false;
  }
  for (const DiscoveryOptions::Output& output : options.outputs) {
    bool found = false;
    for (const NetworkTerm& term : dynamics.networks()) {
      found =
          found || std::find(term.output_names.begin(), term.output_names.end(),
                             output.name) != term.output_names.end();
    }
    if (!found) {
      *error = "no network has an output '" + output.name + "'";
      return false;
    }
  }
  TrajectorySamples samples;
  if (!SampleTrajectories(problem, model, &samples, error)) return false;
  const int n = dynamics.num_dofs();
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(model.parameters.head(dynamics.num_parameters()),
                        &prepared, error)) {
    return false;
  }
  const Matrix accelerations = samples.rates.middleRows(n, n);
  std::vector<std::string> input_names;
  for (const InputSpec& input : dynamics.inputs()) {
    input_names.push_back(input.name);
  }

  std::vector<DiscoveredEquation> result;
  for (const NetworkTerm& term : dynamics.networks()) {
    const double* weights = Weights(dynamics, model, term.name);
    if (!options.networks.empty() &&
        std::find(options.networks.begin(), options.networks.end(),
                  term.name) == options.networks.end()) {
      continue;
    }
    const Matrix inputs = FeatureValues(term.features, n, samples);
    Matrix outputs(samples.num_samples(), term.outputs.cols());
    NetworkWorkspace workspace(*term.network);
    Vector in(inputs.cols());
    Vector out(term.outputs.cols());
    for (int i = 0; i < samples.num_samples(); ++i) {
      in = inputs.row(i).transpose();
      term.network->Evaluate(in.data(), weights, out.data(), &workspace);
      outputs.row(i) = out.transpose();
    }
    const std::vector<Feature>& features =
        options.features.empty() ? term.features : options.features;
    const Matrix feature_values = FeatureValues(features, n, samples);
    const Matrix cause = term.acts_as == ActsAs::kForce
                             ? Matrix(prepared.mass * accelerations)
                             : accelerations;
    for (Eigen::Index o = 0; o < term.outputs.cols(); ++o) {
      DiscoveredEquation equation;
      equation.network = term.name;
      equation.output = term.output_names[static_cast<size_t>(o)];
      equation.acts_as = term.acts_as;
      equation.features = features;
      for (const Feature& feature : features) {
        equation.feature_names.push_back(
            feature.Name(dynamics.model().dof_names, input_names));
      }
      // Of a pair, the DOF that moves less says what matters.
      equation.scale = std::numeric_limits<double>::infinity();
      for (int dof = 0; dof < n; ++dof) {
        if (term.outputs(dof, o) == 0.0) continue;
        equation.scale =
            std::min(equation.scale, Rms(cause.row(dof).transpose()) /
                                         std::abs(term.outputs(dof, o)));
      }
      if (!(equation.scale > 0.0) || !std::isfinite(equation.scale)) {
        *error = "output '" + equation.output + "' of network '" + term.name +
                 "' acts where nothing moves in the training records";
        return false;
      }
      if (!EquationFinder(options, feature_values, samples.record_starts,
                          &equation)
               .Run(outputs.col(o), term.network->architecture().gauge,
                    error)) {
        return false;
      }
      result.push_back(std::move(equation));
    }
  }
  *equations = std::move(result);
  return true;
}

}  // namespace pinode
