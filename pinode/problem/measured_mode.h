// Modes that were measured: frequencies, and shapes at some of the DOFs.

#ifndef PINODE_PROBLEM_MEASURED_MODE_H_
#define PINODE_PROBLEM_MEASURED_MODE_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// How measured modes are held against those of the model. With w^2 and phi of
// the model's mode at the measured DOFs, f and y measured,
//
//   kMac                    (1 - w^2 / (2 pi f)^2) and (1 - c) / c, c the root
//                           of the MAC of phi and y: two residuals a mode
//   kEigenvectorDifference  the first of these, and phi - y, both scaled to one
//                           at the DOF where y is largest
//   kDynamicResidual        (K - (2 pi f)^2 M) psi, num_dofs residuals a mode:
//                           psi is y, one at its largest, and, at the DOFs
//                           that were not measured, what makes them smallest
//
// each times its weight. The first two after X. Dong and Y. Wang, "Formulation
// and optimization algorithm comparison for the FE model updating of
// large-scale structures", Georgia Institute of Technology; the third after C.
// Farhat and F. M. Hemez, AIAA J. 31 (1993) 1702-1711.
enum class ModalForm { kMac, kEigenvectorDifference, kDynamicResidual };
const char* ModalFormName(ModalForm form);

// A mode that was measured.
struct MeasuredMode {
  std::string name;
  double frequency = 0.0;  // cycles per unit of the model's time
  // Standard deviation of the frequency; where it is not given (0), the weight
  // of its residual.
  double frequency_sigma = 0.0;
  double frequency_weight = 1.0;
  // The shape, at whatever scale and sign, at these DOFs; none: not measured.
  std::vector<int> dofs;
  Vector shape;
  // Standard deviation of every entry, in the units of `shape`, of
  // kEigenvectorDifference alone: it makes allowance for the error of the entry
  // that scales the others. Where it is not given (0), the weight.
  double shape_sigma = 0.0;
  double shape_weight = 1.0;
  // In place of both: the covariance of the entries of `shape`, as a modal
  // identification gives it; empty: not given.
  Matrix shape_covariance;
  // Beside both sigma of the frequency and covariance of the shape: that of the
  // frequency with each entry of `shape`; empty: they have nothing in common.
  Vector frequency_shape_covariance;
  // Of kDynamicResidual, in place of all of these: one over the force per
  // largest entry of the shape.
  double residual_weight = 1.0;

  bool HasShape() const { return !dofs.empty(); }
  bool HasShapeSigma() const {
    return shape_sigma > 0.0 || shape_covariance.size() > 0;
  }
};

// What was measured, and how it enters a fit.
struct ModalData {
  ModalForm form = ModalForm::kEigenvectorDifference;
  std::vector<MeasuredMode> modes;
  // Covariates while they were measured, one number for each input of the
  // dynamics; none: groups that follow one take no part, as at their reference.
  Vector inputs;

  bool empty() const { return modes.empty(); }
  // Whether a standard deviation is given. Weights are then the inverse of one;
  // where none is, they say how modes and shapes compare.
  bool HasSigmas() const;
  // Whether every residual is one in units of a standard deviation.
  bool HasSigmasOfAll() const;

  // Positive frequencies and weights, no sigma that the form has no use for,
  // covariances that are positive definite, that of frequency and shape too,
  // DOFs that exist, each once, shapes that are not zero and say something (two
  // DOFs; one for kDynamicResidual, which cannot do without). There may be more
  // modes than DOFs: not all HavePartners then. On failure names the mode.
  [[nodiscard]] bool IsValid(int num_dofs, std::string* error) const;
};

// The mode of a model that a measured one is paired with.
struct ModeMatch {
  int mode = -1;            // ascending by frequency
  double frequency = kNaN;  // as the measured one; NaN where w^2 < 0
  double mac = kNaN;        // at the measured DOFs; NaN without a shape
};

// Whether the model has a mode for each of those measured. A pair is worth what
// MatchModes takes it for, frequencies being compared but for one common factor
// (the median over the pairs: a model may be too stiff as a whole); a measured
// mode that is worth less than kLeastPairProfit to every mode of the model that
// the others leave over has none. All have one where none would, or, of more
// than the model has modes, those that are worth most.
constexpr double kLeastPairProfit = 0.3;
std::vector<bool> HavePartners(const ModalData& data, const Vector& eigenvalues,
                               const Matrix& shapes);

// The same of a model's M and K; where it has no modes as many of the first
// have one as it has DOFs.
std::vector<bool> HavePartners(const ModalData& data,
                               const StructuralModel& model);

// Those of the modes that are marked.
ModalData OnlyModes(const ModalData& data, const std::vector<bool>& kept);

// For each mode of `data` (valid, no more than the model has) its partner among
// the model's, given by its w^2 (ascending) and shapes (num_dofs x modes), one
// to one. The sum of
//
//   MAC - 1/2 (ln (w / (2 pi f)))^2
//
// is as large as possible: shapes decide, also where frequencies have crossed;
// frequencies decide between modes that look alike at few DOFs, and keep the
// order of modes without shapes (MAC 1).
std::vector<ModeMatch> MatchModes(const ModalData& data,
                                  const Vector& eigenvalues,
                                  const Matrix& shapes);

// The same of a model's M and K; false where it has no modes.
[[nodiscard]] bool MatchModes(const ModalData& data,
                              const StructuralModel& model,
                              std::vector<ModeMatch>* matches,
                              std::string* error);

}  // namespace pinode

#endif  // PINODE_PROBLEM_MEASURED_MODE_H_
