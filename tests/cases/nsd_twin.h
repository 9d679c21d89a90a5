// The frame of data/nsd under any ground motion: what its generate.py does, for
// ground motions that are no part of the project.

#ifndef PINODE_TESTS_CASES_NSD_TWIN_H_
#define PINODE_TESTS_CASES_NSD_TWIN_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {
namespace testing {

// Of every response that is written or scored.
inline constexpr double kRateHz = 256.0;
// The records that train end here; their responses go on for 10 s.
inline constexpr double kTrainingSeconds = 20.0;

// M a + C v + K x + e1 f(x1) = -M 1 ag,  f = k (x1 - clamp(x1, -gap, gap)).
//
// Linear outside, inside and on the other side of the gap, so that the response
// to a ground acceleration linear between samples is a product of matrix
// exponentials, cut where x1 meets the gap. Nothing here is pinode's.
class NsdTwin {
 public:
  // Matrices and device from a truth.json.
  explicit NsdTwin(const std::string& truth_path);

  // States x1..x3 v1..v3, a row a sample, from rest.
  Matrix Respond(const Vector& ground, bool device) const;
  // A row a sample; `states` as above.
  Matrix AbsoluteAccelerations(const Matrix& states, bool device) const;

 private:
  double DeviceForce(double drift) const;

  Vector mass_;
  Matrix stiffness_, damping_;
  double k_, gap_;
};

// The case on measured ground motions (Takatori, Pacoima Dam; Rinaldi held out)
// in `folder`, made anew: the case files of data/nsd with other records. False
// with a reason where `measured` lacks one of the motions or a file cannot be
// written.
[[nodiscard]] bool WriteMeasuredNsd(const std::string& measured,
                                    const std::string& folder,
                                    std::string* error);

}  // namespace testing
}  // namespace pinode

#endif  // PINODE_TESTS_CASES_NSD_TWIN_H_
