#include "pinode/case/discovered_case.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/case/grown_case.h"
#include "pinode/case/library_section.h"
#include "pinode/case/toml_value.h"
#include "pinode/discover/stepwise.h"
#include "pinode/discover/term_prices.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/estimate/covariance.h"
#include "pinode/estimate/fitted_cost.h"
#include "pinode/estimate/identify.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/estimate/score.h"

namespace pinode {
namespace {

constexpr int kLargestRefitFactor = 32;
// Each search that is kept lowers the criterion; more than a few are none.
constexpr int kMaxSearches = 20;
// Fits of terms that may not stay need not be exact; wrong terms have long
// valleys.
constexpr double kSearchTolerance = 1e-7;
constexpr int kMaxSearchIterations = 60;

std::string LibraryName(const DiscoveredEquation& equation) {
  return TermName(equation.network + "_" + equation.output);
}

LibraryFunction Parsed(const DiscoveredEquation& equation,
                       const std::string& basis) {
  LibraryFunction function;
  std::string error;
  CHECK(
      LibraryFunction::Parse(basis, equation.feature_names, &function, &error))
      << error;
  return function;
}

TomlValue LibraryTable(const DiscoveredEquation& equation) {
  std::vector<std::string> inputs;
  for (size_t f = 0; f < equation.features.size(); ++f) {
    const bool used = std::any_of(
        equation.terms.begin(), equation.terms.end(),
        [&](const DiscoveredTerm& term) {
          return Parsed(equation, term.basis).DependsOn(static_cast<int>(f));
        });
    if (used) inputs.push_back(equation.feature_names[f]);
  }
  // A constant alone depends on none; a library has at least one input.
  if (inputs.empty()) inputs.push_back(equation.feature_names[0]);
  std::vector<TomlValue> terms;
  for (const DiscoveredTerm& term : equation.terms) {
    TomlValue table = TomlValue::Table();
    table.Set("basis", TomlValue::String(term.basis));
    // The model before the fit, which scores are compared with, is the one
    // without the terms.
    table.Set("initial", TomlValue::Float(term.given ? term.coefficient : 0.0));
    if (term.given) table.Set("free", TomlValue::Boolean(false));
    if (term.sign > 0) table.Set("lower", TomlValue::Float(0.0));
    if (term.sign < 0) table.Set("upper", TomlValue::Float(0.0));
    terms.push_back(std::move(table));
  }
  TomlValue library = TomlValue::Table();
  library.Set("name", TomlValue::String(LibraryName(equation)));
  library.Set("inputs", TomlValue::Strings(inputs));
  library.Set("output", TomlValue::String(equation.output));
  library.Set("acts_as", TomlValue::String(equation.acts_as == ActsAs::kForce
                                               ? "force"
                                               : "acceleration"));
  library.Set("terms", TomlValue::Array(std::move(terms)));
  return library;
}

std::string ParameterName(const DiscoveredEquation& equation,
                          const DiscoveredTerm& term) {
  return LibraryName(equation) + "." + term.basis;
}

const ParameterEstimate* FindEstimate(const IdentificationSummary& summary,
                                      const std::string& name) {
  for (const ParameterEstimate& estimate : summary.parameters) {
    if (estimate.name == name) return &estimate;
  }
  return nullptr;
}

// Coefficients and shares as fitted.
void TakeOver(const IdentificationSummary& summary,
              std::vector<DiscoveredEquation>* equations) {
  for (DiscoveredEquation& equation : *equations) {
    for (DiscoveredTerm& term : equation.terms) {
      const ParameterEstimate* estimate =
          FindEstimate(summary, ParameterName(equation, term));
      if (estimate == nullptr) continue;
      term.coefficient = estimate->value;
      term.share = std::abs(term.coefficient) * term.basis_rms / equation.scale;
    }
  }
}

int NumFittedValues(const IdentificationProblem& problem) {
  int count = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (const MeasuredChannel& channel : record.channels) {
      if (!channel.fit) continue;
      for (const double value : channel.values) count += std::isfinite(value);
    }
  }
  return count;
}

// Takes out the term that is least worth its place; false where all are.
bool DropWeakest(const DiscoveryOptions& options,
                 const IdentificationSummary& summary, const TermPrices& prices,
                 std::vector<DiscoveredEquation>* equations) {
  // Below 1: to be dropped.
  double weakest = 1.0;
  DiscoveredEquation* from = nullptr;
  size_t index = 0;
  for (DiscoveredEquation& equation : *equations) {
    for (size_t k = 0; k < equation.terms.size(); ++k) {
      const DiscoveredTerm& term = equation.terms[k];
      const ParameterEstimate* estimate =
          FindEstimate(summary, ParameterName(equation, term));
      if (term.given || estimate == nullptr) continue;
      double worth = std::numeric_limits<double>::infinity();
      if (options.prune_fraction > 0.0) {
        worth = term.share / (options.prune_fraction * options.tolerance);
      }
      // A coefficient at the bound that a sign sets it is no term. A sigma that
      // is not finite is not evidence against it.
      if (estimate->at_bound && term.sign != 0) worth = 0.0;
      if (estimate->sigma > 0.0) {
        worth = std::min(worth, std::abs(term.coefficient) /
                                    (std::sqrt(prices.Of(equation, term)) *
                                     estimate->sigma));
      }
      if (worth < weakest) {
        weakest = worth;
        from = &equation;
        index = k;
      }
    }
  }
  if (from == nullptr) return false;
  from->terms.erase(from->terms.begin() + static_cast<std::ptrdiff_t>(index));
  return true;
}

bool Has(const DiscoveredEquation& equation, const std::string& basis) {
  return std::any_of(
      equation.terms.begin(), equation.terms.end(),
      [&](const DiscoveredTerm& term) { return term.basis == basis; });
}

// "u1: x[u1]^2": what is in `a` and not in `b`.
std::vector<std::string> Difference(const std::vector<DiscoveredEquation>& a,
                                    const std::vector<DiscoveredEquation>& b) {
  std::vector<std::string> result;
  for (size_t e = 0; e < a.size(); ++e) {
    for (const DiscoveredTerm& term : a[e].terms) {
      if (!Has(b[e], term.basis)) {
        result.push_back(a[e].output + ": " + term.basis);
      }
    }
  }
  return result;
}

bool SameTerms(const std::vector<DiscoveredEquation>& a,
               const std::vector<DiscoveredEquation>& b) {
  return Difference(a, b).empty() && Difference(b, a).empty();
}

// Twice the negative log-likelihood of the training records, but for what does
// not depend on the model.
double Deviance(const IdentificationProblem& problem,
                const IdentificationSummary& summary) {
  double deviance = 0.0;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (size_t c = 0; c < record.channels.size(); ++c) {
      const MeasuredChannel& channel = record.channels[c];
      if (!channel.fit) continue;
      const double present =
          static_cast<double>(channel.values.array().isFinite().count());
      const double mean_square =
          std::max(std::pow(summary.records[r].channels[c].rmse, 2.0), 1e-300);
      deviance += present * (channel.sigma > 0.0
                                 ? mean_square / std::pow(channel.sigma, 2.0)
                                 : std::log(mean_square));
    }
  }
  return deviance;
}

int CountTerms(const std::vector<DiscoveredEquation>& equations) {
  int count = 0;
  for (const DiscoveredEquation& equation : equations) {
    count += static_cast<int>(equation.terms.size());
  }
  return count;
}

// Candidates that are no terms yet with a coefficient of 0.
std::vector<DiscoveredEquation> WithAllCandidates(
    std::vector<DiscoveredEquation> equations) {
  for (DiscoveredEquation& equation : equations) {
    for (const DiscoveryCandidate& candidate : equation.candidates) {
      if (Has(equation, candidate.basis)) continue;
      DiscoveredTerm term;
      term.basis = candidate.basis;
      term.basis_rms = candidate.rms;
      term.sign = candidate.sign;
      term.inclusion_probability = kNaN;
      equation.terms.push_back(std::move(term));
    }
  }
  return equations;
}

// Units, and what each term was before the refit of which `summary` is (nullptr
// without one) and is by it.
void CompleteTerms(const Case& c,
                   const std::vector<DiscoveredEquation>& selected,
                   const IdentificationSummary* summary,
                   std::vector<DiscoveredEquation>* equations) {
  for (size_t e = 0; e < equations->size(); ++e) {
    DiscoveredEquation& equation = (*equations)[e];
    for (DiscoveredTerm& term : equation.terms) {
      term.unit = LibraryCoefficientUnit(
          Parsed(equation, term.basis), equation.features,
          c.problem.dynamics->inputs(), equation.acts_as,
          c.problem.description.units);
      term.regressed = 0.0;
      for (const DiscoveredTerm& before : selected[e].terms) {
        if (before.basis == term.basis) term.regressed = before.coefficient;
      }
      term.sigma = term.lower95 = term.upper95 = kNaN;
      const ParameterEstimate* estimate =
          summary == nullptr
              ? nullptr
              : FindEstimate(*summary, ParameterName(equation, term));
      if (estimate != nullptr) {
        term.sigma = estimate->sigma;
        term.lower95 = estimate->lower95;
        term.upper95 = estimate->upper95;
      }
    }
  }
}

// One fit after the other, each beginning where the one before has ended.
class Refitter {
 public:
  Refitter(const Case& c, const IdentifiedModel& model, Discovery* discovery,
           std::string* error)
      : c_(c),
        model_(model),
        discovery_(*discovery),
        error_(error),
        last_model_(model) {}

  bool Run(const std::vector<DiscoveredEquation>& equations,
           const std::vector<DiscoveredEquation>& begin) {
    discovery_.equations = begin;
    prices_ = TermPrices(NumFittedValues(c_.problem), equations);
    exact_ = false;
    if (!FirstSteps() || !Fit(1)) return false;
    if (discovery_.summary.termination != Termination::kInterrupted &&
        !CompareWithNoTerms()) {
      return false;
    }
    if (!Search() || !Prune(1)) return false;
    exact_ = true;
    for (int factor = 2; factor <= kLargestRefitFactor && Good() && Left();
         factor *= 2) {
      const std::vector<DiscoveredEquation> before = discovery_.equations;
      const Discovery coarse = discovery_;
      if (!Fit(factor)) return false;
      if (!Good()) {
        // What the coarser steps found stands.
        if (discovery_.summary.termination != Termination::kInterrupted) {
          discovery_ = coarse;
        }
        break;
      }
      // Terms that made up for the integrator are not missed by a better one.
      if (!Prune(factor)) return false;
      if (SameTerms(before, discovery_.equations) && Agree(before)) break;
    }
    // The last fit is of a term that is not worth its place.
    if (!Left()) discovery_.refitted = false;
    discovery_.dropped = Difference(equations, discovery_.equations);
    discovery_.added = Difference(discovery_.equations, equations);
    return true;
  }

 private:
  bool Good() const {
    return discovery_.summary.termination == Termination::kConverged ||
           discovery_.summary.termination == Termination::kNoConvergence;
  }
  bool Left() const { return CountTerms(discovery_.equations) > 0; }

  // Drops terms one by one, each followed by a fit of the others.
  bool Prune(int factor) {
    while (Good() && DropWeakest(c_.discover, discovery_.summary, prices_,
                                 &discovery_.equations)) {
      if (!Left()) return true;
      if (!Fit(factor)) return false;
    }
    return true;
  }

  // Where the terms that were regressed cannot be fitted, or are not worth
  // their price even together, as those of a network that follows the noise,
  // whose trajectories diverge: back to the model with none of them, from which
  // the search can begin as well. What that model leaves over without a memory
  // is the noise. All stays as it is where its trajectories are not finite
  // either.
  bool CompareWithNoTerms() {
    if (!c_.discover.search) return true;
    std::vector<DiscoveredEquation> equations = discovery_.equations;
    for (DiscoveredEquation& equation : equations) {
      equation.terms.erase(
          std::remove_if(
              equation.terms.begin(), equation.terms.end(),
              [](const DiscoveredTerm& term) { return !term.given; }),
          equation.terms.end());
    }
    Case c;
    IdentifiedModel initial;
    // A case has something to find.
    const std::vector<DiscoveredEquation> wide = WithAllCandidates(equations);
    if (CountTerms(wide) == CountTerms(equations)) return true;
    if (!MakeDiscoveredCase(c_, model_, wide, {}, &c, &initial, error_)) {
      return false;
    }
    const size_t num_records = c.problem.records.size();
    std::vector<int> substeps;
    std::vector<RecordScore> scores(num_records);
    initial.sigmas.resize(num_records);
    initial.starts.resize(num_records);
    for (size_t r = 0; r < num_records; ++r) {
      const IdentificationRecord& record = c.problem.records[r];
      substeps.push_back(
          std::max(c_.problem.records[r].substeps, record.substeps));
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      Vector& start = initial.starts[r];
      if (start.size() != c.problem.dynamics->num_states()) {
        FreeRunStart(c.problem, static_cast<int>(r), initial.parameters,
                     Vector::Ones(static_cast<int>(record.channels.size())),
                     &start);
      }
      ScoreRecord(c.problem, static_cast<int>(r), initial.parameters, start, 0,
                  &scores[r]);
      if (!scores[r].finite) return true;
      initial.sigmas[r] = NoiseOf(record, scores[r]);
    }
    IdentificationSummary summary;
    summary.termination = Termination::kConverged;
    summary.records = std::move(scores);
    if (Good() && Deviance(c_.problem, discovery_.summary) +
                          prices_.Sum(discovery_.equations) <
                      Deviance(c_.problem, summary) + prices_.Sum(equations)) {
      return true;
    }
    discovery_.equations = std::move(equations);
    discovery_.discovered = std::move(c);
    discovery_.summary = std::move(summary);
    last_model_ = std::move(initial);
    substeps_ = std::move(substeps);
    unfitted_ = true;
    return true;
  }

  static Vector NoiseOf(const IdentificationRecord& record,
                        const RecordScore& score) {
    Vector sigmas(static_cast<int>(record.channels.size()));
    for (Eigen::Index k = 0; k < sigmas.size(); ++k) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(k)];
      Vector residual = score.prediction.row(k).transpose() - channel.values;
      for (double& value : residual) value = std::isfinite(value) ? value : 0.0;
      sigmas[k] = channel.sigma;
      if (!(sigmas[k] > 0.0)) {
        sigmas[k] = std::sqrt(MemorylessMeanSquare(residual));
      }
      if (!(sigmas[k] > 0.0)) sigmas[k] = 1.0;
    }
    return sigmas;
  }

  // Takes in and leaves out what the residuals of the trajectories ask for, as
  // long as the extended BIC of the fits becomes smaller.
  bool Search() {
    if (!c_.discover.search) return true;
    for (int search = 0;
         search < kMaxSearches && Good() && (Left() || unfitted_); ++search) {
      const Discovery before = discovery_;
      const IdentifiedModel model_before = last_model_;
      double memory = 1.0;
      if (!Propose(&discovery_.equations, &memory)) return false;
      if (!Left()) discovery_.equations = before.equations;
      if (SameTerms(before.equations, discovery_.equations)) return true;
      if (!Fit(1) || !Prune(1)) return false;
      if (discovery_.summary.termination == Termination::kInterrupted) break;
      const bool better =
          Good() && Left() &&
          (Deviance(c_.problem, before.summary) -
           Deviance(c_.problem, discovery_.summary)) /
                  memory >
              prices_.Sum(discovery_.equations) - prices_.Sum(before.equations);
      if (!better) {
        discovery_ = before;
        last_model_ = model_before;
        return true;
      }
    }
    return true;
  }

  // The terms that the cost, quadratic near the fit in the coefficients of all
  // candidates, asks for; new ones with a coefficient of 0. *memory: by how
  // much the samples are fewer than they look. The equations stay as they are
  // where the trajectories are not finite.
  bool Propose(std::vector<DiscoveredEquation>* equations, double* memory) {
    const std::vector<DiscoveredEquation> wide = WithAllCandidates(*equations);
    Case c;
    IdentifiedModel initial;
    if (!MakeDiscoveredCase(discovery_.discovered, last_model_, wide, substeps_,
                            &c, &initial, error_)) {
      return false;
    }
    const ParameterLayout layout(c.problem);
    const Vector free = layout.Free(initial.parameters);
    initial.decays = last_model_.decays;
    FittedCost fitted;
    if (!LinearizeAtFit(c.problem, layout, initial, discovery_.summary.records,
                        c_.options.num_threads, &fitted)) {
      return true;
    }
    *memory = fitted.memory;

    // Entries of the libraries count from 0, all others from where they are.
    QuadraticCost cost;
    cost.hessian = fitted.system.hessian / *memory;
    cost.gradient = fitted.system.gradient / *memory;
    StepwiseOptions options;
    options.prices = Vector::Zero(free.size());
    options.optional.assign(static_cast<size_t>(free.size()), false);
    options.signs.assign(static_cast<size_t>(free.size()), 0);
    options.smallest = Vector::Zero(free.size());
    std::map<std::string, int> entries;
    for (int i = 0; i < layout.num_parameters(); ++i) {
      if (layout.FreeIndex(i) >= 0) {
        entries[layout.parameter(i).name] = layout.FreeIndex(i);
      }
    }
    Vector from_zero = Vector::Zero(free.size());
    std::vector<int> start;
    for (size_t e = 0; e < wide.size(); ++e) {
      for (const DiscoveredTerm& term : wide[e].terms) {
        const auto found = entries.find(ParameterName(wide[e], term));
        if (term.given || found == entries.end()) continue;
        const int j = found->second;
        from_zero[j] = free[j];
        options.prices[j] = prices_.Of(wide[e], term);
        options.optional[static_cast<size_t>(j)] = true;
        options.signs[static_cast<size_t>(j)] = term.sign;
        options.smallest[j] = c_.discover.prune_fraction *
                              c_.discover.tolerance * wide[e].scale /
                              std::max(term.basis_rms, 1e-300);
        if (Has((*equations)[e], term.basis)) start.push_back(j);
      }
    }
    cost.gradient -= cost.hessian * from_zero;
    const std::vector<int> support = SelectStepwise(cost, options, start);
    for (size_t e = 0; e < wide.size(); ++e) {
      std::vector<DiscoveredTerm> terms;
      for (const DiscoveredTerm& term : wide[e].terms) {
        const auto found = entries.find(ParameterName(wide[e], term));
        if (term.given || (found != entries.end() &&
                           std::binary_search(support.begin(), support.end(),
                                              found->second))) {
          terms.push_back(term);
        }
      }
      (*equations)[e].terms = std::move(terms);
    }
    return true;
  }

  // The finer of the steps of the network's fit and of those that the equations
  // ask for.
  bool FirstSteps() {
    Case first;
    IdentifiedModel initial;
    if (!MakeDiscoveredCase(c_, last_model_, discovery_.equations, {}, &first,
                            &initial, error_)) {
      return false;
    }
    for (size_t r = 0; r < c_.problem.records.size(); ++r) {
      substeps_.push_back(std::max(c_.problem.records[r].substeps,
                                   first.problem.records[r].substeps));
    }
    return true;
  }

  bool Fit(int factor) {
    std::vector<int> substeps = substeps_;
    for (int& count : substeps) count *= factor;
    IdentifiedModel initial;
    if (!MakeDiscoveredCase(num_fits_ > 0 ? discovery_.discovered : c_,
                            last_model_, discovery_.equations, substeps,
                            &discovery_.discovered, &initial, error_)) {
      return false;
    }
    ++num_fits_;
    unfitted_ = false;
    discovery_.refitted = true;
    discovery_.step_refinement = factor;
    Identify(discovery_.discovered.problem, Options(), &initial,
             &discovery_.summary, &discovery_.model);
    if (discovery_.model.parameters.size() == initial.parameters.size()) {
      last_model_ = discovery_.model;
      TakeOver(discovery_.summary, &discovery_.equations);
    }
    return true;
  }

  // Those of the case, and whoever asked hears of the equations as they change.
  IdentificationOptions Options() const {
    IdentificationOptions options = c_.options;
    if (!exact_) {
      options.function_tolerance =
          std::max(options.function_tolerance, kSearchTolerance);
      options.max_num_iterations =
          std::min(options.max_num_iterations, kMaxSearchIterations);
    }
    if (!c_.discover.on_equations) return options;
    options.callback = [this](const IdentificationProgress& progress) {
      std::vector<DiscoveredEquation> equations = discovery_.equations;
      const ParameterLayout layout(discovery_.discovered.problem);
      std::map<std::string, double> values;
      for (int i = 0; i < layout.num_parameters(); ++i) {
        values[layout.parameter(i).name] = progress.model->parameters[i];
      }
      for (DiscoveredEquation& equation : equations) {
        for (DiscoveredTerm& term : equation.terms) {
          const auto found = values.find(ParameterName(equation, term));
          if (found != values.end()) term.coefficient = found->second;
        }
      }
      c_.discover.on_equations(num_fits_, equations);
      return !c_.options.callback || c_.options.callback(progress);
    };
    return options;
  }

  bool Agree(const std::vector<DiscoveredEquation>& before) const {
    for (size_t e = 0; e < before.size(); ++e) {
      const DiscoveredEquation& after = discovery_.equations[e];
      for (size_t k = 0; k < after.terms.size(); ++k) {
        const ParameterEstimate* estimate = FindEstimate(
            discovery_.summary, ParameterName(after, after.terms[k]));
        const double sigma =
            estimate != nullptr && std::isfinite(estimate->sigma)
                ? estimate->sigma
                : 0.0;
        const double value = after.terms[k].coefficient;
        const double moved = std::abs(value - before[e].terms[k].coefficient);
        if (moved > std::max(0.1 * sigma, 1e-8 * std::abs(value))) return false;
      }
    }
    return true;
  }

  const Case& c_;
  const IdentifiedModel& model_;
  Discovery& discovery_;
  std::string* error_;
  IdentifiedModel last_model_;
  std::vector<int> substeps_;
  TermPrices prices_;
  int num_fits_ = 0;
  bool unfitted_ = false;  // begun without terms, and without a fit
  bool exact_ = true;
};

}  // namespace

int Discovery::num_terms() const { return CountTerms(equations); }

bool MakeDiscoveredCase(const Case& c, const IdentifiedModel& model,
                        const std::vector<DiscoveredEquation>& equations,
                        const std::vector<int>& substeps, Case* discovered,
                        IdentifiedModel* initial, std::string* error) {
  TomlValue tree = *c.source;
  std::vector<TomlValue> networks;
  if (const TomlValue* tables = tree.Find("network")) {
    networks = tables->elements;
  }
  std::vector<TomlValue> libraries;
  if (const TomlValue* tables = tree.Find("library")) {
    libraries = tables->elements;
  }
  for (const DiscoveredEquation& equation : equations) {
    const auto replaced = [&](const char* key, const std::string& name) {
      return [key, name](const TomlValue& table) {
        const TomlValue* value = table.Find(key);
        return value != nullptr && value->text == name;
      };
    };
    networks.erase(std::remove_if(networks.begin(), networks.end(),
                                  replaced("name", equation.network)),
                   networks.end());
    // Of an earlier round.
    libraries.erase(std::remove_if(libraries.begin(), libraries.end(),
                                   replaced("name", LibraryName(equation))),
                    libraries.end());
    if (!equation.terms.empty()) libraries.push_back(LibraryTable(equation));
  }
  // Curves go on beside what stands for the networks.
  if (TomlValue* tables = tree.Find("reference_curve")) {
    std::vector<TomlValue> curves;
    for (TomlValue curve : tables->elements) {
      const TomlValue* term = curve.Find("term");
      bool kept = true;
      for (const DiscoveredEquation& equation : equations) {
        if (term == nullptr || term->text != equation.network) continue;
        kept = !equation.terms.empty();
        curve.Set("term", TomlValue::String(LibraryName(equation)));
        break;
      }
      if (kept) curves.push_back(std::move(curve));
    }
    tree.Erase("reference_curve");
    if (!curves.empty()) {
      tree.Set("reference_curve", TomlValue::Array(std::move(curves)));
    }
  }
  // Nothing is looked for in what is left.
  tree.Erase("discover");
  tree.Erase("network");
  tree.Erase("library");
  if (!libraries.empty()) {
    tree.Set("library", TomlValue::Array(std::move(libraries)));
  }
  if (!networks.empty()) {
    tree.Set("network", TomlValue::Array(std::move(networks)));
  }
  if (!substeps.empty()) {
    std::vector<TomlValue>& records = tree.Find("record")->elements;
    CHECK_EQ(records.size(), substeps.size());
    for (size_t r = 0; r < records.size(); ++r) {
      records[r].Set("substeps", TomlValue::Integer(substeps[r]));
    }
  }
  std::map<std::string, double> values = ParametersByName(c.problem, model);
  // The equations know better than the libraries of an earlier round.
  for (const DiscoveredEquation& equation : equations) {
    for (const DiscoveredTerm& term : equation.terms) {
      values[ParameterName(equation, term)] = term.coefficient;
    }
  }
  if (!RebuildCase(c, tree, discovered, error)) return false;
  *initial = BeginFrom(values, model, discovered->problem);
  return true;
}

bool RefitEquations(const Case& c, const IdentifiedModel& model,
                    const std::vector<DiscoveredEquation>& equations,
                    const std::vector<DiscoveredEquation>* resumed,
                    Discovery* discovery, std::string* error) {
  Discovery result;
  if (!Refitter(c, model, &result, error)
           .Run(equations, resumed != nullptr ? *resumed : equations)) {
    return false;
  }
  CompleteTerms(c, equations, &result.summary, &result.equations);
  *discovery = std::move(result);
  return true;
}

Discovery WithoutRefit(const Case& c,
                       const std::vector<DiscoveredEquation>& equations) {
  Discovery discovery;
  discovery.equations = equations;
  CompleteTerms(c, equations, nullptr, &discovery.equations);
  return discovery;
}

}  // namespace pinode
