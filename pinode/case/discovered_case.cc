#include "pinode/case/discovered_case.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/case/library_section.h"
#include "pinode/case/toml_value.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/estimate/identify.h"
#include "pinode/estimate/parameter_layout.h"

namespace pinode {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kLargestRefinement = 32;

std::string LibraryName(const DiscoveredEquation& equation) {
  // Names of DOFs are freer than those of terms.
  std::string name = equation.network + "_" + equation.output;
  for (char& c : name) {
    if (std::string("/\\:*?\"'<>|&;%$#@!~`^(){}=").find(c) !=
        std::string::npos) {
      c = '_';
    }
  }
  return name;
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
                 const IdentificationSummary& summary, int num_values,
                 std::vector<DiscoveredEquation>* equations,
                 std::vector<std::string>* dropped) {
  // Below 1: to be dropped.
  double weakest = 1.0;
  DiscoveredEquation* from = nullptr;
  size_t index = 0;
  for (DiscoveredEquation& equation : *equations) {
    const double needed =
        std::sqrt(std::log(std::max(num_values, 3)) +
                  2.0 * std::log(std::max(equation.num_candidates, 1)));
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
        worth = std::min(
            worth, std::abs(term.coefficient) / (needed * estimate->sigma));
      }
      if (worth < weakest) {
        weakest = worth;
        from = &equation;
        index = k;
      }
    }
  }
  if (from == nullptr) return false;
  dropped->push_back(from->output + ": " + from->terms[index].basis);
  from->terms.erase(from->terms.begin() + static_cast<std::ptrdiff_t>(index));
  return true;
}

int CountTerms(const std::vector<DiscoveredEquation>& equations) {
  int count = 0;
  for (const DiscoveredEquation& equation : equations) {
    count += static_cast<int>(equation.terms.size());
  }
  return count;
}

std::vector<std::vector<EquationTerm>> Report(
    const Case& c, const std::vector<DiscoveredEquation>& selected,
    const std::vector<DiscoveredEquation>& equations,
    const IdentificationSummary* summary) {
  std::vector<std::vector<EquationTerm>> all;
  for (size_t e = 0; e < equations.size(); ++e) {
    const DiscoveredEquation& equation = equations[e];
    std::vector<EquationTerm> terms;
    for (const DiscoveredTerm& term : equation.terms) {
      EquationTerm reported;
      reported.basis = term.basis;
      reported.unit = LibraryCoefficientUnit(
          Parsed(equation, term.basis), equation.features,
          c.problem.dynamics->inputs(), equation.acts_as, c.units);
      reported.coefficient = term.coefficient;
      reported.sigma = reported.lower95 = reported.upper95 = kNaN;
      reported.share = term.share;
      reported.inclusion_probability = term.inclusion_probability;
      for (const DiscoveredTerm& before : selected[e].terms) {
        if (before.basis == term.basis) {
          reported.from_network = before.coefficient;
        }
      }
      const ParameterEstimate* estimate =
          summary == nullptr
              ? nullptr
              : FindEstimate(*summary, ParameterName(equation, term));
      if (estimate != nullptr) {
        reported.sigma = estimate->sigma;
        reported.lower95 = estimate->lower95;
        reported.upper95 = estimate->upper95;
      }
      terms.push_back(std::move(reported));
    }
    all.push_back(std::move(terms));
  }
  return all;
}

// One fit after the other, each beginning where the one before has ended.
class Refitter {
 public:
  Refitter(const Case& c, const IdentifiedModel& model, Discovery* discovery,
           std::string* error)
      : c_(c), discovery_(*discovery), error_(error), last_model_(model) {}

  bool Run(const std::vector<DiscoveredEquation>& equations) {
    discovery_.equations = equations;
    if (!FirstSteps() || !Fit(1)) return false;
    const int num_values = NumFittedValues(c_.problem);
    while (Good() && DropWeakest(c_.discover, discovery_.summary, num_values,
                                 &discovery_.equations, &discovery_.dropped)) {
      if (CountTerms(discovery_.equations) == 0) {
        // The last fit is of a term that is not worth its place.
        discovery_.refitted = false;
        return true;
      }
      if (!Fit(1)) return false;
    }
    for (int factor = 2; factor <= kLargestRefinement && Good(); factor *= 2) {
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
      if (Agree(before)) break;
    }
    return true;
  }

 private:
  bool Good() const {
    return discovery_.summary.termination == Termination::kConverged ||
           discovery_.summary.termination == Termination::kNoConvergence;
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
    if (!MakeDiscoveredCase(fitted_ ? discovery_.discovered : c_, last_model_,
                            discovery_.equations, substeps,
                            &discovery_.discovered, &initial, error_)) {
      return false;
    }
    fitted_ = true;
    discovery_.refitted = true;
    discovery_.step_refinement = factor;
    IdentificationOptions options = c_.options;
    Identify(discovery_.discovered.problem, options, &initial,
             &discovery_.summary, &discovery_.model);
    if (discovery_.model.parameters.size() == initial.parameters.size()) {
      last_model_ = discovery_.model;
      TakeOver(discovery_.summary, &discovery_.equations);
    }
    return true;
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
  Discovery& discovery_;
  std::string* error_;
  IdentifiedModel last_model_;
  std::vector<int> substeps_;
  bool fitted_ = false;
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
  // Read before anything is overwritten: *discovered may be c.
  Case result;
  const ParameterLayout before(c.problem);
  if (!ReadCaseTree(tree, c.path, &result, error)) return false;
  result.options = c.options;

  CHECK_EQ(model.parameters.size(), before.num_parameters());
  std::map<std::string, double> values;
  for (int i = 0; i < before.num_parameters(); ++i) {
    values[before.parameter(i).name] = model.parameters[i];
  }
  // The equations know better than the libraries of an earlier round.
  for (const DiscoveredEquation& equation : equations) {
    for (const DiscoveredTerm& term : equation.terms) {
      values[ParameterName(equation, term)] = term.coefficient;
    }
  }
  const ParameterLayout after(result.problem);
  IdentifiedModel start;
  start.parameters = after.InitialValues();
  for (int i = 0; i < after.num_parameters(); ++i) {
    const auto found = values.find(after.parameter(i).name);
    if (found != values.end()) start.parameters[i] = found->second;
  }
  start.sigmas = model.sigmas;
  start.starts = model.starts;
  *initial = std::move(start);
  *discovered = std::move(result);
  return true;
}

bool RefitEquations(const Case& c, const IdentifiedModel& model,
                    const std::vector<DiscoveredEquation>& equations,
                    Discovery* discovery, std::string* error) {
  Discovery result;
  if (!Refitter(c, model, &result, error).Run(equations)) return false;
  result.terms = Report(c, equations, result.equations, &result.summary);
  *discovery = std::move(result);
  return true;
}

Discovery WithoutRefit(const Case& c,
                       const std::vector<DiscoveredEquation>& equations) {
  Discovery discovery;
  discovery.equations = equations;
  discovery.terms = Report(c, equations, equations, nullptr);
  return discovery;
}

}  // namespace pinode
