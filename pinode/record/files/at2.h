// Reads ground motions in the text format of the PEER strong motion database.

#ifndef PINODE_RECORD_FILES_AT2_H_
#define PINODE_RECORD_FILES_AT2_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

struct At2Motion {
  // Title: the lines above the one with NPTS, joined by " | ".
  std::string title;
  // Sampling step (s); the first sample is at t = 0.
  double sampling_step = 0.0;
  // Ground acceleration (g).
  Vector acceleration;
};

// Reads an AT2 file. A few title lines come first, then one line with the
// number of points and the step in one of these spellings:
//
//   NPTS=   4172, DT=   .0100 SEC,
//   NPTS = 7990, DT = .005 SEC
//   4000   0.0050   NPTS, DT
//
// The points follow, any number per line. Text lines behind the last point are
// ignored. Refuses with `path:line: ...`: no such line among the first 40, a
// unit other than g, text among the points, fewer or more points than NPTS.
[[nodiscard]] bool ReadAt2(const std::string& path, At2Motion* motion,
                           std::string* error);

// Does what ReadAt2 does, for a text in memory. `path` is only used in
// messages.
[[nodiscard]] bool ParseAt2(const std::string& text, const std::string& path,
                            At2Motion* motion, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_AT2_H_
