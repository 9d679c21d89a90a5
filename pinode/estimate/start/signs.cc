#include "pinode/estimate/start/signs.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/integrate/free_run.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/record_grid.h"
#include "pinode/structure/model/damping.h"

namespace pinode {
namespace {

constexpr double kDampingRatio = 0.15;
// Limits of the agreement: a sign is accepted beyond the first. A given sign
// counts as wrong below the second.
constexpr double kClearSign = 0.25;
constexpr double kWrongSign = -0.4;
// Two channels count as exchanged if neither agrees with its own response, and
// each agrees with that of the other. Agreements of sensors in one direction
// are alike, which shows no exchange. On the frame of data/frame sensors agree
// with their own response by 0.58 to 0.64, with that of any other by less than
// 0.31; exchanged ones with their own by -0.3.
constexpr double kOwnOfExchanged = 0.25;
constexpr double kOtherOfExchanged = 0.5;
// Share of the mean amplitude below which an amplitude counts as zero.
constexpr double kSmallAmplitude = 1e-2;
// Number of samples that suffice for a sign.
constexpr Eigen::Index kMostSamples = 1 << 17;

bool HasOpenSign(const Parameter& parameter) {
  return parameter.free && !parameter.HasPrior() && parameter.lower < 0.0 &&
         parameter.upper > 0.0;
}

// Returns the spectrum of deviations from the mean without the zero frequency,
// since an offset does not show a sign. Zeros after the samples make its length
// a power of two.
Eigen::VectorXcd Spectrum(const Vector& deviations) {
  Eigen::Index size = 2;
  while (size < deviations.size()) size *= 2;
  Vector padded = Vector::Zero(size);
  padded.head(deviations.size()) = deviations;
  Eigen::VectorXcd spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, padded);
  return spectrum.segment(1, size / 2);
}

// Sums the agreement over frequencies and channels.
struct Agreement {
  double product = 0.0;
  double weight = 0.0;

  void Add(const Eigen::VectorXcd& measured, const Eigen::VectorXcd& response) {
    for (Eigen::Index f = 0; f < measured.size(); ++f) {
      const double w = std::sqrt(std::abs(measured[f]) * std::abs(response[f]));
      if (!(w > 0.0)) continue;
      product += (std::conj(measured[f]) * response[f]).real() / w;
      weight += w;
    }
  }
  // Returns the agreement; NaN without motion.
  double Value() const { return product / weight; }
};

// Measurement and responses of one channel of a training record, as spectra.
struct SeenChannel {
  int record = -1;
  int channel = -1;
  Eigen::VectorXcd measured;
  // Responses, frequencies x (1 + open scales): to the ground and the known
  // forces, then to those of each open scale at scale 1.
  Eigen::MatrixXcd responses;
};

// Damped responses at the given values, compared with the records.
class Responses {
 public:
  Responses(const IdentificationProblem& problem, Vector parameters)
      : problem_(problem),
        dynamics_(*problem.dynamics),
        num_dynamics_(dynamics_.num_parameters()),
        parameters_(std::move(parameters)) {
    for (size_t j = 0; j < dynamics_.force_scales().size(); ++j) {
      const Parameter& scale =
          dynamics_.force_scales()[j].parameters.parameters[0];
      if (HasOpenSign(scale)) open_scales_.push_back(static_cast<int>(j));
    }
    for (int i = 0; i < problem.sensors.size(); ++i) {
      has_open_gains_ = has_open_gains_ || HasOpenGain(i);
    }
  }

  bool AnySignOpen() const { return has_open_gains_ || !open_scales_.empty(); }

  // Computes the responses; false if the damped model has no finite response.
  bool Run() {
    StructuralModel model = dynamics_.CorrectedModel(dynamics_.Parameters());
    Matrix damped;
    std::string unused;
    if (ModalDamping(model.mass, model.stiffness,
                     Vector::Constant(1, kDampingRatio), &damped, &unused)) {
      model.damping = damped;
    }
    auto linear = StructuralDynamics::Create(std::move(model),
                                             dynamics_.inputs(), &unused);
    StructuralDynamics::Prepared prepared;
    if (linear == nullptr ||
        !linear->Prepare(linear->Parameters(), &prepared, &unused)) {
      return false;
    }
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const IdentificationRecord& record = problem_.records[r];
      if (record.role != IdentificationRecord::Role::kTrain ||
          !problem_.IsDriven(record)) {
        continue;
      }
      if (!RunRecord(*linear, prepared, static_cast<int>(r))) return false;
    }
    return !seen_.empty();
  }

  // Finds the scales' signs by least squares over the channels of known sign,
  // each frequency in units of its measured amplitude.
  void FindScales() {
    if (open_scales_.empty()) return;
    const auto count = static_cast<Eigen::Index>(open_scales_.size());
    Matrix normal = Matrix::Zero(count, count);
    Vector right = Vector::Zero(count);
    ForKnownSigns([&](const SeenChannel& seen, const Eigen::MatrixXcd& by_scale,
                      const Eigen::VectorXcd& rest) {
      const Eigen::ArrayXd amplitude = seen.measured.cwiseAbs().array();
      const Vector weights =
          amplitude.max(kSmallAmplitude * amplitude.mean()).inverse().matrix();
      const Eigen::MatrixXcd weighted = weights.asDiagonal() * by_scale;
      normal += (weighted.adjoint() * by_scale).real();
      right += (weighted.adjoint() * rest).real();
    });
    const Vector found = normal.colPivHouseholderQr().solve(right);
    for (Eigen::Index k = 0; k < count; ++k) {
      Agreement agreement;
      ForKnownSigns([&](const SeenChannel& /*seen*/,
                        const Eigen::MatrixXcd& by_scale,
                        const Eigen::VectorXcd& rest) {
        Vector others = found;
        others[k] = 0.0;
        agreement.Add(rest - by_scale * others, by_scale.col(k));
      });
      if (!(std::abs(agreement.Value()) >= kClearSign)) continue;
      const int scale = open_scales_[static_cast<size_t>(k)];
      SetSign(agreement.Value(), ScaleParameter(scale), ScaleIndex(scale));
    }
  }

  void FindGains() {
    for (int i = 0; i < problem_.sensors.size(); ++i) {
      if (!HasOpenGain(i)) continue;
      const double agreement = AgreementOf(
          [i](const MeasuredChannel& channel) { return channel.gain == i; });
      if (!(std::abs(agreement) >= kClearSign)) continue;
      SetSign(agreement, problem_.sensors.parameters[static_cast<size_t>(i)],
              num_dynamics_ + i);
    }
  }

  // Returns the agreement of the channels of one name with the response, by the
  // present signs.
  double AgreementOfChannel(const std::string& name) const {
    return AgreementOf([&](const MeasuredChannel& channel) {
      return channel.observation.name == name;
    });
  }

  // Returns the agreement of the measurement of one channel with the response
  // of another, over the records that have both.
  double AgreementAcross(const std::string& measured,
                         const std::string& other) const {
    Agreement agreement;
    for (const SeenChannel& seen : seen_) {
      if (ChannelOf(seen).observation.name != measured) continue;
      for (const SeenChannel& theirs : seen_) {
        if (theirs.record != seen.record ||
            ChannelOf(theirs).observation.name != other ||
            ChannelOf(theirs).observation.quantity !=
                ChannelOf(seen).observation.quantity ||
            theirs.responses.rows() != seen.measured.size()) {
          continue;
        }
        agreement.Add(seen.measured, theirs.responses * Factors());
      }
    }
    return agreement.Value();
  }

  // Returns the names of the channels in their order, each with the index of
  // its gain.
  std::vector<std::pair<std::string, int>> Channels() const {
    std::vector<std::pair<std::string, int>> channels;
    for (const SeenChannel& seen : seen_) {
      const MeasuredChannel& channel = ChannelOf(seen);
      const std::pair<std::string, int> entry = {channel.observation.name,
                                                 channel.gain};
      if (std::find(channels.begin(), channels.end(), entry) ==
          channels.end()) {
        channels.push_back(entry);
      }
    }
    return channels;
  }

  bool HasOpenGain(int gain) const {
    return gain >= 0 &&
           HasOpenSign(problem_.sensors.parameters[static_cast<size_t>(gain)]);
  }

  const Vector& parameters() const { return parameters_; }

  const Parameter& ScaleParameter(int scale) const {
    return dynamics_.force_scales()[static_cast<size_t>(scale)]
        .parameters.parameters[0];
  }
  int ScaleIndex(int scale) const {
    return dynamics_.block_offset(dynamics_.force_scale_block(scale));
  }

 private:
  const MeasuredChannel& ChannelOf(const SeenChannel& seen) const {
    return problem_.records[static_cast<size_t>(seen.record)]
        .channels[static_cast<size_t>(seen.channel)];
  }

  double GainOf(const MeasuredChannel& channel) const {
    return channel.gain < 0 ? 1.0 : parameters_[num_dynamics_ + channel.gain];
  }

  void SetSign(double sign, const Parameter& parameter, int index) {
    parameters_[index] = std::clamp(std::copysign(parameters_[index], sign),
                                    parameter.lower, parameter.upper);
  }

  // Returns the excitation of a record with its forces at the values of their
  // scales. `open` >= 0: the forces of that open scale alone, at scale 1. -1:
  // all other forces.
  Excitation ExcitationBy(const IdentificationRecord& record, int open) const {
    const Matrix& given = record.excitation->samples();
    Matrix samples =
        open < 0 ? given : Matrix::Zero(given.rows(), given.cols());
    for (size_t j = 0; j < dynamics_.force_scales().size(); ++j) {
      const int scale = static_cast<int>(j);
      const bool is_open = std::find(open_scales_.begin(), open_scales_.end(),
                                     scale) != open_scales_.end();
      for (const auto& force : dynamics_.force_scales()[j].forces) {
        if (force.record_switch >= 0 && given(force.record_switch, 0) == 0.0) {
          continue;
        }
        if (open < 0) {
          samples.row(force.input) *=
              is_open ? 0.0 : parameters_[ScaleIndex(scale)];
        } else if (open_scales_[static_cast<size_t>(open)] == scale) {
          samples.row(force.input) = given.row(force.input);
        }
      }
    }
    return Excitation(record.excitation->start_time(), record.sampling_step(),
                      std::move(samples), record.excitation->interpolation(),
                      record.excitation->periodic());
  }

  // Returns the first of the samples in use. In a long record these are the
  // samples with the most motion.
  Eigen::Index FirstSample(const IdentificationRecord& record) const {
    const Eigen::Index samples = record.num_samples();
    if (samples <= kMostSamples) return 0;
    // Sums squares over half a window at a time, each channel in its own unit.
    constexpr Eigen::Index kHalf = kMostSamples / 2;
    Vector squares = Vector::Zero(samples / kHalf);
    for (const MeasuredChannel& channel : record.channels) {
      Vector own = Vector::Zero(squares.size());
      for (Eigen::Index h = 0; h < own.size(); ++h) {
        const auto part = channel.values.segment(h * kHalf, kHalf).array();
        own[h] = part.isFinite().select(part.square(), 0.0).sum();
      }
      if (own.sum() > 0.0) squares += own / own.sum();
    }
    Eigen::Index best = 0;
    (squares.head(squares.size() - 1) + squares.tail(squares.size() - 1))
        .maxCoeff(&best);
    return best * kHalf;
  }

  bool RunRecord(const StructuralDynamics& linear,
                 const StructuralDynamics::Prepared& prepared, int index) {
    const IdentificationRecord& record =
        problem_.records[static_cast<size_t>(index)];
    const ObservationMap observation(linear, record.Observations());
    const Eigen::Index first = FirstSample(record);
    const Eigen::Index last =
        std::min(record.num_samples(), first + kMostSamples) - 1;
    std::vector<Matrix> histories;  // samples x channels
    for (int k = -1; k < static_cast<int>(open_scales_.size()); ++k) {
      const Excitation excitation = ExcitationBy(record, k);
      const IntegrationGrid grid = GridOf(linear, record, excitation);
      Trajectory trajectory;
      if (!FreeRun(linear, prepared, observation, grid,
                   Vector::Zero(linear.num_states()), first, last, &trajectory,
                   Keep::kChannels)) {
        return false;
      }
      Matrix history = trajectory.channels.transpose();
      if (record.filter != nullptr) record.filter->Apply(&history);
      histories.push_back(std::move(history));
    }
    for (size_t c = 0; c < record.channels.size(); ++c) {
      See(index, static_cast<int>(c), first, histories);
    }
    return true;
  }

  // Adds a channel. `histories`: from sample `first` on.
  void See(int record, int channel, Eigen::Index first,
           const std::vector<Matrix>& histories) {
    SeenChannel seen;
    seen.record = record;
    seen.channel = channel;
    // The linear model does not determine the resistance of a device.
    if (ChannelOf(seen).observation.quantity == Quantity::kForce) return;
    const Vector values =
        ChannelOf(seen).values.segment(first, histories[0].rows());
    std::vector<Eigen::Index> present;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (std::isfinite(values[i])) present.push_back(i);
    }
    const auto deviations = [&present](const auto& series) {
      Vector result(static_cast<Eigen::Index>(present.size()));
      for (size_t i = 0; i < present.size(); ++i) {
        result[static_cast<Eigen::Index>(i)] = series[present[i]];
      }
      return Vector(result.array() - result.mean());
    };
    seen.measured = Spectrum(deviations(values));
    if (!(seen.measured.norm() > 0.0)) return;
    seen.responses.resize(seen.measured.size(),
                          static_cast<Eigen::Index>(histories.size()));
    for (size_t k = 0; k < histories.size(); ++k) {
      seen.responses.col(static_cast<Eigen::Index>(k)) =
          Spectrum(deviations(histories[k].col(channel)));
    }
    seen_.push_back(std::move(seen));
  }

  // Calls visit(seen, responses to the open scales, the remainder for them) for
  // the fitted channels whose gain has a known sign.
  template <typename Visit>
  void ForKnownSigns(const Visit& visit) const {
    for (const SeenChannel& seen : seen_) {
      const MeasuredChannel& channel = ChannelOf(seen);
      if (!channel.fit || HasOpenGain(channel.gain)) continue;
      const double gain = GainOf(channel);
      const Eigen::MatrixXcd by_scale =
          gain * seen.responses.rightCols(seen.responses.cols() - 1);
      const Eigen::VectorXcd rest =
          seen.measured - gain * seen.responses.col(0);
      visit(seen, by_scale, rest);
    }
  }

  // Returns the factors of the columns of SeenChannel::responses.
  Vector Factors() const {
    Vector factors =
        Vector::Ones(1 + static_cast<Eigen::Index>(open_scales_.size()));
    for (size_t k = 0; k < open_scales_.size(); ++k) {
      factors[static_cast<Eigen::Index>(k) + 1] =
          parameters_[ScaleIndex(open_scales_[k])];
    }
    return factors;
  }

  // Returns the agreement over all channels for which `wanted` returns true.
  template <typename Wanted>
  double AgreementOf(const Wanted& wanted) const {
    const Vector factors = Factors();
    Agreement agreement;
    for (const SeenChannel& seen : seen_) {
      const MeasuredChannel& channel = ChannelOf(seen);
      if (!wanted(channel)) continue;
      // The gain in question takes no part.
      const double gain = HasOpenGain(channel.gain) ? 1.0 : GainOf(channel);
      agreement.Add(seen.measured, gain * (seen.responses * factors));
    }
    return agreement.Value();
  }

  const IdentificationProblem& problem_;
  const StructuralDynamics& dynamics_;
  const int num_dynamics_;
  Vector parameters_;
  std::vector<int> open_scales_;  // among the dynamics' force scales
  bool has_open_gains_ = false;
  std::vector<SeenChannel> seen_;
};

std::string Value(double value, const std::string& unit) {
  return FormatNumber(value, 3) + (unit == "1" ? "" : " " + unit);
}

bool HasTurned(double initial, double value) { return initial * value < 0.0; }

// Returns a remark if delays were found equal at all sensors of the fit: the
// clock of the excitation then differs. Empty: they were not.
std::string DelayRemark(const IdentificationProblem& problem,
                        const Vector& parameters) {
  constexpr double kClear = 0.5;  // samples
  constexpr double kAlike = 0.1;
  const int first = problem.dynamics->num_parameters();
  std::vector<int> delays;
  double lowest = kInfinity;
  double highest = -kInfinity;
  double step = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    if (!problem.IsDriven(record)) return "";
    step = std::max(step, record.sampling_step());
    for (const MeasuredChannel& channel : record.channels) {
      if (!channel.fit) continue;
      if (channel.delay < 0) return "";
      const Parameter& delay =
          problem.sensors.parameters[static_cast<size_t>(channel.delay)];
      const double value = parameters[first + channel.delay];
      if (!delay.free || value == delay.value) return "";
      if (std::find(delays.begin(), delays.end(), channel.delay) ==
          delays.end()) {
        delays.push_back(channel.delay);
      }
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
  }
  const double mean = 0.5 * (lowest + highest);
  if (delays.size() < 2 || !(std::abs(mean) > kClear * step) ||
      highest - lowest > kAlike * std::abs(mean)) {
    return "";
  }
  return "All sensors are " + std::string(mean > 0.0 ? "late" : "early") +
         " by the same time, " +
         Value(std::abs(mean), problem.description.units.time) +
         ". Probably the excitation is " + (mean > 0.0 ? "early" : "late") +
         ": check its clock.";
}

// Returns a remark for each pair of channels that are probably exchanged.
std::vector<std::string> ExchangeRemarks(
    const Responses& responses,
    const std::vector<std::pair<std::string, double>>& agreements) {
  std::vector<std::string> remarks;
  for (size_t i = 0; i < agreements.size(); ++i) {
    const auto& [first, own] = agreements[i];
    if (!(own < kOwnOfExchanged)) continue;
    for (size_t j = i + 1; j < agreements.size(); ++j) {
      const auto& [second, own_of_second] = agreements[j];
      if (!(own_of_second < kOwnOfExchanged)) continue;
      const double across = responses.AgreementAcross(first, second);
      const double back = responses.AgreementAcross(second, first);
      if (!(std::min(across, back) > kOtherOfExchanged)) continue;
      remarks.push_back(
          "Channels '" + first + "' and '" + second +
          "' agree with the model's response at each other's place "
          "(agreement " +
          FormatNumber(across, 2) + " and " + FormatNumber(back, 2) +
          " of 1), not at their own (" + FormatNumber(own, 2) + " and " +
          FormatNumber(own_of_second, 2) +
          "). They are probably exchanged: check their DOFs.");
    }
  }
  return remarks;
}

}  // namespace

void FindSigns(const IdentificationProblem& problem, Vector* parameters) {
  Responses responses(problem, *parameters);
  if (!responses.AnySignOpen() || !responses.Run()) return;
  responses.FindScales();
  responses.FindGains();
  *parameters = responses.parameters();
}

std::vector<std::string> SignRemarks(const IdentificationProblem& problem,
                                     const Vector& parameters) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  Responses responses(problem, parameters);
  std::vector<std::string> remarks;
  for (size_t j = 0; j < dynamics.force_scales().size(); ++j) {
    const int scale = static_cast<int>(j);
    const Parameter& parameter = responses.ScaleParameter(scale);
    const double value = parameters[responses.ScaleIndex(scale)];
    if (!HasTurned(parameter.value, value)) continue;
    remarks.push_back("'" + parameter.name +
                      "': the force acts against the sign of its column: " +
                      "scale = " + Value(value, parameter.unit) + ".");
  }
  const int first = dynamics.num_parameters();
  std::vector<std::string> turned;
  for (const IdentificationRecord& record : problem.records) {
    for (const MeasuredChannel& channel : record.channels) {
      if (channel.gain < 0) continue;
      const Parameter& gain =
          problem.sensors.parameters[static_cast<size_t>(channel.gain)];
      const std::string& name = channel.observation.name;
      const double value = parameters[first + channel.gain];
      if (!HasTurned(gain.value, value) ||
          std::find(turned.begin(), turned.end(), name) != turned.end()) {
        continue;
      }
      turned.push_back(name);
      remarks.push_back(
          "Sensor '" + name +
          "' is mounted upside down: gain = " + Value(value, gain.unit) + ".");
    }
  }
  const std::string delays = DelayRemark(problem, parameters);
  if (!delays.empty()) remarks.push_back(delays);
  if (!responses.Run()) return remarks;
  std::vector<std::string> against;
  std::vector<std::pair<std::string, double>> agreements;
  for (const auto& [name, gain] : responses.Channels()) {
    if (responses.HasOpenGain(gain)) continue;
    agreements.emplace_back(name, responses.AgreementOfChannel(name));
  }
  for (std::string& remark : ExchangeRemarks(responses, agreements)) {
    remarks.push_back(std::move(remark));
  }
  for (const auto& [name, agreement] : agreements) {
    if (!(agreement < kWrongSign)) continue;
    against.push_back("'" + name + "' (agreement " +
                      FormatNumber(agreement, 2) + " of 1)");
  }
  if (against.empty()) return remarks;
  if (against.size() == agreements.size()) {
    remarks.push_back(
        "All channels have the opposite sign of the model's response: " +
        Join(against, ", ") +
        ". Check the sign of the excitation and the direction of the model.");
    return remarks;
  }
  const bool is_one = against.size() == 1;
  remarks.push_back(std::string(is_one ? "Channel " : "Channels ") +
                    Join(against, ", ") + (is_one ? " has" : " have") +
                    " the opposite sign of the model's response. " +
                    (is_one ? "It is" : "They are") +
                    " probably upside down: set sign = -1, or "
                    "gain = {free = true} to find the sign.");
  return remarks;
}

}  // namespace pinode
