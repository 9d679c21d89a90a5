// Merges the modes of one structure from several sensor set-ups.

#ifndef PINODE_MODAL_MERGE_SETUPS_H_
#define PINODE_MODAL_MERGE_SETUPS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/identify_modes.h"

namespace pinode {

// The modes of one set-up, and the places of its shapes' entries.
struct SetupModes {
  std::string name;
  std::vector<std::string> places;
  std::vector<IdentifiedMode> modes;
};

struct MergeOptions {
  // Places that connect the set-ups. Default: the places that all set-ups have.
  std::vector<std::string> references;
};

// A mode of the structure.
struct MergedMode {
  // Merged mode. Frequency and damping are means weighted by the set-ups'
  // variances. Their sigmas are those of the mean, or follow from the scatter
  // of the set-ups if that is larger. The shape covers all places. The
  // covariance is that of frequency, damping ratio, real parts, imaginary
  // parts; it is NaN at places where no set-up sees the mode.
  IdentifiedMode mode;
  std::vector<int> in_setups;  // number of the mode in each; -1: none
  // Standard deviations between the set-ups, if several see the mode.
  double frequency_between = 0.0;  // Hz
  double damping_between = 0.0;
};

struct MergedModes {
  std::vector<std::string> places;
  std::vector<MergedMode> modes;  // by frequency
  std::vector<std::string> remarks;
};

// Merges modes of set-ups that agree in frequency and in shape at the
// references. Scales each shape so that it agrees there with the most certain
// set-up (least squares). Averages entries that several set-ups have, weighted
// by their variances. A mode that at least half of the set-ups see is a mode of
// the structure; others become remarks. A single set-up is returned unchanged.
// Source: post-separate-estimation re-scaling, e.g. M. Doehler, P. Andersen, L.
// Mevel, Proc. IMAC 28 (2010).
//
// Returns false if the set-ups have no place in common.
[[nodiscard]] bool MergeSetups(const std::vector<SetupModes>& setups,
                               const MergeOptions& options, MergedModes* merged,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_MODAL_MERGE_SETUPS_H_
