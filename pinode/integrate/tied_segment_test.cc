#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/dynamics/elements.h"
#include "pinode/integrate/exponential_step.h"
#include "pinode/integrate/segment.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

// A tie of the parameter with the first name to that with the second one.
struct NamedTie {
  std::string parameter, source;
  double factor = 1.0;
};

// Three masses with the groups "k1" and "k2" and the cubic springs "a.k3" and
// "b.k3". Values are those of tied parameters, tied or not.
std::unique_ptr<StructuralDynamics> MakeTied(const NamedTie& tie, bool tied) {
  auto dynamics = std::make_unique<StructuralDynamics>(
      testing::MakeChain(3, 30.0, 0.2), std::vector<InputSpec>());
  double source = 0.0;
  const auto set = [&](double value, Parameter* parameter) {
    parameter->value = value;
    if (parameter->name == tie.source) source = value;
    if (parameter->name != tie.parameter) return;
    parameter->value = tie.factor * source;
    parameter->free = !tied;
    if (!tied) return;
    parameter->value = 0.0;  // the dynamics sets it
    parameter->tie = tie.source;
    parameter->tie_factor = tie.factor;
  };
  std::string error;
  for (const int i : {1, 2}) {
    GroupTerm group;
    group.group.name = group.alpha.name = "k" + std::to_string(i);
    group.group.target = MatrixGroup::Target::kStiffness;
    group.group.matrix = SpringMatrix(3, i - 2, i - 1);
    set(4.0 * i, &group.alpha);
    CHECK(dynamics->AddGroup(std::move(group), &error)) << error;
  }
  for (const int i : {0, 1}) {
    LawTerm law;
    CHECK(MakeElement(i == 0 ? "a" : "b", "cubic", 3, i, i + 1, {1.0}, &law,
                      &error))
        << error;
    for (Parameter& parameter : law.parameters.parameters) {
      set(40.0 + 10.0 * i, &parameter);
    }
    CHECK(dynamics->AddLaw(std::move(law), &error)) << error;
  }
  return dynamics;
}

class TiedSegment : public ::testing::TestWithParam<NamedTie> {
 protected:
  static SegmentTangents Propagate(const StructuralDynamics& dynamics,
                                   Integrator integrator,
                                   DerivativeMethod method) {
    StructuralDynamics::Prepared prepared;
    std::string error;
    EXPECT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
    const ObservationMap observation(
        dynamics,
        {{"x3", Quantity::kDisplacement, Vector::Unit(3, 2)},
         {"a1", Quantity::kRelativeAcceleration, Vector::Unit(3, 0)}});
    const Excitation excitation(0.0, 0.05, Matrix::Zero(0, 21),
                                Interpolation::kLinear);
    const IntegrationGrid grid(excitation, 4, integrator);
    SegmentPropagator propagator(dynamics, method);
    SegmentTangents result;
    EXPECT_TRUE(propagator.Propagate(prepared, observation, grid,
                                     Vector::LinSpaced(6, -0.5, 0.6), 0, 20,
                                     true, SegmentColumns::kAll, &result));
    return result;
  }

  static int ColumnOf(const StructuralDynamics& dynamics,
                      const std::string& name) {
    int index = 0;
    for (const ParameterBlock& block : dynamics.blocks()) {
      for (const Parameter& parameter : block.parameters) {
        if (parameter.name == name) {
          const auto& columns = dynamics.tangent_columns();
          for (size_t j = 0; j < columns.size(); ++j) {
            if (columns[j] == index) return static_cast<int>(j);
          }
        }
        ++index;
      }
    }
    ADD_FAILURE() << name;
    return 0;
  }
};

// The chain rule on the derivatives of a problem without ties.
TEST_P(TiedSegment, ColumnsAddUp) {
  const NamedTie tie = GetParam();
  const auto tied = MakeTied(tie, true);
  const auto apart = MakeTied(tie, false);
  ASSERT_EQ(tied->ties().size(), 1u);
  EXPECT_LT((tied->Parameters() - apart->Parameters()).norm(), 1e-14);
  ASSERT_EQ(tied->num_tangent_columns(), 3);
  const auto compare = [&](Integrator integrator, DerivativeMethod method) {
    const SegmentTangents one = Propagate(*tied, integrator, method);
    const SegmentTangents two = Propagate(*apart, integrator, method);
    EXPECT_LT((one.channels - two.channels).norm(), 1e-13);
    const Matrix expected =
        two.jacobian().col(6 + ColumnOf(*apart, tie.source)) +
        tie.factor * two.jacobian().col(6 + ColumnOf(*apart, tie.parameter));
    const Matrix found = one.jacobian().col(6 + ColumnOf(*tied, tie.source));
    EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm());
    for (const std::string other : {"k1", "k2", "a.k3", "b.k3"}) {
      if (other == tie.source || other == tie.parameter) continue;
      EXPECT_LT((one.jacobian().col(6 + ColumnOf(*tied, other)) -
                 two.jacobian().col(6 + ColumnOf(*apart, other)))
                    .norm(),
                1e-12)
          << other;
    }
  };
  compare(Integrator::kRungeKutta, DerivativeMethod::kTangents);
  compare(Integrator::kRungeKutta, DerivativeMethod::kJets);
  if (ExponentialStep::Suits(*tied)) {
    compare(Integrator::kExponential, DerivativeMethod::kTangents);
  }
}

INSTANTIATE_TEST_SUITE_P(AllPairs, TiedSegment,
                         ::testing::Values(NamedTie{"k2", "k1", -1.5},
                                           NamedTie{"b.k3", "a.k3", 2.0},
                                           NamedTie{"a.k3", "k1", 3.0}));

}  // namespace
}  // namespace pinode
