#include "pinode/study/explanations/suspect.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <set>

#include "pinode/base/constants.h"
#include "pinode/dynamics/law_term.h"
#include "pinode/study/explanations/frf_suspects.h"
#include "pinode/study/explanations/shape_suspects.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

bool AddTerms(const std::vector<Suspect>& suspects,
              IdentificationProblem* problem, std::string* error) {
  std::vector<std::string> freed;
  std::vector<Suspect::ForceAt> moved;
  for (const Suspect& suspect : suspects) {
    freed.insert(freed.end(), suspect.freed.begin(), suspect.freed.end());
    moved.insert(moved.end(), suspect.moved_forces.begin(),
                 suspect.moved_forces.end());
  }
  std::shared_ptr<const StructuralDynamics> base = problem->dynamics;
  if (!freed.empty() || !moved.empty()) {
    StructureTerms terms = TermsOf(*base);
    for (GroupTerm& term : terms.groups) {
      if (std::find(freed.begin(), freed.end(), term.group.name) ==
          freed.end()) {
        continue;
      }
      if (!term.alpha.free) term.alpha.prior_sigma = 1.0;
      term.alpha.free = true;
      term.alpha.tie.clear();
      term.alpha.lower = -kInfinity;
      term.alpha.upper = kInfinity;
    }
    for (UnknownForceTerm& force : terms.unknown_forces) {
      for (const Suspect::ForceAt& at : moved) {
        if (force.name == at.name) force.outputs = at.outputs;
      }
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
    for (const LibrarySpec& force : suspect.forces) {
      LawTerm term;
      if (!MakeLibraryTerm(force, *dynamics, problem->description.units, &term,
                           error) ||
          !dynamics->AddLaw(std::move(term), error)) {
        return false;
      }
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
  for (const LibrarySpec& force : forces) {
    for (const LibrarySpec::Coefficient& one : force.coefficients) {
      names.push_back(force.name + "." + one.basis);
    }
  }
  for (const SensorUnknown& sensor : sensors) {
    names.push_back(sensor.parameter.name);
  }
  names.insert(names.end(), freed.begin(), freed.end());
  return names;
}

std::string SuspectUnknown(const std::string& text) {
  return TermName("other." + text);
}

Suspect::SensorUnknown UnknownGain(
    const std::string& name, const std::vector<std::pair<int, int>>& channels) {
  Suspect::SensorUnknown gain;
  gain.role = &MeasuredChannel::gain;
  gain.parameter.name = SuspectUnknown("gain." + name);
  gain.parameter.value = 1.0;
  gain.parameter.prior_mean = 1.0;
  gain.parameter.prior_sigma = 2.0;
  gain.channels = channels;
  return gain;
}

const char* SuspectKindName(Suspect::Kind kind) {
  switch (kind) {
    case Suspect::Kind::kDamping:
      return "damping";
    case Suspect::Kind::kMass:
      return "mass";
    case Suspect::Kind::kStiffness:
      return "stiffness";
    case Suspect::Kind::kBound:
      return "bound";
    case Suspect::Kind::kNonlinear:
      return "nonlinear";
    case Suspect::Kind::kSensorGain:
      return "sensor_gain";
    case Suspect::Kind::kSensorDelay:
      return "sensor_delay";
    case Suspect::Kind::kSensorOffset:
      return "sensor_offset";
    case Suspect::Kind::kExcitationDelay:
      return "excitation_delay";
    case Suspect::Kind::kExcitationScale:
      return "excitation_scale";
    case Suspect::Kind::kClockRate:
      return "clock_rate";
    case Suspect::Kind::kExchange:
      return "sensors_exchanged";
    case Suspect::Kind::kForcePlace:
      return "force_place";
    case Suspect::Kind::kMode:
      return "mode";
  }
  return "";
}

bool AddSuspects(const std::vector<Suspect>& suspects,
                 IdentificationProblem* problem, std::string* error) {
  IdentificationProblem result = *problem;
  result.description.known_as.clear();
  if (!AddTerms(suspects, &result, error)) return false;
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
      for (const auto& [set, response] : sensor.frf_responses) {
        FrfRecord& record = result.frfs[static_cast<size_t>(set)];
        std::vector<int>& unknowns = sensor.role == &MeasuredChannel::delay
                                         ? record.delays
                                         : record.gains;
        unknowns.resize(record.responses.size(), -1);
        int& place = unknowns[static_cast<size_t>(response)];
        if (place >= 0) {
          *error = "a sensor would have two unknowns of one kind";
          return false;
        }
        place = index;
      }
    }
    ChangeFrfs(suspect.frf_changes, &result);
    ChangeShapes(suspect.shape_changes, &result.modal);
    for (const auto& [one, two] : suspect.exchanged) {
      std::swap(ChannelAt(one, &result)->values,
                ChannelAt(two, &result)->values);
    }
    for (const Suspect::AmbientExchange& at : suspect.ambient_exchanged) {
      Matrix& samples = result.ambient[static_cast<size_t>(at.record)].samples;
      samples.row(at.one).swap(samples.row(at.two));
    }
    for (const Suspect::AmbientScale& at : suspect.ambient_scales) {
      result.ambient[static_cast<size_t>(at.record)].samples.row(at.channel) *=
          at.factor;
    }
  }
  std::set<int, std::greater<int>> left_out;
  for (const Suspect& suspect : suspects) {
    left_out.insert(suspect.left_out_modes.begin(),
                    suspect.left_out_modes.end());
  }
  for (const int mode : left_out) {
    result.modal.modes.erase(result.modal.modes.begin() + mode);
  }
  const bool has_forces = std::any_of(
      suspects.begin(), suspects.end(),
      [](const Suspect& suspect) { return !suspect.forces.empty(); });
  if (has_forces && !SetStepsAgain({}, &result, error)) return false;
  if (!result.IsValid(error)) return false;
  *problem = std::move(result);
  return true;
}

}  // namespace pinode
