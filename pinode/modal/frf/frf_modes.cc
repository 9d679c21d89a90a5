#include "pinode/modal/frf/frf_modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/modal/frf/frf_moments.h"
#include "pinode/modal/frf/frf_search.h"
#include "pinode/modal/mode_estimate.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr int kMaxOrder = 60;
// Lines for each order at least, and in all.
constexpr double kLinesOfOrder = 3.0;
constexpr Index kFewestLines = 20;
// Degrees of freedom above which a t distribution is normal.
constexpr Index kMostDegrees = 1000;
// Deviations from zero from which the sign of a modal mass is clear, and of a
// 95 % interval.
constexpr double kClearSign = 3.0;
constexpr double kHalfWidth = 1.96;

// FRFs of a band, with the larger set of places as outputs.
struct FrfSelection {
  FrfData data;
  Index first_line = 0;
  bool exchanged = false;  // outputs are the references
};

bool Select(const FrequencyResponses& all, double lowest_hz, double highest_hz,
            FrfSelection* selection, std::string* error) {
  Index first = 0;
  Index last = all.num_lines();
  while (first < last && (all.frequencies_hz[first] < lowest_hz ||
                          all.frequencies_hz[first] <= 0.0)) {
    ++first;
  }
  while (last > first && highest_hz > 0.0 &&
         all.frequencies_hz[last - 1] > highest_hz) {
    --last;
  }
  const Index lines = last - first;
  if (lines < kFewestLines) {
    *error = "'" + all.name + "' has " + std::to_string(lines) +
             " lines in the band, expected at least " +
             std::to_string(kFewestLines) +
             "; widen lowest_hz and highest_hz, or measure at more lines";
    return false;
  }
  FrfData& data = selection->data;
  selection->first_line = first;
  selection->exchanged = all.num_references() > all.num_responses();
  data.outputs =
      selection->exchanged ? all.num_references() : all.num_responses();
  data.references =
      selection->exchanged ? all.num_responses() : all.num_references();
  data.derivative = all.derivative;
  data.decay_rate = all.decay_rate;
  data.angular = kTwoPi * all.frequencies_hz.segment(first, lines);
  data.h.resize(lines, all.values.cols());
  if (all.variances.rows() > 0) data.variances.resize(lines, data.h.cols());
  for (Index o = 0; o < data.outputs; ++o) {
    for (Index j = 0; j < data.references; ++j) {
      const Index pair = selection->exchanged ? all.Pair(j, o) : all.Pair(o, j);
      const Index to = o + data.outputs * j;
      data.h.col(to) = all.values.col(pair).segment(first, lines);
      if (all.variances.rows() > 0) {
        data.variances.col(to) = all.variances.col(pair).segment(first, lines);
      }
    }
  }
  for (Index o = 0; o < data.h.cols(); ++o) {
    if (data.h.col(o).norm() > 0.0) continue;
    *error = "'" + all.name +
             "' has a frequency response function that is zero at all lines; "
             "leave its place out";
    return false;
  }
  return true;
}

// Turns the covariance of Re s, Im s and the shape into influences. Their
// number is that of the degrees of freedom.
void SetInfluences(const Matrix& covariance, Index degrees,
                   SubspacePole* pole) {
  const Index outputs = pole->shape.size();
  const Vector scale =
      covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(
      scale.asDiagonal() * covariance * scale.asDiagonal());
  const Index own = covariance.cols();
  const Index count = std::max(degrees, own);
  const Matrix root =
      std::sqrt(static_cast<double>(count)) *
      (scale.cwiseInverse().asDiagonal() * solver.eigenvectors() *
       solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal());
  pole->s_influence = ComplexVector::Zero(count);
  pole->shape_influence = ComplexMatrix::Zero(outputs, count);
  for (Index j = 0; j < own; ++j) {
    pole->s_influence[j] = {root(0, j), root(1, j)};
    for (Index o = 0; o < outputs; ++o) {
      pole->shape_influence(o, j) = {root(2 + 2 * o, j), root(3 + 2 * o, j)};
    }
  }
}

class FrfModesFinder {
 public:
  FrfModesFinder(const FrequencyResponses& all, const FrfModesOptions& options,
                 ModesOfFrfs* result, std::string* error)
      : all_(all), options_(options), result_(*result), error_(error) {}

  bool Find() {
    const ModeIdentificationOptions& options = options_.identification;
    if (!Select(all_, options.lowest_hz, options.highest_hz, &selection_,
                error_)) {
      return false;
    }
    const FrfData& data = selection_.data;
    MakeBand();
    const std::vector<FrfCandidate> candidates =
        FindFrfCandidates(data, options, &band_);
    result_.places = selection_.exchanged ? all_.references : all_.responses;
    FrfModel model(data, options.num_threads);
    FrfSearchResult search;
    if (!candidates.empty()) {
      search =
          FitFrfCandidates(candidates, band_, options.stabilisation, &model);
    }
    std::vector<FrfMoments> moments = MomentsOf(model, search.fit);
    if (options_.poles_per_file && !moments.empty()) {
      if (!FitEachFile(model, &search, &moments)) return false;
    }
    TakeModes(candidates, search.kept, moments, model.unknowns_of_mode());
    TakeSynthesis(search.fit.residuals);
    result_.record.bands = {band_};
    return true;
  }

 private:
  void MakeBand() {
    const FrfData& data = selection_.data;
    const Index lines = data.num_lines();
    band_.lowest_hz = data.angular[0] / kTwoPi;
    band_.highest_hz = data.angular[lines - 1] / kTwoPi;
    band_.sampling_step = 0.5 / band_.highest_hz;
    band_.max_order = options_.identification.max_order;
    if (band_.max_order == 0) {
      const int most =
          static_cast<int>(static_cast<double>(lines) / kLinesOfOrder / 2.0) *
          2;
      band_.max_order = std::clamp(most, 2, kMaxOrder);
    }
  }

  // Returns true if a stronger mode is nearer than the decay rates of both.
  // Poles that all files share need several of them for one that drifts.
  static bool IsCopy(const FrfModel& model, const FrfFit& fit, size_t m) {
    const double gain = model.GainOf(fit, m);
    for (size_t other = 0; other < fit.modes.size(); ++other) {
      const Complex apart = fit.modes[other].s - fit.modes[m].s;
      const double decays = -fit.modes[other].s.real() - fit.modes[m].s.real();
      if (other != m && std::abs(apart.imag()) < decays &&
          model.GainOf(fit, other) > gain) {
        return true;
      }
    }
    return false;
  }

  // Replaces moments and residuals by those of fits with poles of each file.
  bool FitEachFile(const FrfModel& model, FrfSearchResult* search,
                   std::vector<FrfMoments>* moments) {
    const FrfData& data = selection_.data;
    if (data.references > 1) {
      *error_ = "'" + all_.name +
                "' has several references and several responses: poles of each "
                "file need files with one reference or one response in all; "
                "use common poles";
      return false;
    }
    std::vector<FrfMode> common;
    std::vector<size_t> kept;
    for (size_t m = 0; m < moments->size(); ++m) {
      if (IsCopy(model, search->fit, m)) continue;
      common.push_back((*moments)[m].mode);
      kept.push_back(search->kept[m]);
    }
    search->kept = kept;
    std::vector<std::complex<double>> drift;
    *moments = FitPolesPerFile(
        data, common, all_.files, search->complex_residuals,
        options_.identification.num_threads, &search->fit.residuals, &drift);
    std::vector<std::string> texts;
    for (size_t m = 0; m < drift.size(); ++m) {
      texts.push_back(FormatNumber(drift[m].imag() / kTwoPi, 2) + " Hz at " +
                      FormatNumber((*moments)[m].mode.s.imag() / kTwoPi, 5) +
                      " Hz");
    }
    result_.record.remarks.push_back(
        "Each file has poles of its own. Standard deviation between the files, "
        "which the intervals hold: " +
        Join(texts, ", ") + ".");
    return true;
  }

  void TakeModes(const std::vector<FrfCandidate>& candidates,
                 const std::vector<size_t>& kept,
                 const std::vector<FrfMoments>& moments, Index per_mode) {
    const FrfData& data = selection_.data;
    const Index count = static_cast<Index>(moments.size());
    const Index degrees =
        std::min(kMostDegrees, 2 * data.num_lines() * data.h.cols() -
                                   count * (per_mode + 2 * data.outputs));
    ResponseRecord record;
    for (const std::string& place : result_.places) {
      record.channels.push_back({place, 0});
    }
    std::vector<size_t> order(moments.size());
    for (size_t m = 0; m < order.size(); ++m) order[m] = m;
    std::sort(order.begin(), order.end(), [&moments](size_t a, size_t b) {
      return std::abs(moments[a].mode.s) < std::abs(moments[b].mode.s);
    });
    for (const size_t m : order) {
      const FrfCandidate& candidate = candidates[kept[m]];
      PoleCluster cluster = candidate.cluster;
      SubspacePole& pole = cluster.mean;
      pole.s = moments[m].mode.s + data.decay_rate;
      pole.shape = moments[m].shape;
      const Index width = 2 + 2 * data.outputs;
      SetInfluences(moments[m].covariance.topLeftCorner(width, width), degrees,
                    &pole);
      pole.shape.cwiseAbs().maxCoeff(&cluster.reference);
      const int number = static_cast<int>(result_.record.modes.size());
      for (const int place : candidate.places) {
        band_.poles[static_cast<size_t>(place)].mode = number;
      }
      result_.record.modes.push_back(
          MakeMode(record, Vector::Ones(data.outputs), band_.sampling_step,
                   cluster, band_.max_order, /*window_seconds=*/0.0));
      SayHiddenDamping(&result_.record.modes.back());
      result_.scales.push_back(ScaleOfMode(moments[m]));
    }
    CheckDrivingPoint();
  }

  // The decay of a window may exceed that of a mode with it, by noise.
  void SayHiddenDamping(IdentifiedMode* mode) {
    if (mode->damping_ratio > 0.0) return;
    // The lower end is 0 otherwise, above the value.
    mode->damping_lower95 = 2.0 * mode->damping_ratio - mode->damping_upper95;
    if (!(all_.decay_rate > 0.0)) return;
    result_.record.remarks.push_back("The window hides the damping at " +
                                     FormatNumber(mode->frequency_hz, 4) +
                                     " Hz: set a longer exponential_window.");
  }

  // Returns the driving point as output and reference, the one at which most
  // moves; -1: none.
  std::pair<Index, Index> DrivingPoint(const FrfMoments& moments) const {
    const FrfData& data = selection_.data;
    std::pair<Index, Index> best = {-1, -1};
    double largest = 0.0;
    const std::vector<std::string>& inputs =
        selection_.exchanged ? all_.responses : all_.references;
    for (Index o = 0; o < data.outputs; ++o) {
      for (Index j = 0; j < data.references; ++j) {
        if (result_.places[static_cast<size_t>(o)] !=
            inputs[static_cast<size_t>(j)]) {
          continue;
        }
        const double size =
            std::abs(moments.shape[o] * moments.mode.participation[j]);
        if (size > largest) best = {o, j};
        largest = std::max(largest, size);
      }
    }
    return best;
  }

  FrfModeScale ScaleOfMode(const FrfMoments& moments) const {
    const FrfData& data = selection_.data;
    FrfModeScale scale;
    scale.residues.resize(all_.num_responses(), all_.num_references());
    scale.sigma_real.resize(all_.num_responses(), all_.num_references());
    scale.sigma_imaginary = scale.sigma_real;
    for (Index o = 0; o < data.outputs; ++o) {
      for (Index j = 0; j < data.references; ++j) {
        const FrfResidue residue = ResidueOf(moments, o, j);
        const Index row = selection_.exchanged ? j : o;
        const Index column = selection_.exchanged ? o : j;
        scale.residues(row, column) = residue.value;
        scale.sigma_real(row, column) = residue.sigma_real;
        scale.sigma_imaginary(row, column) = residue.sigma_imaginary;
      }
    }
    const auto [o, j] = DrivingPoint(moments);
    if (o < 0) return scale;
    const FrfScale own = ScaleOf(moments, o, j);
    scale.modal_a = own.modal_a;
    scale.modal_mass = own.mass;
    scale.modal_mass_sigma = own.mass_sigma;
    return scale;
  }

  // A driving point moves with its force: modal masses are positive.
  void CheckDrivingPoint() {
    std::vector<FrfModeScale>& scales = result_.scales;
    if (scales.empty()) return;
    if (!std::isfinite(scales.front().modal_mass)) {
      result_.record.remarks.push_back(
          "No response is at the place of a force: the modes are not scaled. "
          "Measure a driving point, or give both the same name, for modal "
          "masses.");
      return;
    }
    int negative = 0;
    int positive = 0;
    for (const FrfModeScale& scale : scales) {
      if (std::abs(scale.modal_mass) < kClearSign * scale.modal_mass_sigma) {
        continue;
      }
      ++(scale.modal_mass < 0.0 ? negative : positive);
    }
    const bool reversed = negative > positive;
    if (reversed) {
      for (FrfModeScale& scale : scales) {
        scale.modal_a = -scale.modal_a;
        scale.modal_mass = -scale.modal_mass;
      }
      result_.record.remarks.push_back(
          "The driving point moves against its force: sensor and hammer point "
          "in opposite directions. Modal masses are given with the other "
          "sign. Put a minus sign before one of the two places.");
    } else if (negative > 0) {
      result_.record.remarks.push_back(
          "The modal mass of " + std::to_string(negative) +
          (negative == 1 ? " mode is" : " modes are") +
          " negative: look at the driving point, and at the synthesis in the "
          "report.");
    }
    std::vector<std::string> texts;
    for (size_t m = 0; m < scales.size(); ++m) {
      texts.push_back(FormatNumber(scales[m].modal_mass, 4) + " +- " +
                      FormatNumber(kHalfWidth * scales[m].modal_mass_sigma, 2));
    }
    result_.record.remarks.push_back(
        "Modal masses, for shapes with the largest entry 1: " +
        Join(texts, ", ") + ".");
  }

  // `residuals`: lines x outputs and references.
  void TakeSynthesis(const ComplexMatrix& residuals) {
    const FrfData& data = selection_.data;
    const Index lines = data.num_lines();
    result_.frequencies_hz =
        all_.frequencies_hz.segment(selection_.first_line, lines);
    result_.measured = all_.values.middleRows(selection_.first_line, lines);
    for (const std::string& reference : all_.references) {
      for (const std::string& response : all_.responses) {
        result_.pair_names.push_back(response + "/" + reference);
      }
    }
    result_.num_responses = all_.num_responses();
    if (all_.coherence.rows() > 0) {
      result_.coherence =
          all_.coherence.middleRows(selection_.first_line, lines);
    }
    result_.synthesised = ComplexMatrix::Zero(lines, data.h.cols());
    result_.errors = Vector::Ones(data.h.cols());
    if (residuals.size() == 0) return;
    for (Index o = 0; o < data.outputs; ++o) {
      for (Index j = 0; j < data.references; ++j) {
        const Index from = o + data.outputs * j;
        const Index pair =
            selection_.exchanged ? all_.Pair(j, o) : all_.Pair(o, j);
        result_.synthesised.col(pair) = data.h.col(from) - residuals.col(from);
        result_.errors[pair] =
            residuals.col(from).norm() / data.h.col(from).norm();
      }
    }
  }

  const FrequencyResponses& all_;
  const FrfModesOptions& options_;
  ModesOfFrfs& result_;
  std::string* error_;
  FrfSelection selection_;
  AnalysedBand band_;
};

}  // namespace

bool FindFrfModes(const FrequencyResponses& responses,
                  const FrfModesOptions& options, ModesOfFrfs* result,
                  std::string* error) {
  *result = ModesOfFrfs();
  return FrfModesFinder(responses, options, result, error).Find();
}

}  // namespace pinode
