// Frequency response functions of the model, with exact derivatives.

#ifndef PINODE_ESTIMATE_FRF_FRF_TRANSFER_H_
#define PINODE_ESTIMATE_FRF_FRF_TRANSFER_H_

#include <complex>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/solver/free_groups.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// FRFs of the model at the lines of a record, see FrfRecord, in the coordinates
// of the undamped modes Phi at the point,
//
//   h = f S Phi z^-1 Phi' L,
//   z = (1 + i eta) Lambda + i w Phi' C Phi - w^2 I.
//
// All modes of the model take part, so that this is exact. With
// damping that does not couple the modes, z is diagonal, and a line costs n for
// the n modes. Otherwise it costs n^3 / 3. A change dZ of the dynamic stiffness
// by a parameter changes h by
//
//   dh = -f (Z^-T S')' dZ (Z^-1 L),
//
// with both factors from the same solution (adjoint method), so that a
// parameter costs no more than a product with the factors of its matrix.
class FrfTransfer {
 public:
  // Values and derivatives at one line.
  struct Line {
    ComplexVector values;  // pairs
    ComplexMatrix slopes;  // pairs x columns()
  };

  // `record` and `layout` must outlive this object.
  FrfTransfer(const FrfRecord& record, const StructuralDynamics& dynamics,
              const ParameterLayout& layout);

  // Positions among the free parameters of the columns of derivatives. A
  // parameter may occur in several.
  const std::vector<int>& columns() const { return columns_; }

  // Sets the free parameters. Returns false, with *error, if the model has no
  // modes there.
  [[nodiscard]] bool SetPoint(const Vector& free, std::string* error);
  // Computes a line at the last point. Several threads may call it.
  void Compute(Eigen::Index line, bool with_slopes, Line* result) const;

 private:
  using Complex = std::complex<double>;
  // Parameter of the sensors, at the last point.
  struct SensorValue {
    double value = 0.0;
    int free = -1;
    double factor = 1.0;
  };
  struct Solution;

  SensorValue SensorAt(int index, double ideal, const Vector& all) const;
  void AddColumns();
  Solution Solve(double w, bool with_adjoint) const;
  void DifferentiateByMatrices(double w, const Solution& solution,
                               const ComplexVector& factors,
                               Line* result) const;

  const FrfRecord& record_;
  const StructuralDynamics dynamics_;
  const ParameterLayout& layout_;
  const std::vector<FreeGroup> groups_;
  Matrix sensors_;      // responses x num_dofs
  Vector derivatives_;  // of each response: 0, 1 or 2
  std::vector<int> columns_;
  // Columns of gains and delays, -1 if they are fixed, and of the loss factor.
  std::vector<int> gain_columns_, delay_columns_;
  int loss_column_ = -1;

  // At the last point, in the coordinates of the modes.
  std::vector<SensorValue> gains_, delays_;
  SensorValue loss_;
  Vector eigenvalues_;
  Matrix damping_;  // n x n, or n x 1 if it does not couple the modes
  Matrix seen_;     // responses x n
  Matrix forces_;   // n x references
  std::vector<Matrix> lefts_, rights_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FRF_FRF_TRANSFER_H_
