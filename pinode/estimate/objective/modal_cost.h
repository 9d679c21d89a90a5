// Residuals between measured modes and those of the model, with derivatives.

#ifndef PINODE_ESTIMATE_OBJECTIVE_MODAL_COST_H_
#define PINODE_ESTIMATE_OBJECTIVE_MODAL_COST_H_

#include <ceres/cost_function.h>

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/objective/span_comparison.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Returns the dynamics during the measurement of the modes: covariates of
// groups have their values of that time.
StructuralDynamics AveragedDynamics(const ModalData& data,
                                    const StructuralDynamics& dynamics);

// Marks the measured modes that a fit uses: those that HavePartners in the
// initial model, with the parameters of `dynamics`. A foreign mode, compared
// with its nearest, would displace the measured mode that belongs there.
std::vector<bool> ModesInUse(const ModalData& data,
                             const StructuralDynamics& dynamics);

// Weighted residuals of ModalForm for the ModesInUse, as a function of the free
// parameters. The model's modes are those of M and K with the groups that
// follow no covariate in AveragedDynamics.
//
// With K phi_j = w_j^2 M phi_j and phi_j' M phi_j = 1, a change dK, dM makes
//
//   d(w_j^2) = phi_j' (dK - w_j^2 dM) phi_j
//   d phi_j  = sum_{k != j} phi_k phi_k' (dK - w_j^2 dM) phi_j
//                           / (w_j^2 - w_k^2)  + a multiple of phi_j
//
// (R. L. Fox and M. P. Kapoor, "Rates of change of eigenvalues and
// eigenvectors", AIAA Journal 6 (1968) 2426-2429), exact with all modes. The
// multiple has no effect on residuals that do not depend on scale. In the
// dynamic residual, the unmeasured part of a shape is projected out with its
// full derivative (G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973)
// 413-432).
//
// CloseModes are compared by SpanComparison: x_i and G_ii replace the shape and
// the eigenvalue of the partner. One more residual per pair is G_ij over its
// deviation. G has the measured eigenvalues l_i, with deviations s_i, in a
// frame that may be turned against the measured one by any angle; G_ij is then
// at most half of their distance, (l_i - l_j) / 2 with the deviation
// (s_i^2 + s_j^2)^(1/2) / 2.
class ModalCost final : public ceres::CostFunction, public CostPart {
 public:
  // Keeps a reference to `layout`, which must outlive this object. `data` must
  // be valid.
  ModalCost(const ModalData& data, const StructuralDynamics& dynamics,
            const ParameterLayout& layout);

  // Measured modes in use.
  const ModalData& data() const { return data_; }

  // Marks of all measured modes: those in data().
  const std::vector<bool>& in_use() const { return in_use_; }

  // Dynamics during the measurement, AveragedDynamics.
  const StructuralDynamics& dynamics() const { return dynamics_; }

  // Number of unknowns of the shapes that use up residuals.
  int num_eliminated() const { return num_eliminated_; }

  // Computes `residuals` (num_residuals) and `jacobian` (num_residuals x
  // num_free; nullptr to leave it out). Returns false, with a sentence in
  // *error, if
  //
  // - M is not positive definite,
  // - a residual is not finite (a shape orthogonal to the measured one), or
  // - a requested derivative does not exist: that of one of two modes with the
  //   same frequency that a free group mixes, and that are no CloseModes.
  [[nodiscard]] bool Evaluate(const StructuralDynamics::Prepared& prepared,
                              Vector* residuals, Matrix* jacobian,
                              std::string* error) const;

  // Computes the same at the free parameters, which are the single parameter
  // block. Evaluations must come one at a time.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;
  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;
  std::string Failure() const override { return failure_; }

 private:
  // Free correction to M or K.
  struct Column {
    int free = -1;
    double factor = 1.0;  // derivative of the parameter by the free one
    MatrixGroup::Target target = MatrixGroup::Target::kStiffness;
    const Matrix* matrix = nullptr;
  };
  // Measured shape, scaled for its form.
  struct Shape {
    Vector values;       // of unit norm (MAC), else one at `largest`
    int largest = 0;     // position in `dofs`
    Matrix weight_root;  // kEigenvectorDifference
    // Expected error of the shape, before weight_root, per unit residual of the
    // frequency. Empty: zero.
    Vector by_frequency;
    std::vector<int> unmeasured;
    bool in_close_set = false;
  };
  // Modes compared by their span, see SpanComparison.
  struct CloseSet {
    std::vector<int> modes;
    std::vector<int> dofs;
    Matrix measured;
    std::vector<Matrix> roots;
  };
  struct Partner;

  void AddCloseSets();
  bool FindPartners(const UndampedModes& modes, size_t num_columns,
                    std::vector<Partner>* partners, std::vector<Partner>* cross,
                    std::string* error) const;
  bool FindTogether(const CloseSet& set, const UndampedModes& modes,
                    const std::vector<ModeMatch>& matches, size_t num_columns,
                    std::vector<Partner>* partners, std::vector<Partner>* cross,
                    std::string* error) const;

  bool EvaluateModes(const StructuralDynamics::Prepared& prepared,
                     Vector* residuals, Matrix* jacobian,
                     std::string* error) const;
  bool EvaluateDynamicResiduals(const StructuralDynamics::Prepared& prepared,
                                Vector* residuals, Matrix* jacobian,
                                std::string* error) const;

  // Evaluates at the free parameters; records the reason of a failure.
  [[nodiscard]] bool EvaluateAt(const Vector& free, Vector* residuals,
                                Matrix* jacobian) const;

  const StructuralDynamics dynamics_;  // averaged
  const std::vector<bool> in_use_;     // per measured mode
  const ModalData data_;               // in use
  const ParameterLayout& layout_;
  std::vector<Column> columns_;
  std::vector<Shape> shapes_;  // one per mode
  std::vector<CloseSet> close_sets_;
  std::vector<double> cross_weights_;  // of the pairs, in the order of the sets
  int num_eliminated_ = 0;
  mutable std::string failure_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_MODAL_COST_H_
