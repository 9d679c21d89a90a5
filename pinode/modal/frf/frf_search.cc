#include "pinode/modal/frf/frf_search.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/modal/frf/lscf.h"
#include "pinode/modal/mode_list.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Probability that noise is taken for a mode anywhere.
constexpr double kFalseMode = 1e-3;
// Lines on each side of a mode over which noise is averaged: at least so many,
// and those within so many decay rates.
constexpr Index kNoiseLines = 10;
constexpr double kNoiseDecays = 4.0;
// Poles of two orders are one mode below this relative distance of their
// frequencies. FRFs tell modes apart that differ by a per cent.
constexpr double kFrequencyTolerance = 0.003;

// Mean square of the residuals near a mode, as a multiple of the variance that
// the model of the noise has there; at least 1.
double NoiseNear(const FrfModel& model, const FrfFit& fit, Complex s) {
  const Vector& angular = model.data().angular;
  const auto at = [&angular](double w) {
    return static_cast<Index>(
        std::lower_bound(angular.data(), angular.data() + angular.size(), w) -
        angular.data());
  };
  const double width = kNoiseDecays * std::abs(s.real());
  const Index middle = at(s.imag());
  const Index first =
      std::max<Index>(0, std::min(at(s.imag() - width), middle - kNoiseLines));
  const Index last = std::min<Index>(
      angular.size(), std::max(at(s.imag() + width), middle + kNoiseLines));
  const Matrix squares =
      fit.residuals.middleRows(first, last - first).cwiseAbs2().array() /
      model.variances().middleRows(first, last - first).array();
  const double count = static_cast<double>(squares.size());
  return std::max(1.0, squares.mean() * (1.0 + 2.0 / std::sqrt(count)));
}

class FrfPruning {
 public:
  FrfPruning(const std::vector<FrfCandidate>& candidates,
             const AnalysedBand& band, const StabilisationOptions& options,
             FrfModel* model)
      : candidates_(candidates),
        band_(band),
        options_(options),
        model_(*model) {}

  FrfSearchResult Find() {
    FrfSearchResult result;
    result.kept.resize(candidates_.size());
    std::iota(result.kept.begin(), result.kept.end(), size_t{0});
    std::vector<FrfMode> modes;
    for (const FrfCandidate& candidate : candidates_) {
      modes.push_back(candidate.mode);
    }
    bool fresh = true;
    while (!modes.empty()) {
      result.fit = FitFrfModes(modes, fresh, &model_, &result.noise);
      if (fresh) ChooseResiduals(&result);
      fresh = false;
      modes = result.fit.modes;

      const int worst = Superfluous(result.fit);
      if (worst < 0) break;
      modes.erase(modes.begin() + worst);
      result.kept.erase(result.kept.begin() + worst);
    }
    return result;
  }

 private:
  void ChooseResiduals(FrfSearchResult* result) {
    const Matrix variances = model_.variances();
    FrfNoise noise;
    model_.set_complex_residuals(true);
    FrfFit fit =
        FitFrfModes(result->fit.modes, /*fresh=*/false, &model_, &noise);
    const double values = static_cast<double>(model_.data().h.size());
    const double more = 2.0 * static_cast<double>(model_.data().h.cols());
    result->complex_residuals =
        2.0 * (noise.log_likelihood - result->noise.log_likelihood) >
        more * std::log(values);
    if (result->complex_residuals) {
      result->fit = std::move(fit);
      result->noise = noise;
      return;
    }
    model_.set_complex_residuals(false);
    model_.set_variances(variances, result->noise.even);
  }

  // Returns the mode that is needed least; -1: all are needed.
  int Superfluous(const FrfFit& fit) const {
    const size_t count = fit.modes.size();
    std::vector<double> gains(count);
    for (size_t m = 0; m < count; ++m) gains[m] = model_.GainOf(fit, m);
    for (size_t m = 0; m < count; ++m) {
      const Complex s = fit.modes[m].s + model_.data().decay_rate;
      const double hz = std::abs(s) / 6.283185307179586;
      if (-s.real() > options_.largest_damping_ratio * std::abs(s) ||
          hz < band_.lowest_hz || hz > band_.highest_hz) {
        return static_cast<int>(m);
      }
    }
    for (size_t m = 0; m < count; ++m) {
      for (size_t n = m + 1; n < count; ++n) {
        if (IsOneMode(fit.modes[m].s,
                      fit.shapes.row(static_cast<Index>(m)).transpose(),
                      fit.modes[n].s,
                      fit.shapes.row(static_cast<Index>(n)).transpose())) {
          return static_cast<int>(gains[m] < gains[n] ? m : n);
        }
      }
    }
    if (!options_.pick.empty()) return -1;
    int worst = -1;
    double largest = 0.0;
    const FrfData& data = model_.data();
    const double degrees =
        static_cast<double>(2 * data.outputs + model_.unknowns_of_mode());
    for (size_t m = 0; m < count; ++m) {
      const double noise = NoiseNear(model_, fit, fit.modes[m].s);
      const double probability =
          static_cast<double>(data.num_lines()) *
          ChiSquareProbability(gains[m] / noise, degrees);
      if (probability > kFalseMode && probability > largest) {
        largest = probability;
        worst = static_cast<int>(m);
      }
    }
    return worst;
  }

  const std::vector<FrfCandidate>& candidates_;
  const AnalysedBand& band_;
  const StabilisationOptions& options_;
  FrfModel& model_;
};

}  // namespace

std::vector<FrfCandidate> FindFrfCandidates(
    const FrfData& data, const ModeIdentificationOptions& options,
    AnalysedBand* band) {
  const LscfPoles found =
      FindLscfPoles(data, band->max_order, options.num_threads);
  LscfPoles inside;
  std::vector<SubspacePole> shown;  // without the window
  for (size_t i = 0; i < found.poles.size(); ++i) {
    // The limits are those of the structure, without the window.
    SubspacePole own = found.poles[i];
    own.s += data.decay_rate;
    if (!IsInside(own, *band) ||
        own.damping_ratio() > options.stabilisation.largest_damping_ratio) {
      continue;
    }
    inside.poles.push_back(found.poles[i]);
    inside.participations.push_back(found.participations[i]);
    shown.push_back(std::move(own));
  }
  const std::vector<int> places = AddPoles(shown, /*window_seconds=*/0.0, band);
  StabilisationOptions limits = options.stabilisation;
  limits.frequency_tolerance = kFrequencyTolerance;
  limits.largest_damping_ratio = 1.0;  // of poles with the window
  std::vector<FrfCandidate> candidates;
  for (PoleCluster& cluster : FindClusters(inside.poles, band->max_order,
                                           /*window_seconds=*/0.0, limits)) {
    FrfCandidate candidate;
    size_t nearest = 0;
    double distance = 1e300;
    for (const int member : cluster.members) {
      const size_t i = static_cast<size_t>(member);
      if (places[i] >= 0) candidate.places.push_back(places[i]);
      const double own = std::abs(inside.poles[i].s_influence[0]);
      if (own < distance) {
        distance = own;
        nearest = i;
      }
    }
    candidate.mode.s = inside.poles[nearest].s;
    candidate.mode.participation = inside.participations[nearest];
    candidate.mode.participation.cwiseAbs().maxCoeff(&candidate.mode.reference);
    candidate.cluster = std::move(cluster);
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

FrfSearchResult FitFrfCandidates(const std::vector<FrfCandidate>& candidates,
                                 const AnalysedBand& band,
                                 const StabilisationOptions& options,
                                 FrfModel* model) {
  return FrfPruning(candidates, band, options, model).Find();
}

}  // namespace pinode
