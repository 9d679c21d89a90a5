// Tests every kind of term alone, through the interface of Term.

#include "pinode/dynamics/term.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/dynamics/memory_network.h"
#include "pinode/dynamics/products.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

constexpr double kTermTime = 0.47;
const double kTermInput[] = {0.4, -0.9, 2.1};

Vector TermState(int size) {
  Vector state(size);
  for (int i = 0; i < size; ++i) state[i] = 0.5 * std::cos(2.1 * i + 0.4);
  return state;
}

// Returns columns for states, then free parameters, by central differences of
// the rate. Data prepared from theta vary too.
Matrix DifferenceJacobian(const StructuralDynamics& dynamics,
                          const Vector& theta, const Vector& state) {
  const int ns = dynamics.num_states();
  const double step = 1e-6;
  Matrix jacobian(ns, ns + dynamics.num_tangent_columns());
  auto scratch = dynamics.MakeLinearization();
  for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
    Vector rates[2];
    for (int side = 0; side < 2; ++side) {
      Vector p = theta;
      Vector h = state;
      (j < ns ? h[j] : p[dynamics.tangent_columns()[j - ns]]) +=
          (side == 0 ? -step : step);
      StructuralDynamics::Prepared prepared;
      std::string error;
      EXPECT_TRUE(dynamics.Prepare(p, &prepared, &error)) << error;
      rates[side].resize(ns);
      dynamics.Rate(prepared, kTermTime, kTermInput, h.data(),
                    rates[side].data(), &scratch);
    }
    jacobian.col(j) = (rates[1] - rates[0]) / (2.0 * step);
  }
  return jacobian;
}

// Checks a structure with this term alone: its rate against Jets' values, its
// linearisation and its parameter tangents against Jets and differences, and
// the tangents of four stages against their sum.
void CheckTerm(std::unique_ptr<Term> term) {
  const auto all = testing::MakeEverything();
  StructuralDynamics dynamics(all->model(), all->inputs());
  std::string error;
  SCOPED_TRACE(term->parameters().name);
  const int num_free = NumFree(term->parameters());
  ASSERT_TRUE(dynamics.AddTerm(std::move(term), &error)) << error;
  ASSERT_EQ(dynamics.num_tangent_columns(), num_free);
  StructuralDynamics::Prepared prepared;
  ASSERT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
  const int ns = dynamics.num_states();
  const Vector state = TermState(ns);

  auto at = dynamics.MakeLinearization();
  Vector rate(ns);
  dynamics.Rate(prepared, kTermTime, kTermInput, state.data(), rate.data(),
                &at);
  std::vector<WideJet> h(static_cast<size_t>(ns)), jet_rate(h.size());
  std::vector<WideJet> theta(static_cast<size_t>(dynamics.num_parameters()));
  for (size_t i = 0; i < h.size(); ++i) h[i] = WideJet(state[i]);
  for (size_t i = 0; i < theta.size(); ++i) {
    theta[i] = WideJet(prepared.theta[i]);
  }
  dynamics.Rate(prepared, kTermTime, kTermInput, h.data(), theta.data(),
                jet_rate.data());
  for (int i = 0; i < ns; ++i) {
    EXPECT_NEAR(jet_rate[i].a, rate[i], 1e-13 * rate.norm()) << i;
  }
  dynamics.Linearize(prepared, kTermTime, kTermInput, state.data(), &at);
  EXPECT_LT((at.rate - rate).norm(), 1e-13 * rate.norm());

  Matrix jacobian(ns, ns + num_free);
  jacobian.leftCols(ns) = at.jacobian;
  jacobian.rightCols(num_free).setZero();
  const Matrix identity = Matrix::Identity(ns, ns);
  const StructuralDynamics::Linearization* points[] = {&at, &at, &at, &at};
  const Matrix* lefts[] = {&identity, &identity, &identity, &identity};
  auto scratch = dynamics.MakeTangentScratch(ns);
  dynamics.AddParameterTangents(prepared, points, lefts, 1, &scratch,
                                jacobian.data() + ns * ns);
  const Matrix jets =
      testing::JetJacobian(dynamics, prepared, kTermTime, kTermInput, state);
  EXPECT_LT((jacobian - jets).norm(), 1e-12 * jets.norm());
  const Matrix differences =
      DifferenceJacobian(dynamics, prepared.theta, state);
  EXPECT_LT((jacobian - differences).norm(), 1e-8 * jets.norm());

  Matrix four = Matrix::Zero(ns, num_free);
  dynamics.AddParameterTangents(prepared, points, lefts, 4, &scratch,
                                four.data());
  EXPECT_LT((four - 4.0 * jacobian.rightCols(num_free)).norm(),
            1e-13 * jets.norm());
}

void FixEverySecond(ParameterBlock* block) {
  for (size_t i = 0; i < block->parameters.size(); i += 2) {
    block->parameters[i].free = false;
  }
}

TEST(Term, EveryOneAloneAgreesWithJetsAndDifferences) {
  const auto all = testing::MakeEverything();
  for (int i = 0; i < all->num_terms(); ++i) CheckTerm(all->term(i).Clone());
}

TEST(Term, NetworkWithMemory) {
  MemoryNetworkShape shape;
  shape.sliders = 2;
  shape.width = 3;
  const Vector weights = MemoryNetwork(shape).DrawWeights(5);
  const int n = testing::MakeEverything()->num_dofs();
  CheckTerm(MakeTerm(MakeMemoryNetwork(
      "memory", shape,
      {Feature::Deformation(0, 1), Feature::DeformationRate(0, 1)}, n, weights,
      1.0)));
}

TEST(Term, SomeParametersFixed) {
  const auto all = testing::MakeEverything();
  auto groups = std::make_unique<GroupTerms>();
  for (GroupTerm group : all->groups()) {
    group.alpha.free = groups->groups().size() % 2 == 1;
    std::string error;
    ASSERT_TRUE(groups->Add(group, all->model(), 3, &error)) << error;
  }
  CheckTerm(std::move(groups));
  for (LawTerm law : all->laws()) {
    FixEverySecond(&law.parameters);
    CheckTerm(MakeTerm(std::move(law)));
  }
  for (UnknownForceTerm force : all->unknown_forces()) {
    FixEverySecond(&force.parameters);
    CheckTerm(MakeTerm(std::move(force)));
  }
  for (GroupCurve curve : all->group_curves()) {
    FixEverySecond(&curve.parameters);
    CheckTerm(MakeTerm(std::move(curve)));
  }
  for (NetworkTerm network : all->networks()) {
    FixEverySecond(&network.weights);
    CheckTerm(MakeTerm(std::move(network)));
  }
}

// A kind of term unknown to the library: a spinning mass. Its gyro couples
// velocities by a skew matrix, and it stretches its support. Its drive follows
// with a lag,
//
//   M a + ... + z G v + p_1 K_1 x = 0,   dz/dt = p_0 (x_2 - z).
struct Rotor {
  Matrix gyro;  // G
  MatrixGroup stretch;
  ParameterBlock parameters;  // p_0: rate of the lag, p_1: stretch
};

class RotorTerm final : public TermOf<Rotor> {
 public:
  using TermOf::TermOf;

  TermKind kind() const override { return TermKind::kOther; }
  std::unique_ptr<Term> Clone() const override {
    return std::make_unique<RotorTerm>(*this);
  }
  bool IsValid(const StructuralModel& model, int /*num_inputs*/,
               std::string* error) const override {
    return description_.stretch.IsValid(model.dof_names, error) &&
           description_.parameters.IsValid(error);
  }
  const ParameterBlock& parameters() const override {
    return description_.parameters;
  }
  void SetParameters(const Vector& values) override {
    description_.parameters.SetValues(values);
  }
  std::vector<std::string> InternalNames() const override {
    return {"z[rotor]"};
  }
  std::vector<MatrixChange> MatrixChanges() const override {
    return {
        {&description_.stretch, 1, TangentColumns(description_.parameters)[1]}};
  }
  std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* /*parameters*/) const override {
    auto prepared = std::make_unique<TermPrepared>();
    prepared->output_map = -linear.mass_inverse * description_.gyro;
    return prepared;
  }
  struct Kept : TermLinearization {
    double lag = 0.0;
  };
  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& /*place*/) const override {
    return std::make_unique<Kept>();
  }
  void AddRate(const TermPrepared& prepared, const TermPoint<double>& at,
               TermRate<double>* rate,
               TermLinearization* /*scratch*/) const override {
    AddRateOf(prepared, at, rate);
  }
  void AddRate(const TermPrepared& prepared, const TermPoint<WideJet>& at,
               TermRate<WideJet>* rate) const override {
    AddRateOf(prepared, at, rate);
  }
  void Linearize(const TermPrepared& prepared, const TermPoint<double>& at,
                 TermRate<double>* rate, Matrix* jacobian,
                 TermLinearization* kept) const override {
    AddRateOf(prepared, at, rate);
    const int n = at.place.num_dofs;
    const int z = at.place.first_internal;
    const Eigen::Map<const Vector> v(at.velocity(), n);
    jacobian->block(n, n, n, n) += at.internal()[0] * prepared.output_map;
    jacobian->col(z).segment(n, n) += prepared.output_map * v;
    (*jacobian)(z, 2) += at.parameters[0];
    (*jacobian)(z, z) -= at.parameters[0];
    static_cast<Kept*>(kept)->lag = at.displacement()[2] - at.internal()[0];
  }
  std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& /*place*/, int /*rows*/) const override {
    return std::make_unique<TermTangentScratch>();
  }
  void AddParameterTangents(const TermPlace& place,
                            const TermPrepared& /*prepared*/,
                            const TermLinearization* const* stages,
                            const Matrix* const* lefts, int num_stages,
                            TermTangentScratch* /*scratch*/,
                            double* result) const override {
    // p_1's column is the linear part's.
    for (int s = 0; s < num_stages; ++s) {
      Eigen::Map<Vector>(result, lefts[s]->rows()) +=
          static_cast<const Kept&>(*stages[s]).lag *
          lefts[s]->col(place.first_internal);
    }
  }

 private:
  template <typename T>
  void AddRateOf(const TermPrepared& prepared, const TermPoint<T>& at,
                 TermRate<T>* rate) const {
    const int n = at.place.num_dofs;
    const T& spin = at.internal()[0];
    std::vector<T> couple(static_cast<size_t>(n));
    for (int i = 0; i < n; ++i) {
      couple[static_cast<size_t>(i)] = spin * at.velocity()[i];
    }
    AddProduct(prepared.output_map, couple.data(), rate->acceleration);
    AddProduct(prepared.output_map, couple.data(), rate->force_acceleration);
    rate->internal[0] = at.parameters[0] * (at.displacement()[2] - spin);
  }
};

Rotor MakeRotor() {
  Rotor rotor;
  rotor.gyro = Matrix::Zero(3, 3);
  rotor.gyro(0, 1) = 1.5;
  rotor.gyro(1, 0) = -1.5;
  rotor.stretch.name = "stretch";
  rotor.stretch.matrix = SpringMatrix(3, 0, 1);
  rotor.parameters.name = "rotor";
  for (const char* name : {"rotor.lag", "rotor.stretch"}) {
    Parameter parameter;
    parameter.name = name;
    parameter.value = 0.7;
    rotor.parameters.parameters.push_back(parameter);
  }
  return rotor;
}

TEST(Term, OfAKindOfOnesOwn) {
  CheckTerm(std::make_unique<RotorTerm>(MakeRotor()));
}

// The term together with all others: mass groups and laws with internal states.
TEST(Term, OfAKindOfOnesOwnAmongAllOthers) {
  const auto dynamics = testing::MakeEverything();
  std::string error;
  ASSERT_TRUE(
      dynamics->AddTerm(std::make_unique<RotorTerm>(MakeRotor()), &error))
      << error;
  EXPECT_EQ(dynamics->StateNames().back(), "z[rotor]");
  EXPECT_EQ(dynamics->networks().size(), 4u);
  StructuralDynamics::Prepared prepared;
  ASSERT_TRUE(dynamics->Prepare(dynamics->Parameters(), &prepared, &error));
  EXPECT_EQ(prepared.linear.stiffness,
            dynamics->CorrectedModel(prepared.theta).stiffness);
  const int ns = dynamics->num_states();
  const Vector state = TermState(ns);
  auto at = dynamics->MakeLinearization();
  dynamics->Linearize(prepared, kTermTime, kTermInput, state.data(), &at);
  Matrix by_theta = Matrix::Zero(ns, dynamics->num_tangent_columns());
  const Matrix identity = Matrix::Identity(ns, ns);
  const StructuralDynamics::Linearization* points[] = {&at};
  const Matrix* lefts[] = {&identity};
  auto scratch = dynamics->MakeTangentScratch(ns);
  dynamics->AddParameterTangents(prepared, points, lefts, 1, &scratch,
                                 by_theta.data());
  const Matrix jets =
      testing::JetJacobian(*dynamics, prepared, kTermTime, kTermInput, state);
  EXPECT_LT((at.jacobian - jets.leftCols(ns)).norm(), 1e-12 * jets.norm());
  EXPECT_LT((by_theta - jets.rightCols(by_theta.cols())).norm(),
            1e-12 * jets.norm());
}

}  // namespace
}  // namespace pinode
