// The transfer functions from unknown loads to the channels of a record.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_TRANSFER_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_TRANSFER_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/ambient/ambient_lines.h"
#include "pinode/estimate/ambient/line_pieces.h"
#include "pinode/estimate/solver/free_groups.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Cholesky factor L of a Hermitian matrix.
using ComplexFactor = Eigen::LLT<Eigen::MatrixXcd>;

// The response of each channel, over its scale, to a unit load at each area, at
// the frequency of each line, and its derivatives by the free groups.
//
// If loads act at fewer areas than there are channels, the spectrum S_y of a
// line is all but singular, and the transfer function's change within the line
// is more than small noise. Its mean over the line is then taken from two
// frequencies (nodes), exact up to the third power of the width. Work per line:
// n^3 for the n DOFs, and for each group n^2 times the rank of its matrix.
class AmbientTransfer {
 public:
  // `modes` are those of `averaged` at the initial values. `lines` and `pieces`
  // must outlive this object.
  AmbientTransfer(const AmbientRecord& record,
                  const StructuralDynamics& averaged,
                  const ModalProperties& modes, const ParameterLayout& layout,
                  const AmbientLines& lines, const LinePieces& pieces);

  int num_areas() const { return static_cast<int>(loads_.cols()); }
  // Number of frequencies at which a line is taken, one or two.
  int num_nodes() const { return num_nodes_; }
  const std::vector<FreeGroup>& groups() const { return groups_; }
  Eigen::Index num_groups() const {
    return static_cast<Eigen::Index>(groups_.size());
  }

  // Sets the matrices of the model. FindOwn or FindAll must follow.
  void SetModel(StructuralModel model);
  // Computes the transfer functions of this rank's lines.
  void FindOwn();
  // Computes the transfer functions of all lines.
  void FindAll();

  // Transfer function of a line at the last model: channels x (areas of each
  // node), over the root of the number of nodes.
  const Eigen::MatrixXcd& at(Eigen::Index line) const {
    return transfer_[static_cast<size_t>(line)];
  }
  // Adds L^-1 dH P H^H L^-H for each group, summed over the nodes. P is the
  // covariance of the loads and L the factor of the line's spectrum; `whitened`
  // is L^-1 H.
  void AddDerivatives(Eigen::Index line, const Matrix& covariance,
                      const Eigen::MatrixXcd& whitened,
                      const ComplexFactor& factor,
                      std::vector<Eigen::MatrixXcd>* sums) const;

 private:
  // Sets loads_, base_ and direct_.
  void SetLoads(const AmbientRecord& record, const StructuralModel& model,
                const ModalProperties& modes);
  void Find(int piece);
  // Frequency of a node of a line.
  double NodeFrequency(Eigen::Index line, int node) const;
  // Factor from displacement to the quantity of each channel, over its scale.
  Eigen::VectorXcd ChannelFactors(double frequency) const;
  // LU factors of K + i w C - w^2 M.
  Eigen::PartialPivLU<Eigen::MatrixXcd> DynamicStiffness(
      double frequency) const;

  const AmbientLines& lines_;
  const LinePieces& pieces_;
  Matrix sensors_;      // channels x num_dofs
  Vector derivatives_;  // 0, 1 or 2: order of each channel's time derivative
  // Unit forces, num_dofs x areas, followed by the forces -M base_ of unit
  // accelerations of the base.
  Matrix loads_;
  Matrix base_;    // num_dofs x directions
  Matrix direct_;  // channels x areas: the base's part in absolute acceleration
  std::vector<FreeGroup> groups_;
  int num_nodes_ = 1;
  StructuralModel model_;
  std::vector<Eigen::MatrixXcd> transfer_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_TRANSFER_H_
