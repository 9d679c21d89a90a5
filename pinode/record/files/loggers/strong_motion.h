// Reads accelerograms in the formats of CSMIP and COSMOS.

#ifndef PINODE_RECORD_FILES_LOGGERS_STRONG_MOTION_H_
#define PINODE_RECORD_FILES_LOGGERS_STRONG_MOTION_H_

#include <string>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Parses a file of strong motions: Volume 1 of CSMIP (acceleration that is not
// corrected), Volume 2 (acceleration, velocity and displacement), and COSMOS
// version 1.20, volumes 1 and 2. All have text, whole numbers, real numbers,
// and sections that begin with
//
//   12000 points of accel data equally spaced at  .005 sec, in cm/sec2.
//   12000 Accelerogram points at 200 pts/sec in units of g.  Format: (8f9.6)
//   12091 acceleration pts, approx 120 secs, units=cm/s^2,Format=(8F10.5)
//
// Volume 1 of film recorders, which has values at uneven times, is refused.
//
// The columns are ch1_acc, ch1_vel, ch1_disp and so on, by the channels'
// numbers. Velocities and displacements are derived channels. COSMOS states the
// sampling interval in its real header, number 62 (ms). The start is that of
// the header's text, if it is in UTC, GMT, PST or PDT.
// Source: COSMOS Strong Motion Data Format, version 1.20 (2001), and CSMIP
// report OSMS 85-03 for Volume 2.
[[nodiscard]] bool ParseStrongMotion(const std::string& text,
                                     const std::string& path,
                                     const ChannelFilter& wanted,
                                     LoggedFile* file, std::string* error);

// Returns true if the first line is that of such a file.
bool IsStrongMotionTitle(std::string_view line);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_STRONG_MOTION_H_
