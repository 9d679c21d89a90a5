#include "pinode/problem/ambient_record.h"

#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/problem/ambient_spectrum.h"
#include "pinode/record/channel_faults.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

// Largest number of correlated areas. The number of their covariances is half
// its square at each knot.
constexpr Eigen::Index kMostCorrelatedAreas = 40;
// Largest remainder of the squared correlation of two channels that are equal
// but for a factor and rounding.
constexpr double kCopy = 1e-10;
// Fewest cycles of the model's lowest mode in the band. In shorter records
// spectral lines are not independent.
constexpr double kFewestCyclesOfMode = 20.0;
// Smallest share of the record that all channels must have in common.
constexpr double kLeastInCommon = 0.5;

bool IsLoad(InputSpec::Kind kind) {
  return kind == InputSpec::Kind::kForce ||
         kind == InputSpec::Kind::kGroundAcceleration;
}

// Returns an empty text if the inputs are valid.
std::string WhatIsWrongWithInputs(const AmbientRecord& record,
                                  const StructuralDynamics& dynamics) {
  if (!record.inputs.has_value()) {
    return dynamics.CovariateParameters().empty()
               ? ""
               : "a group follows a covariate, which it does not have";
  }
  const Excitation& measured = *record.inputs;
  if (measured.num_inputs() != dynamics.num_inputs() ||
      measured.num_samples() != record.samples.cols() ||
      measured.step() != record.sampling_step ||
      !measured.samples().allFinite()) {
    return "its measured inputs need a finite row for each input of the model, "
           "with the samples of its channels";
  }
  if (record.HasMeasuredLoads(dynamics) &&
      !record.AveragedDynamics(dynamics).IsLinear()) {
    return "measured loads need a linear model with constant matrices, but "
           "this one has laws, networks or unknown scales; leave out these or "
           "the loads";
  }
  return {};
}

}  // namespace

Matrix AmbientRecord::MeasuredLoads(const StructuralDynamics& dynamics) const {
  if (!inputs.has_value()) return {};
  const Matrix& all = inputs->samples();
  std::vector<int> rows;
  for (Eigen::Index i = 0; i < all.rows(); ++i) {
    if (IsLoad(dynamics.inputs()[static_cast<size_t>(i)].kind) &&
        all.row(i).maxCoeff() > all.row(i).minCoeff()) {
      rows.push_back(static_cast<int>(i));
    }
  }
  return all(rows, Eigen::all);
}

StructuralDynamics AmbientRecord::AveragedDynamics(
    const StructuralDynamics& dynamics) const {
  // No group follows a covariate.
  if (dynamics.IsLinear()) return dynamics;
  // Gaps have no part in the record's lines.
  std::vector<Eigen::Index> present;
  double middle = 0.0;
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    if (samples.col(i).array().isNaN().any()) continue;
    present.push_back(i);
    middle += static_cast<double>(i);
  }
  middle *= sampling_step / std::max(1.0, static_cast<double>(present.size()));
  if (!inputs.has_value() || present.empty()) {
    return dynamics.Averaged({Matrix::Zero(dynamics.num_inputs(), 1), middle});
  }
  return dynamics.Averaged(
      {inputs->samples()(Eigen::all, present), inputs->start_time() + middle});
}

double AmbientRecord::LowestModeInBand(
    const StructuralDynamics& dynamics) const {
  const StructuralModel model =
      AveragedDynamics(dynamics).CorrectedModel(dynamics.Parameters());
  const double highest =
      highest_frequency > 0.0 ? highest_frequency : 0.5 / sampling_step;
  ModalProperties modes;
  std::string ignored;
  if (!ComputeModes(model.mass, model.damping, model.stiffness, &modes,
                    &ignored)) {
    return 0.0;
  }
  for (const double f : modes.frequency_hz) {
    if (f > 0.0 && f >= lowest_frequency && f <= highest) return f;
  }
  return 0.0;
}

bool AmbientRecord::IsValid(const StructuralDynamics& dynamics,
                            std::string* error) const {
  const Eigen::Index dofs = dynamics.num_dofs();
  const auto fail = [&](const std::string& what) {
    *error = "ambient record '" + name + "': " + what;
    return false;
  };
  if (!(sampling_step > 0.0) || !std::isfinite(sampling_step)) {
    return fail("its sampling step must be positive");
  }
  if (channels.empty() ||
      samples.rows() != static_cast<Eigen::Index>(channels.size())) {
    return fail("it needs a row of samples for each of its channels");
  }
  if (samples.cols() < 200) {
    return fail("it has " + std::to_string(samples.cols()) +
                " samples, expected 200 and more");
  }
  for (size_t c = 0; c < channels.size(); ++c) {
    const Observation& channel = channels[c];
    const std::string where = "channel '" + channel.name + "' ";
    if (channel.quantity == Quantity::kForce ||
        channel.quantity == Quantity::kAbsoluteDisplacement) {
      return fail(where + "is a " + QuantityName(channel.quantity) +
                  ", expected a displacement, velocity, acceleration or "
                  "strain");
    }
    if (channel.weights.size() != dofs || !channel.weights.allFinite() ||
        channel.weights.isZero(0.0)) {
      return fail(where + "needs a finite weight for each DOF, not all zero");
    }
    const Vector values = samples.row(static_cast<Eigen::Index>(c));
    const std::string useless = WhyChannelIsUseless(values);
    if (!useless.empty()) return fail(where + useless);
    if (10 * CountPresent(values) < 9 * values.size()) {
      return fail(where + "lacks more than a tenth of its samples");
    }
    for (size_t other = 0; other < c; ++other) {
      const double correlation = CorrelationOfPresent(
          values, samples.row(static_cast<Eigen::Index>(other)));
      if (1.0 - correlation * correlation < kCopy) {
        return fail(where + "is channel '" + channels[other].name +
                    "' again; leave one of the two out");
      }
    }
  }
  const std::string wrong = WhatIsWrongWithInputs(*this, dynamics);
  if (!wrong.empty()) return fail(wrong);
  const double in_common = ShareOutsideGaps(samples);
  if (in_common < kLeastInCommon) {
    return fail("its channels have gaps at different times. Only " +
                FormatNumber(100.0 * in_common, 2) +
                " % of the record is free of gaps, expected " +
                FormatNumber(100.0 * kLeastInCommon, 2) +
                " % and more. Leave out the channels with most gaps");
  }
  if (loads.size() > 0 &&
      (loads.rows() != dofs || !loads.allFinite() ||
       (loads.colwise().squaredNorm().array() <= 0.0).any() ||
       static_cast<Eigen::Index>(areas.size()) != loads.cols())) {
    return fail("its loads need a finite number for each DOF, and a name each");
  }
  if (base.size() > 0 &&
      (base.rows() != dofs || !base.allFinite() ||
       (base.colwise().squaredNorm().array() <= 0.0).any())) {
    return fail("motions of its base need a finite number for each DOF");
  }
  const Eigen::Index given = loads.cols() + base.cols();
  const Eigen::Index areas_of_all =
      given > 0 ? given : static_cast<Eigen::Index>(channels.size());
  if (correlated && areas_of_all > kMostCorrelatedAreas) {
    return fail("its " + std::to_string(areas_of_all) +
                " loads have too many covariances, expected " +
                std::to_string(kMostCorrelatedAreas) +
                " loads at most, or such that are not correlated");
  }
  if (knots < 0) return fail("its number of knots must not be negative");
  const Eigen::Index per_knot =
      correlated ? areas_of_all * (areas_of_all + 1) / 2 : areas_of_all;
  if (knots > kMostLoadUnknowns / per_knot) {
    return fail(
        "a spectrum of " + std::to_string(knots) + " knots with " +
        std::to_string(per_knot) + " numbers each is too fine, expected " +
        std::to_string(kMostLoadUnknowns / per_knot) + " knots at most");
  }
  const double nyquist = 0.5 / sampling_step;
  if (!(lowest_frequency >= 0.0) || !(highest_frequency >= 0.0) ||
      highest_frequency > nyquist ||
      (highest_frequency > 0.0 && lowest_frequency >= highest_frequency)) {
    return fail("its band must lie between zero and half the sampling rate");
  }
  if (!dynamics.prescribed().empty()) {
    return fail(
        "the model has prescribed motions, but the record does not have them");
  }
  const double cycles = LowestModeInBand(dynamics) *
                        static_cast<double>(samples.cols()) * sampling_step;
  if (cycles > 0.0 && cycles < kFewestCyclesOfMode) {
    return fail("it holds " + FormatNumber(cycles, 3) +
                " cycles of the model's lowest mode in the band, expected " +
                FormatNumber(kFewestCyclesOfMode, 3) + " and more");
  }
  return true;
}

}  // namespace pinode
