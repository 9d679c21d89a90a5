#include "pinode/dynamics/memory_network.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

MemoryNetworkShape Shape(int sliders, int width) {
  MemoryNetworkShape shape;
  shape.sliders = sliders;
  shape.width = width;
  shape.deformation = 0.02;
  shape.rate = 0.3;
  shape.force = 500.0;
  return shape;
}

std::vector<double> Random(Eigen::Index size, double spread,
                           std::mt19937_64* random) {
  std::normal_distribution<double> normal(0.0, spread);
  std::vector<double> values(static_cast<size_t>(size));
  for (double& value : values) value = normal(*random);
  return values;
}

std::vector<double> Evaluate(const MemoryNetwork& network, const double* q,
                             const double* z, const double* p) {
  std::vector<double> result(static_cast<size_t>(network.num_results()));
  network.Evaluate(q, z, p, result.data());
  return result;
}

TEST(MemoryNetwork, DerivativesAreThoseOfDifferencesAndJets) {
  std::mt19937_64 random(3);
  for (const auto& [sliders, width] :
       {std::pair(1, 3), std::pair(2, 4), std::pair(4, 1)}) {
    const MemoryNetwork network(Shape(sliders, width));
    const int arguments = network.num_arguments();
    for (const double energy : {0.8, -0.3}) {
      std::vector<double> all = Random(arguments, 0.7, &random);
      all[0] *= 0.02;
      all[1] *= 0.3;
      all[static_cast<size_t>(2 + sliders)] = energy;
      const double* p = all.data() + 2 + network.num_internal();
      std::vector<double> result(static_cast<size_t>(network.num_results()));
      std::vector<double> jacobian(result.size() * all.size());
      network.Linearize(all.data(), all.data() + 2, p, result.data(),
                        jacobian.data());
      EXPECT_EQ(result, Evaluate(network, all.data(), all.data() + 2, p));
      for (int i = 0; i < arguments; ++i) {
        const double step = 1e-6 * (i == 0 ? 0.02 : i == 1 ? 0.3 : 1.0);
        std::vector<double> sides[2];
        for (const int side : {0, 1}) {
          std::vector<double> at = all;
          at[static_cast<size_t>(i)] += side == 0 ? -step : step;
          sides[side] = Evaluate(network, at.data(), at.data() + 2,
                                 at.data() + 2 + network.num_internal());
        }
        std::vector<WideJet> jets(all.begin(), all.end());
        jets[static_cast<size_t>(i)].v[0] = 1.0;
        std::vector<WideJet> of_jets(result.size());
        network.Evaluate(jets.data(), jets.data() + 2,
                         jets.data() + 2 + network.num_internal(),
                         of_jets.data());
        for (size_t r = 0; r < result.size(); ++r) {
          const double slope =
              jacobian[r * all.size() + static_cast<size_t>(i)];
          const double difference = (sides[1][r] - sides[0][r]) / (2.0 * step);
          const double size = std::abs(difference) +
                              (r == 0 ? 500.0 : 15.0) * 1e-6 * 1e-6 / step;
          EXPECT_NEAR(slope, difference, 1e-6 * size + 1e-6) << r << ", " << i;
          EXPECT_NEAR(slope, of_jets[r].v[0], 1e-11 * std::abs(slope) + 1e-12)
              << r << ", " << i;
        }
      }
    }
  }
}

// With a constant flow c the slider is Dahl's: beyond its start its spring has
// the elongation (1 - exp(-softplus(c) x)) / softplus(c) at the deformation x.
TEST(MemoryNetwork, WithoutHiddenWeightsIsDahlsFriction) {
  const MemoryNetworkShape shape = Shape(1, 1);
  const MemoryNetwork network(shape);
  std::vector<double> p(static_cast<size_t>(network.num_parameters()), 0.0);
  const double stiffness = 1.7;
  const double flow = 2.3;
  p[0] = std::log(std::expm1(stiffness));
  p[static_cast<size_t>(network.num_parameters() - 2)] =
      std::log(std::expm1(flow));
  const double w = 3.0 * shape.rate;  // |y| is 3 but for 1e-5 of it
  double z[] = {0.0, 0.0};
  const int steps = 2000;
  const double step = 1.5 * shape.deformation / w / steps;
  for (int i = 0; i < steps; ++i) {
    // The rule of the midpoint.
    double q[] = {i * step * w, w};
    const std::vector<double> first = Evaluate(network, q, z, p.data());
    q[0] += 0.5 * step * w;
    const double half[] = {z[0] + 0.5 * step * first[1],
                           z[1] + 0.5 * step * first[2]};
    const std::vector<double> middle = Evaluate(network, q, half, p.data());
    z[0] += step * middle[1];
    z[1] += step * middle[2];
  }
  const double elongation = (1.0 - std::exp(-flow * 1.5)) / flow;
  EXPECT_NEAR(z[0], elongation, 1e-4 * elongation);
  const double q[] = {1.5 * shape.deformation, w};
  EXPECT_NEAR(Evaluate(network, q, z, p.data())[0],
              shape.force * stiffness * elongation, 0.1);
  EXPECT_NEAR(network.StoredEnergy(z, p.data()),
              0.5 * shape.force * shape.deformation * stiffness * elongation *
                  elongation,
              1e-3);
  // The slider dissipates what the springs do not store: the work is the
  // integral of k s over x.
  const double work =
      stiffness / flow * (1.5 - (1.0 - std::exp(-flow * 1.5)) / flow);
  EXPECT_NEAR(z[1], work - 0.5 * stiffness * elongation * elongation, 1e-3);
}

// The power that a device takes up is never less than the growth of the energy
// in its springs, whatever the weights and the state.
TEST(MemoryNetwork, NeverGivesEnergyThatItHasNotTakenUp) {
  std::mt19937_64 random(11);
  for (int draw = 0; draw < 400; ++draw) {
    const MemoryNetworkShape shape = Shape(1 + draw % 4, 1 + draw % 7);
    const MemoryNetwork network(shape);
    const double spread = draw % 2 == 0 ? 1.0 : 5.0;
    const std::vector<double> p =
        Random(network.num_parameters(), spread, &random);
    std::vector<double> q = Random(2, 1.0, &random);
    q[0] *= shape.deformation;
    q[1] *= shape.rate;
    std::vector<double> z = Random(network.num_internal(), 1.0, &random);
    z.back() = std::abs(z.back());
    const std::vector<double> result =
        Evaluate(network, q.data(), z.data(), p.data());
    const double step = 1e-6 * shape.deformation / shape.rate;
    double energies[2];
    double size = 0.0;
    for (const int side : {0, 1}) {
      std::vector<double> moved = z;
      for (size_t i = 0; i < z.size(); ++i) {
        moved[i] += (side == 0 ? -step : step) * result[1 + i];
      }
      energies[side] = network.StoredEnergy(moved.data(), p.data());
      size = std::max(size, energies[side]);
    }
    const double power = result[0] * q[1];
    const double growth = (energies[1] - energies[0]) / (2.0 * step);
    EXPECT_GE(power - growth,
              -1e-6 * (std::abs(power) + std::abs(growth)) - 1e-9 * size / step)
        << draw;
  }
}

TEST(MemoryNetwork, DrawsTheSameWeightsFromTheSameSeed) {
  const MemoryNetwork network(Shape(2, 5));
  EXPECT_EQ(network.DrawWeights(4), network.DrawWeights(4));
  EXPECT_NE(network.DrawWeights(4), network.DrawWeights(5));
  EXPECT_EQ(network.DrawWeights(4).size(), network.num_parameters());
}

TEST(MemoryNetwork, IsFoundAmongTheLaws) {
  StructuralDynamics dynamics(
      MakeStructuralModel(Matrix::Identity(1, 1), Matrix::Zero(1, 1),
                          Matrix::Identity(1, 1), {"u"}),
      {});
  std::string error;
  ASSERT_TRUE(
      dynamics.AddElement("cubic", "cubic", Feature::kGround, 0, {1.0}, &error))
      << error;
  EXPECT_FALSE(HasMemoryNetwork(dynamics));
  const std::vector<Feature> features = {Feature::Displacement(0),
                                         Feature::Velocity(0)};
  const MemoryNetworkShape shape = Shape(1, 2);
  const Vector weights = MemoryNetwork(shape).DrawWeights(1);
  LawTerm fixed = MakeMemoryNetwork("fixed", shape, features, 1, weights, 3.0);
  for (Parameter& weight : fixed.parameters.parameters) weight.free = false;
  ASSERT_TRUE(dynamics.AddLaw(std::move(fixed), &error)) << error;
  EXPECT_TRUE(HasMemoryNetwork(dynamics));
  EXPECT_FALSE(HasFreeMemoryNetwork(dynamics));
  ASSERT_TRUE(dynamics.AddLaw(
      MakeMemoryNetwork("free", shape, features, 1, weights, 3.0), &error))
      << error;
  EXPECT_TRUE(HasFreeMemoryNetwork(dynamics));
}

TEST(MemoryNetwork, RefusesSizesItCannotHave) {
  std::string error;
  EXPECT_TRUE(Shape(1, 6).IsValid(&error)) << error;
  EXPECT_FALSE(Shape(5, 6).IsValid(&error));
  EXPECT_THAT(error, ::testing::HasSubstr("'memory' is 5, expected 1 to 4"));
  EXPECT_FALSE(Shape(1, 0).IsValid(&error));
  MemoryNetworkShape shape = Shape(1, 6);
  shape.rate = -1.0;
  EXPECT_FALSE(shape.IsValid(&error));
  EXPECT_THAT(error, ::testing::HasSubstr("the rate scale"));
  shape.rate = 0.0;
  EXPECT_TRUE(shape.IsValid(&error));
  EXPECT_FALSE(shape.HasScales());
}

}  // namespace
}  // namespace pinode
