#include "pinode/estimate/fit/multistart.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/estimate/fit/pulse_scan.h"
#include "pinode/estimate/fit/ways.h"
#include "pinode/estimate/objective/prior_cost.h"
#include "pinode/estimate/start/signs.h"
#include "pinode/network/initialize_weights.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

// Result of one start.
struct StartResult {
  bool done = false;
  double cost = 0.0;
  double expected_error = 0.0;
  double prior_cost = 0.0;
  Vector stiffness;  // of the free stiffness groups
};

// Range of a group without given bounds, relative to its nominal size: from 1 /
// factor to factor. 1: the group is not drawn.
double LargestFactor(MatrixGroup::Target target) {
  switch (target) {
    case MatrixGroup::Target::kStiffness:
      return 2.0;
    case MatrixGroup::Target::kDamping:
      return 3.0;
    case MatrixGroup::Target::kMass:
      break;
  }
  return 1.0;
}

const GroupTerm* FindGroup(const StructuralDynamics& dynamics,
                           const std::string& name) {
  for (const GroupTerm& term : dynamics.groups()) {
    if (term.group.name == name &&
        term.follows == GroupTerm::Follows::kNothing) {
      return &term;
    }
  }
  return nullptr;
}

// Returns the indices of the groups' parameters.
std::vector<int> FreeStiffnessGroups(const IdentificationProblem& problem,
                                     const ParameterLayout& layout) {
  std::vector<int> groups;
  for (const int index : layout.free()) {
    if (!layout.IsNamed(index)) continue;
    const GroupTerm* term =
        FindGroup(*problem.dynamics, layout.parameter(index).name);
    if (term != nullptr &&
        term->group.target == MatrixGroup::Target::kStiffness) {
      groups.push_back(index);
    }
  }
  return groups;
}

// Returns the largest number of fitted channels in a training record.
Eigen::Index MostChannels(const IdentificationProblem& problem) {
  Eigen::Index most = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    most = std::max(most, static_cast<Eigen::Index>(std::count_if(
                              record.channels.begin(), record.channels.end(),
                              [](const MeasuredChannel& c) { return c.fit; })));
  }
  return most;
}

// Frequencies without shapes have many minima, in which they are exchanged.
bool IsOfFrequenciesAlone(const IdentificationProblem& problem) {
  const std::vector<MeasuredMode>& modes = problem.modal.modes;
  return problem.num_train_records() == 0 && !problem.HasSpectra() &&
         !modes.empty() &&
         std::none_of(modes.begin(), modes.end(),
                      [](const MeasuredMode& mode) { return mode.HasShape(); });
}

// True for linear structures with records alone, whose fit begins without
// given values.
bool MayChooseStarts(const IdentificationProblem& problem,
                     const IdentifiedModel* initial) {
  return initial == nullptr && problem.dynamics->IsLinear() &&
         problem.num_train_records() > 0 && !problem.HasSpectra() &&
         problem.modal.modes.empty();
}

// True if a fit breaks down or predicts hardly better than no motion at all
// would. A beam that
// was stiffer than its model by up to a quarter ended so at 1.12, with one
// element 3e4 times too stiff; seven other starts reached 0.047. Wrong sensors
// and loads end between 0.47 and 0.87.
bool IsLost(const StartResult& result) {
  constexpr double kLost = 0.9;
  return !result.done || !(result.expected_error < kLost);
}

// See IdentificationOptions::num_starts.
int NumStarts(const IdentificationProblem& problem,
              const IdentificationOptions& options,
              const IdentifiedModel* initial, size_t num_groups) {
  constexpr int kStarts = 8;
  constexpr int kStartsOfFrequencies = 16;
  if (options.num_starts > 0) return options.num_starts;
  if (initial == nullptr && IsOfFrequenciesAlone(problem)) {
    return kStartsOfFrequencies;
  }
  if (!MayChooseStarts(problem, initial)) return 1;
  return 2 * MostChannels(problem) <= static_cast<Eigen::Index>(num_groups)
             ? kStarts
             : 1;
}

// Compares the expected errors or, without records, the costs.
bool IsBetter(const IdentificationProblem& problem, const StartResult& one,
              const StartResult& other) {
  return problem.num_train_records() == 0
             ? one.cost < other.cost
             : one.expected_error < other.expected_error;
}

// True if a start has reached `best`. With an estimated noise all costs of
// records are alike, whatever is left.
bool IsSame(const IdentificationProblem& problem,
            const IdentificationOptions& options, const StartResult& best,
            const StartResult& result) {
  const double share = options.tuning.multistart.same_cost;
  return problem.num_train_records() == 0
             ? result.cost <= best.cost + share * std::abs(best.cost)
             : result.expected_error <= (1.0 + share) * best.expected_error;
}

}  // namespace

Vector DrawStart(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const MultistartTuning& tuning,
                 uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random]() {
    return (static_cast<double>(random() >> 11) + 0.5) * 0x1.0p-53;
  };
  Vector values = layout.InitialValues();
  for (int index : layout.free()) {
    const Parameter& parameter = layout.parameter(index);
    if (!layout.IsNamed(index)) continue;
    double low = parameter.lower;
    double high = parameter.upper;
    if (parameter.HasPrior()) {
      low = std::max(low, parameter.prior_mean -
                              tuning.prior_deviations * parameter.prior_sigma);
      high = std::min(high, parameter.prior_mean + tuning.prior_deviations *
                                                       parameter.prior_sigma);
    }
    if (std::isfinite(low) && std::isfinite(high)) {
      values[index] = low + (high - low) * uniform();
      continue;
    }
    const GroupTerm* group = FindGroup(*problem.dynamics, parameter.name);
    if (group == nullptr) continue;
    const double reach = std::log(LargestFactor(group->group.target));
    if (reach > 0.0) {
      values[index] =
          std::clamp(std::exp(reach * (2.0 * uniform() - 1.0)) - group->present,
                     low, high);
    }
  }
  const StructuralDynamics& dynamics = *problem.dynamics;
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const int block = dynamics.network_block(static_cast<int>(j));
    const Vector weights = InitializeWeights(
        dynamics.networks()[j].network->architecture(), random(), true);
    for (int i = 0; i < weights.size(); ++i) {
      const int index = dynamics.block_offset(block) + i;
      if (layout.FreeIndex(index) >= 0) values[index] = weights[i];
    }
  }
  // These come last, so that the draws of other problems stay.
  size_t law = 0;
  for (int t = 0; t < dynamics.num_terms(); ++t) {
    if (dynamics.term(t).kind() != TermKind::kLaw) continue;
    const MemoryNetwork* network = AsMemoryNetwork(dynamics.laws()[law++]);
    if (network == nullptr) continue;
    const Vector weights = network->DrawWeights(random());
    for (int i = 0; i < weights.size(); ++i) {
      const int index = dynamics.block_offset(t) + i;
      if (layout.FreeIndex(index) >= 0) values[index] = weights[i];
    }
  }
  return values;
}

namespace {

// Fits from one start after another.
class Starts {
 public:
  Starts(const IdentificationProblem& problem,
         const IdentificationOptions& options, const IdentifiedModel* initial)
      : problem_(problem),
        options_(options),
        initial_(initial),
        layout_(problem),
        groups_(FreeStiffnessGroups(problem, layout_)) {}

  StartResult ResultOf(const Fit& fit) const {
    const FitState& state = fit.best();
    StartResult result;
    result.cost = state.cost;
    result.expected_error = state.ExpectedError();
    result.stiffness = fit.BestParameters()(groups_);
    // Cost of the priors of single parameters, as given by the user.
    result.done = PriorCost(layout_).Evaluate(state.free, &result.prior_cost);
    return result;
  }

  int count() const {
    return NumStarts(problem_, options_, initial_, groups_.size());
  }
  const std::vector<int>& groups() const { return groups_; }
  // Returns the deviations of the stiffness groups at the end of `fit`, from
  // the curvature of its cost; infinite where that is flat.
  Vector DeviationsAt(Fit* fit) const {
    constexpr double kFlatOfLargest = 1e-12;
    const auto size = static_cast<Eigen::Index>(groups_.size());
    CondensedSystem system;
    if (!fit->objective().Linearize(layout_.Free(fit->BestParameters()),
                                    &system)) {
      return Vector::Constant(size, kInfinity);
    }
    const Eigen::SelfAdjointEigenSolver<Matrix> modes(system.hessian);
    const double least = kFlatOfLargest * modes.eigenvalues().tail(1)[0];
    Vector deviations(size);
    for (Eigen::Index j = 0; j < size; ++j) {
      const Vector shares =
          modes.eigenvectors()
              .row(layout_.FreeIndex(groups_[static_cast<size_t>(j)]))
              .cwiseAbs2();
      deviations[j] = std::sqrt(
          shares.cwiseQuotient(modes.eigenvalues().cwiseMax(least)).sum());
    }
    return deviations;
  }
  // Returns "k1 0.1 (0.2 here)" for the first group whose values differ by more
  // than the deviations of either allow.
  std::string Difference(const Vector& here, const Vector& there,
                         const Vector& deviations) const {
    constexpr double kFarInValue = 0.05;
    constexpr double kFarInDeviations = 6.0;
    for (Eigen::Index j = 0; j < here.size(); ++j) {
      if (std::abs(there[j] - here[j]) <=
          std::max(kFarInValue, kFarInDeviations * deviations[j])) {
        continue;
      }
      return layout_.parameter(groups_[static_cast<size_t>(j)]).name + " " +
             FormatNumber(there[j], 3) + " (" + FormatNumber(here[j], 3) +
             " here)";
    }
    return "";
  }

  // Runs one start; nullptr, with a message in *outcome, if there is no finite
  // result.
  std::unique_ptr<Fit> Run(int start, Communicator* communicator,
                           FitSummary* outcome) const {
    Vector parameters = layout_.InitialValues();
    if (start > 0) {
      parameters = DrawStart(problem_, layout_, options_.tuning.multistart,
                             options_.seed + static_cast<uint64_t>(start));
    } else if (initial_ != nullptr) {
      parameters = initial_->parameters;
    } else {
      FindSigns(problem_, &parameters);
      ScanPulses(problem_, &parameters);
    }
    IdentificationOptions options = options_;
    options.communicator = communicator;
    return RunWays(problem_, options, parameters,
                   start == 0 ? initial_ : nullptr, outcome);
  }

 private:
  const IdentificationProblem& problem_;
  const IdentificationOptions& options_;
  const IdentifiedModel* initial_;
  const ParameterLayout layout_;
  const std::vector<int> groups_;
};

// True if `other` describes the measurements nearly as well as `best`, and
// priors do not distinguish them.
bool IsAsGood(const IdentificationProblem& problem, const StartResult& best,
              const StartResult& other) {
  // A difference of a tenth is large for chance, but not for a model's error.
  // For four storeys measured at their roof alone, with damping of another
  // form, wrong solutions were better by 3 %.
  constexpr double kNearlyAsGood = 1.1;
  // Half a chi^2 of 6, for priors and for modes with standard deviations.
  constexpr double kSameCost = 3.0;
  if (other.prior_cost > best.prior_cost + kSameCost) return false;
  return problem.num_train_records() > 0
             ? other.expected_error <= kNearlyAsGood * best.expected_error
             : other.cost <= best.cost + kSameCost;
}

// Describes the difference of another minimum that is nearly as good.
std::string OtherSolution(const IdentificationProblem& problem,
                          const Starts& starts,
                          const std::vector<StartResult>& results, Fit* fit) {
  const bool by_modes = problem.num_train_records() == 0 &&
                        !problem.HasSpectra() && problem.modal.HasSigmasOfAll();
  if ((problem.num_train_records() == 0 && !by_modes) || results.size() < 2 ||
      starts.groups().empty()) {
    return "";
  }
  const StartResult best = starts.ResultOf(*fit);
  const Vector deviations = starts.DeviationsAt(fit);
  for (const StartResult& result : results) {
    if (!result.done || !IsAsGood(problem, best, result)) continue;
    std::string difference =
        starts.Difference(best.stiffness, result.stiffness, deviations);
    if (!difference.empty()) return difference;
  }
  return "";
}

// Runs the starts on the ranks in parallel. Returns false if a rank does not
// answer.
bool RunApart(const Starts& starts, Communicator* ranks,
              std::vector<StartResult>* results) {
  constexpr int kNumbers = 4;
  const auto num_groups = static_cast<Eigen::Index>(starts.groups().size());
  Matrix numbers = Matrix::Zero(kNumbers + num_groups,
                                static_cast<Eigen::Index>(results->size()));
  for (int s = ranks->rank(); s < numbers.cols(); s += ranks->size()) {
    FitSummary unused;
    const std::unique_ptr<Fit> fit = starts.Run(s, nullptr, &unused);
    if (fit == nullptr) continue;
    const StartResult result = starts.ResultOf(*fit);
    numbers.col(s) << 1.0, result.cost, result.expected_error,
        result.prior_cost, result.stiffness;
    if (fit->interrupted()) break;
  }
  if (!ranks->Await() || !ranks->Sum(numbers.data(), numbers.size())) {
    return false;
  }
  for (size_t s = 0; s < results->size(); ++s) {
    const Vector column = numbers.col(static_cast<Eigen::Index>(s));
    (*results)[s] = {column[0] > 0.0, column[1], column[2], column[3],
                     column.tail(num_groups)};
  }
  return true;
}

}  // namespace

std::unique_ptr<Fit> RunStarts(const IdentificationProblem& problem,
                               const IdentificationOptions& options,
                               const IdentifiedModel* initial,
                               FitSummary* summary) {
  const Starts starts(problem, options, initial);
  Communicator& ranks = CommunicatorOrSingle(options.communicator);
  std::vector<StartResult> results(static_cast<size_t>(starts.count()));
  std::unique_ptr<Fit> best;
  int num_starts = 0;
  const bool apart = ranks.size() > 1 && results.size() > 1;
  bool was_lost = false;
  if (apart) {
    if (!RunApart(starts, &ranks, &results)) {
      summary->message = "a rank does not answer";
      return nullptr;
    }
    num_starts = static_cast<int>(results.size());
    // All ranks run the best start again, so that each has its fit.
    int at = 0;
    for (size_t s = 0; s < results.size(); ++s) {
      const StartResult& chosen = results[static_cast<size_t>(at)];
      if (results[s].done &&
          (!chosen.done || IsBetter(problem, results[s], chosen))) {
        at = static_cast<int>(s);
      }
    }
    best = starts.Run(at, options.communicator, summary);
  }
  for (int start = 0; !apart && start < static_cast<int>(results.size());
       ++start) {
    ++num_starts;
    FitSummary outcome;
    std::unique_ptr<Fit> fit =
        starts.Run(start, options.communicator, &outcome);
    const bool interrupted = fit != nullptr && fit->interrupted();
    StartResult& result = results[static_cast<size_t>(start)];
    if (fit != nullptr) result = starts.ResultOf(*fit);
    if (fit == nullptr) {
      if (start == 0) *summary = outcome;
    } else if (best == nullptr ||
               IsBetter(problem, result, starts.ResultOf(*best))) {
      best = std::move(fit);
      *summary = outcome;
    }
    if (interrupted) break;
    if (was_lost && result.done && !IsLost(result)) break;
    if (results.size() == 1 && options.num_starts == 0 &&
        MayChooseStarts(problem, initial) && IsLost(result)) {
      was_lost = true;
      results.resize(kStartsOfLost);
    }
  }
  if (best == nullptr) return nullptr;
  summary->num_starts = num_starts;
  const StartResult reached = starts.ResultOf(*best);
  summary->num_starts_at_best = static_cast<int>(std::count_if(
      results.begin(), results.end(), [&](const StartResult& result) {
        return result.done && IsSame(problem, options, reached, result);
      }));
  summary->other_solution = OtherSolution(problem, starts, results, best.get());
  return best;
}

}  // namespace pinode
