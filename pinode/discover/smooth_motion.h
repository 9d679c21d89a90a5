// Position, velocity and acceleration from noisy records of some of them.

#ifndef PINODE_DISCOVER_SMOOTH_MOTION_H_
#define PINODE_DISCOVER_SMOOTH_MOTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// A record of one DOF's displacement (derivative 0), velocity (1) or
// acceleration (2), all of the same motion.
struct MotionChannel {
  int derivative = 0;
  Vector values;       // one a sample; NaN where missing
  double sigma = 0.0;  // of the noise; 0: estimate it
};

struct SmoothedMotion {
  Matrix motion;  // 3 x samples: displacement, velocity, acceleration
  Matrix sigma;   // their standard deviations given all records
  std::vector<double> noise;  // of each channel, as given or estimated
  // Which derivative of the displacement is taken for a Wiener process.
  int order = 0;
};

// Smooths without a model of the structure: the second or the third derivative
// of the displacement is a Wiener process, which makes the estimate a smoothing
// spline of degree 5 or 7 through all channels at once (G. Wahba, JRSS B 40
// (1978) 364). Order, intensity of the process and noise levels are those of
// the greatest likelihood; means and variances come from the Kalman filter and
// the smoother of Rauch, Tung and Striebel (1965).
//
// `step`: time between samples, all channels having the same, at least eight.
// False without a displacement channel of at least eight values that are not
// all equal: what only velocities or accelerations show, leaves the
// displacement open.
[[nodiscard]] bool SmoothMotion(double step,
                                const std::vector<MotionChannel>& channels,
                                SmoothedMotion* result, std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_SMOOTH_MOTION_H_
