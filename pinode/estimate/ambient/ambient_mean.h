// The response of an ambient record to its measured loads.

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

// The response to the measured loads and its spectral lines. A record's lines
// are the sum of these and of the lines of a stationary rest.
//
// The response is computed as a run from rest, and the run has the same taper
// as the record. So the ends, the gaps and the memory of lightly damped modes
// are the same in both. The loads before the record are unknown; the taper at
// the beginning of the record leaves little of their effect.
class AmbientMean {
 public:
  // `record` has measured loads, and `dynamics` is linear. The lines are those
  // of `transform`, each channel over its entry of `scales`. The references
  // must outlive this object.
  AmbientMean(const AmbientRecord& record, const StructuralDynamics& dynamics,
              LineTransform transform, const Vector& scales, int num_threads);

  // Number of free parameters of the dynamics, the first of a problem's.
  int num_free() const { return layout_.num_free(); }

  // Runs the model; on failure *error says why.
  [[nodiscard]] bool SetPoint(const Vector& free, std::string* error);
  // Lines of the record minus the run, channels x lines.
  const Eigen::MatrixXcd& rest() const { return rest_; }
  // Lines of the record itself.
  const Eigen::MatrixXcd& measured() const { return measured_; }

  // Computes the derivatives of the response at `free` and keeps them until the
  // next call. On failure *error says why.
  [[nodiscard]] bool SetSlopes(const Vector& free, std::string* error);
  // Derivatives of a line of the response, channels x num_free().
  Eigen::Map<const Eigen::MatrixXcd> slopes(Eigen::Index line) const {
    return {slopes_.col(line).data(), measured_.rows(), num_free()};
  }

 private:
  // Lines of `samples`, in which the record's gaps are gaps too.
  Eigen::MatrixXcd LinesOf(Matrix samples) const;

  const AmbientRecord& record_;
  const LineTransform transform_;
  const Vector& scales_;
  const int num_threads_;
  IdentificationProblem alone_;  // the run
  ParameterLayout layout_;
  MultipleShooting shooting_;
  Eigen::MatrixXcd measured_;
  Eigen::MatrixXcd rest_;
  Eigen::MatrixXcd slopes_;  // (channels num_free()) x lines
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_MEAN_H_
