// What measured loads do beside those that nobody measured.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_MEAN_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_MEAN_H_

#include <Eigen/Core>
#include <memory>
#include <string>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/ambient_spectrum.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// The lines of a record are those of the response to its measured loads, which
// a run from rest has exactly, and of a stationary rest. The run is tapered as
// the record is: neither ends nor gaps nor the memory of lightly damped modes
// make a difference between the two. Only what measured loads did before the
// record is not known; of that, the taper at its beginning leaves little.
class AmbientMean {
 public:
  // Of a record with measured loads. The lines are those of `transform`, over
  // `scales`, one a channel; all others must outlive this object.
  AmbientMean(const AmbientRecord& record, const StructuralDynamics& dynamics,
              LineTransform transform, const Vector& scales, int num_threads);

  // Free parameters of the dynamics, which come first among those of a problem.
  int num_free() const { return layout_.num_free(); }

  // Runs the model; on failure *error says why.
  [[nodiscard]] bool SetPoint(const Vector& free, std::string* error);
  // Lines of what the run leaves of the record, channels x lines.
  const Eigen::MatrixXcd& rest() const { return rest_; }
  // Lines of the record itself.
  const Eigen::MatrixXcd& measured() const { return measured_; }

  // Derivatives of the response at `free`, which are kept until the next call.
  [[nodiscard]] bool SetSlopes(const Vector& free, std::string* error);
  // Channels x num_free() of a line.
  Eigen::Map<const Eigen::MatrixXcd> slopes(Eigen::Index line) const {
    return {slopes_.col(line).data(), measured_.rows(), num_free()};
  }

 private:
  // With the gaps of the record.
  Eigen::MatrixXcd LinesOf(Matrix samples) const;

  const AmbientRecord& record_;
  const LineTransform transform_;
  const Vector& scales_;
  const int num_threads_;
  IdentificationProblem alone_;
  ParameterLayout layout_;
  MultipleShooting shooting_;
  Eigen::MatrixXcd measured_;
  Eigen::MatrixXcd rest_;
  Eigen::MatrixXcd slopes_;  // (channels num_free()) x lines
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_MEAN_H_
