#include "pinode/estimate/fit/ambient_start.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <utility>

#include "pinode/modal/identify_modes.h"

namespace pinode {
namespace {

// Limits within which a mode agrees with the model: its shape's MAC, and the
// logarithm of the ratio of frequencies.
constexpr double kSmallestMac = 0.7;
constexpr double kLargestRatio = 0.5;
// Smallest deviations of a start, as fractions.
constexpr double kFrequencySigma = 0.003;
constexpr double kShapeSigma = 0.05;
// Limits of the samples that a start uses of a record: their number, and cycles
// of the model's lowest mode.
constexpr double kSamplesOfStart = 65536.0;
constexpr double kCyclesOfStart = 1000.0;

int DerivativeOfQuantity(Quantity quantity) {
  switch (quantity) {
    case Quantity::kVelocity:
      return 1;
    case Quantity::kRelativeAcceleration:
    case Quantity::kAbsoluteAcceleration:
      return 2;
    default:
      return 0;
  }
}

// Turns the shape by the angle that leaves the least in the imaginary parts.
Vector RealShape(const Eigen::VectorXcd& shape) {
  const std::complex<double> square = shape.transpose() * shape;
  return (std::polar(1.0, -0.5 * std::arg(square)) * shape).real();
}

// Stretch of a record: its first sample and length. Among all consecutive parts
// of that length it has the fewest missing samples.
struct Stretch {
  Eigen::Index first = 0;
  Eigen::Index size = 0;
};
Stretch StretchForStart(const AmbientRecord& record,
                        const StructuralDynamics& dynamics) {
  const double samples_per_second = 1.0 / record.sampling_step;
  const double lowest = record.LowestModeInBand(dynamics);
  const double wanted = std::max(
      kSamplesOfStart,
      lowest > 0.0 ? kCyclesOfStart / lowest * samples_per_second : 0.0);
  const Eigen::Index all = record.samples.cols();
  if (wanted >= static_cast<double>(all)) return {0, all};
  Stretch best{0, static_cast<Eigen::Index>(wanted)};
  Eigen::Index fewest_missing = record.samples.size();
  for (Eigen::Index first = 0; first + best.size <= all; first += best.size) {
    const Eigen::Index missing =
        record.samples.middleCols(first, best.size).array().isNaN().count();
    if (missing < fewest_missing) {
      fewest_missing = missing;
      best.first = first;
    }
  }
  return best;
}

// Adds the modes of one record, at the DOFs that a single channel measures.
void AddModes(const IdentificationProblem& problem, const AmbientRecord& record,
              int num_threads, ModalData* modal) {
  ResponseRecord response;
  response.name = record.name;
  response.sampling_step = record.sampling_step;
  std::vector<int> rows;
  for (size_t c = 0; c < record.channels.size(); ++c) {
    if ((record.channels[c].weights.array() != 0.0).count() == 1) {
      rows.push_back(static_cast<int>(c));
    }
  }
  if (rows.empty()) return;
  const Stretch stretch = StretchForStart(record, *problem.dynamics);
  response.samples.resize(static_cast<Eigen::Index>(rows.size()), stretch.size);
  std::vector<int> dofs;
  Vector scales(static_cast<Eigen::Index>(rows.size()));
  for (size_t i = 0; i < rows.size(); ++i) {
    const Observation& channel = record.channels[static_cast<size_t>(rows[i])];
    response.channels.push_back(
        {std::to_string(i), DerivativeOfQuantity(channel.quantity)});
    response.samples.row(static_cast<Eigen::Index>(i)) =
        record.samples.row(rows[i]).segment(stretch.first, stretch.size);
    Eigen::Index dof = 0;
    channel.weights.cwiseAbs().maxCoeff(&dof);
    dofs.push_back(static_cast<int>(dof));
    scales[static_cast<Eigen::Index>(i)] = channel.weights[dof];
  }
  const Matrix loads = record.MeasuredLoads(*problem.dynamics);
  if (loads.rows() > 0) {
    response.inputs = loads.middleCols(stretch.first, stretch.size);
  }
  ModeIdentificationOptions options;
  options.lowest_hz = record.lowest_frequency;
  options.highest_hz = record.highest_frequency;
  options.num_threads = num_threads;
  ModesOfRecord found;
  std::string ignored;
  if (!IdentifyModes(response, options, &found, &ignored)) return;
  for (const IdentifiedMode& mode : found.modes) {
    if (static_cast<int>(modal->modes.size()) == problem.dynamics->num_dofs()) {
      return;
    }
    MeasuredMode measured;
    measured.name = std::to_string(modal->modes.size() + 1);
    measured.frequency = mode.frequency_hz;
    measured.frequency_sigma =
        std::max(mode.frequency_sigma, kFrequencySigma * mode.frequency_hz);
    if (dofs.size() > 1) {
      measured.dofs = dofs;
      measured.shape = RealShape(mode.shape).cwiseQuotient(scales);
      measured.shape_sigma = kShapeSigma * measured.shape.cwiseAbs().maxCoeff();
    }
    modal->modes.push_back(std::move(measured));
  }
}

// Returns the dynamics for a record. Groups that follow a covariate have their
// initial values: one record does not distinguish them from constant groups.
std::shared_ptr<const StructuralDynamics> SeenBy(
    const AmbientRecord& record, const StructuralDynamics& dynamics) {
  std::vector<std::string> names = dynamics.CovariateParameters();
  for (const GroupTerm& term : dynamics.groups()) {
    if (term.follows == GroupTerm::Follows::kTime) {
      names.push_back(term.group.name);
    }
  }
  return std::make_shared<const StructuralDynamics>(record.AveragedDynamics(
      dynamics.WithGroupParameters([&names](Parameter* parameter) {
        if (std::count(names.begin(), names.end(), parameter->name) > 0) {
          parameter->free = false;
        }
      })));
}

// Returns the modes that the model has as well.
ModalData KnownToModel(const IdentificationProblem& problem,
                       const ModalData& modal) {
  ModalData kept;
  kept.form = modal.form;
  std::vector<ModeMatch> matches;
  std::string ignored;
  const StructuralDynamics& dynamics = *problem.dynamics;
  const StructuralModel model = dynamics.CorrectedModel(dynamics.Parameters());
  const ModalData paired = OnlyModes(modal, HavePartners(modal, model));
  if (modal.empty() || !MatchModes(paired, model, &matches, &ignored)) {
    return kept;
  }
  for (size_t i = 0; i < matches.size(); ++i) {
    const MeasuredMode& mode = paired.modes[i];
    if (std::abs(std::log(matches[i].frequency / mode.frequency)) <
            kLargestRatio &&
        (!mode.HasShape() || matches[i].mac > kSmallestMac)) {
      kept.modes.push_back(mode);
    }
  }
  return kept;
}

}  // namespace

bool ModesOfAmbientRecord(const IdentificationProblem& problem, int num_threads,
                          IdentificationProblem* modes_alone) {
  if (problem.ambient.empty() || problem.num_train_records() > 0 ||
      !problem.modal.empty() || !problem.frfs.empty()) {
    return false;
  }
  ModalData modal;
  AddModes(problem, problem.ambient.front(), num_threads, &modal);
  // Leaves out the records, to avoid a copy.
  modes_alone->dynamics = SeenBy(problem.ambient.front(), *problem.dynamics);
  modes_alone->sensors = problem.sensors;
  modes_alone->description = problem.description;
  modes_alone->modal = KnownToModel(*modes_alone, modal);
  return !modes_alone->modal.empty();
}

}  // namespace pinode
