// The spectral lines of an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_LINES_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_LINES_H_

#include <Eigen/Core>
#include <memory>
#include <string>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/ambient/ambient_mean.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/ambient_spectrum.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {

// The data of the likelihood: the record's lines in its band, each channel over
// its scale, minus those of the response to measured loads. Neighbouring lines
// within an eighth of a mode's bandwidth are taken together; "line" in this
// room means one such group of lines.
class AmbientLines {
 public:
  AmbientLines(const AmbientLines&) = delete;
  AmbientLines& operator=(const AmbientLines&) = delete;

  // `averaged` is record.AveragedDynamics(), and `modes` are its modes at the
  // initial values. `measured_loads` has the record's measured loads as rows,
  // none if nothing was measured. The record and `averaged` must outlive this
  // object.
  AmbientLines(const AmbientRecord& record, const StructuralDynamics& averaged,
               const ModalProperties& modes, const Matrix& measured_loads,
               int num_threads);

  Eigen::Index size() const { return groups_.size(); }
  double frequency(Eigen::Index line) const { return groups_.frequency[line]; }
  // Number of independent lines that a line stands for.
  double count(Eigen::Index line) const { return groups_.count[line]; }
  // Sum of Y Y^H over those.
  const Eigen::MatrixXcd& products(Eigen::Index line) const {
    return groups_.products[static_cast<size_t>(line)];
  }
  const LineGroups& groups() const { return groups_; }
  // Number of lines before neighbours were taken together.
  Eigen::Index num_single() const { return num_single_; }

  // Ends of the band, cycles per model time.
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  // Scale of each channel: the root of its mean density in the band.
  const Vector& scales() const { return scales_; }
  // Density of each channel, over its scale, below which noise makes no
  // difference.
  const Vector& smallest_noise() const { return smallest_noise_; }
  // Constant that makes the cost positive.
  double offset() const { return offset_; }
  // Response to the measured loads; nullptr: no load is measured.
  const AmbientMean* mean() const { return mean_.get(); }

  // Subtracts the response to measured loads at `free`. On failure *error says
  // why.
  [[nodiscard]] bool SetPoint(const Vector& free, std::string* error);
  // Finds the derivatives of that response.
  [[nodiscard]] bool SetSlopes(const Vector& free, std::string* error);

 private:
  double lowest_ = 0.0;
  double highest_ = 0.0;
  Eigen::Index num_single_ = 0;
  Vector scales_;
  LineGroups groups_;
  Vector smallest_noise_;
  double offset_ = 0.0;
  std::unique_ptr<AmbientMean> mean_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_LINES_H_
