#include "pinode/structure/model/modal_mass.h"

#include <Eigen/Cholesky>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"

namespace pinode {

Matrix ModalMasses::Shares() const {
  Matrix shares = effective;
  for (Eigen::Index d = 0; d < shares.cols(); ++d) {
    if (moving[d] > 0.0) {
      shares.col(d) /= moving[d];
    } else {
      shares.col(d).setConstant(kNaN);
    }
  }
  return shares;
}

ModalMasses EffectiveModalMasses(const StructuralModel& model,
                                 const Matrix& shapes) {
  CHECK_EQ(shapes.rows(), model.num_dofs()) << "a row for each DOF";
  Matrix loads = model.mass * model.influence;
  if (model.support_mass_coupling.size() > 0) {
    CHECK_EQ(model.support_mass_coupling.cols(), loads.cols())
        << "a column for each direction";
    loads += model.support_mass_coupling;
  }
  ModalMasses masses;
  masses.participation = shapes.transpose() * loads;
  masses.effective = masses.participation.cwiseAbs2();
  const Matrix rigid = model.mass.llt().solve(loads);
  masses.moving = loads.cwiseProduct(rigid).colwise().sum().transpose();
  return masses;
}

}  // namespace pinode
