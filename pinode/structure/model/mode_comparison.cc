#include "pinode/structure/model/mode_comparison.h"

#include <Eigen/SVD>
#include <vector>

#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/model/modal_mass.h"

namespace pinode {
namespace {

std::vector<Eigen::Index> RigidBodies(const ModalProperties& modes) {
  std::vector<Eigen::Index> rigid;
  for (Eigen::Index i = 0; i < modes.frequency_hz.size(); ++i) {
    if (modes.frequency_hz[i] == 0.0) rigid.push_back(i);
  }
  return rigid;
}

// Any combination of rigid-body modes is a rigid-body mode. Takes the
// combinations of `after` that are nearest to those of `before`.
void AlignRigidBodies(const ModalProperties& before, const Matrix& mass,
                      ModalProperties* after) {
  const std::vector<Eigen::Index> from = RigidBodies(before);
  const std::vector<Eigen::Index> to = RigidBodies(*after);
  if (from.empty() || from.size() != to.size()) return;
  const Matrix shapes = after->mode_shapes(Eigen::all, to);
  const Matrix wanted = before.mode_shapes(Eigen::all, from);
  const Eigen::JacobiSVD<Matrix> svd(shapes.transpose() * mass * wanted,
                                     Eigen::ComputeFullU | Eigen::ComputeFullV);
  after->mode_shapes(Eigen::all, to) =
      Matrix(shapes * svd.matrixU() * svd.matrixV().transpose());
}

}  // namespace

bool CompareModes(const StructuralModel& initial,
                  const StructuralModel& updated, std::vector<ModePair>* pairs,
                  std::string* error) {
  pairs->clear();
  if (initial.num_dofs() == 0) return true;
  ModalProperties before, after;
  if (!ComputeModes(initial.mass, initial.damping, initial.stiffness, &before,
                    error) ||
      !ComputeModes(updated.mass, updated.damping, updated.stiffness, &after,
                    error)) {
    return false;
  }
  AlignRigidBodies(before, updated.mass, &after);
  const std::vector<int> partners =
      PairModes(before.mode_shapes, after.mode_shapes);
  const Matrix shares =
      updated.num_directions() > 0
          ? EffectiveModalMasses(updated, after.mode_shapes).Shares()
          : Matrix(after.mode_shapes.cols(), 0);
  for (int i = 0; i < before.frequency_hz.size(); ++i) {
    ModePair pair;
    pair.initial_frequency = before.frequency_hz[i];
    pair.initial_damping = before.damping_ratio[i];
    pair.initial_shape = before.mode_shapes.col(i);
    const int partner = partners[static_cast<size_t>(i)];
    pair.updated_mode = partner;
    if (partner >= 0) {
      pair.updated_frequency = after.frequency_hz[partner];
      pair.updated_damping = after.damping_ratio[partner];
      pair.updated_shape = after.mode_shapes.col(partner);
      pair.updated_mass_shares = shares.row(partner).transpose();
      pair.mac = Mac(pair.initial_shape, pair.updated_shape);
    }
    pairs->push_back(std::move(pair));
  }
  return true;
}

}  // namespace pinode
