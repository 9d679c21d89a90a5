#include "pinode/estimate/certainty/profile.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/constants.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/strings.h"
#include "pinode/base/types.h"
#include "pinode/estimate/certainty/profiler.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/parameter_profile.h"

namespace pinode {
namespace {

const ParameterEstimate* FindEstimate(const FitSummary& summary,
                                      const std::string& name) {
  for (const ParameterEstimate& estimate : summary.parameters) {
    if (estimate.name == name) return &estimate;
  }
  return nullptr;
}

// Finds the columns to be profiled.
bool FindColumns(const ParameterLayout& layout,
                 const std::vector<std::string>& names,
                 std::vector<int>* columns, std::string* error) {
  std::vector<std::string> known;
  for (int j = 0; j < layout.num_free(); ++j) {
    if (!layout.IsNamed(layout.free()[static_cast<size_t>(j)])) continue;
    known.push_back(layout.free_parameter(j).name);
    if (names.empty()) columns->push_back(j);
  }
  for (const std::string& name : names) {
    const int j = layout.FreeIndex(name);
    if (j < 0) {
      const std::string nearest = NearestName(name, known);
      *error = "there is no free parameter '" + name + "' to profile" +
               (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
      return false;
    }
    columns->push_back(j);
  }
  if (columns->empty()) *error = "no parameter with a name is free";
  return !columns->empty();
}

// The fit's linear interval of a parameter; sigma is 0 if there is none.
struct LinearInterval {
  double sigma = 0.0;
  double quantile = 0.0;
  double lower95 = -kInfinity, upper95 = kInfinity;
};

LinearInterval LinearIntervalOf(const FitSummary& summary,
                                const std::string& name) {
  LinearInterval interval;
  const ParameterEstimate* estimate = FindEstimate(summary, name);
  if (estimate == nullptr || !(estimate->sigma > 0.0) ||
      !std::isfinite(estimate->sigma)) {
    return interval;
  }
  interval.sigma = estimate->sigma;
  interval.lower95 = estimate->value - estimate->half_width95;
  interval.upper95 = estimate->value + estimate->half_width95;
  interval.quantile = estimate->half_width95 / estimate->sigma;
  return interval;
}

// Returns the known profile around this value; nullptr if there is none.
const ParameterProfile* FindKnown(const std::vector<ParameterProfile>& known,
                                  const std::string& name, double value,
                                  double sigma) {
  const double least = sigma > 0.0 ? sigma : std::abs(value);
  for (const ParameterProfile& profile : known) {
    if (profile.name == name &&
        std::abs(profile.estimate - value) <= 1e-3 * least) {
      return &profile;
    }
  }
  return nullptr;
}

// The numbers that every profile has, in one order for writing and reading.
template <typename Profile, typename Visit>
void VisitNumbers(Profile* p, const Visit& visit) {
  visit(&p->estimate);
  visit(&p->lower95);
  visit(&p->upper95);
  visit(&p->lower99);
  visit(&p->upper99);
  visit(&p->threshold95);
  visit(&p->threshold99);
  visit(&p->linear_lower95);
  visit(&p->linear_upper95);
  visit(&p->determination);
  visit(&p->found_lower);
  visit(&p->unsettled);
  visit(&p->linearizations);
}

Vector NumbersOf(const ParameterProfile& profile) {
  std::vector<double> numbers;
  VisitNumbers(&profile, [&numbers](const auto* number) {
    numbers.push_back(static_cast<double>(*number));
  });
  for (const ParameterProfile::Point& point : profile.points) {
    numbers.push_back(point.value);
    numbers.push_back(point.ratio);
  }
  return Eigen::Map<const Vector>(numbers.data(),
                                  static_cast<Eigen::Index>(numbers.size()));
}

void SetNumbers(const Vector& numbers, ParameterProfile* profile) {
  Eigen::Index at = 0;
  VisitNumbers(profile, [&](auto* number) {
    *number =
        static_cast<std::remove_pointer_t<decltype(number)>>(numbers[at++]);
  });
  profile->points.clear();
  for (; at + 1 < numbers.size(); at += 2) {
    profile->points.push_back({numbers[at], numbers[at + 1]});
  }
}

// *done and, where it is not 0, the profile of rank `owner`, made known to all.
// False where a rank does not answer.
bool BroadcastProfile(int owner, Communicator* communicator, char* done,
                      ParameterProfile* profile) {
  if (communicator->size() == 1) return true;
  if (!communicator->Broadcast(owner, done, 1)) return false;
  if (*done == 0) return true;
  Vector numbers = NumbersOf(*profile);
  auto num_combinations = static_cast<double>(profile->combinations.size());
  if (!communicator->Broadcast(owner, &numbers) ||
      !communicator->Broadcast(owner, &num_combinations, sizeof(double)) ||
      !communicator->Broadcast(owner, &profile->name) ||
      !communicator->Broadcast(owner, &profile->unit)) {
    return false;
  }
  SetNumbers(numbers, profile);
  profile->combinations.resize(static_cast<size_t>(num_combinations));
  for (std::string& combination : profile->combinations) {
    if (!communicator->Broadcast(owner, &combination)) return false;
  }
  return true;
}

}  // namespace

bool ProfileParameters(const IdentificationProblem& problem,
                       const FitSummary& summary, const IdentifiedModel& model,
                       const IdentificationOptions& options,
                       const ProfileOptions& profile_options,
                       std::vector<ParameterProfile>* profiles,
                       std::string* error) {
  profiles->clear();
  if (!problem.IsValid(error)) return false;
  if (summary.covariance_method == "errors in variables") {
    *error =
        "profiles need a fit that takes the excitation as exact, but its "
        "errors were unknowns; set covariance = \"plain\" or \"sandwich\"";
    return false;
  }
  const ParameterLayout layout(problem);
  std::vector<int> columns;
  if (!FindColumns(layout, profile_options.parameters, &columns, error))
    return false;
  if (model.parameters.size() != layout.num_parameters()) {
    *error = "the model is of another problem";
    return false;
  }
  const Vector fit = layout.Free(model.parameters);
  Communicator& ranks = CommunicatorOrSingle(options.communicator);
  const auto owner = [&ranks](size_t k) {
    return static_cast<int>(k) % ranks.size();
  };
  const int threads =
      std::clamp(options.num_threads, 1, static_cast<int>(columns.size()));
  std::atomic<bool> stopped{false};
  const std::function<bool()> stop = [&stopped, &profile_options]() {
    return stopped.load() || (profile_options.stop && profile_options.stop());
  };
  std::vector<std::unique_ptr<Profiler>> profilers;
  for (int t = 0; t < threads; ++t) {
    profilers.push_back(
        std::make_unique<Profiler>(problem, layout, options, stop));
    if (!profilers.back()->Place(problem, model, summary.records)) {
      *error = "the cost cannot be had at the fit";
      return false;
    }
  }
  ProfileOrigin origin;
  if (!profilers[0]->FindOrigin(fit, &origin)) {
    if (!stop()) {
      *error = "the cost cannot be had at the fit";
      return false;
    }
    stopped = true;
  }
  std::vector<ParameterProfile> all(columns.size());
  std::vector<char> done(columns.size(), 0);
  std::mutex mutex;
  std::vector<ParameterProfile> finished;
  ParallelFor(
      static_cast<int>(columns.size()), threads, [&](int i, int thread) {
        const size_t k = static_cast<size_t>(i);
        if (owner(k) != ranks.rank()) return;
        const Parameter& parameter = layout.free_parameter(columns[k]);
        const LinearInterval linear = LinearIntervalOf(summary, parameter.name);
        const ParameterProfile* known =
            FindKnown(profile_options.known, parameter.name, fit[columns[k]],
                      linear.sigma);
        ParameterProfile& profile = all[k];
        if (known != nullptr) {
          profile = *known;
        } else {
          profile.name = parameter.name;
          profile.unit = parameter.unit;
          profile.linear_lower95 = linear.lower95;
          profile.linear_upper95 = linear.upper95;
          if (stop() || !profilers[static_cast<size_t>(thread)]->Run(
                            origin, columns[k], linear.sigma, linear.quantile,
                            &profile)) {
            return;
          }
        }
        const std::lock_guard<std::mutex> lock(mutex);
        done[k] = 1;
        finished.push_back(profile);
        if (profile_options.callback &&
            !profile_options.callback(finished,
                                      static_cast<int>(columns.size()))) {
          stopped = true;
        }
      });
  if (!ranks.Await()) {
    *error = "a rank does not answer";
    return false;
  }
  for (size_t k = 0; k < all.size(); ++k) {
    if (!BroadcastProfile(owner(k), &ranks, &done[k], &all[k])) {
      *error = "a rank does not answer";
      return false;
    }
    if (done[k] != 0) profiles->push_back(std::move(all[k]));
  }
  return true;
}

}  // namespace pinode
