// Position, velocity and acceleration from noisy records of some of them.

#ifndef PINODE_DISCOVER_SMOOTH_MOTION_H_
#define PINODE_DISCOVER_SMOOTH_MOTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Record of one DOF's displacement (derivative 0), velocity (1) or acceleration
// (2). All channels show the same motion.
struct MotionChannel {
  int derivative = 0;
  Vector values;       // one per sample; NaN where missing
  double sigma = 0.0;  // of the noise; 0: estimate it
};

struct SmoothedMotion {
  Matrix motion;  // 3 x samples: displacement, velocity, acceleration
  Matrix sigma;   // their standard deviations given all records
  std::vector<double> noise;  // of each channel, as given or estimated
  // Order of the derivative of the displacement that is a Wiener process.
  int order = 0;
};

// Smooths motion without a model of the structure. The second or the third
// derivative of the displacement is a Wiener process, which makes the estimate
// a smoothing spline of degree 5 or 7 through all channels at once (G. Wahba,
// JRSS B 40 (1978) 364). Order, intensity of the process and noise levels are
// those of the greatest likelihood; means and variances come from the Kalman
// filter and the smoother of Rauch, Tung and Striebel (1965).
//
// `step`: time between samples. All channels have the same number of samples,
// at least eight. Returns false without a displacement channel of at least
// eight values that are not all equal: velocities and accelerations alone do
// not determine the displacement.
[[nodiscard]] bool SmoothMotion(double step,
                                const std::vector<MotionChannel>& channels,
                                SmoothedMotion* result, std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_SMOOTH_MOTION_H_
