// Measured modes against those of the model, with derivatives.

#ifndef PINODE_ESTIMATE_OBJECTIVE_MODAL_COST_H_
#define PINODE_ESTIMATE_OBJECTIVE_MODAL_COST_H_

#include <ceres/cost_function.h>

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// The dynamics whose modes were measured: what groups follow as it was then.
StructuralDynamics AveragedDynamics(const ModalData& data,
                                    const StructuralDynamics& dynamics);

// Which of the measured modes a fit uses: those that the model with the
// parameters of `dynamics`, before any fit, HavePartners for. A mode that is
// none of the structure's, held against its nearest, would take that from the
// mode whose it is.
std::vector<bool> ModesInUse(const ModalData& data,
                             const StructuralDynamics& dynamics);

// The weighted residuals of ModalForm as a function of the free parameters, of
// the ModesInUse. The model's modes are those of M and K with the groups that
// follow nothing in AveragedDynamics.
//
// With K phi_j = w_j^2 M phi_j and phi_j' M phi_j = 1, a change dK, dM makes
//
//   d(w_j^2) = phi_j' (dK - w_j^2 dM) phi_j
//   d phi_j  = sum_{k != j} phi_k phi_k' (dK - w_j^2 dM) phi_j
//                           / (w_j^2 - w_k^2)  + a multiple of phi_j
//
// (R. L. Fox and M. P. Kapoor, "Rates of change of eigenvalues and
// eigenvectors", AIAA Journal 6 (1968) 2426-2429), exact with all modes; the
// multiple has no effect on residuals that do not depend on scale. What is not
// measured of a shape in the dynamic residual is projected out with its full
// derivative (G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973)
// 413-432).
class ModalCost final : public ceres::CostFunction, public CostPart {
 public:
  // `data` is valid; `layout` must outlive this object.
  ModalCost(const ModalData& data, const StructuralDynamics& dynamics,
            const ParameterLayout& layout);

  // The modes in use.
  const ModalData& data() const { return data_; }

  // Of the shapes: unknowns that the residuals have used up.
  int num_eliminated() const { return num_eliminated_; }

  // `residuals`: num_residuals; `jacobian`: num_residuals x num_free, nullptr
  // to leave it out. False, with a sentence, where M is not positive definite,
  // where a residual is not finite (a shape orthogonal to the measured one), or
  // where a derivative is asked for that does not exist: of one of two modes
  // with the same frequency that a free group mixes.
  [[nodiscard]] bool Evaluate(const StructuralDynamics::Prepared& prepared,
                              Vector* residuals, Matrix* jacobian,
                              std::string* error) const;

  // The same at the free parameters, the one parameter block. Evaluations must
  // come one at a time.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;
  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;
  std::string Failure() const override { return failure_; }

 private:
  // A free correction to M or K.
  struct Column {
    int free = -1;
    MatrixGroup::Target target = MatrixGroup::Target::kStiffness;
    const Matrix* matrix = nullptr;
  };
  // A measured shape, scaled for its form.
  struct Shape {
    Vector values;       // of unit norm (MAC), else one at `largest`
    int largest = 0;     // position in `dofs`
    Matrix weight_root;  // kEigenvectorDifference
    // What the shape's error is expected to be, before weight_root, for one
    // residual of the frequency; empty: nothing.
    Vector by_frequency;
    std::vector<int> unmeasured;
  };

  bool EvaluateModes(const StructuralDynamics::Prepared& prepared,
                     Vector* residuals, Matrix* jacobian,
                     std::string* error) const;
  bool EvaluateDynamicResiduals(const StructuralDynamics::Prepared& prepared,
                                Vector* residuals, Matrix* jacobian,
                                std::string* error) const;

  // At the free parameters; notes why where it fails.
  [[nodiscard]] bool EvaluateAt(const Vector& free, Vector* residuals,
                                Matrix* jacobian) const;

  const StructuralDynamics dynamics_;  // averaged
  const ModalData data_;               // in use
  const ParameterLayout& layout_;
  std::vector<Column> columns_;
  std::vector<Shape> shapes_;  // one per mode
  int num_eliminated_ = 0;
  mutable std::string failure_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_MODAL_COST_H_
