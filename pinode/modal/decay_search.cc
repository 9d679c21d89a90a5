#include "pinode/modal/decay_search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/modal/mode_estimate.h"
#include "pinode/modal/stabilisation.h"

namespace pinode {
namespace {

// Largest remainder of a channel without a remark.
constexpr double kLargestRest = 0.3;
// Largest uncertainty of the frequency of a vibration that is listed.
constexpr double kLargestDecaySigma = 0.1;
// Most samples of a rate at which all vibrations of a decay are fitted.
constexpr Eigen::Index kMostJointSamples = 30000;

}  // namespace

void DecaySearch::Take(const RecordAtRate& level,
                       std::vector<SubspacePole> poles, AnalysedBand band) {
  std::vector<int> places = AddPoles(poles, 0.0, &band);
  const std::vector<DecayTerm> terms =
      FindDecayTerms(level.samples, level.step, poles, terms_);
  terms_ = TermsAtHalfRate(terms, level.step);
  std::vector<std::complex<double>> picked;
  if (!options_.pick.empty()) {
    for (const PoleCluster& cluster :
         FindClusters(poles, band.max_order, 0.0, options_)) {
      if (IsInside(cluster.mean, band)) picked.push_back(cluster.mean.s);
    }
  }
  const int number = static_cast<int>(result_.bands.size());
  if (job_ == nullptr) {
    job_ = std::make_unique<Job>(Job{level,
                                     number,
                                     std::move(poles),
                                     std::move(places),
                                     terms,
                                     {},
                                     std::move(picked)});
  } else {
    for (const DecayTerm& term : terms) {
      SubspacePole pole;
      pole.s = term.s;
      if (term.vibrates() && !term.is_alias && IsInside(pole, band)) {
        job_->candidates.push_back(term.s);
      }
    }
    job_->picked.insert(job_->picked.end(), picked.begin(), picked.end());
  }
  result_.bands.push_back(std::move(band));
  if (level.samples.cols() > kMostJointSamples) Fit(level.lowest_hz);
}

void DecaySearch::Fit(double lowest_hz) {
  if (job_ == nullptr) return;
  const Job job = std::move(*job_);
  job_.reset();
  AnalysedBand band = result_.bands[static_cast<size_t>(job.band)];
  band.lowest_hz = lowest_hz;
  if (!options_.pick.empty() && job.picked.empty()) return;
  DecayModes modes = EstimateDecays(job.level.samples, job.level.step,
                                    job.terms, job.candidates, job.picked);
  if (modes_.empty()) RemarkOnRest(modes.rest);
  for (PoleCluster& cluster : modes.clusters) {
    if (!IsInside(cluster.mean, band)) continue;
    if (options_.pick.empty() && !IsListed(cluster)) continue;
    cluster.first_order = band.max_order;
    FindDecayMembers(job.poles, options_, &cluster);
    std::vector<std::pair<int, int>> members;
    for (const int member : cluster.members) {
      const int place = job.places[static_cast<size_t>(member)];
      if (place >= 0) members.emplace_back(job.band, place);
    }
    IdentifiedMode mode =
        MakeMode(record_, job.level.scales, job.level.step, cluster,
                 band.max_order, /*window_seconds=*/0.0);
    modes_.MarkHarmonic(job.level, cluster.mean, &mode);
    if (mode.damping_ratio <= 0.0 && !mode.is_harmonic) continue;
    AddMembersOfLowerRates(job.band, &mode, &members);
    modes_.Add({std::move(mode), job.band, std::move(members),
                cluster.frequency_sigma});
  }
}

// Adds the poles of lower rates near the mode. Counts orders at the rate that
// sees it most often.
void DecaySearch::AddMembersOfLowerRates(
    int band, IdentifiedMode* mode,
    std::vector<std::pair<int, int>>* members) const {
  const double tolerance = options_.frequency_tolerance;
  for (int b = band + 1; b < static_cast<int>(result_.bands.size()); ++b) {
    const AnalysedBand& other = result_.bands[static_cast<size_t>(b)];
    std::map<int, int> by_order;
    for (size_t i = 0; i < other.poles.size(); ++i) {
      const DiagramPole& pole = other.poles[i];
      if (std::abs(pole.frequency_hz / mode->frequency_hz - 1.0) <= tolerance &&
          std::abs(pole.damping_ratio - mode->damping_ratio) <=
              tolerance + mode->damping_ratio) {
        by_order.insert({pole.order, static_cast<int>(i)});
      }
    }
    for (const auto& [order, place] : by_order) {
      members->emplace_back(b, place);
    }
    const int seen = static_cast<int>(by_order.size());
    if (seen <= mode->orders_seen) continue;
    mode->orders_seen = seen;
    mode->orders_possible = (other.max_order - by_order.begin()->first) / 2 + 1;
  }
}

// Returns true for modes within the limits. Names the others.
bool DecaySearch::IsListed(const PoleCluster& cluster) {
  const double hz = cluster.mean.frequency();
  const double ratio = cluster.mean.damping_ratio();
  if (ratio > options_.largest_damping_ratio) {
    result_.remarks.push_back(
        "A vibration at " + FormatNumber(hz, 4) + " Hz has a damping of " +
        FormatNumber(100.0 * ratio, 3) + " +- " +
        FormatNumber(100.0 * cluster.damping_sigma, 2) +
        " %, more than max_damping_ratio = " +
        FormatNumber(options_.largest_damping_ratio, 3) +
        ", and is not listed. Increase max_damping_ratio in [modes] to list "
        "it.");
    return false;
  }
  return ratio + 2.0 * cluster.damping_sigma > 0.0 &&
         cluster.frequency_sigma <= kLargestDecaySigma * hz;
}

void DecaySearch::RemarkOnRest(const Vector& rest) {
  for (Eigen::Index c = 0; c < rest.size(); ++c) {
    if (rest[c] < kLargestRest) continue;
    result_.remarks.push_back("Channel '" +
                              record_.channels[static_cast<size_t>(c)].name +
                              "': decaying vibrations do not explain " +
                              FormatNumber(100.0 * rest[c], 2) +
                              " % of it. Check whether a load still acts, or "
                              "whether the damping depends on the amplitude.");
  }
}

}  // namespace pinode
