// Vibrations with noise, for tests.

#ifndef TESTS_SUPPORT_MODAL_TESTING_H_
#define TESTS_SUPPORT_MODAL_TESTING_H_

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/response_record.h"

namespace pinode {

// Unit masses in a row, with springs between them and to the ground, and the
// same damping ratio in all modes.
struct TestChain {
  Matrix stiffness;
  Matrix shapes;        // a column per mode
  Vector frequency_hz;  // ascending
  double damping_ratio = 0.01;

  TestChain(int masses, double spring, double ratio = 0.01)
      : stiffness(Matrix::Zero(masses, masses)), damping_ratio(ratio) {
    for (int i = 0; i < masses; ++i) {
      stiffness(i, i) += spring;
      if (i == 0) continue;
      stiffness(i - 1, i - 1) += spring;
      stiffness(i, i - 1) -= spring;
      stiffness(i - 1, i) -= spring;
    }
    Decompose();
  }
  // Creates a structure with any stiffness matrix.
  TestChain(Matrix matrix, double ratio)
      : stiffness(std::move(matrix)), damping_ratio(ratio) {
    Decompose();
  }

  int masses() const { return static_cast<int>(stiffness.rows()); }

 private:
  void Decompose() {
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(stiffness);
    shapes = solver.eigenvectors();
    frequency_hz = solver.eigenvalues().cwiseSqrt() / 6.283185307179586;
  }
};

struct TestExcitation {
  // Memory of the forces of successive samples: u(k) = memory u(k - 1) + noise.
  double memory = 0.0;
  // Force that all masses have in common, in addition to each mass's own.
  double common = 0.7;
  // Noise of the sensors, relative to each channel's standard deviation.
  double sensor_noise = 0.02;
  // True: instead of forces the base moves, with the common noise as its
  // acceleration. Accelerations are then absolute, and displacements and
  // velocities are relative to the base.
  bool base = false;
  // Number of measured forces of the masses. With a moving base: 1 if its
  // acceleration is measured.
  int measured = 0;
};

// Returns the records of sensors at all masses, named "u1", "u2", ...:
// quantities [i mod their number] (0 displacement, 1 velocity, 2 acceleration).
// The forces are held over a sample. The discrete model is exact, so its poles
// are those of the chain.
inline ResponseRecord SimulateChain(const TestChain& chain, double step,
                                    Eigen::Index samples, unsigned seed,
                                    const std::vector<int>& derivatives = {2},
                                    const TestExcitation& excitation = {}) {
  const Eigen::Index n = chain.masses();
  const Matrix damping =
      chain.shapes *
      (2.0 * chain.damping_ratio * 6.283185307179586 * chain.frequency_hz)
          .asDiagonal() *
      chain.shapes.transpose();
  Matrix generator = Matrix::Zero(3 * n, 3 * n);
  generator.block(0, n, n, n).setIdentity();
  generator.block(n, 0, n, n) = -chain.stiffness;
  generator.block(n, n, n, n) = -damping;
  generator.block(n, 2 * n, n, n).setIdentity();
  const Matrix acceleration = generator.block(n, 0, n, 3 * n);
  const Matrix advance = Matrix(step * generator).exp().topRows(2 * n);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double slowest =
      chain.damping_ratio * 6.283185307179586 * chain.frequency_hz[0];
  const Eigen::Index before = static_cast<Eigen::Index>(8.0 / slowest / step);
  ResponseRecord record;
  record.name = "ambient";
  record.sampling_step = step;
  record.samples.resize(n, samples);
  record.inputs.resize(excitation.measured, samples);
  for (Eigen::Index i = 0; i < n; ++i) {
    record.channels.push_back(
        {"u" + std::to_string(i + 1),
         derivatives[static_cast<size_t>(i) % derivatives.size()]});
  }
  Vector state = Vector::Zero(3 * n);  // x, v, u
  for (Eigen::Index k = -before; k < samples; ++k) {
    const double common = excitation.common * normal(random);
    for (Eigen::Index i = 2 * n; i < 3 * n; ++i) {
      state[i] = excitation.memory * state[i] + common +
                 (excitation.base ? 0.0 : normal(random));
    }
    if (k >= 0) {
      record.inputs.col(k) = state.segment(2 * n, excitation.measured);
      Vector a = acceleration * state;
      // The force on unit masses is minus the base's acceleration.
      if (excitation.base) a -= state.tail(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const int d = record.channels[static_cast<size_t>(i)].derivative;
        record.samples(i, k) = d == 2 ? a[i] : state[d * n + i];
      }
    }
    state.head(2 * n) = advance * state;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const double sigma = excitation.sensor_noise *
                         std::sqrt(record.samples.row(i).squaredNorm() /
                                   static_cast<double>(samples));
    for (Eigen::Index k = 0; k < samples; ++k) {
      record.samples(i, k) += sigma * normal(random);
    }
  }
  return record;
}

// Returns accelerations of the chain in free decay with all modes at the same
// velocity, and white noise of `noise` times each channel's standard deviation.
inline ResponseRecord SimulateRingDown(const TestChain& chain, double step,
                                       Eigen::Index samples, unsigned seed,
                                       double noise) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::Index n = chain.masses();
  ResponseRecord record;
  record.name = "ring-down";
  record.sampling_step = step;
  record.free_decay = true;
  record.samples = Matrix::Zero(n, samples);
  for (Eigen::Index m = 0; m < n; ++m) {
    const double w = 6.283185307179586 * chain.frequency_hz[m];
    const double z = chain.damping_ratio;
    const std::complex<double> s(-z * w, w * std::sqrt(1.0 - z * z));
    for (Eigen::Index k = 0; k < samples; ++k) {
      // v = Im(exp(s t)) + ..., a = its derivative.
      const double a =
          (s * std::exp(s * (step * static_cast<double>(k)))).real() / w;
      record.samples.col(k) += a * chain.shapes.col(m);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    record.channels.push_back({"u" + std::to_string(i + 1), 2});
    const double sigma = noise * std::sqrt(record.samples.row(i).squaredNorm() /
                                           static_cast<double>(samples));
    for (Eigen::Index k = 0; k < samples; ++k) {
      record.samples(i, k) += sigma * normal(random);
    }
  }
  return record;
}

// Checks that all modes of the chain and no others were found, each within
// `sigmas` standard deviations. Returns "" or the difference.
inline std::string DifferenceFromChain(const TestChain& chain,
                                       const ModesOfRecord& result,
                                       double sigmas) {
  std::string found;
  bool good = static_cast<int>(result.modes.size()) == chain.masses();
  for (size_t m = 0; m < result.modes.size(); ++m) {
    const IdentifiedMode& mode = result.modes[m];
    const int row = std::min(static_cast<int>(m), chain.masses() - 1);
    good = good &&
           std::abs(mode.frequency_hz - chain.frequency_hz[row]) <
               sigmas * mode.frequency_sigma &&
           std::abs(mode.damping_ratio - chain.damping_ratio) <
               sigmas * mode.damping_sigma;
    found += std::to_string(mode.frequency_hz) + " +- " +
             std::to_string(mode.frequency_sigma) + " (" +
             std::to_string(mode.damping_ratio) + " +- " +
             std::to_string(mode.damping_sigma) + ") in " +
             std::to_string(mode.orders_seen) + " orders at " +
             std::to_string(1.0 / mode.sampling_step) + " Hz, ";
  }
  return good ? std::string() : "found " + found;
}

}  // namespace pinode

#endif  // TESTS_SUPPORT_MODAL_TESTING_H_
