#include "pinode/discover/discovery.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/discover/ensemble.h"
#include "pinode/discover/least_squares_system.h"
#include "pinode/discover/regression_problem.h"
#include "pinode/discover/smooth_motion.h"
#include "pinode/dynamics/observation.h"
#include "pinode/estimate/covariance.h"
#include "pinode/estimate/initial_states.h"
#include "pinode/estimate/objective.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/estimate/score.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/rk4.h"
#include "pinode/network/network.h"

namespace pinode {
namespace {

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
    equation_.num_regressed_terms = chosen.num_terms;
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
    std::vector<int> degrees;  // of the regression's candidates
    for (int k = 0; k < library.size(); ++k) {
      const std::string name = library.Names()[static_cast<size_t>(k)];
      const bool plain = std::find(equation_.feature_names.begin(),
                                   equation_.feature_names.end(),
                                   name) != equation_.feature_names.end();
      if (without_slope && plain) continue;
      regression.candidates.push_back(name);
      degrees.push_back(library.degree(k));
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
    for (int k = 0; k < equation_.num_candidates; ++k) {
      if (map_.free(k) < 0) continue;
      DiscoveryCandidate candidate;
      candidate.basis = output().candidates[static_cast<size_t>(k)];
      candidate.rms = Rms(output().theta.col(k));
      candidate.sign = map_.signs()[static_cast<size_t>(map_.free(k))];
      candidate.degree = degrees[static_cast<size_t>(k)];
      equation_.candidates.push_back(std::move(candidate));
    }
    equation_.sample_features = features_;
    equation_.sample_outputs = y;
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

  // Nothing can be asked of what is regressed beyond its own uncertainty.
  double Tolerance() const {
    return std::max(options_.tolerance, std::min(equation_.uncertainty, 0.5));
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
      if (chosen == nullptr && lost <= Tolerance()) chosen = &entry;
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
    stlsq.threshold = std::clamp(Tolerance() / output_rms, 1e-6, 1.0);
    const double fraction = std::clamp(
        selection.num_independent / static_cast<double>(output().y.size()),
        1e-6, 1.0);
    Ensemble ensemble;
    if (!RunEnsemble(problem_,
                     options_.solver == DiscoveryOptions::Solver::kStlsq
                         ? StlsqLearner(stlsq)
                         : LassoLearnerWithin(Tolerance(), LassoOptions(),
                                              SelectionOptions(), fraction),
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
  auto stage = dynamics.MakeLinearization();
  Rk4Scratch<double> scratch(ns);
  int column = 0;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    result.record_starts.push_back(column);
    result.strides.push_back(record.substeps);
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

std::vector<Matrix> NetworkUncertainty(const IdentificationProblem& problem,
                                       const IdentifiedModel& model,
                                       const TrajectorySamples& samples) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::vector<int> columns;
  std::vector<Matrix> trajectories;
  for (size_t t = 0; t < samples.record_starts.size(); ++t) {
    const int begin = samples.record_starts[t];
    const int end = t + 1 < samples.record_starts.size()
                        ? samples.record_starts[t + 1]
                        : samples.num_samples();
    Matrix trajectory(dynamics.num_states(),
                      (end - 1 - begin) / samples.strides[t] + 1);
    for (Eigen::Index i = 0; i < trajectory.cols(); ++i) {
      columns.push_back(begin + static_cast<int>(i) * samples.strides[t]);
      trajectory.col(i) = samples.states.col(columns.back());
    }
    trajectories.push_back(std::move(trajectory));
  }
  std::vector<Matrix> result;
  for (const NetworkTerm& term : dynamics.networks()) {
    result.push_back(Matrix::Zero(term.outputs.cols(),
                                  static_cast<Eigen::Index>(columns.size())));
  }

  std::vector<Vector> sigmas;
  std::vector<Vector> scales;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    if (record.channels.empty() || r >= model.sigmas.size() ||
        model.sigmas[r].size() !=
            static_cast<Eigen::Index>(record.channels.size()) ||
        !(model.sigmas[r].minCoeff() > 0.0)) {
      return result;
    }
    scales.push_back(StateScales(problem, trajectories[sigmas.size()]));
    sigmas.push_back(model.sigmas[r]);
  }
  const ParameterLayout layout(problem);
  if (model.decays.size() != layout.num_decay_groups()) return result;
  Objective objective(problem, layout, MultipleShooting::Options());
  objective.shooting().SetSigmas(sigmas);
  objective.shooting().SetStateScales(scales);
  objective.shooting().SetSegments(0, trajectories);
  objective.priors().SetDecays(model.decays);
  const Vector free = layout.Free(model.parameters);
  CondensedSystem system;
  if (!objective.Linearize(free, &system) || !system.hessian.allFinite()) {
    return result;
  }
  // Directions in which nothing is determined would make up any uncertainty,
  // also where the output does not change along them.
  const Vector scale = system.hessian.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Matrix hessian = scale.cwiseInverse().asDiagonal() * system.hessian *
                         scale.cwiseInverse().asDiagonal();
  Matrix lower;
  if (!FactorizeInformation(hessian, &lower)) return result;

  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const NetworkTerm& term = dynamics.networks()[j];
    const Matrix features =
        FeatureValues(term.features, dynamics.num_dofs(), samples);
    const int offset =
        dynamics.block_offset(dynamics.network_block(static_cast<int>(j)));
    NetworkTangent tangent(*term.network);
    for (size_t i = 0; i < columns.size(); ++i) {
      const Vector in = features.row(columns[i]).transpose();
      term.network->Linearize(in.data(), model.parameters.data() + offset,
                              &tangent);
      const Matrix weights = term.network->WeightJacobian(tangent);
      Matrix jacobian = Matrix::Zero(layout.num_free(), term.outputs.cols());
      for (Eigen::Index w = 0; w < weights.cols(); ++w) {
        const int k = layout.FreeIndex(offset + static_cast<int>(w));
        if (k >= 0) jacobian.row(k) = weights.col(w).transpose() / scale[k];
      }
      result[j].col(static_cast<Eigen::Index>(i)) =
          lower.triangularView<Eigen::Lower>()
              .solve(jacobian)
              .colwise()
              .norm()
              .transpose();
    }
  }
  return result;
}

namespace {

// What each network of a problem stands for, along common samples.
struct NetworkOutputs {
  TrajectorySamples samples;
  std::vector<Matrix> outputs;      // samples x outputs, of each network
  std::vector<double> uncertainty;  // RMS of each output, all networks in turn
  Matrix mass;
};

bool FindEquations(const IdentificationProblem& problem,
                   const DiscoveryOptions& options, const NetworkOutputs& data,
                   std::vector<DiscoveredEquation>* equations,
                   std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const int n = dynamics.num_dofs();
  const Matrix accelerations = data.samples.rates.middleRows(n, n);
  std::vector<std::string> input_names;
  for (const InputSpec& input : dynamics.inputs()) {
    input_names.push_back(input.name);
  }
  std::vector<DiscoveredEquation> result;
  size_t next_uncertainty = 0;
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const NetworkTerm& term = dynamics.networks()[j];
    const size_t first_uncertainty = next_uncertainty;
    next_uncertainty += static_cast<size_t>(term.outputs.cols());
    if (!options.networks.empty() &&
        std::find(options.networks.begin(), options.networks.end(),
                  term.name) == options.networks.end()) {
      continue;
    }
    const std::vector<Feature>& features =
        options.features.empty() ? term.features : options.features;
    const Matrix feature_values = FeatureValues(features, n, data.samples);
    const Matrix cause = term.acts_as == ActsAs::kForce
                             ? Matrix(data.mass * accelerations)
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
      equation.uncertainty =
          data.uncertainty[first_uncertainty + static_cast<size_t>(o)] /
          equation.scale;
      if (!EquationFinder(options, feature_values, data.samples.record_starts,
                          &equation)
               .Run(data.outputs[j].col(o), term.network->architecture().gauge,
                    error)) {
        return false;
      }
      result.push_back(std::move(equation));
    }
  }
  *equations = std::move(result);
  return true;
}

bool CheckOptions(const IdentificationProblem& problem,
                  const DiscoveryOptions& options, std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (!options.IsValid(error)) return false;
  if (dynamics.networks().empty()) {
    *error =
        "the model has no network, expected one that says where terms are "
        "looked for";
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
  return true;
}

// The motion of one DOF over one record, from the channels that show it alone.
bool SmoothDof(const IdentificationProblem& problem,
               const IdentificationRecord& record, int dof,
               SmoothedMotion* motion, std::vector<int>* channels,
               std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::vector<MotionChannel> shown;
  for (size_t c = 0; c < record.channels.size(); ++c) {
    const MeasuredChannel& channel = record.channels[c];
    const Observation& observation = channel.observation;
    const double weight = observation.weights[dof];
    if (!channel.fit || weight == 0.0 ||
        (observation.weights.array() != 0.0).count() != 1) {
      continue;
    }
    MotionChannel entry;
    entry.derivative =
        observation.quantity == Quantity::kVelocity ? 1
        : observation.quantity == Quantity::kRelativeAcceleration ||
                observation.quantity == Quantity::kAbsoluteAcceleration
            ? 2
            : 0;
    // Absolute ones less the ground's own motion.
    const ObservationMap map(dynamics, {observation});
    const Vector rest = Vector::Zero(dynamics.num_states());
    entry.values = channel.values;
    for (Eigen::Index i = 0; i < entry.values.size(); ++i) {
      const Vector input = record.excitation->samples().col(i);
      double ground = 0.0;
      map.Observe(rest.data(), rest.data(), input.data(), &ground);
      entry.values[i] = (entry.values[i] - ground) / weight;
    }
    entry.sigma = channel.sigma / std::abs(weight);
    shown.push_back(std::move(entry));
    channels->push_back(static_cast<int>(c));
  }
  if (shown.empty()) {
    *error = "no displacement channel of it alone";
    return false;
  }
  return SmoothMotion(record.sampling_step(), shown, motion, error);
}

}  // namespace

bool DiscoverFromNetworks(const IdentificationProblem& problem,
                          const IdentifiedModel& model,
                          const DiscoveryOptions& options,
                          std::vector<DiscoveredEquation>* equations,
                          std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (!CheckOptions(problem, options, error)) return false;
  NetworkOutputs data;
  if (!SampleTrajectories(problem, model, &data.samples, error)) return false;
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(model.parameters.head(dynamics.num_parameters()),
                        &prepared, error)) {
    return false;
  }
  data.mass = prepared.linear.mass;
  for (const Matrix& sigma : NetworkUncertainty(problem, model, data.samples)) {
    for (Eigen::Index o = 0; o < sigma.rows(); ++o) {
      data.uncertainty.push_back(Rms(sigma.row(o).transpose()));
    }
  }
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const NetworkTerm& term = dynamics.networks()[j];
    const double* weights =
        model.parameters.data() +
        dynamics.block_offset(dynamics.network_block(static_cast<int>(j)));
    const Matrix inputs =
        FeatureValues(term.features, dynamics.num_dofs(), data.samples);
    Matrix outputs(data.samples.num_samples(), term.outputs.cols());
    NetworkWorkspace workspace(*term.network);
    Vector in(inputs.cols());
    Vector out(term.outputs.cols());
    for (int i = 0; i < data.samples.num_samples(); ++i) {
      in = inputs.row(i).transpose();
      term.network->Evaluate(in.data(), weights, out.data(), &workspace);
      outputs.row(i) = out.transpose();
    }
    data.outputs.push_back(std::move(outputs));
  }
  return FindEquations(problem, options, data, equations, error);
}

bool DiscoverFromDerivatives(const IdentificationProblem& problem,
                             const DiscoveryOptions& options,
                             std::vector<DiscoveredEquation>* equations,
                             IdentifiedModel* model, std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const int n = dynamics.num_dofs();
  if (!CheckOptions(problem, options, error)) return false;
  if (dynamics.num_internal() > 0) {
    *error =
        "elements with internal states are not seen in records, expected none "
        "with source = \"derivatives\"";
    return false;
  }
  if (!options.networks.empty() &&
      options.networks.size() < dynamics.networks().size()) {
    *error =
        "all networks are replaced at once with source = \"derivatives\": "
        "none of them is trained";
    return false;
  }
  // The model without networks: they are 0 where all their weights are.
  IdentifiedModel begin;
  begin.parameters = ParameterLayout(problem).InitialValues();
  Vector theta = begin.parameters.head(dynamics.num_parameters());
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const int block = dynamics.network_block(static_cast<int>(j));
    theta
        .segment(dynamics.block_offset(block),
                 dynamics.networks()[j].network->num_weights())
        .setZero();
  }
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(theta, &prepared, error)) return false;
  NetworkOutputs data;
  data.mass = prepared.linear.mass;

  // Smoothed records, less the samples of which they know little: those at the
  // ends.
  const size_t num_records = problem.records.size();
  begin.sigmas.resize(num_records);
  begin.starts.resize(num_records);
  std::vector<double> times;
  auto stage = dynamics.MakeLinearization();
  Matrix residuals(n, 0);
  const auto append = [](const Matrix& more, Matrix* all) {
    const Eigen::Index before = all->cols();
    all->conservativeResize(more.rows(), before + more.cols());
    all->rightCols(more.cols()) = more;
  };
  Matrix variance(n, 0);
  for (size_t r = 0; r < num_records; ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const int samples = record.num_samples();
    Matrix state(2 * n, samples);
    Matrix rate(2 * n, samples);
    Matrix sigma(n, samples);
    begin.sigmas[r] =
        Vector::Constant(static_cast<Eigen::Index>(record.channels.size()), 0);
    for (int dof = 0; dof < n; ++dof) {
      SmoothedMotion motion;
      std::vector<int> channels;
      if (!SmoothDof(problem, record, dof, &motion, &channels, error)) {
        *error = "record '" + record.name + "', DOF '" +
                 dynamics.model().dof_names[static_cast<size_t>(dof)] +
                 "': " + *error;
        return false;
      }
      state.row(dof) = motion.motion.row(0);
      state.row(n + dof) = rate.row(dof) = motion.motion.row(1);
      rate.row(n + dof) = motion.motion.row(2);
      sigma.row(dof) = motion.sigma.row(2);
      for (size_t k = 0; k < channels.size(); ++k) {
        begin.sigmas[r][channels[k]] = motion.noise[k];
      }
    }
    // Channels that show several DOFs, or are not fitted: of their own spread.
    for (size_t c = 0; c < record.channels.size(); ++c) {
      double& noise = begin.sigmas[r][static_cast<Eigen::Index>(c)];
      if (noise == 0.0) {
        noise = record.channels[c].sigma > 0.0
                    ? record.channels[c].sigma
                    : std::max(0.05 * StandardDeviationOfPresent(
                                          record.channels[c].values),
                               1e-290);
      }
    }
    begin.starts[r] = record.start == IdentificationRecord::Start::kKnown
                          ? record.known_start
                      : record.start == IdentificationRecord::Start::kRest
                          ? Vector(Vector::Zero(2 * n))
                          : Vector(state.col(0));
    std::vector<int> kept;
    for (int dof = 0; dof < n; ++dof) {
      Vector sorted = sigma.row(dof).transpose();
      std::nth_element(sorted.begin(), sorted.begin() + samples / 2,
                       sorted.end());
      const double limit = 2.0 * sorted[samples / 2];
      if (dof == 0) {
        for (int i = 0; i < samples; ++i) kept.push_back(i);
      }
      kept.erase(std::remove_if(kept.begin(), kept.end(),
                                [&](int i) { return sigma(dof, i) > limit; }),
                 kept.end());
    }
    const Eigen::Index count = static_cast<Eigen::Index>(kept.size());
    data.samples.record_starts.push_back(static_cast<int>(times.size()));
    data.samples.strides.push_back(1);
    Matrix input(dynamics.num_inputs(), count);
    Matrix residual(n, count);
    Vector model_rate(2 * n);
    for (Eigen::Index k = 0; k < count; ++k) {
      const int i = kept[static_cast<size_t>(k)];
      times.push_back(record.excitation->time(i));
      input.col(k) = record.excitation->samples().col(i);
      const Vector at = state.col(i);
      const Vector in = input.col(k);
      dynamics.Rate(prepared, times.back(), in.data(), at.data(),
                    model_rate.data(), &stage);
      residual.col(k) = rate.col(i).tail(n) - model_rate.tail(n);
    }
    append(state(Eigen::all, kept), &data.samples.states);
    append(rate(Eigen::all, kept), &data.samples.rates);
    append(input, &data.samples.inputs);
    append(residual, &residuals);
    append(sigma(Eigen::all, kept).array().square().matrix(), &variance);
  }
  data.samples.times = Eigen::Map<const Vector>(
      times.data(), static_cast<Eigen::Index>(times.size()));

  // residual = sum_j network_map_j outputs_j.
  Eigen::Index num_outputs = 0;
  std::vector<Matrix> network_maps;
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    network_maps.push_back(dynamics.NetworkMap(prepared, static_cast<int>(j)));
    num_outputs += network_maps.back().cols();
  }
  Matrix map(n, num_outputs);
  num_outputs = 0;
  for (const Matrix& part : network_maps) {
    map.middleCols(num_outputs, part.cols()) = part;
    num_outputs += part.cols();
  }
  const Eigen::ColPivHouseholderQR<Matrix> qr(map);
  if (qr.rank() < map.cols()) {
    *error = "the networks have " + std::to_string(map.cols()) +
             " outputs, of which accelerations tell " +
             std::to_string(qr.rank()) +
             " apart, expected no more with source = \"derivatives\"";
    return false;
  }
  const Matrix inverse = qr.solve(Matrix::Identity(n, n));
  const Matrix outputs = (inverse * residuals).transpose();
  const Vector output_variance =
      inverse.array().square().matrix() * variance.rowwise().mean();
  for (const double value : output_variance) {
    data.uncertainty.push_back(std::sqrt(value));
  }
  num_outputs = 0;
  for (const Matrix& part : network_maps) {
    data.outputs.push_back(outputs.middleCols(num_outputs, part.cols()));
    num_outputs += part.cols();
  }
  if (!FindEquations(problem, options, data, equations, error)) return false;
  for (DiscoveredEquation& equation : *equations) {
    equation.source = DiscoveryOptions::Source::kDerivatives;
  }
  *model = std::move(begin);
  return true;
}

}  // namespace pinode
