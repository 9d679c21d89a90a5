#include "pinode/study/sensors/sensor_information.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "pinode/dynamics/observation.h"
#include "pinode/estimate/certainty/assessment.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/shooting/linear_record.h"
#include "pinode/estimate/shooting/residual_rows.h"
#include "pinode/estimate/start/free_run_start.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/record_grid.h"

namespace pinode {
namespace {

constexpr double kAssumedShare = 0.05;
// Rounding error relative to the largest response of a quantity.
constexpr double kRounding = 1e-9;
// Largest number of entries of Jacobians, or of channels' matrices, in memory
// at a time.
constexpr double kMostNumbers = 3e6;

// J'J and RMS of channels, at noise one.
struct ChannelInformation {
  std::vector<Matrix> products;
  Vector rms;
};

// Runs one record, with as many channels at once as memory allows.
class RecordLinearizer {
 public:
  RecordLinearizer(const IdentificationProblem& problem,
                   const IdentificationOptions& options, int record)
      : problem_(problem),
        layout_(problem),
        options_(options),
        record_(record),
        data_(problem.records[static_cast<size_t>(record)]),
        grid_(GridOf(*problem.dynamics, data_)),
        parameters_(layout_.InitialValues()) {}

  bool StartIsUnknown() const {
    return data_.start == IdentificationRecord::Start::kFree &&
           data_.start_samples == 0;
  }

  [[nodiscard]] bool Prepare(std::string* error) {
    const StructuralDynamics& dynamics = *problem_.dynamics;
    if (!dynamics.Prepare(parameters_.head(layout_.num_dynamics()), &prepared_,
                          error)) {
      return false;
    }
    start_ = Vector::Zero(dynamics.num_states());
    if (data_.start == IdentificationRecord::Start::kKnown) {
      start_ = data_.known_start;
    } else if (data_.excitation->periodic() &&
               !FindSteadyState(problem_, record_, parameters_, &start_)) {
      *error = "record '" + data_.name + "' has no steady state";
      return false;
    }
    columns_ =
        StartIsUnknown() ? SegmentColumns::kAll : SegmentColumns::kParameters;
    return true;
  }

  // Linearises these channels, in their order.
  [[nodiscard]] bool Run(const std::vector<MeasuredChannel>& channels,
                         ChannelInformation* information, std::string* error) {
    const double columns = problem_.dynamics->num_states() + layout_.num_free();
    const bool linear = problem_.dynamics->IsLinear();
    const double each =
        columns * (linear ? columns : static_cast<double>(data_.num_samples()));
    const auto chunk =
        static_cast<size_t>(std::max(1.0, std::floor(kMostNumbers / each)));
    information->products.clear();
    information->rms.resize(static_cast<Eigen::Index>(channels.size()));
    for (size_t first = 0; first < channels.size(); first += chunk) {
      const size_t last = std::min(channels.size(), first + chunk);
      IdentificationRecord record = data_;
      record.channels.assign(
          channels.begin() + static_cast<std::ptrdiff_t>(first),
          channels.begin() + static_cast<std::ptrdiff_t>(last));
      for (MeasuredChannel& channel : record.channels) {
        channel.values = Vector::Zero(record.num_samples());
        channel.fit = true;
      }
      const ObservationMap observation(*problem_.dynamics,
                                       record.Observations());
      if (!RunByModes(record, observation, first, information) &&
          !RunBySteps(record, observation, first, information)) {
        *error = "record '" + data_.name +
                 "': no finite trajectory at the initial values";
        return false;
      }
    }
    return true;
  }

 private:
  bool RunByModes(const IdentificationRecord& record,
                  const ObservationMap& observation, size_t first,
                  ChannelInformation* information) const {
    const auto linear = LinearRecord::Create(problem_, layout_, record, grid_,
                                             observation, RobustLoss::kNone);
    if (linear == nullptr) return false;
    const auto count = static_cast<Eigen::Index>(record.channels.size());
    std::vector<Matrix> products;
    for (Eigen::Index c = 0; c < count; ++c) {
      // One channel at a time: all others get an infinite sigma. The histories
      // are summed once.
      Vector sigmas = Vector::Constant(
          count, count > 1 ? std::numeric_limits<double>::infinity() : 1.0);
      sigmas[c] = 1.0;
      LinearRecord::Equations equations;
      if (!linear->Evaluate(
              {&prepared_, &parameters_, &sigmas, start_, columns_},
              options_.num_threads, nullptr, &equations)) {
        return false;
      }
      information->rms[static_cast<Eigen::Index>(first) + c] = std::sqrt(
          2.0 * equations.cost / static_cast<double>(record.num_samples()));
      products.push_back(std::move(equations.hessian));
    }
    std::move(products.begin(), products.end(),
              std::back_inserter(information->products));
    return true;
  }

  bool RunBySteps(const IdentificationRecord& record,
                  const ObservationMap& observation, size_t first,
                  ChannelInformation* information) const {
    SegmentPropagator propagator(*problem_.dynamics, options_.derivatives);
    SegmentTangents tangents;
    ResidualRows rows(layout_, RobustLoss::kNone, 1.0);
    const auto count = static_cast<Eigen::Index>(record.channels.size());
    rows.Prepare(record, Vector::Ones(count), true,
                 problem_.dynamics->num_states(), columns_, &tangents);
    if (!propagator.Propagate(prepared_, observation, grid_, start_, 0,
                              record.num_samples() - 1, true, columns_,
                              &tangents)) {
      return false;
    }
    rows.Compute(record, Vector::Ones(count), parameters_, 0, true, columns_,
                 &tangents);
    const auto jacobian = rows.rows().jacobian();
    const auto residuals = rows.rows().residuals();
    const Eigen::Index samples = jacobian.rows() / count;
    Matrix own(samples, jacobian.cols());
    for (Eigen::Index c = 0; c < count; ++c) {
      double squares = 0.0;
      for (Eigen::Index i = 0; i < samples; ++i) {
        own.row(i) = jacobian.row(i * count + c);
        squares += std::pow(residuals[i * count + c], 2.0);
      }
      information->rms[static_cast<Eigen::Index>(first) + c] =
          std::sqrt(squares / static_cast<double>(samples));
      information->products.push_back(own.transpose() * own);
    }
    return true;
  }

  const IdentificationProblem& problem_;
  const ParameterLayout layout_;
  const IdentificationOptions& options_;
  const int record_;
  const IdentificationRecord& data_;
  const IntegrationGrid grid_;
  const Vector parameters_;
  StructuralDynamics::Prepared prepared_;
  Vector start_;
  SegmentColumns columns_ = SegmentColumns::kParameters;
};

// Computes the information of priors, modes and smoothness: the problem without
// its records.
bool KnownInformation(IdentificationProblem problem,
                      const IdentificationOptions& options, Matrix* known,
                      std::string* error) {
  problem.records.clear();
  // Modes with unknown errors weight the residuals of a fit. They do not
  // determine the errors of its result.
  if (!problem.modal.HasSigmas()) problem.modal = ModalData();
  const ParameterLayout layout(problem);
  Objective objective(problem, layout, MultipleShooting::Options());
  objective.priors().SetDecays(
      SmoothnessPrecisions(layout, options.tuning.evidence));
  CondensedSystem system;
  if (!objective.Linearize(layout.Free(layout.InitialValues()), &system)) {
    *error = objective.Failure();
    return false;
  }
  *known = system.hessian;
  return true;
}

// Checks the validity of the problem with these sensors.
bool CheckSensors(const IdentificationProblem& problem,
                  const IdentificationOptions& options,
                  const std::vector<CandidateSensor>& candidates,
                  std::string* error) {
  if (!options.IsValid(error)) return false;
  if (!problem.ambient.empty()) {
    *error =
        "sensors are planned for records of measured loads, expected no "
        "record with excitation = \"ambient\"";
    return false;
  }
  if (problem.num_train_records() == 0) {
    *error =
        "sensors are planned for a load that acts, expected a training record "
        "with one (its responses need not be measured)";
    return false;
  }
  for (const CandidateSensor& candidate : candidates) {
    if (!(candidate.sigma >= 0.0 && candidate.noise_share >= 0.0 &&
          std::isfinite(candidate.sigma + candidate.noise_share))) {
      *error = "noise of sensor '" + candidate.observation.name +
               "', expected a finite number that is not negative";
      return false;
    }
  }
  IdentificationProblem with_sensors = problem;
  for (IdentificationRecord& record : with_sensors.records) {
    for (MeasuredChannel& channel : record.channels) {
      channel.values = Vector::Zero(record.num_samples());
    }
    for (const CandidateSensor& candidate : candidates) {
      MeasuredChannel channel;
      channel.observation = candidate.observation;
      channel.values = Vector::Zero(record.num_samples());
      record.channels.push_back(std::move(channel));
    }
  }
  return with_sensors.IsValid(error);
}

// Sets values to zero that are rounding compared with others of the quantity:
// five per cent of them would not be a noise level.
void LeaveOutRounding(const IdentificationProblem& problem,
                      const std::vector<OwnSensor>& own,
                      const std::vector<CandidateSensor>& candidates,
                      PlanningInformation* information) {
  std::map<Quantity, double> largest;
  const auto visit = [&](const auto& each) {
    for (size_t i = 0; i < own.size(); ++i) {
      each(problem.records[static_cast<size_t>(own[i].record)]
               .channels[static_cast<size_t>(own[i].channel)]
               .observation.quantity,
           &information->own[i].rms);
    }
    for (size_t i = 0; i < candidates.size(); ++i) {
      each(candidates[i].observation.quantity, &information->candidates[i].rms);
    }
  };
  visit([&](Quantity quantity, const double* rms) {
    largest[quantity] = std::max(largest[quantity], *rms);
  });
  visit([&](Quantity quantity, double* rms) {
    if (*rms < kRounding * largest[quantity]) *rms = 0.0;
  });
}

// Returns the median noise of own sensors of one quantity; 0 without any.
double NoiseOfOthers(const IdentificationProblem& problem,
                     const std::vector<OwnSensor>& own,
                     const std::vector<SensorInformation>& known,
                     Quantity quantity) {
  std::vector<double> sigmas;
  for (size_t i = 0; i < own.size(); ++i) {
    const MeasuredChannel& channel =
        problem.records[static_cast<size_t>(own[i].record)]
            .channels[static_cast<size_t>(own[i].channel)];
    // Values of a gauge with several weights have another size.
    if (channel.observation.quantity == quantity && known[i].sigma > 0.0) {
      sigmas.push_back(known[i].sigma);
    }
  }
  if (sigmas.empty()) return 0.0;
  std::sort(sigmas.begin(), sigmas.end());
  const size_t half = sigmas.size() / 2;
  return sigmas.size() % 2 == 1 ? sigmas[half]
                                : 0.5 * (sigmas[half - 1] + sigmas[half]);
}

// Sets the noise of candidates that have none of their own.
void SetNoise(const IdentificationProblem& problem,
              const std::vector<OwnSensor>& own,
              const std::vector<CandidateSensor>& candidates,
              PlanningInformation* information) {
  for (size_t i = 0; i < candidates.size(); ++i) {
    SensorInformation& sensor = information->candidates[i];
    sensor.sigma = candidates[i].sigma > 0.0
                       ? candidates[i].sigma
                       : candidates[i].noise_share * sensor.rms;
  }
  for (size_t i = 0; i < candidates.size(); ++i) {
    if (information->candidates[i].sigma > 0.0) continue;
    const Quantity quantity = candidates[i].observation.quantity;
    double sigma = NoiseOfOthers(problem, own, information->own, quantity);
    if (sigma == 0.0) {
      double squares = 0.0, count = 0.0;
      for (size_t k = 0; k < candidates.size(); ++k) {
        if (candidates[k].observation.quantity != quantity) continue;
        squares += std::pow(information->candidates[k].rms, 2.0);
        count += 1.0;
      }
      sigma = kAssumedShare * std::sqrt(squares / count);
    }
    for (size_t k = i; k < candidates.size(); ++k) {
      if (candidates[k].observation.quantity == quantity &&
          information->candidates[k].sigma == 0.0) {
        information->candidates[k].sigma = sigma;
      }
    }
  }
}

// Weighs the information by the noise. A sensor with zero values gives no
// information.
void WeighByNoise(SensorInformation* sensor) {
  for (Matrix& product : sensor->by_record) {
    if (sensor->sigma > 0.0) {
      product /= sensor->sigma * sensor->sigma;
    } else {
      product.setZero();
    }
  }
}

// Linearises one training record.
bool LinearizeRecord(const IdentificationProblem& problem,
                     const IdentificationOptions& options,
                     const std::vector<OwnSensor>& own,
                     const std::vector<CandidateSensor>& candidates, int r,
                     PlanningInformation* information, std::string* error) {
  const IdentificationRecord& record = problem.records[static_cast<size_t>(r)];
  std::vector<MeasuredChannel> channels;
  std::vector<SensorInformation*> sensors;
  for (size_t i = 0; i < own.size(); ++i) {
    information->own[i].by_record.emplace_back();
    if (own[i].record != r) continue;
    channels.push_back(record.channels[static_cast<size_t>(own[i].channel)]);
    sensors.push_back(&information->own[i]);
  }
  const size_t first_candidate = channels.size();
  for (size_t i = 0; i < candidates.size(); ++i) {
    channels.emplace_back();
    channels.back().observation = candidates[i].observation;
    sensors.push_back(&information->candidates[i]);
    sensors.back()->by_record.emplace_back();
  }
  RecordLinearizer linearizer(problem, options, r);
  information->num_starts.push_back(
      linearizer.StartIsUnknown() ? problem.dynamics->num_states() : 0);
  ChannelInformation found;
  if (!linearizer.Prepare(error) || !linearizer.Run(channels, &found, error)) {
    return false;
  }
  if (found.rms.size() > 0 && found.rms.isZero(0.0)) {
    *error = "nothing moves in record '" + record.name +
             "' at the initial values, expected a load or a known start";
    return false;
  }
  const double records = problem.num_train_records();
  for (size_t i = 0; i < sensors.size(); ++i) {
    const double rms = found.rms[static_cast<Eigen::Index>(i)];
    sensors[i]->rms =
        i < first_candidate
            ? rms
            : std::hypot(sensors[i]->rms, rms / std::sqrt(records));
    sensors[i]->by_record.back() = std::move(found.products[i]);
  }
  return true;
}

}  // namespace

std::vector<OwnSensor> OwnSensors(const IdentificationProblem& problem) {
  std::vector<OwnSensor> own;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (size_t c = 0; c < record.channels.size(); ++c) {
      if (record.channels[c].fit) {
        own.push_back({static_cast<int>(r), static_cast<int>(c), 0.0});
      }
    }
  }
  return own;
}

bool LinearizeSensors(const IdentificationProblem& problem,
                      const IdentificationOptions& options,
                      const std::vector<OwnSensor>& own,
                      const std::vector<CandidateSensor>& candidates,
                      PlanningInformation* information, std::string* error) {
  *information = PlanningInformation();
  if (!CheckSensors(problem, options, candidates, error) ||
      !KnownInformation(problem, options, &information->known, error)) {
    return false;
  }
  for (const OwnSensor& sensor : own) {
    SensorInformation own_information;
    own_information.name = problem.records[static_cast<size_t>(sensor.record)]
                               .channels[static_cast<size_t>(sensor.channel)]
                               .observation.name;
    information->own.push_back(std::move(own_information));
  }
  for (const CandidateSensor& candidate : candidates) {
    SensorInformation sensor;
    sensor.name = candidate.observation.name;
    information->candidates.push_back(std::move(sensor));
  }
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (problem.records[r].role == IdentificationRecord::Role::kTrain &&
        !LinearizeRecord(problem, options, own, candidates, static_cast<int>(r),
                         information, error)) {
      return false;
    }
  }
  LeaveOutRounding(problem, own, candidates, information);
  for (size_t i = 0; i < own.size(); ++i) {
    SensorInformation& sensor = information->own[i];
    const MeasuredChannel& channel =
        problem.records[static_cast<size_t>(own[i].record)]
            .channels[static_cast<size_t>(own[i].channel)];
    const double share =
        own[i].noise_share > 0.0 ? own[i].noise_share : kAssumedShare;
    sensor.sigma = channel.sigma > 0.0 ? channel.sigma : share * sensor.rms;
    WeighByNoise(&sensor);
  }
  SetNoise(problem, own, candidates, information);
  for (SensorInformation& sensor : information->candidates) {
    WeighByNoise(&sensor);
  }
  return true;
}

SensorSum::SensorSum(const PlanningInformation& information, int num_free)
    : information_(&information), num_free_(num_free) {
  for (const int starts : information.num_starts) {
    sums_.push_back(Matrix::Zero(starts + num_free, starts + num_free));
  }
}

void SensorSum::Add(const SensorInformation& sensor) {
  for (size_t r = 0; r < sums_.size(); ++r) {
    if (sensor.by_record[r].size() > 0) sums_[r] += sensor.by_record[r];
  }
}

Matrix SensorSum::Information() const {
  Matrix information = information_->known;
  for (size_t r = 0; r < sums_.size(); ++r) {
    const int starts = information_->num_starts[r];
    information += sums_[r].bottomRightCorner(num_free_, num_free_);
    if (starts == 0) continue;
    // Scaled so that the starts' own information has a unit diagonal.
    Vector scale(starts);
    for (int i = 0; i < starts; ++i) {
      const double own = sums_[r](i, i);
      scale[i] = own > 0.0 ? 1.0 / std::sqrt(own) : 1.0;
    }
    Matrix lower;
    if (!FactorizeInformation(scale.asDiagonal() *
                                  sums_[r].topLeftCorner(starts, starts) *
                                  scale.asDiagonal(),
                              &lower)) {
      return Matrix::Zero(num_free_, num_free_);
    }
    const Matrix cross = lower.triangularView<Eigen::Lower>().solve(
        scale.asDiagonal() * sums_[r].topRightCorner(starts, num_free_));
    information.noalias() -= cross.transpose() * cross;
  }
  return information;
}

}  // namespace pinode
