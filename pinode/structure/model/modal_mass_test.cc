#include "pinode/structure/model/modal_mass.h"

#include <cmath>
#include <string>

#include "gtest/gtest.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

// Two equal storeys of mass m and stiffness k: shapes (1, g) and (1, 1 - g)
// with the golden section g, so effective masses are in closed form.
StructuralModel TwoStoreys() {
  StructuralModel model;
  model.dof_names = {"u1", "u2"};
  model.mass = 3.0 * Matrix::Identity(2, 2);
  model.damping = Matrix::Zero(2, 2);
  model.stiffness.resize(2, 2);
  model.stiffness << 20.0, -10.0, -10.0, 10.0;
  model.directions = {"x"};
  model.influence = Matrix::Ones(2, 1);
  model.support_mass_coupling = Matrix::Zero(2, 1);
  return model;
}

Matrix ShapesOf(const StructuralModel& model) {
  ModalProperties modes;
  std::string error;
  EXPECT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error))
      << error;
  return modes.mode_shapes;
}

TEST(EffectiveModalMasses, TwoStoreysInClosedForm) {
  const StructuralModel model = TwoStoreys();
  const ModalMasses masses = EffectiveModalMasses(model, ShapesOf(model));
  EXPECT_NEAR(masses.moving[0], 6.0, 1e-12);
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  for (int i = 0; i < 2; ++i) {
    const double g = i == 0 ? golden : 1.0 - golden;
    const double effective = 3.0 * (1.0 + g) * (1.0 + g) / (1.0 + g * g);
    EXPECT_NEAR(masses.effective(i, 0), effective, 1e-12);
    EXPECT_NEAR(std::abs(masses.participation(i, 0)), std::sqrt(effective),
                1e-12);
    EXPECT_NEAR(masses.Shares()(i, 0), effective / 6.0, 1e-12);
  }
}

// Consistent mass: all effective masses are the moving mass, the coupling to
// the support among it. A direction that moves nothing has no shares.
TEST(EffectiveModalMasses, AllModesTogetherAreTheMovingMass) {
  StructuralModel model = TwoStoreys();
  model.mass << 4.0, 1.0, 1.0, 2.0;
  model.directions = {"x", "y"};
  model.influence.resize(2, 2);
  model.influence << 1.0, 0.0, 1.0, 0.0;
  model.support_mass_coupling.resize(2, 2);
  model.support_mass_coupling << 0.5, 0.0, 0.0, 0.0;
  const ModalMasses masses = EffectiveModalMasses(model, ShapesOf(model));
  // M r + M_fs = (5.5, 3), M^-1 = [2, -1; -1, 4] / 7.
  const double moving = (2.0 * 5.5 * 5.5 - 2.0 * 5.5 * 3.0 + 4.0 * 9.0) / 7.0;
  EXPECT_NEAR(masses.moving[0], moving, 1e-12);
  EXPECT_NEAR(masses.effective.col(0).sum(), moving, 1e-12);
  EXPECT_EQ(masses.moving[1], 0.0);
  EXPECT_TRUE(std::isnan(masses.Shares()(0, 1)));
}

}  // namespace
}  // namespace pinode
