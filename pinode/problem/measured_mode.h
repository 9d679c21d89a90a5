// Measured modes: frequencies, and mode shapes at some of the DOFs.

#ifndef PINODE_PROBLEM_MEASURED_MODE_H_
#define PINODE_PROBLEM_MEASURED_MODE_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Form of the residuals between measured modes and modes of the model. f and y
// are the measured frequency and shape. w^2 and phi are the eigenvalue of the
// model's mode and its shape at the measured DOFs. Each residual is multiplied
// by its weight.
//
//   kMac                    (1 - w^2 / (2 pi f)^2) and (1 - c) / c, c the root
//                           of the MAC of phi and y: two residuals per mode
//   kEigenvectorDifference  the first of these, and phi - y, both scaled to one
//                           at the DOF where y is largest
//   kDynamicResidual        (K - (2 pi f)^2 M) psi, num_dofs residuals a mode:
//                           psi is y, one at its largest, and, at the DOFs
//                           that were not measured, the values that make the
//                           residuals smallest
//
// Sources: kMac and kEigenvectorDifference are those of X. Dong and Y. Wang,
// "Formulation and optimization algorithm comparison for the FE model updating
// of large-scale structures", Georgia Institute of Technology. kDynamicResidual
// is that of C. Farhat and F. M. Hemez, AIAA J. 31 (1993) 1702-1711.
enum class ModalForm { kMac, kEigenvectorDifference, kDynamicResidual };
// Returns the name as in case files.
const char* ModalFormName(ModalForm form);

// Measured mode.
struct MeasuredMode {
  std::string name;
  double frequency = 0.0;  // cycles per unit of the model's time
  // Standard deviation of the frequency, in the same unit. 0: not given; the
  // weight of the residual is then frequency_weight.
  double frequency_sigma = 0.0;
  double frequency_weight = 1.0;
  // Indices of the measured DOFs, and the shape there with any scale and sign,
  // one entry each. Empty: no shape was measured.
  std::vector<int> dofs;
  Vector shape;
  // Standard deviation of each entry, in the units of `shape`, for
  // kEigenvectorDifference only. It includes the error of the largest entry,
  // which scales the others. 0: not given; the weight is then shape_weight.
  double shape_sigma = 0.0;
  double shape_weight = 1.0;
  // Covariance of the entries of `shape`, square, from a modal identification.
  // It replaces shape_sigma and shape_weight. Empty: not given.
  Matrix shape_covariance;
  // Covariance of the frequency with each entry of `shape`. It needs
  // frequency_sigma and shape_covariance. Empty: they are independent.
  Vector frequency_shape_covariance;
  // Weight of kDynamicResidual, in place of all values above. It is the inverse
  // of a force per unit of the shape's largest entry.
  double residual_weight = 1.0;

  bool HasShape() const { return !dofs.empty(); }
  bool HasShapeSigma() const {
    return shape_sigma > 0.0 || shape_covariance.size() > 0;
  }
};

// Measured modes, and how they enter a fit.
struct ModalData {
  ModalForm form = ModalForm::kEigenvectorDifference;
  std::vector<MeasuredMode> modes;
  // Values of the inputs (covariates) during the measurement, one per input of
  // the dynamics. Empty: groups that follow a covariate stay at their
  // reference.
  Vector inputs;

  bool empty() const { return modes.empty(); }
  // True if any standard deviation is given. Weights are then inverses of
  // standard deviations. Without any, only the ratios of weights matter.
  bool HasSigmas() const;
  // True if every residual is in units of a standard deviation.
  bool HasSigmasOfAll() const;

  // Checks the modes:
  //
  // - frequencies and weights are positive, and each sigma is used by the form;
  // - covariances are positive definite, also that of frequency and shape;
  // - DOFs exist, each once;
  // - shapes are not zero and have at least two DOFs; kDynamicResidual needs a
  //   shape, of at least one DOF.
  //
  // There may be more modes than DOFs; some then have no partner, see
  // HavePartners. On failure returns false, and *error names the mode.
  [[nodiscard]] bool IsValid(int num_dofs, std::string* error) const;
};

// Mode of a model that is the partner of a measured mode.
struct ModeMatch {
  int mode = -1;            // index by ascending frequency
  double frequency = kNaN;  // unit as measured; NaN if w^2 < 0
  // MAC at the measured DOFs; NaN without a shape. For close modes: MAC of the
  // measured shape with the span of all their partners (CloseModes).
  double mac = kNaN;
};

// Value of a pair of modes below which they are not partners, see HavePartners.
constexpr double kLeastPairProfit = 0.3;
// Returns one flag per measured mode, true if it has a partner among the modes
// of the model. `eigenvalues` are the w^2 of the model, ascending; `shapes` is
// num_dofs x modes.
//
// The value of a pair is that of MatchModes. Before, the model's frequencies
// are scaled by a common factor, the median over the pairs, because a model may
// be too stiff as a whole. A measured mode has no partner if its value is below
// kLeastPairProfit for every mode that is not the partner of another one. If no
// mode would have a partner, all have one. If the model has fewer modes than
// were measured, the pairs with the largest values are used.
std::vector<bool> HavePartners(const ModalData& data, const Vector& eigenvalues,
                               const Matrix& shapes);

// Returns the same flags for a model with the matrices M and K. If its modes
// cannot be computed, the first num_dofs measured modes have a partner.
std::vector<bool> HavePartners(const ModalData& data,
                               const StructuralModel& model);

// Returns the modes that are marked in `kept`, one flag per mode.
ModalData OnlyModes(const ModalData& data, const std::vector<bool>& kept);

// Returns the partner of each measured mode among the modes of the model, one
// to one. `data` must be valid and have no more modes than the model.
// `eigenvalues` are the w^2 of the model, ascending; `shapes` is num_dofs x
// modes. The pairs maximise the sum of
//
//   MAC - 1/2 (ln (w / (2 pi f)))^2
//
// (H. W. Kuhn 1955). Shapes therefore decide, also if frequencies have crossed.
// Frequencies decide between modes with similar shapes at the measured DOFs,
// and between modes without shapes, whose MAC counts as 1.
std::vector<ModeMatch> MatchModes(const ModalData& data,
                                  const Vector& eigenvalues,
                                  const Matrix& shapes);

// Finds the same partners for a model with the matrices M and K. Returns false,
// with *error, if its modes cannot be computed.
[[nodiscard]] bool MatchModes(const ModalData& data,
                              const StructuralModel& model,
                              std::vector<ModeMatch>* matches,
                              std::string* error);

}  // namespace pinode

#endif  // PINODE_PROBLEM_MEASURED_MODE_H_
