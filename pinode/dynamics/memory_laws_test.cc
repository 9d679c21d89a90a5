// Elements with a memory under a given motion, held against figures of SciPy's
// solve_ivp (tolerance 1e-11) for the textbooks' own equations, against closed
// forms, and against each other.

#include "pinode/dynamics/memory_laws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/dynamics/elements.h"

namespace pinode {
namespace {

struct Motion {
  std::function<double(double)> deformation, rate;
};

Motion Sine(double amplitude) {
  return {[amplitude](double t) { return amplitude * std::sin(t); },
          [amplitude](double t) { return amplitude * std::cos(t); }};
}

Motion TwoSines() {
  return {[](double t) {
            return 0.03 * std::sin(2.0 * t) + 0.02 * std::sin(5.0 * t);
          },
          [](double t) {
            return 0.06 * std::cos(2.0 * t) + 0.1 * std::cos(5.0 * t);
          }};
}

// Device under a motion, integrated by the classical Runge-Kutta method.
class Device {
 public:
  Device(const std::string& type, std::vector<double> parameters)
      : parameters_(std::move(parameters)) {
    std::string error;
    law_ = CreateElement(type, &error);
    EXPECT_NE(law_, nullptr) << error;
    EXPECT_EQ(static_cast<size_t>(law_->num_parameters()), parameters_.size());
    internal_.assign(static_cast<size_t>(law_->num_internal()), 0.0);
  }

  double Force(const Motion& motion, double time) const {
    return At(motion, time, internal_)[0];
  }
  double internal(size_t i) const { return internal_[i]; }

  // Moves from one time to another and returns the work done on the device.
  double Move(const Motion& motion, double from, double to, int steps) {
    const double h = (to - from) / steps;
    double work = 0.0;
    for (int i = 0; i < steps; ++i) {
      const double t = from + h * i;
      const std::vector<double> a = At(motion, t, internal_);
      const std::vector<double> b = At(motion, t + h / 2, Shifted(a, h / 2));
      const std::vector<double> c = At(motion, t + h / 2, Shifted(b, h / 2));
      const std::vector<double> d = At(motion, t + h, Shifted(c, h));
      for (size_t k = 0; k < internal_.size(); ++k) {
        internal_[k] +=
            h / 6.0 * (a[k + 1] + 2.0 * b[k + 1] + 2.0 * c[k + 1] + d[k + 1]);
      }
      work += h / 6.0 *
              (a[0] * motion.rate(t) +
               2.0 * (b[0] + c[0]) * motion.rate(t + h / 2) +
               d[0] * motion.rate(t + h));
    }
    return work;
  }

 private:
  std::vector<double> At(const Motion& motion, double time,
                         const std::vector<double>& internal) const {
    const double features[] = {motion.deformation(time), motion.rate(time)};
    std::vector<double> result(static_cast<size_t>(law_->num_results()));
    law_->Evaluate(features, internal.data(), parameters_.data(),
                   result.data());
    return result;
  }

  std::vector<double> Shifted(const std::vector<double>& rates,
                              double step) const {
    std::vector<double> moved = internal_;
    for (size_t k = 0; k < moved.size(); ++k) moved[k] += step * rates[k + 1];
    return moved;
  }

  std::vector<double> parameters_;
  std::unique_ptr<Law> law_;
  std::vector<double> internal_;
};

struct Reference {
  std::string type;
  std::vector<double> parameters;
  // Forces at 1, 2.5, 4 and 6 s under TwoSines() from rest.
  std::vector<double> forces;
};

class MemoryLaw : public ::testing::TestWithParam<Reference> {};

TEST_P(MemoryLaw, AgreesWithTheTextbooksEquation) {
  Device device(GetParam().type, GetParam().parameters);
  const Motion motion = TwoSines();
  const std::vector<double> times = {0.0, 1.0, 2.5, 4.0, 6.0};
  for (size_t i = 1; i < times.size(); ++i) {
    device.Move(motion, times[i - 1], times[i],
                static_cast<int>(2000 * (times[i] - times[i - 1])));
    EXPECT_NEAR(device.Force(motion, times[i]), GetParam().forces[i - 1], 2e-5)
        << times[i] << " s";
  }
}

// baber_noori: Foliente's form with z in metres, beta = s / (f/k)^n and gamma =
// (1 - s) / (f/k)^n. maxwell: the closed solution of z' + (k/c) z = w.
INSTANTIATE_TEST_SUITE_P(
    SciPy, MemoryLaw,
    ::testing::ValuesIn(std::vector<Reference>{
        {"baber_noori",
         {1000.0, 12.0, 0.7, 1.5, 0.05, 0.03, 0.8, 0.4, 0.15, 0.25, 0.01, 0.6},
         {-9.113590877, 0.882603407, 9.250243540, -3.697045569}},
        {"lugre",
         {1000.0, 12.0, 0.4, 0.05, 3.0, 2.0},
         {-10.949067659, 7.098884480, 12.404980601, -5.013539051}},
        {"maxwell",
         {1000.0, 300.0},
         {-9.747381502, 4.426107872, 22.338588033, -5.348943276}}}));

TEST(BaberNoori, WithoutDegradationIsBoucWen) {
  const double k = 800.0, f = 15.0, s = 0.6, n = 2.0;
  const double yield = f / k;
  Device degrading("baber_noori",
                   {k, f, s, n, 0.0, 0.0, 0.0, 0.5, 0.1, 0.2, 0.0, 0.5});
  Device plain("bouc_wen", {k, 1.0, s / (yield * yield),
                            (1.0 - s) / (yield * yield), n, 1.0});
  const Motion motion = TwoSines();
  const double work = plain.Move(motion, 0.0, 5.0, 5000);
  EXPECT_NEAR(degrading.Move(motion, 0.0, 5.0, 5000), work, 1e-9 * work);
  EXPECT_NEAR(degrading.Force(motion, 5.0), plain.Force(motion, 5.0), 1e-9);
  // Its second state is the work over f^2 / k.
  EXPECT_NEAR(degrading.internal(1) * f * yield, work, 1e-6 * work);
}

// At the end of a long push the force is the strength that is left.
TEST(BaberNoori, LosesItsStrengthAsDescribed) {
  const double k = 1000.0, f = 12.0, strength = 0.05, n = 1.5;
  Device device("baber_noori",
                {k, f, 0.5, n, strength, 0.0, 0.0, 0.5, 0.1, 0.2, 0.0, 0.5});
  const Motion push = {[](double t) { return 0.1 * t; },
                       [](double /*t*/) { return 0.1; }};
  device.Move(push, 0.0, 3.0, 6000);
  const double left =
      f * std::pow(1.0 + strength * device.internal(1), -1.0 / n);
  EXPECT_LT(left, 0.75 * f);
  EXPECT_NEAR(device.Force(push, 3.0), left, 0.02 * left);
}

// The force of a push at a limit u is the integral of the density of limits,
// and a cycle's work is 4 R u^(chi + 3) / ((chi + 2) (chi + 3)).
TEST(Iwan, StandsForTheContinuousModel) {
  const double k = 1000.0, f = 12.0, chi = -0.4, beta = 0.3;
  const double widest =
      f * (1.0 + beta) / (k * (beta + (chi + 1.0) / (chi + 2.0)));
  const double density =
      k * (chi + 1.0) / (std::pow(widest, chi + 1.0) * (1.0 + beta));
  for (const double share : {0.2, 0.4, 0.8}) {
    const double u = share * widest;
    Device device("iwan", {k, f, chi, beta});
    device.Move(Sine(u), 0.0, 0.5 * kPi, 1000);
    const double force =
        density * std::pow(u, chi + 2.0) / (chi + 2.0) +
        u * (density * (std::pow(widest, chi + 1.0) - std::pow(u, chi + 1.0)) /
                 (chi + 1.0) +
             k * beta / (1.0 + beta));
    EXPECT_NEAR(device.Force(Sine(u), 0.5 * kPi), force, 0.03 * force) << share;
    const double exact =
        4.0 * density * std::pow(u, chi + 3.0) / ((chi + 2.0) * (chi + 3.0));
    device.Move(Sine(u), 0.5 * kPi, 2.0 * kPi, 3000);
    const double work = device.Move(Sine(u), 2.0 * kPi, 4.0 * kPi, 4000);
    EXPECT_NEAR(work, exact, 0.04 * exact) << share;
  }
  // Stiffness and force of all sliders together are those given.
  Device device("iwan", {k, f, chi, beta});
  device.Move(Sine(1e-4 * widest), 0.0, 0.5 * kPi, 100);
  EXPECT_NEAR(device.Force(Sine(1e-4 * widest), 0.5 * kPi), k * 1e-4 * widest,
              1e-3 * k * 1e-4 * widest);
  device.Move(Sine(5.0 * widest), 0.0, 0.5 * kPi, 20000);
  EXPECT_NEAR(device.Force(Sine(5.0 * widest), 0.5 * kPi), f, 0.01 * f);
}

// No device may give more work back than it has received.
TEST(MemoryLaws, GiveNoEnergy) {
  const std::vector<std::pair<std::string, std::vector<double>>> devices = {
      {"maxwell", {1000.0, 300.0}},
      {"lugre", {1000.0, 12.0, 0.4, 0.05, 0.0, 2.0}},
      {"iwan", {1000.0, 12.0, -0.4, 0.3}},
      {"baber_noori",
       {1000.0, 12.0, 0.7, 1.5, 0.05, 0.03, 0.8, 0.4, 0.15, 0.25, 0.01, 0.6}}};
  for (const auto& [type, parameters] : devices) {
    Device device(type, parameters);
    double work = 0.0;
    for (int i = 0; i < 60; ++i) {
      work += device.Move(TwoSines(), 0.1 * i, 0.1 * (i + 1), 200);
      EXPECT_GE(work, 0.0) << type << " at " << 0.1 * (i + 1) << " s";
    }
    EXPECT_GT(work, 0.1) << type;
  }
}

TEST(Play, ActsBeyondItsGapAboutItsCentre) {
  const auto force = [](double deformation, double width) {
    Device device("play", {50.0, 0.2, 0.1, width});
    return device.Force({[deformation](double) { return deformation; },
                         [](double) { return 0.0; }},
                        0.0);
  };
  EXPECT_NEAR(force(0.5, 0.0), 10.0, 1e-12);
  EXPECT_NEAR(force(-0.3, 0.0), -10.0, 1e-12);
  EXPECT_NEAR(force(0.29, 0.0), 0.0, 1e-12);
  EXPECT_NEAR(force(0.3, 0.02), 50.0 * 0.01, 0.02);
  EXPECT_NEAR(force(0.1, 0.02), 0.0, 1e-12);
}

}  // namespace
}  // namespace pinode
