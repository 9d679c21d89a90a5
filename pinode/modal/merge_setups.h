// Modes of one structure from several sensor set-ups, merged.

#ifndef PINODE_MODAL_MERGE_SETUPS_H_
#define PINODE_MODAL_MERGE_SETUPS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/identify_modes.h"

namespace pinode {

// Modes of one set-up. `places` names the place of each entry of their shapes.
struct SetupModes {
  std::string name;
  std::vector<std::string> places;
  std::vector<IdentifiedMode> modes;
};

// Options of MergeSetups.
struct MergeOptions {
  // Places that connect the set-ups. Empty: the places that all set-ups have.
  std::vector<std::string> references;
};

// Mode of the structure.
struct MergedMode {
  // Merged mode. Frequency and damping are means of the set-ups, weighted by 1
  // / variance. Their sigmas are those of the mean, or follow from the scatter
  // of the set-ups if that gives more. The shape has one entry for each of
  // MergedModes::places. Shape and covariance are NaN at places where no set-up
  // sees the mode.
  IdentifiedMode mode;
  // Index of the mode in each set-up, from 0; -1: the set-up does not see it.
  std::vector<int> in_setups;
  // Standard deviations between the set-ups. 0 if only one sees the mode.
  double frequency_between = 0.0;  // Hz
  double damping_between = 0.0;
};

// Result of MergeSetups. `places` has the places of all set-ups.
struct MergedModes {
  std::vector<std::string> places;
  std::vector<MergedMode> modes;  // ascending frequency
  std::vector<std::string> remarks;
};

// Merges modes that agree in frequency, and in shape at the reference places.
// Each shape is scaled so that it agrees there with the shape of the most
// certain set-up, by least squares. Entries that several set-ups have are
// averaged, weighted by 1 / variance. The method is post-separate-estimation
// re-scaling (M. Doehler, P. Andersen, L. Mevel, Proc. IMAC 28 (2010)).
//
// A mode is a mode of the structure if at least half of the set-ups see it.
// Other modes become remarks. A single set-up is returned unchanged.
//
// Returns false, with a sentence in *error, if the set-ups have no place in
// common.
[[nodiscard]] bool MergeSetups(const std::vector<SetupModes>& setups,
                               const MergeOptions& options, MergedModes* merged,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_MODAL_MERGE_SETUPS_H_
