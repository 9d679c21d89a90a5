#include "pinode/study/damage/change_refit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/damage/baseline.h"
#include "pinode/study/damage/baseline_of_modes.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

// Refits are compared: a step that changes the cost by less moves no odds.
constexpr double kRefitTolerance = 1e-6;
constexpr int kRefitIterations = 20;
// Rounds of Refit. Elements of a beam that a prior of 10 % leaves open took two
// or three for losses up to half.
constexpr int kMostRefitRounds = 8;
// Gain in log-likelihood below which a further round changes nothing.
constexpr double kSettledRefit = 0.02;
// A set of changes is hopeless if a few gains leave it above this multiple of
// the cost with all changes. Gains are those of its last round, or those that
// its linearisation promises. More rounds of it do not change the odds: on
// three_storey, seven of nine sets cost 60 to 90 times as much. All later
// rounds of its sets gained at most 1.3 times what the round before promised.
constexpr double kHopelessGains = 4.0;
constexpr double kHopelessCost = 3.0;
// Deviations of the held values where nothing else is free, as a fraction of
// the baselines'.
constexpr double kTight = 1e-3;

bool IsChanged(const std::vector<int>& list, int entry) {
  return std::find(list.begin(), list.end(), entry) != list.end();
}

double LogDeterminant(const Eigen::LLT<Matrix>& llt) {
  return 2.0 * Matrix(llt.matrixL()).diagonal().array().log().sum();
}

double NormalProbability(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

}  // namespace

ChangeModel::ChangeModel(const PooledBaselines& expected,
                         std::vector<bool> absolute)
    : expected_(expected), absolute_(std::move(absolute)) {}

Matrix ChangeModel::PriorOf(const std::vector<int>& changed) const {
  Matrix prior = covariance();
  for (const int j : changed) {
    const double scale =
        absolute_[static_cast<size_t>(j)] ? 1.0 : 1.0 + values()[j];
    prior(j, j) += scale * scale;
  }
  return prior;
}

ChangePosterior ChangeModel::PosteriorOf(
    const ComparedCost& cost, const std::vector<int>& changed) const {
  const Matrix identity = Matrix::Identity(size(), size());
  const Eigen::LLT<Matrix> prior(PriorOf(changed));
  const Matrix precision = prior.solve(identity);
  const Eigen::LLT<Matrix> both(Matrix(cost.information + precision));
  const Vector away = cost.at - values();
  const Vector down = -(cost.gradient + precision * away);
  const Vector step = both.solve(down);
  ChangePosterior posterior;
  posterior.values = cost.at + step;
  posterior.covariance = both.solve(identity);
  posterior.cost = cost.cost + expected_.cost +
                   0.5 * away.dot(precision * away) - 0.5 * down.dot(step);
  posterior.log_evidence = expected_.log_volume - posterior.cost -
                           0.5 * (LogDeterminant(prior) + LogDeterminant(both));
  return posterior;
}

double ChangeModel::DistanceOf(const Vector& at,
                               const std::vector<int>& changed) const {
  const Vector away = at - values();
  return expected_.cost +
         0.5 * away.dot(Eigen::LLT<Matrix>(PriorOf(changed)).solve(away));
}

Vector ChangeModel::BeforeOf(const ChangePosterior& posterior,
                             const std::vector<int>& changed) const {
  const Eigen::LLT<Matrix> prior(PriorOf(changed));
  const Vector away = posterior.values - values();
  const Vector weighed = prior.solve(away);
  return values() + covariance() * weighed;
}

Vector ChangeModel::GainsOf(const ComparedCost& cost,
                            const std::vector<int>& changed) const {
  const Matrix precision = Eigen::LLT<Matrix>(PriorOf(changed))
                               .solve(Matrix::Identity(size(), size()));
  const ChangePosterior posterior = PosteriorOf(cost, changed);
  const Vector pull = precision * (posterior.values - values());
  const Matrix curvature =
      precision - precision * posterior.covariance * precision;
  Vector gains = Vector::Zero(size());
  for (Eigen::Index j = 0; j < size(); ++j) {
    if (IsChanged(changed, static_cast<int>(j))) continue;
    gains[j] = 0.5 * pull[j] * pull[j] / std::max(curvature(j, j), 1e-300);
  }
  return gains;
}

std::vector<GroupChange> ChangeModel::ChangesOf(
    const ChangePosterior& posterior, const std::vector<int>& changed,
    double threshold) const {
  // Values h without the change, given the values c: normal with mean m + A (c
  // - m) and covariance P - A P, A = P Q^-1.
  const Eigen::LLT<Matrix> prior(PriorOf(changed));
  const Matrix a = prior.solve(covariance()).transpose();
  const Vector before = BeforeOf(posterior, changed);
  const Matrix with = a * posterior.covariance;
  const Matrix covariance_before =
      covariance() - a * covariance() + with * a.transpose();
  const double count = static_cast<double>(expected_.num_baselines);
  std::vector<GroupChange> changes;
  for (const int j : changed) {
    GroupChange change;
    change.changed = true;
    const bool absolute = absolute_[static_cast<size_t>(j)];
    const double now = absolute ? 1.0 : 1.0 + posterior.values[j];
    const double then = absolute ? 1.0 : 1.0 + before[j];
    const double variance = posterior.covariance(j, j) / (now * now) +
                            covariance_before(j, j) / (then * then) -
                            2.0 * with(j, j) / (now * then);
    const double sigma = std::sqrt(std::max(variance, 1e-300));
    double degrees = kInfinity;
    const double between = expected_.between[j] / (then * then);
    if (between > 0.0) {
      const double share = between * (1.0 + 1.0 / count) / variance;
      degrees = (count - 1.0) / std::min(1.0, share * share);
    }
    const double half = StudentQuantile(degrees) * sigma;
    if (absolute) {
      change.change = posterior.values[j] - before[j];
      change.sigma = sigma;
      change.lower95 = change.change - half;
      change.upper95 = change.change + half;
      change.probability =
          NormalProbability((-threshold - change.change) / sigma);
    } else {
      const double ratio = std::log(std::max(now, 1e-12) / then);
      change.change = std::expm1(ratio);
      change.sigma = sigma * std::exp(ratio);
      change.lower95 = std::expm1(ratio - half);
      change.upper95 = std::expm1(ratio + half);
      change.probability =
          NormalProbability((std::log1p(-threshold) - ratio) / sigma);
    }
    changes.push_back(change);
  }
  return changes;
}

struct ChangeRefitter::Names {
  std::vector<std::string> names;
  Vector unit;
  Vector present;  // multiples that the matrices have already, minus 1

  int IndexOf(const std::string& name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
  }
  double ParameterOf(const Vector& values, Eigen::Index j) const {
    return values[j] * unit[j] - present[j];
  }
};

struct ChangeRefitter::Problems {
  IdentificationProblem open, held;
};

ChangeRefitter::ChangeRefitter(const FitOfRecords& fit,
                               const FitOfRecords& with_all,
                               const std::vector<std::string>& groups,
                               const IdentificationOptions& options,
                               InnerFit* inner)
    : fit_(fit),
      with_all_(with_all),
      groups_(groups),
      options_(options),
      inner_(*inner) {
  BeginNearTheEnd(&options_);
  options_.function_tolerance =
      std::max(options_.function_tolerance, kRefitTolerance);
  options_.max_num_iterations =
      std::min(options_.max_num_iterations, kRefitIterations);
  options_.keep_states = false;
  options_.prediction_bands = false;
  // Modes have their covariance at once.
  options_.covariance = fit.problem.num_train_records() > 0
                            ? IdentificationOptions::Covariance::kNone
                            : IdentificationOptions::Covariance::kPlain;
  options_.num_starts = 1;
  if (!WhyNot().empty()) return;
  if (fit.problem.num_train_records() == 0) {
    const ParameterLayout layout(with_all.problem);
    memory_ = VarianceOfModes(with_all.problem, layout,
                              layout.Free(with_all.model.parameters));
    known_ = true;
    return;
  }
  const ParameterLayout layout(with_all.problem);
  FittedCost cost;
  known_ = LinearizeAtFit(with_all.problem, layout, with_all.model,
                          with_all.summary.records, options.num_threads, &cost);
  memory_ = cost.memory;
  cost_with_all_ = cost.system.cost / memory_;
}

std::string ChangeRefitter::WhyNot() const {
  if (!fit_.problem.ambient.empty()) return "there are ambient records";
  if (!fit_.problem.frfs.empty()) return "there are frequency responses";
  const StructuralDynamics& dynamics = *fit_.problem.dynamics;
  if (!dynamics.networks().empty() || HasMemoryNetwork(dynamics)) {
    return "there is a network";
  }
  if (!dynamics.unknown_forces().empty()) {
    return "there are unknown forces";
  }
  for (const IdentificationRecord& record : fit_.problem.records) {
    if (!record.NoisyInputs().empty()) return "inputs have noise";
  }
  return "";
}

ChangeRefitter::Names ChangeRefitter::NamesWith(
    const std::vector<ChangeCandidate>& candidates) const {
  Names result;
  result.names = groups_;
  result.unit = Vector::Ones(
      static_cast<Eigen::Index>(groups_.size() + candidates.size()));
  for (const ChangeCandidate& candidate : candidates) {
    result.unit[static_cast<Eigen::Index>(result.names.size())] =
        candidate.unit;
    result.names.push_back(candidate.subject.name);
  }
  result.present = AlreadyPresent(*fit_.problem.dynamics, result.names);
  return result;
}

bool ChangeRefitter::MakeProblems(
    const std::vector<ChangeCandidate>& candidates,
    const std::vector<int>& changed, const Vector& held,
    Problems* problems) const {
  std::string unused;
  IdentificationProblem& open = problems->open;
  if (!AddCandidates(fit_.problem, candidates, &open, &unused)) return false;
  const Names names = NamesWith(candidates);
  for (size_t r = 0; r < open.records.size(); ++r) {
    IdentificationRecord& record = open.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (size_t c = 0; c < record.channels.size(); ++c) {
      record.channels[c].sigma =
          with_all_.model.sigmas[r][static_cast<Eigen::Index>(c)];
    }
  }
  StructureTerms terms = TermsOf(*open.dynamics);
  StructureTerms held_terms = terms;
  // A fit of records needs something free.
  const bool tight = changed.empty() && open.num_train_records() > 0;
  for (size_t i = 0; i < terms.groups.size(); ++i) {
    const int j = names.IndexOf(terms.groups[i].group.name);
    if (j < 0) continue;
    Parameter& free = terms.groups[i].alpha;
    free.prior_sigma = kInfinity;
    Parameter& own = held_terms.groups[i].alpha;
    own.prior_sigma = kInfinity;
    free.lower = -kInfinity;
    free.upper = kInfinity;
    if (IsChanged(changed, j)) continue;
    own = free;
    own.value = names.ParameterOf(held, j);
    own.free = tight;
    if (tight) {
      own.prior_mean = own.value;
      own.prior_sigma = kTight;
    }
  }
  const StructuralDynamics& dynamics = *open.dynamics;
  problems->held = open;
  std::shared_ptr<const StructuralDynamics> with_all_free;
  if (!Assemble(dynamics.model(), dynamics.inputs(), held_terms,
                &problems->held.dynamics, &unused) ||
      !Assemble(dynamics.model(), dynamics.inputs(), terms, &with_all_free,
                &unused)) {
    return false;
  }
  open.dynamics = std::move(with_all_free);
  return true;
}

bool ChangeRefitter::Linearize(const Names& names,
                               const IdentificationProblem& open,
                               const IdentifiedModel& at,
                               const std::vector<RecordScore>& scores,
                               ComparedCost* cost) const {
  const ParameterLayout layout(open);
  CondensedSystem system;
  if (!LinearizeAtFit(open, layout, at, scores, options_.num_threads,
                      &system)) {
    return false;
  }
  std::vector<int> compared(names.names.size(), -1), others;
  for (const int index : layout.free()) {
    const int j = names.IndexOf(layout.parameter(index).name);
    if (j < 0) {
      others.push_back(layout.FreeIndex(index));
    } else {
      compared[static_cast<size_t>(j)] = layout.FreeIndex(index);
    }
  }
  if (IsChanged(compared, -1)) return false;
  const Matrix hessian = system.hessian / memory_;
  const Vector gradient = system.gradient / memory_;
  cost->at = layout.Free(at.parameters)(compared);
  cost->at += names.present;
  cost->cost = system.cost / memory_;
  cost->gradient = gradient(compared);
  cost->information = hessian(compared, compared);
  if (!others.empty()) {
    const Matrix own = hessian(others, others);
    const Vector scale =
        own.diagonal().array().max(1e-300).sqrt().inverse().matrix();
    Matrix lower;
    if (!FactorizeInformation(scale.asDiagonal() * own * scale.asDiagonal(),
                              &lower)) {
      return false;
    }
    const auto triangle = lower.triangularView<Eigen::Lower>();
    const Matrix coupling = scale.asDiagonal() * hessian(others, compared);
    const Matrix reduced = triangle.solve(coupling);
    const Vector pulled =
        triangle.solve(scale.cwiseProduct(Vector(gradient(others))));
    cost->information -= reduced.transpose() * reduced;
    cost->gradient -= reduced.transpose() * pulled;
    cost->cost -= 0.5 * pulled.squaredNorm();
  }
  cost->at = cost->at.cwiseQuotient(names.unit);
  cost->gradient = cost->gradient.cwiseProduct(names.unit);
  cost->information =
      names.unit.asDiagonal() * cost->information * names.unit.asDiagonal();
  return cost->information.allFinite() && cost->gradient.allFinite() &&
         std::isfinite(cost->cost);
}

bool ChangeRefitter::AllFree(ComparedCost* cost) const {
  Problems problems;
  const Vector none = Vector::Zero(static_cast<Eigen::Index>(groups_.size()));
  if (!known_ || !MakeProblems({}, {}, none, &problems)) return false;
  IdentifiedModel at = BeginFrom(ParametersByName(fit_.problem, fit_.model),
                                 fit_.model, problems.open);
  at.sigmas = with_all_.model.sigmas;
  return Linearize(NamesWith({}), problems.open, at, fit_.summary.records,
                   cost);
}

bool ChangeRefitter::RunRound(const std::vector<ChangeCandidate>& candidates,
                              const std::vector<int>& changed,
                              const Vector& held,
                              std::map<std::string, double>* parameters,
                              ComparedCost* cost) {
  Problems problems;
  if (!MakeProblems(candidates, changed, held, &problems)) return false;
  const Names names = NamesWith(candidates);
  for (size_t j = 0; j < names.names.size(); ++j) {
    if (IsChanged(changed, static_cast<int>(j))) continue;
    (*parameters)[names.names[j]] =
        names.ParameterOf(held, static_cast<Eigen::Index>(j));
  }
  FitSummary summary;
  IdentifiedModel model = BeginFrom(*parameters, fit_.model, problems.held);
  model.sigmas = with_all_.model.sigmas;
  if (ParameterLayout(problems.held).num_free() > 0) {
    const IdentifiedModel start = model;
    inner_.Run("with chosen changes", problems.held, options_, &start, &summary,
               &model);
    interrupted_ =
        interrupted_ || summary.termination == Termination::kInterrupted;
    if (interrupted_ || summary.termination == Termination::kFailure) {
      return false;
    }
  }
  *parameters = ParametersByName(problems.held, model);
  IdentifiedModel at = BeginFrom(*parameters, model, problems.open);
  at.decays = model.decays;
  // Costs of several sets are compared with the same noise.
  at.sigmas = with_all_.model.sigmas;
  return Linearize(names, problems.open, at, summary.records, cost);
}

bool ChangeRefitter::Refit(const ChangeModel& model,
                           const std::vector<ChangeCandidate>& candidates,
                           const std::vector<int>& changed,
                           const BaselinesNear& near,
                           const std::map<std::string, double>* begin,
                           ChangeRefit* result) {
  if (!known_) return false;
  // Far from the groups' own fit, candidates that begin at zero may end in
  // another minimum than the one where they were found.
  const FitOfRecords& nearest = candidates.empty() ? fit_ : with_all_;
  std::map<std::string, double> parameters =
      begin != nullptr ? *begin
                       : ParametersByName(nearest.problem, nearest.model);
  ChangeModel expected = model;
  Vector held = model.values();
  Vector before = held;
  double least = kInfinity;
  bool halved = false;
  for (int i = 0; i < kMostRefitRounds; ++i) {
    std::map<std::string, double> found = parameters;
    ComparedCost cost;
    PooledBaselines baselines;
    if (near && !near(before, &baselines)) break;
    if (near) expected.Expect(baselines);
    if (!RunRound(candidates, changed, held, &found, &cost)) break;
    const double here = cost.cost + expected.DistanceOf(cost.at, changed);
    const double gain =
        std::isfinite(least) ? std::max(least - here, 0.0) : here;
    const double promise =
        std::max(here - expected.PosteriorOf(cost, changed).cost, 0.0);
    const bool hopeless =
        std::min(here, least) - kHopelessGains * std::min(gain, promise) >
        kHopelessCost * cost_with_all_;
    if (!(here < least + kSettledRefit)) {
      // A step that was too long says nothing before it is halved.
      if (hopeless && halved) break;
      halved = true;
      // Too long a step: half of it.
      held = 0.5 * (held + result->cost.at);
      before = 0.5 * (before + result->before);
      continue;
    }
    const bool settled = std::abs(here - least) < kSettledRefit;
    least = here;
    parameters = std::move(found);
    result->model = expected;
    result->changed = changed;
    result->cost = std::move(cost);
    result->posterior = expected.PosteriorOf(result->cost, changed);
    result->parameters = parameters;
    result->before = before;
    if (settled || hopeless ||
        (!near && here - result->posterior.cost < kSettledRefit)) {
      break;
    }
    held = result->posterior.values;
    before = expected.BeforeOf(result->posterior, changed);
  }
  return std::isfinite(least);
}

}  // namespace pinode
