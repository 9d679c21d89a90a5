// Measured modes: frequencies, and shapes at some of the DOFs.

#ifndef PINODE_PROBLEM_MEASURED_MODE_H_
#define PINODE_PROBLEM_MEASURED_MODE_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Form of the residuals between measured modes and those of the model. With w^2
// and phi of the model's mode at the measured DOFs, f and y measured,
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
// each times its weight. The first two follow X. Dong and Y. Wang, "Formulation
// and optimization algorithm comparison for the FE model updating of
// large-scale structures", Georgia Institute of Technology; the third follows
// C. Farhat and F. M. Hemez, AIAA J. 31 (1993) 1702-1711.
enum class ModalForm { kMac, kEigenvectorDifference, kDynamicResidual };
const char* ModalFormName(ModalForm form);

// A measured mode.
struct MeasuredMode {
  std::string name;
  double frequency = 0.0;  // cycles per unit of the model's time
  // Standard deviation of the frequency. If it is not given (0),
  // `frequency_weight` is the weight of its residual.
  double frequency_sigma = 0.0;
  double frequency_weight = 1.0;
  // Shape at these DOFs, at any scale and sign. Empty: not measured.
  std::vector<int> dofs;
  Vector shape;
  // Standard deviation of each entry, in the units of `shape`; for
  // kEigenvectorDifference only. It includes the error of the entry that scales
  // the others. If it is not given (0), the weight applies.
  double shape_sigma = 0.0;
  double shape_weight = 1.0;
  // Covariance of the entries of `shape` from a modal identification; replaces
  // both. Empty: not given.
  Matrix shape_covariance;
  // Covariance of the frequency with each entry of `shape`; needs both
  // `frequency_sigma` and `shape_covariance`. Empty: they are independent.
  Vector frequency_shape_covariance;
  // Weight of kDynamicResidual, which replaces all of these: one over the force
  // per largest entry of the shape.
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
  // Covariates during the measurement, one number per input of the dynamics.
  // Empty: groups that follow a covariate stay at their reference.
  Vector inputs;

  bool empty() const { return modes.empty(); }
  // True if a standard deviation is given. Weights are then inverses of
  // standard deviations. Without any, they say how frequencies and shapes
  // compare.
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
  // There may be more modes than DOFs: not all HavePartners then. On failure
  // *error names the mode.
  [[nodiscard]] bool IsValid(int num_dofs, std::string* error) const;
};

// Mode of a model that is paired with a measured one.
struct ModeMatch {
  int mode = -1;            // ascending by frequency
  double frequency = kNaN;  // as the measured one; NaN where w^2 < 0
  double mac = kNaN;        // at the measured DOFs; NaN without a shape
};

// Tells which measured modes have a partner among the model's. A pair's value
// is that of MatchModes, after frequencies are scaled by one common factor (the
// median over the pairs: a model may be too stiff as a whole). A measured mode
// has no partner if its value is below kLeastPairProfit for every mode of the
// model that the others leave over. All have one if none would. With more
// measured modes than the model has, the pairs of highest value count.
constexpr double kLeastPairProfit = 0.3;
std::vector<bool> HavePartners(const ModalData& data, const Vector& eigenvalues,
                               const Matrix& shapes);

// Returns the same for a model's M and K. If the model has no modes, as many of
// the first measured modes have a partner as it has DOFs.
std::vector<bool> HavePartners(const ModalData& data,
                               const StructuralModel& model);

// Returns the marked modes.
ModalData OnlyModes(const ModalData& data, const std::vector<bool>& kept);

// Returns for each mode of `data` (valid, no more than the model has) its
// partner among the model's, one to one. The model's are given by w^2
// (ascending) and shapes (num_dofs x modes). The sum of
//
//   MAC - 1/2 (ln (w / (2 pi f)))^2
//
// is as large as possible. Shapes decide, also where frequencies have crossed.
// Frequencies decide between modes that look alike at few DOFs, and keep the
// order of modes without shapes (MAC 1).
std::vector<ModeMatch> MatchModes(const ModalData& data,
                                  const Vector& eigenvalues,
                                  const Matrix& shapes);

// Finds the same for a model's M and K; false if it has no modes.
[[nodiscard]] bool MatchModes(const ModalData& data,
                              const StructuralModel& model,
                              std::vector<ModeMatch>* matches,
                              std::string* error);

}  // namespace pinode

#endif  // PINODE_PROBLEM_MEASURED_MODE_H_
