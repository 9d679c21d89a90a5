// Catalogue of what a model may lack, each entry a few extra unknowns.

#ifndef PINODE_STUDY_EXPLANATIONS_SUSPECT_H_
#define PINODE_STUDY_EXPLANATIONS_SUSPECT_H_

#include <string>
#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/group_term.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Entry of the catalogue: the unknowns that a problem gets if this is what its
// model lacks. All begin at values that change nothing.
struct Suspect {
  enum class Kind {
    kDamping,          // factors on the damping
    kMass,             // a mass, or all of them by one factor
    kStiffness,        // of a spring, or of a group that the user has fixed
    kBound,            // bounds of a group that a fit has reached
    kSensorGain,       // of one sensor
    kSensorDelay,      // of one sensor
    kSensorOffset,     // of one sensor
    kExcitationDelay,  // of the excitation against all sensors
    kExcitationScale,  // of the excitation, or of all sensors alike
    kExchange,         // two sensors in each other's place
  };

  // Unknown of sensors, shared by these channels (record, channel).
  struct SensorUnknown {
    int MeasuredChannel::*role = &MeasuredChannel::gain;
    Parameter parameter;
    std::vector<std::pair<int, int>> channels;
  };

  Kind kind = Kind::kDamping;
  std::string place;  // as Explanation::place
  std::string what;   // as Explanation::what, without values
  std::vector<GroupTerm> groups;
  std::vector<SensorUnknown> sensors;
  // Groups of the problem that become free, without bounds.
  std::vector<std::string> freed;
  // Two channels of a record that exchange their values.
  std::vector<std::pair<std::pair<int, int>, std::pair<int, int>>> exchanged;

  // Its only unknown equals these unknowns of other suspects, all at the same
  // value: a common delay, the delays of all sensors. Empty: there are none.
  std::vector<std::string> tied;

  // Names of its unknowns in a problem that has them.
  std::vector<std::string> Unknowns() const;
};

// Returns "damping", "mass", ..., as Explanation::kind.
const char* SuspectKindName(Suspect::Kind kind);

// Returns the catalogue for `problem` near `model`, values of its unknowns.
// It leaves out unknowns that the problem has already. Single masses and
// springs are in it for structures with at most 40 DOFs, and springs for
// stiffness matrices that consist of them.
std::vector<Suspect> MakeSuspects(const IdentificationProblem& problem,
                                  const IdentifiedModel& model);

// Adds the unknowns of `suspects` to *problem. Returns false, with *error, if
// they do not fit it or each other.
[[nodiscard]] bool AddSuspects(const std::vector<Suspect>& suspects,
                               IdentificationProblem* problem,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_SUSPECT_H_
