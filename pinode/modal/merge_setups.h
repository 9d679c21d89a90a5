// Modes of one structure from several set-ups of sensors.

#ifndef PINODE_MODAL_MERGE_SETUPS_H_
#define PINODE_MODAL_MERGE_SETUPS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/identify_modes.h"

namespace pinode {

// The modes of one set-up, and where its shapes' entries are.
struct SetupModes {
  std::string name;
  std::vector<std::string> places;
  std::vector<IdentifiedMode> modes;
};

struct MergeOptions {
  // Places by which set-ups are tied together; default: those that all have.
  std::vector<std::string> references;
};

// A mode of the structure.
struct MergedMode {
  // Frequency and damping: means weighed by the set-ups' variances, their
  // sigmas those of the mean, or what the set-ups' scatter makes of them where
  // that is more. The shape is over all places: the covariance is that of
  // frequency, damping ratio, real parts, imaginary parts, NaN at places where
  // no set-up sees the mode.
  IdentifiedMode mode;
  std::vector<int> in_setups;  // of each set-up its mode's number, -1: none
  // Standard deviations between the set-ups, where several see it.
  double frequency_between = 0.0;  // Hz
  double damping_between = 0.0;
};

struct MergedModes {
  std::vector<std::string> places;
  std::vector<MergedMode> modes;  // by frequency
  std::vector<std::string> remarks;
};

// Ties modes of set-ups together that agree in frequency and in shape at the
// references, scales each shape so that it agrees at these with the most
// certain set-up (least squares), and means entries that several have by their
// variances. A mode that at least half of the set-ups see is one of the
// structure, others are remarks. One set-up is returned as it is. Source:
// post-separate-estimation re-scaling, e.g. M. Doehler, P. Andersen, L. Mevel,
// Proc. IMAC 28 (2010).
//
// False where the set-ups have no place in common.
[[nodiscard]] bool MergeSetups(const std::vector<SetupModes>& setups,
                               const MergeOptions& options, MergedModes* merged,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_MODAL_MERGE_SETUPS_H_
