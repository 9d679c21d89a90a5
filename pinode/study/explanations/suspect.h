// Entry of the catalogue of things that a model may lack.

#ifndef PINODE_STUDY_EXPLANATIONS_SUSPECT_H_
#define PINODE_STUDY_EXPLANATIONS_SUSPECT_H_

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pinode/dynamics/group_term.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/terms/library_term.h"

namespace pinode {

// Entry of the catalogue (MakeSuspects). All its unknowns begin at values that
// change nothing.
struct Suspect {
  enum class Kind {
    kDamping,          // factors on the damping
    kMass,             // a mass, or all of them by one factor
    kStiffness,        // of a spring, or of a group that the user has fixed
    kBound,            // bounds of a group that a fit has reached
    kNonlinear,        // a nonlinear force at a spring
    kSensorGain,       // of one sensor
    kSensorDelay,      // of one sensor
    kSensorOffset,     // of one sensor
    kExcitationDelay,  // of the excitation against all sensors
    kExcitationScale,  // of the excitation, or of all sensors alike
    kClockRate,        // of the logger
    kExchange,         // two sensors in each other's place
    kForcePlace,       // another place of an unknown force
    kMode,             // a measured mode that is left out
  };

  // Unknown of sensors, shared by these channels (record, channel).
  struct SensorUnknown {
    int MeasuredChannel::*role = &MeasuredChannel::gain;
    Parameter parameter;
    std::vector<std::pair<int, int>> channels;
    // Responses of frequency responses (set-up, response) with this gain or
    // delay.
    std::vector<std::pair<int, int>> frf_responses;
  };

  Kind kind = Kind::kDamping;
  std::string place;  // as Explanation::place
  std::string what;   // as Explanation::what, without values
  std::vector<GroupTerm> groups;
  std::vector<LibrarySpec> forces;
  std::vector<SensorUnknown> sensors;
  // Groups of the problem that become free, without bounds.
  std::vector<std::string> freed;
  // Unknown forces that act through other outputs (num_dofs).
  struct ForceAt {
    std::string name;
    Vector outputs;
  };
  std::vector<ForceAt> moved_forces;
  // Measured modes that are left out, by index.
  std::vector<int> left_out_modes;
  // Two channels of a record that exchange their values.
  std::vector<std::pair<std::pair<int, int>, std::pair<int, int>>> exchanged;

  // Two channels of an ambient record that exchange their samples, and channels
  // of one whose samples are multiplied by a factor.
  struct AmbientExchange {
    int record = 0;
    int one = 0, two = 0;
  };
  std::vector<AmbientExchange> ambient_exchanged;
  struct AmbientScale {
    int record = 0;
    int channel = 0;
    double factor = 1.0;
  };
  std::vector<AmbientScale> ambient_scales;

  // Two responses, or forces, of a set-up of frequency responses that exchange
  // their functions. Twice the same one: its functions change their sign.
  struct FrfChange {
    int record = 0;
    bool of_forces = false;
    int one = 0, two = 0;
  };
  std::vector<FrfChange> frf_changes;

  // Change of measured shapes: the entries at a DOF are multiplied by a factor,
  // the entries at two DOFs change places, or two modes change shapes.
  struct ShapeChange {
    enum class Kind { kScale, kExchangeDofs, kExchangeModes };
    Kind kind = Kind::kScale;
    int one = -1, two = -1;  // DOFs, or indices of modes
    int mode = -1;           // -1: in all modes
    double factor = 1.0;
  };
  std::vector<ShapeChange> shape_changes;

  // Number of suspects of its kind from which it was chosen by the same data.
  size_t num_compared = 1;

  // The unknown of its sensors equals these unknowns of other suspects, all at
  // the same value: a common delay, the delays of all sensors. Empty: there are
  // none.
  std::vector<std::string> tied;

  // Plausible size of its unknowns: standard deviation of the error that a
  // careful user still makes.
  double usual = 0.1;

  // True if it changes the problem at once: it has no infinitesimal part that a
  // score test could see.
  bool IsDiscrete() const {
    return !exchanged.empty() || !moved_forces.empty() ||
           !left_out_modes.empty() || !ambient_exchanged.empty() ||
           !ambient_scales.empty() || !frf_changes.empty() ||
           !shape_changes.empty();
  }
  // Names of its unknowns in a problem that has them.
  std::vector<std::string> Unknowns() const;
};

// Returns "damping", "mass", ..., as Explanation::kind.
const char* SuspectKindName(Suspect::Kind kind);

// Name of an unknown of a suspect.
std::string SuspectUnknown(const std::string& text);

// Unknown gain of these channels, 1 at first.
Suspect::SensorUnknown UnknownGain(
    const std::string& name, const std::vector<std::pair<int, int>>& channels);

// Adds the unknowns of `suspects` to *problem. Returns false, with *error, if
// they do not fit it or each other.
[[nodiscard]] bool AddSuspects(const std::vector<Suspect>& suspects,
                               IdentificationProblem* problem,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_SUSPECT_H_
