#include "pinode/study/explanations/likely_delays.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/problem/simulation.h"

namespace pinode {
namespace {

// Least increase of a correlation that makes a delay likely. Of 12 structures
// without a delay, whose stiffnesses were up to 25 % off, the best lag raised
// the correlation by up to 0.06. Of 24 with delays of 11 to 250 ms it did so by
// 0.2 to 1.6, but for three below a tenth of a period.
constexpr double kClearlyBetter = 0.1;
// Least correlation of a channel, or of all, with the right delay. The 24 had
// 0.57 and above.
constexpr double kLeastAgreement = 0.4;
// Number of delays to return.
constexpr size_t kMostDelays = 2;
// Periods of the lowest mode, and share of a record, that delays reach over.
constexpr double kPeriods = 2.0;
constexpr Eigen::Index kShareOfRecord = 4;
// Number of lags either way that are tried first, before the neighbours of the
// best one. They look at every so many samples as they are apart.
constexpr Eigen::Index kCoarseLags = 200;

using Place = std::pair<int, int>;  // record, channel

bool IsDelayOfChannels(const Suspect& suspect) {
  return (suspect.kind == Suspect::Kind::kExcitationDelay ||
          suspect.kind == Suspect::Kind::kSensorDelay) &&
         suspect.sensors.size() == 1 && !suspect.sensors[0].channels.empty();
}

const MeasuredChannel& ChannelOf(const IdentificationProblem& problem,
                                 const Place& at) {
  return problem.records[static_cast<size_t>(at.first)]
      .channels[static_cast<size_t>(at.second)];
}

// Correlations of measured channels with one simulation of all records.
class Correlations {
 public:
  // `simulations` has one matrix per record, channels x samples, empty where
  // there is none.
  Correlations(const IdentificationProblem& problem,
               std::vector<Matrix> simulations)
      : problem_(problem), simulations_(std::move(simulations)) {}

  // Mean over `places` at a lag in samples; 0 without a simulation. Of the
  // samples it takes one of `every`.
  double At(const std::vector<Place>& places, Eigen::Index lag,
            Eigen::Index every = 1) const {
    double sum = 0.0;
    for (const Place& at : places) sum += At(at, lag, every);
    return sum / static_cast<double>(places.size());
  }

  // Lag of the largest mean, with |lag| <= widest.
  Eigen::Index Best(const std::vector<Place>& places,
                    Eigen::Index widest) const {
    const Eigen::Index stride = 1 + (widest - 1) / kCoarseLags;
    Eigen::Index best = 0;
    Eigen::Index every = stride;
    double most = At(places, 0, every);
    const auto look = [&](Eigen::Index lag) {
      if (std::abs(lag) > widest) return;
      const double own = At(places, lag, every);
      if (own > most) {
        most = own;
        best = lag;
      }
    };
    for (Eigen::Index lag = stride; lag <= widest; lag += stride) {
      look(lag);
      look(-lag);
    }
    const Eigen::Index centre = best;
    every = 1;
    most = At(places, centre);
    for (Eigen::Index near = 1; near < stride; ++near) {
      look(centre + near);
      look(centre - near);
    }
    return best;
  }

 private:
  double At(const Place& at, Eigen::Index lag, Eigen::Index every) const {
    const Matrix& simulation = simulations_[static_cast<size_t>(at.first)];
    const Vector& values = ChannelOf(problem_, at).values;
    const Eigen::Index count = values.size() - std::abs(lag);
    if (simulation.cols() != values.size() || count < 2) return 0.0;
    const Eigen::Index late = std::max<Eigen::Index>(lag, 0);
    double product = 0.0, measured = 0.0, simulated = 0.0;
    for (Eigen::Index k = 0; k < count; k += every) {
      const double y = values[late + k];
      const double p = simulation(at.second, late - lag + k);
      if (!std::isfinite(y)) continue;
      product += y * p;
      measured += y * y;
      simulated += p * p;
    }
    const double size = std::sqrt(measured * simulated);
    return size > 0.0 ? product / size : 0.0;
  }

  const IdentificationProblem& problem_;
  const std::vector<Matrix> simulations_;
};

// Simulation by the initial model, in the model's units.
std::vector<Matrix> SimulationsOfInitial(const IdentificationProblem& problem) {
  const Vector initial = ParameterLayout(problem).InitialValues();
  std::vector<Matrix> result(problem.records.size());
  for (size_t r = 0; r < result.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    SimulatedResponse response =
        SimulateRecord(problem, static_cast<int>(r), initial);
    if (!response.finite) continue;
    result[r] = std::move(response.sensors);
    for (size_t c = 0; c < record.channels.size(); ++c) {
      result[r].row(static_cast<Eigen::Index>(c)) *=
          record.channels[c].description.factor;
    }
  }
  return result;
}

std::vector<Matrix> SimulationsOfFit(const IdentificationProblem& problem,
                                     const FitSummary& fit) {
  std::vector<Matrix> result(problem.records.size());
  for (size_t r = 0; r < result.size() && r < fit.records.size(); ++r) {
    if (fit.records[r].finite) result[r] = fit.records[r].prediction;
  }
  return result;
}

// Sampling step if all training records have the same one, else 0.
double CommonStep(const IdentificationProblem& problem) {
  double step = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const double own = record.sampling_step();
    constexpr double kSame = 1e-6;
    if (step > 0.0 && std::abs(own - step) > kSame * step) return 0.0;
    step = own;
  }
  return step;
}

// Largest lag to be tried, in samples.
Eigen::Index WidestLag(const IdentificationProblem& problem, double step,
                       double bound) {
  double widest = bound;
  const StructuralModel& model = problem.dynamics->model();
  UndampedModes modes;
  std::string unused;
  if (ComputeUndampedModes(model.mass, model.stiffness, &modes, &unused)) {
    const double* begin = modes.eigenvalues.data();
    const double* end = begin + modes.eigenvalues.size();
    const double* lowest =
        std::find_if(begin, end, [](double square) { return square > 0.0; });
    if (lowest != end) {
      widest = std::max(widest, kPeriods * kTwoPi / std::sqrt(*lowest));
    }
  }
  Eigen::Index shortest = -1;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const Eigen::Index samples = record.num_samples();
    shortest = shortest < 0 ? samples : std::min(shortest, samples);
  }
  const double most = static_cast<double>(shortest / kShareOfRecord);
  return static_cast<Eigen::Index>(std::min(widest / step, most));
}

}  // namespace

std::vector<LikelyDelay> FindLikelyDelays(
    const IdentificationProblem& problem, const FitSummary& fit,
    const std::vector<Suspect>& suspects) {
  std::vector<LikelyDelay> of_all, of_one;
  const double step = CommonStep(problem);
  const auto any =
      std::find_if(suspects.begin(), suspects.end(), IsDelayOfChannels);
  if (any == suspects.end() || !(step > 0.0)) return {};
  const Eigen::Index widest =
      WidestLag(problem, step, any->sensors[0].parameter.upper);
  if (widest < 1) return {};
  for (std::vector<Matrix>& simulations : std::vector<std::vector<Matrix>>{
           SimulationsOfInitial(problem), SimulationsOfFit(problem, fit)}) {
    const Correlations correlations(problem, std::move(simulations));
    for (size_t i = 0; i < suspects.size(); ++i) {
      if (!IsDelayOfChannels(suspects[i])) continue;
      const std::vector<Place>& places = suspects[i].sensors[0].channels;
      LikelyDelay likely;
      likely.suspect = i;
      const Eigen::Index lag = correlations.Best(places, widest);
      likely.delay = static_cast<double>(lag) * step;
      likely.widest = static_cast<double>(widest) * step;
      likely.correlation = correlations.At(places, lag);
      likely.without = correlations.At(places, 0);
      if (likely.correlation < kLeastAgreement ||
          likely.correlation < likely.without + kClearlyBetter) {
        continue;
      }
      const bool is_of_all =
          suspects[i].kind == Suspect::Kind::kExcitationDelay;
      (is_of_all ? of_all : of_one).push_back(likely);
    }
  }
  std::vector<LikelyDelay>& found = of_all.empty() ? of_one : of_all;
  std::stable_sort(found.begin(), found.end(),
                   [](const LikelyDelay& a, const LikelyDelay& b) {
                     return a.correlation > b.correlation;
                   });
  // Two simulations may find the same delay.
  std::vector<LikelyDelay> result;
  for (const LikelyDelay& likely : found) {
    const bool is_known = std::any_of(
        result.begin(), result.end(), [&](const LikelyDelay& other) {
          return other.suspect == likely.suspect &&
                 std::abs(other.delay - likely.delay) < 1.5 * step;
        });
    if (!is_known && result.size() < kMostDelays) result.push_back(likely);
  }
  return result;
}

}  // namespace pinode
