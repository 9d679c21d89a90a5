#include "pinode/modal/forced_search.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/modal/forced_model.h"
#include "pinode/modal/forced_shapes.h"
#include "pinode/modal/mode_estimate.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Relative distance by which a pole may move from that of the subspace, at
// least and at most, and deviations.
constexpr double kPoleReach = 0.02;
constexpr double kMostPoleReach = 0.1;
constexpr double kPoleReachInDeviations = 4.0;
// Most lines of a fit.
constexpr Eigen::Index kMostLines = 20000;
// Room beyond the lowest frequency and the highest pole.
constexpr double kBelowLowest = 0.7;
constexpr double kAboveHighest = 1.15;
// Frequency up to which the sum over samples holds loads between samples, as a
// fraction of half the sampling rate, and room beyond a higher pole.
constexpr double kTopOfLoads = 0.85;
constexpr double kAboveTop = 1.02;
// Smallest part of a record without missing samples.
constexpr double kSmallestStretch = 0.5;

struct Stretch {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

Stretch LongestComplete(const Matrix& samples) {
  Stretch longest;
  Eigen::Index first = 0;
  for (Eigen::Index k = 0; k <= samples.cols(); ++k) {
    if (k < samples.cols() && !samples.col(k).hasNaN()) continue;
    if (k - first > longest.count) longest = {first, k - first};
    first = k + 1;
  }
  return longest;
}

double ReachOf(const PoleCluster& cluster) {
  const double size = std::abs(cluster.mean.s);
  return std::clamp(
      kPoleReachInDeviations * std::hypot(kTwoPi * cluster.frequency_sigma,
                                          size * cluster.damping_sigma),
      kPoleReach * size, kMostPoleReach * size);
}

}  // namespace

void ForcedSearch::Take(const RecordAtRate& level, const AnalysedBand& band,
                        const std::vector<PoleCluster>& clusters,
                        const std::vector<int>& places, double window_seconds) {
  if (level_ == nullptr) level_ = std::make_unique<RecordAtRate>(level);
  const int number = static_cast<int>(result_.bands.size());
  for (const PoleCluster& cluster : clusters) {
    if (!IsInside(cluster.mean, band)) continue;
    Candidate candidate;
    candidate.cluster = cluster;
    candidate.max_order = band.max_order;
    ModeList::Entry& entry = candidate.entry;
    for (const int member : cluster.members) {
      const int place = places[static_cast<size_t>(member)];
      if (place >= 0) entry.members.emplace_back(number, place);
    }
    entry.band = number;
    entry.sigma = cluster.frequency_sigma;
    entry.mode = MakeMode(record_, level.scales, level.step, cluster,
                          band.max_order, window_seconds);
    candidates_.push_back(std::move(candidate));
  }
}

void ForcedSearch::Fit(double lowest_hz) {
  MergeCandidates();
  if (FitPoles(lowest_hz)) return;
  for (const Candidate& candidate : candidates_) AddUnfitted(candidate);
}

void ForcedSearch::AddUnfitted(const Candidate& candidate) {
  ModeList::Entry entry = candidate.entry;
  modes_.MarkHarmonic(*level_, candidate.cluster.mean, &entry.mode);
  modes_.Add(std::move(entry));
}

// Keeps the most certain of those that two rates found.
void ForcedSearch::MergeCandidates() {
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [](const Candidate& a, const Candidate& b) {
                     return a.entry.sigma < b.entry.sigma;
                   });
  std::vector<Candidate> kept;
  for (Candidate& next : candidates_) {
    const bool is_new =
        std::none_of(kept.begin(), kept.end(), [&](const Candidate& other) {
          return other.entry.band != next.entry.band &&
                 IsSameMode(other.entry.mode, next.entry.mode);
        });
    if (is_new) kept.push_back(std::move(next));
  }
  candidates_ = std::move(kept);
}

// Returns false if the record is too short, or has too many gaps.
bool ForcedSearch::FitPoles(double lowest_hz) {
  if (candidates_.empty() || !options_.pick.empty()) return false;
  const Stretch stretch = LongestComplete(level_->samples);
  if (static_cast<double>(stretch.count) <
      kSmallestStretch * static_cast<double>(level_->samples.cols())) {
    return false;
  }
  std::vector<ForcedCandidate> poles;
  ForcedModel::Band band;
  band.most_lines = kMostLines;
  band.lowest_hz = kBelowLowest * lowest_hz;
  double highest = 0.0;
  for (const Candidate& candidate : candidates_) {
    const Complex s = candidate.cluster.mean.s;
    poles.push_back({s, ReachOf(candidate.cluster)});
    band.centres.push_back(s);
    highest = std::max(highest, candidate.cluster.mean.frequency());
  }
  const Eigen::Index fewest =
      ForcedModel::FewestLines(poles.size(), level_->inputs.rows());
  // A few more, because the lines are those of a rounded length.
  const double for_fewest =
      band.lowest_hz + 1.1 * static_cast<double>(fewest) /
                           (level_->step * static_cast<double>(stretch.count));
  band.highest_hz =
      std::min(std::max(kAboveHighest * highest, for_fewest),
               std::max(kAboveTop * highest, kTopOfLoads * 0.5 / level_->step));
  ForcedModel model(level_->samples.middleCols(stretch.first, stretch.count),
                    level_->inputs.middleCols(stretch.first, stretch.count),
                    level_->step, band);
  if (model.num_lines() < fewest) return false;
  const ForcedPoles found = FindForcedPoles(poles, &model);
  // Loads that are not measured move the structure as much as a fit of measured
  // ones allows for at few lines: the fit's poles then follow them.
  if (found.has_peak) {
    for (const size_t kept : found.kept) AddUnfitted(candidates_[kept]);
    return true;
  }
  const std::vector<SubspacePole> estimates =
      EstimateForcedPoles(model, found.fit);
  for (size_t m = 0; m < found.kept.size(); ++m) {
    AddFitted(estimates[m], candidates_[found.kept[m]]);
  }
  return true;
}

void ForcedSearch::AddFitted(const SubspacePole& pole,
                             const Candidate& candidate) {
  PoleCluster cluster = candidate.cluster;
  pole.shape.cwiseAbs().maxCoeff(&cluster.reference);
  cluster.mean = NormalisedPole(pole, cluster.reference);
  cluster.mean.order = candidate.cluster.mean.order;
  const PoleSigmas sigmas = FindPoleSigmas(cluster.mean, 0.0);
  cluster.frequency_sigma = sigmas.frequency;
  cluster.damping_sigma = sigmas.damping;
  const double hz = pole.frequency();
  if (sigmas.frequency > options_.largest_frequency_sigma * hz ||
      pole.damping_ratio() > options_.largest_damping_ratio) {
    return;
  }
  ModeList::Entry entry = candidate.entry;
  entry.mode = MakeMode(record_, level_->scales, level_->step, cluster,
                        candidate.max_order, /*window_seconds=*/0.0);
  entry.mode.sampling_step = candidate.entry.mode.sampling_step;
  entry.sigma = sigmas.frequency;
  modes_.MarkHarmonic(*level_, cluster.mean, &entry.mode);
  if (entry.mode.damping_ratio <= 0.0 && !entry.mode.is_harmonic) return;
  modes_.Add(std::move(entry));
}

}  // namespace pinode
