#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/study/explanations/catalogue.h"

namespace pinode {
namespace {

using Kind = Suspect::Kind;

// Widest delay that is looked for, in samples: that of a logger's channel, not
// of another record.
constexpr double kMostDelay = 50.0;

// True if the start is an unknown, or was found from the same samples
// (FixTrainingStarts).
bool HasFoundStart(const IdentificationRecord& record) {
  using Start = IdentificationRecord::Start;
  return record.start == Start::kFree ||
         (record.start == Start::kKnown && record.start_samples > 0);
}

// True if an input changes during the record. Covariates and switches need not.
bool HasChangingInput(const IdentificationRecord& record) {
  const Matrix& samples = record.excitation->samples();
  return samples.size() > 0 &&
         !(samples.colwise() - samples.col(0)).isZero(0.0);
}

class SensorCatalogue {
 public:
  SensorCatalogue(const IdentificationProblem& problem,
                  std::vector<Suspect>* suspects)
      : problem_(problem), suspects_(suspects) {}

  void Make() {
    // A sensor in several records has one name.
    std::map<std::string, std::vector<std::pair<int, int>>> sensors;
    std::vector<std::string> names;
    std::vector<std::pair<int, int>> all;
    bool any_gain = false, any_delay = false;
    bool any_driven = false, any_clock = false;
    double step = 0.0;
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const IdentificationRecord& record = problem_.records[r];
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      step = std::max(step, record.sampling_step());
      for (size_t c = 0; c < record.channels.size(); ++c) {
        const MeasuredChannel& channel = record.channels[c];
        if (!channel.fit) continue;
        const bool is_driven = !IsFreeVibration(record);
        any_driven = any_driven || is_driven;
        any_clock = any_clock || is_driven || HasChangingInput(record);
        const std::pair<int, int> at(static_cast<int>(r), static_cast<int>(c));
        any_gain = any_gain || channel.gain >= 0;
        any_delay = any_delay || channel.delay >= 0;
        all.push_back(at);
        std::vector<std::pair<int, int>>& places =
            sensors[channel.observation.name];
        if (places.empty()) names.push_back(channel.observation.name);
        places.push_back(at);
      }
    }
    if (all.empty()) return;
    std::vector<std::string> gains, delays;
    if (names.size() > 1) {
      for (const std::string& name : names) {
        gains.push_back(SuspectUnknown("gain." + name));
        delays.push_back(SuspectUnknown("delay." + name));
      }
    }
    if (!any_delay && any_clock) {
      Suspect* late = Add(Kind::kExcitationDelay, "",
                          "the clock of all sensors against the excitation");
      late->sensors = {Delay("excitation", step, all)};
      late->tied = delays;
      late->usual = step;
    }
    if (!any_gain && (any_driven || !problem_.dynamics->IsLinear())) {
      Suspect* scale =
          Add(Kind::kExcitationScale, "",
              "all sensors by one factor (or the excitation by its inverse)");
      scale->sensors = {UnknownGain("sensors", all)};
      scale->tied = gains;
    }
    if (names.size() < 2) return;
    for (const std::string& name : names) {
      const std::vector<std::pair<int, int>>& at = sensors[name];
      const MeasuredChannel& channel = Channel(at.front());
      if (!any_gain) {
        Add(Kind::kSensorGain, name, "the gain of sensor '" + name + "'")
            ->sensors = {UnknownGain(name, at)};
      }
      if (!any_delay) {
        Suspect* late =
            Add(Kind::kSensorDelay, name, "the clock of sensor '" + name + "'");
        late->sensors = {Delay(name, step, at)};
        late->usual = step;
      }
      if (channel.offset < 0) {
        Suspect* off =
            Add(Kind::kSensorOffset, name, "the zero of sensor '" + name + "'");
        off->sensors = {Offset(name, at)};
        off->usual = 0.1 * off->sensors[0].parameter.prior_sigma;
      }
    }
    AddExchanges();
  }

  // True if nothing but its start moves the record. For linear models another
  // start is then the same as another scale of all sensors. If no input
  // changes, it is the same as a late clock too.
  bool IsFreeVibration(const IdentificationRecord& record) const {
    return HasFoundStart(record) && !problem_.IsDriven(record);
  }

  const MeasuredChannel& Channel(const std::pair<int, int>& at) const {
    return problem_.records[static_cast<size_t>(at.first)]
        .channels[static_cast<size_t>(at.second)];
  }

  Suspect::SensorUnknown Delay(
      const std::string& name, double step,
      const std::vector<std::pair<int, int>>& at) const {
    Suspect::SensorUnknown delay;
    delay.role = &MeasuredChannel::delay;
    delay.parameter.name = SuspectUnknown("delay." + name);
    delay.parameter.unit = problem_.description.units.time;
    delay.parameter.lower = -kMostDelay * step;
    delay.parameter.upper = kMostDelay * step;
    delay.channels = at;
    return delay;
  }

  Suspect::SensorUnknown Offset(
      const std::string& name,
      const std::vector<std::pair<int, int>>& at) const {
    Suspect::SensorUnknown offset;
    offset.role = &MeasuredChannel::offset;
    offset.parameter.name = SuspectUnknown("offset." + name);
    const double rms = RmsOfPresent(Channel(at.front()).values);
    offset.parameter.prior_sigma = rms > 0.0 ? rms : 1.0;
    offset.channels = at;
    return offset;
  }

  // Pairs of sensors of one quantity that may have changed places.
  void AddExchanges() {
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const IdentificationRecord& record = problem_.records[r];
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      const int count = static_cast<int>(record.channels.size());
      for (int c = 0; c < count; ++c) {
        for (int d = 0; d < c; ++d) {
          const MeasuredChannel& one = record.channels[static_cast<size_t>(d)];
          const MeasuredChannel& two = record.channels[static_cast<size_t>(c)];
          if (!one.fit || !two.fit ||
              one.observation.quantity != two.observation.quantity) {
            continue;
          }
          const std::string& first = one.observation.name;
          const std::string& second = two.observation.name;
          // Exchanged in every record alike.
          const auto known = std::find_if(
              suspects_->begin(), suspects_->end(), [&](const Suspect& other) {
                return other.kind == Kind::kExchange &&
                       other.place == first + "," + second;
              });
          const int at = static_cast<int>(r);
          Suspect* suspect =
              known != suspects_->end()
                  ? &*known
                  : Add(Kind::kExchange, first + "," + second,
                        "sensors '" + first + "' and '" + second + "' swapped");
          suspect->exchanged.push_back({{at, d}, {at, c}});
        }
      }
    }
  }

  Suspect* Add(Kind kind, const std::string& place, const std::string& what) {
    Suspect suspect;
    suspect.kind = kind;
    suspect.place = place;
    suspect.what = what;
    suspects_->push_back(std::move(suspect));
    return &suspects_->back();
  }

  const IdentificationProblem& problem_;
  std::vector<Suspect>* suspects_;
};

}  // namespace

void AddSensorSuspects(const IdentificationProblem& problem,
                       std::vector<Suspect>* suspects) {
  SensorCatalogue(problem, suspects).Make();
}

}  // namespace pinode
