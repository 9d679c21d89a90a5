#include "pinode/study/explanations/suspect.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/dynamics/feature.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

using Kind = Suspect::Kind;
using Target = MatrixGroup::Target;

// Largest number of DOFs for which each mass and spring is a suspect. The cost
// of the score tests grows with the number of candidates.
constexpr int kMostPlaces = 40;
// Least damping ratio on which a factor per mode is based.
constexpr double kLeastRatio = 0.005;
// Widest delay that is looked for, in samples: that of a logger's channel, not
// of another record.
constexpr double kMostDelay = 50.0;

// Name of an unknown of a suspect.
std::string Unknown(const std::string& text) {
  return TermName("other." + text);
}

GroupTerm FactorGroup(const std::string& name, Target target,
                      const Matrix& matrix) {
  GroupTerm term;
  term.group.name = Unknown(name);
  term.group.target = target;
  term.group.matrix = matrix;
  term.alpha.name = term.group.name;
  // The prior only keeps undetermined factors from growing.
  term.alpha.prior_sigma = 1.0;
  return term;
}

class Catalogue {
 public:
  Catalogue(const IdentificationProblem& problem, const IdentifiedModel& model)
      : problem_(problem),
        dynamics_(*problem.dynamics),
        corrected_(dynamics_.CorrectedModel(
            model.parameters.head(dynamics_.num_parameters()))) {}

  std::vector<Suspect> Make() {
    AddDampings();
    AddMasses();
    AddSprings();
    AddGroups();
    AddSensors();
    return std::move(suspects_);
  }

 private:
  Suspect* Add(Kind kind, const std::string& place, const std::string& what) {
    Suspect suspect;
    suspect.kind = kind;
    suspect.place = place;
    suspect.what = what;
    suspects_.push_back(std::move(suspect));
    return &suspects_.back();
  }

  const std::string& Dof(int j) const {
    return corrected_.dof_names[static_cast<size_t>(j)];
  }

  void AddDampings() {
    const Matrix& damping = corrected_.damping;
    const double size = damping.cwiseAbs().maxCoeff();
    ModalProperties modes;
    std::string unused;
    if (!ComputeModes(corrected_.mass, damping, corrected_.stiffness, &modes,
                      &unused)) {
      return;
    }
    if (size > 0.0) {
      Add(Kind::kDamping, "",
          "damping of the whole structure by one factor (where all stiffness "
          "is free, a clock or all masses off by a factor look the same)")
          ->groups = {FactorGroup("damping", Target::kDamping, damping)};
    }
    std::vector<int> vibrating;
    for (int i = 0; i < modes.frequency_hz.size(); ++i) {
      if (modes.frequency_hz[i] > 0.0) vibrating.push_back(i);
    }
    if (vibrating.empty()) return;
    const auto circular = [&](int i) {
      return 2.0 * kPi * modes.frequency_hz[i];
    };
    const auto ratio = [&](int i) {
      const double zeta = modes.damping_ratio[i];
      return std::isfinite(zeta) ? std::max(zeta, kLeastRatio) : kLeastRatio;
    };
    const int first = vibrating.front();
    Add(Kind::kDamping, "", "damping proportional to mass and to stiffness")
        ->groups = {
        FactorGroup("damping.mass", Target::kDamping,
                    2.0 * ratio(first) * circular(first) * corrected_.mass),
        FactorGroup(
            "damping.stiffness", Target::kDamping,
            2.0 * ratio(first) / circular(first) * corrected_.stiffness)};
    if (vibrating.size() < 2 ||
        vibrating.size() > static_cast<size_t>(kMostPlaces)) {
      return;
    }
    Suspect* per_mode =
        Add(Kind::kDamping, "", "damping by a factor of its own per mode");
    for (const int i : vibrating) {
      const Vector shape = corrected_.mass * modes.mode_shapes.col(i);
      per_mode->groups.push_back(FactorGroup(
          "damping.mode" + std::to_string(i + 1), Target::kDamping,
          2.0 * ratio(i) * circular(i) * shape * shape.transpose()));
    }
  }

  void AddMasses() {
    Add(Kind::kMass, "",
        "all masses by one factor (where all stiffness is free, damping or a "
        "clock off by a factor look the same)")
        ->groups = {FactorGroup("mass", Target::kMass, corrected_.mass)};
    const int size = corrected_.num_dofs();
    if (size > kMostPlaces) return;
    for (int j = 0; j < size; ++j) {
      if (!(corrected_.mass(j, j) > 0.0)) continue;
      Matrix matrix = Matrix::Zero(size, size);
      matrix(j, j) = corrected_.mass(j, j);
      Add(Kind::kMass, Dof(j), "the mass at " + Dof(j))->groups = {
          FactorGroup("mass." + Dof(j), Target::kMass, matrix)};
    }
  }

  // Springs between two DOFs or a DOF and the ground, where the matrix consists
  // of them.
  void AddSprings() {
    const Matrix& k = corrected_.stiffness;
    const int size = corrected_.num_dofs();
    if (size > kMostPlaces) return;
    constexpr double kRounding = 1e-9;
    const double largest = k.cwiseAbs().maxCoeff();
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < i; ++j) {
        if (k(i, j) > kRounding * largest) return;
      }
      if (k.row(i).sum() < -kRounding * largest) return;
    }
    for (int to = 0; to < size; ++to) {
      for (int from = Feature::kGround; from < to; ++from) {
        const double stiffness =
            from == Feature::kGround ? k.row(to).sum() : -k(to, from);
        const Matrix spring = stiffness * SpringMatrix(size, from, to);
        if (!(stiffness > 1e-6 * largest) || IsGroup(spring)) continue;
        const std::string start =
            from == Feature::kGround ? "ground" : Dof(from);
        const std::string place = start + "-" + Dof(to);
        Add(Kind::kStiffness, place,
            "the stiffness between " + start + " and " + Dof(to))
            ->groups = {
            FactorGroup("stiffness." + place, Target::kStiffness, spring)};
      }
    }
  }

  // True if a constant group of the problem is `stiffness` times a number.
  bool IsGroup(const Matrix& stiffness) const {
    const std::vector<GroupTerm>& groups = dynamics_.groups();
    return std::any_of(
        groups.begin(), groups.end(), [&](const GroupTerm& term) {
          if (term.group.target != Target::kStiffness ||
              term.follows != GroupTerm::Follows::kNothing) {
            return false;
          }
          const Matrix& matrix = term.group.matrix;
          const double product = matrix.cwiseProduct(stiffness).sum();
          return product >= (1.0 - 1e-9) * matrix.norm() * stiffness.norm();
        });
  }

  // Groups that the user has fixed, or whose bounds they have reached.
  void AddGroups() {
    for (const GroupTerm& term : dynamics_.groups()) {
      const Parameter& alpha = term.alpha;
      if (!alpha.free) {
        Kind kind = Kind::kStiffness;
        if (term.group.target == Target::kMass) kind = Kind::kMass;
        if (term.group.target == Target::kDamping) kind = Kind::kDamping;
        Add(kind, term.group.name,
            "group '" + term.group.name + "', which is fixed")
            ->freed = {term.group.name};
      } else if (std::isfinite(alpha.lower) || std::isfinite(alpha.upper)) {
        Add(Kind::kBound, term.group.name,
            "group '" + term.group.name + "' beyond its bounds")
            ->freed = {term.group.name};
      }
    }
  }

  void AddSensors() {
    // A sensor in several records has one name.
    std::map<std::string, std::vector<std::pair<int, int>>> sensors;
    std::vector<std::string> names;
    std::vector<std::pair<int, int>> all;
    bool any_gain = false, any_delay = false;
    double step = 0.0;
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const IdentificationRecord& record = problem_.records[r];
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      step = std::max(step, record.sampling_step());
      for (size_t c = 0; c < record.channels.size(); ++c) {
        const MeasuredChannel& channel = record.channels[c];
        if (!channel.fit) continue;
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
        gains.push_back(Unknown("gain." + name));
        delays.push_back(Unknown("delay." + name));
      }
    }
    if (!any_delay) {
      Suspect* late = Add(Kind::kExcitationDelay, "",
                          "the clock of all sensors against the excitation");
      late->sensors = {Delay("excitation", step, all)};
      late->tied = delays;
    }
    if (!any_gain) {
      Suspect* scale =
          Add(Kind::kExcitationScale, "",
              "all sensors by one factor (or the excitation by its inverse)");
      scale->sensors = {Gain("sensors", all)};
      scale->tied = gains;
    }
    if (names.size() < 2) return;
    for (const std::string& name : names) {
      const std::vector<std::pair<int, int>>& at = sensors[name];
      const MeasuredChannel& channel = Channel(at.front());
      if (!any_gain) {
        Add(Kind::kSensorGain, name, "the gain of sensor '" + name + "'")
            ->sensors = {Gain(name, at)};
      }
      if (!any_delay) {
        Add(Kind::kSensorDelay, name, "the clock of sensor '" + name + "'")
            ->sensors = {Delay(name, step, at)};
      }
      if (channel.offset < 0) {
        Add(Kind::kSensorOffset, name, "the zero of sensor '" + name + "'")
            ->sensors = {Offset(name, at)};
      }
    }
    AddExchanges();
  }

  const MeasuredChannel& Channel(const std::pair<int, int>& at) const {
    return problem_.records[static_cast<size_t>(at.first)]
        .channels[static_cast<size_t>(at.second)];
  }

  static Suspect::SensorUnknown Gain(
      const std::string& name, const std::vector<std::pair<int, int>>& at) {
    Suspect::SensorUnknown gain;
    gain.role = &MeasuredChannel::gain;
    gain.parameter.name = Unknown("gain." + name);
    gain.parameter.value = 1.0;
    gain.parameter.prior_mean = 1.0;
    gain.parameter.prior_sigma = 2.0;
    gain.channels = at;
    return gain;
  }

  Suspect::SensorUnknown Delay(
      const std::string& name, double step,
      const std::vector<std::pair<int, int>>& at) const {
    Suspect::SensorUnknown delay;
    delay.role = &MeasuredChannel::delay;
    delay.parameter.name = Unknown("delay." + name);
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
    offset.parameter.name = Unknown("offset." + name);
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
              suspects_.begin(), suspects_.end(), [&](const Suspect& other) {
                return other.kind == Kind::kExchange &&
                       other.place == first + "," + second;
              });
          const int at = static_cast<int>(r);
          Suspect* suspect = known != suspects_.end()
                                 ? &*known
                                 : Add(Kind::kExchange, first + "," + second,
                                       "sensors '" + first + "' and '" +
                                           second + "' in each other's place");
          suspect->exchanged.push_back({{at, d}, {at, c}});
        }
      }
    }
  }

  const IdentificationProblem& problem_;
  const StructuralDynamics& dynamics_;
  const StructuralModel corrected_;
  std::vector<Suspect> suspects_;
};

bool AddGroups(const std::vector<Suspect>& suspects,
               IdentificationProblem* problem, std::string* error) {
  std::vector<std::string> freed;
  for (const Suspect& suspect : suspects) {
    freed.insert(freed.end(), suspect.freed.begin(), suspect.freed.end());
  }
  std::shared_ptr<const StructuralDynamics> base = problem->dynamics;
  if (!freed.empty()) {
    StructureTerms terms = TermsOf(*base);
    for (GroupTerm& term : terms.groups) {
      if (std::find(freed.begin(), freed.end(), term.group.name) ==
          freed.end()) {
        continue;
      }
      if (!term.alpha.free) term.alpha.prior_sigma = 1.0;
      term.alpha.free = true;
      term.alpha.lower = -kInfinity;
      term.alpha.upper = kInfinity;
    }
    if (!Assemble(base->model(), base->inputs(), terms, &base, error)) {
      return false;
    }
  }
  auto dynamics = std::make_shared<StructuralDynamics>(*base);
  for (const Suspect& suspect : suspects) {
    for (const GroupTerm& group : suspect.groups) {
      if (!dynamics->AddGroup(group, error)) return false;
    }
  }
  problem->dynamics = std::move(dynamics);
  return true;
}

MeasuredChannel* ChannelAt(const std::pair<int, int>& at,
                           IdentificationProblem* problem) {
  return &problem->records[static_cast<size_t>(at.first)]
              .channels[static_cast<size_t>(at.second)];
}

}  // namespace

std::vector<std::string> Suspect::Unknowns() const {
  std::vector<std::string> names;
  for (const GroupTerm& group : groups) names.push_back(group.alpha.name);
  for (const SensorUnknown& sensor : sensors) {
    names.push_back(sensor.parameter.name);
  }
  names.insert(names.end(), freed.begin(), freed.end());
  return names;
}

const char* SuspectKindName(Kind kind) {
  switch (kind) {
    case Kind::kDamping:
      return "damping";
    case Kind::kMass:
      return "mass";
    case Kind::kStiffness:
      return "stiffness";
    case Kind::kBound:
      return "bound";
    case Kind::kSensorGain:
      return "sensor_gain";
    case Kind::kSensorDelay:
      return "sensor_delay";
    case Kind::kSensorOffset:
      return "sensor_offset";
    case Kind::kExcitationDelay:
      return "excitation_delay";
    case Kind::kExcitationScale:
      return "excitation_scale";
    case Kind::kExchange:
      return "sensors_exchanged";
  }
  return "";
}

std::vector<Suspect> MakeSuspects(const IdentificationProblem& problem,
                                  const IdentifiedModel& model) {
  return Catalogue(problem, model).Make();
}

bool AddSuspects(const std::vector<Suspect>& suspects,
                 IdentificationProblem* problem, std::string* error) {
  IdentificationProblem result = *problem;
  result.description.known_as.clear();
  if (!AddGroups(suspects, &result, error)) return false;
  for (const Suspect& suspect : suspects) {
    for (const Suspect::SensorUnknown& sensor : suspect.sensors) {
      const int index = result.sensors.size();
      result.sensors.parameters.push_back(sensor.parameter);
      for (const std::pair<int, int>& at : sensor.channels) {
        int& place = ChannelAt(at, &result)->*sensor.role;
        if (place >= 0) {
          *error = "a sensor would have two unknowns of one kind";
          return false;
        }
        place = index;
      }
    }
    for (const auto& [one, two] : suspect.exchanged) {
      std::swap(ChannelAt(one, &result)->values,
                ChannelAt(two, &result)->values);
    }
  }
  if (!result.IsValid(error)) return false;
  *problem = std::move(result);
  return true;
}

}  // namespace pinode
