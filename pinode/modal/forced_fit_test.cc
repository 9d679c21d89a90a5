#include "pinode/modal/forced_fit.h"

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/modal/forced_model.h"
#include "pinode/modal/forced_shapes.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/stabilisation.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

constexpr double kStep = 0.02;

Complex PoleAt(double hertz, double ratio) {
  const double w = kTwoPi * hertz;
  return {-ratio * w, w * std::sqrt(1.0 - ratio * ratio)};
}

std::vector<Complex> PolesOf(const TestChain& chain) {
  std::vector<Complex> s;
  for (const double f : chain.frequency_hz) {
    s.push_back(PoleAt(f, chain.damping_ratio));
  }
  return s;
}

std::vector<ForcedCandidate> Candidates(const std::vector<Complex>& poles) {
  std::vector<ForcedCandidate> candidates;
  for (const Complex s : poles) candidates.push_back({s, 0.02 * std::abs(s)});
  return candidates;
}

// Three masses and as many unit loads, `measured` of them measured, or a moving
// base. The record starts in motion.
ResponseRecord Loaded(const TestChain& chain, unsigned seed, double noise,
                      bool base = true) {
  TestExcitation excitation;
  excitation.base = base;
  excitation.common = base ? 1.0 : 0.0;
  excitation.measured = 1;
  excitation.memory = 0.9;
  excitation.sensor_noise = noise;
  return SimulateChain(chain, kStep, 6000, seed, {2}, excitation);
}

ForcedModel ModelOf(const ResponseRecord& record) {
  ForcedModel::Band band;
  band.lowest_hz = 0.3;
  band.highest_hz = 21.0;
  band.most_lines = 10000;
  return ForcedModel(record.samples, record.inputs, kStep, band);
}

TEST(ForcedModelTest, ExactWithTheTruePolesAndFindsThemNearby) {
  const TestChain chain(3, 900.0);
  const ResponseRecord record = Loaded(chain, 4, 0.0);
  ForcedModel model = ModelOf(record);
  Vector weights = Vector::Ones(model.num_lines());
  for (const bool weighted : {false, true}) {
    SCOPED_TRACE(weighted);
    if (weighted) weights.head(400).setConstant(0.1);
    model.set_weights(Vector::Constant(3, 2.0), weights);
    const std::vector<Complex> s = PolesOf(chain);
    const double size = model.data().norm();
    EXPECT_LT(std::sqrt(model.Solve(s).cost), 1e-9 * size);
    std::vector<Complex> moved = s;
    moved[0] *= 1.001;
    moved[2] *= Complex(0.9995, 0.001);
    ForcedFit fit = model.Solve(moved);
    EXPECT_GT(std::sqrt(fit.cost), 1e-3 * size);
    model.Refine(moved, {1.0, 1.0, 1.0}, &fit);
    EXPECT_LT(std::sqrt(fit.cost), 1e-9 * size);
    for (size_t m = 0; m < 3; ++m) {
      EXPECT_LT(std::abs(fit.s[m] - s[m]), 1e-8 * std::abs(s[m]));
      const ForcedShape found = FindForcedShape(model, fit, m);
      EXPECT_GT(ComplexMac(found.shape, ComplexVector(chain.shapes.col(
                                            static_cast<Eigen::Index>(m)))),
                1.0 - 1e-8);
    }
  }
}

TEST(ForcedModelTest, FewLinesAreThoseNextToThePoles) {
  const TestChain chain(3, 900.0);
  const ResponseRecord record = Loaded(chain, 4, 0.0);
  ForcedModel::Band band;
  band.highest_hz = 25.0;
  band.most_lines = 400;
  band.centres = {PolesOf(chain)[1]};
  const ForcedModel model(record.samples, record.inputs, kStep, band);
  ASSERT_EQ(model.num_lines(), 400);
  const double middle = band.centres[0].imag();
  EXPECT_NEAR(model.angular()[0], middle - 200 * model.line_spacing(),
              2.0 * model.line_spacing());
  EXPECT_NEAR(model.angular()[399], middle + 200 * model.line_spacing(),
              2.0 * model.line_spacing());
  EXPECT_LT(std::sqrt(model.Solve(PolesOf(chain)).cost),
            1e-9 * model.data().norm());
  EXPECT_LT(ForcedModel::FewestLines(3, 1), 400);
  EXPECT_GT(ForcedModel::FewestLines(80, 1), 400);
}

// Poles beside those of the structure, and one of them twice, at any noise.
TEST(ForcedFitTest, OnlyTheStructuresPolesAreNeeded) {
  const TestChain chain(3, 900.0);
  std::vector<Complex> poles = PolesOf(chain);
  poles.push_back(PoleAt(0.6 * chain.frequency_hz[0], 0.02));
  poles.push_back(PoleAt(1.3 * chain.frequency_hz[1], 0.01));
  poles.push_back(PoleAt(1.004 * chain.frequency_hz[0], 0.012));
  for (const double noise : {0.0, 1e-12, 1e-6, 1e-3, 1e-2, 0.1}) {
    SCOPED_TRACE(noise);
    ForcedModel model = ModelOf(Loaded(chain, 5, noise));
    const ForcedPoles found = FindForcedPoles(Candidates(poles), &model);
    ASSERT_EQ(found.kept.size(), 3u);
    EXPECT_TRUE(found.kept[0] == 0 || found.kept[2] == 5);
    EXPECT_FALSE(found.has_peak);
    for (const Complex s : found.fit.s) {
      double nearest = kInfinity;
      for (const Complex truth : PolesOf(chain)) {
        nearest = std::min(nearest, std::abs(s - truth) / std::abs(truth));
      }
      EXPECT_LT(nearest, 3e-3);
    }
  }
}

// The measured load is another record's: all modes are excited by loads that
// are not measured, and all are kept.
TEST(ForcedFitTest, ModesUnderUnmeasuredLoadsStay) {
  const TestChain chain(3, 900.0);
  ResponseRecord record = Loaded(chain, 6, 0.01);
  record.inputs = Loaded(chain, 7, 0.01).inputs;
  std::vector<Complex> poles = PolesOf(chain);
  poles.push_back(PoleAt(1.3 * chain.frequency_hz[1], 0.01));
  ForcedModel model = ModelOf(record);
  const ForcedPoles found = FindForcedPoles(Candidates(poles), &model);
  EXPECT_EQ(found.kept, std::vector<size_t>({0, 1, 2}));
  EXPECT_TRUE(found.has_peak);
}

// Errors in their deviations have a mean square of one, and the deviations
// follow the noise.
TEST(ForcedFitTest, InfluencesAreThoseOfTheNoise) {
  const TestChain chain(3, 900.0);
  const std::vector<Complex> truth = PolesOf(chain);
  double squares = 0.0;
  double shapes = 0.0;
  int count = 0;
  Vector sigmas = Vector::Zero(2);
  for (unsigned seed = 1; seed <= 12; ++seed) {
    for (const double noise : {0.02, 0.04}) {
      ForcedModel model = ModelOf(Loaded(chain, seed, noise));
      const ForcedPoles found = FindForcedPoles(Candidates(truth), &model);
      ASSERT_EQ(found.kept.size(), 3u);
      const std::vector<SubspacePole> poles =
          EstimateForcedPoles(model, found.fit);
      for (size_t m = 0; m < 3; ++m) {
        Eigen::Index largest = 0;
        poles[m].shape.cwiseAbs().maxCoeff(&largest);
        const SubspacePole pole =
            NormalisedPole(poles[m], static_cast<int>(largest));
        const Vector deviations =
            FindPoleMoments(pole, 0.0).covariance.diagonal().cwiseSqrt();
        squares += std::pow((pole.frequency() - std::abs(truth[m]) / kTwoPi) /
                                deviations[0],
                            2) +
                   std::pow((pole.damping_ratio() - 0.01) / deviations[1], 2);
        const Vector shape =
            chain.shapes.col(static_cast<Eigen::Index>(m)) /
            chain.shapes(largest, static_cast<Eigen::Index>(m));
        for (Eigen::Index c = 0; c < 3; ++c) {
          if (c == largest) continue;
          shapes += 0.5 * std::pow((pole.shape[c].real() - shape[c]) /
                                       deviations[2 + c],
                                   2) +
                    0.5 * std::pow(pole.shape[c].imag() / deviations[5 + c], 2);
        }
        count += 2;
        if (m == 0) sigmas[noise > 0.03 ? 1 : 0] += deviations[0];
      }
    }
  }
  EXPECT_NEAR(squares / count, 1.0, 0.35);
  EXPECT_NEAR(shapes / count, 1.0, 0.35);
  EXPECT_NEAR(sigmas[1] / sigmas[0], 2.0, 0.1);
}

// Force of a record is three sines, which have no mode of their own.
TEST(ForcedFitTest, AnOscillatorUnderThreeSinesHasOneMode) {
  const Complex s = PoleAt(0.8717, 0.01);
  ResponseRecord record;
  record.name = "sines";
  record.sampling_step = 0.03;
  record.channels = {{"u", 0}};
  record.samples = Matrix::Zero(1, 5000);
  record.inputs = Matrix::Zero(1, 5000);
  for (const double hertz : {0.015, 0.1217, 0.2617}) {
    const Complex w(0.0, kTwoPi * hertz);
    for (Eigen::Index k = 0; k < 5000; ++k) {
      const double t = 0.03 * static_cast<double>(k);
      const auto response = [&](Complex pole) {
        return (std::exp(w * t) - std::exp(pole * t)) / (w - pole);
      };
      record.inputs(0, k) += std::exp(w * t).imag();
      record.samples(0, k) += ((response(s) - response(std::conj(s))) /
                               Complex(0.0, 2.0 * s.imag()))
                                  .imag();
    }
  }
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const double noise : {0.0, 1e-14, 1e-9, 1e-4}) {
    SCOPED_TRACE(noise);
    ResponseRecord noisy = record;
    for (double& value : noisy.samples.reshaped()) {
      value += noise * normal(random);
    }
    ModesOfRecord result;
    std::string error;
    ASSERT_TRUE(IdentifyModes(noisy, {}, &result, &error)) << error;
    ASSERT_EQ(result.modes.size(), 1u);
    EXPECT_NEAR(result.modes[0].frequency_hz, 0.8717,
                4.0 * result.modes[0].frequency_sigma + 1e-9);
  }
}

}  // namespace
}  // namespace pinode
