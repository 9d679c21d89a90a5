// Structures, records and noise for the tests of the trainer.

#ifndef TESTS_SUPPORT_ESTIMATE_TESTING_H_
#define TESTS_SUPPORT_ESTIMATE_TESTING_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/gaussian_testing.h"

namespace pinode {
namespace testing {

// Returns a chain under ground motion (input 0) with one stiffness group per
// spring: k1 ... kn, the fractional change of each.
std::shared_ptr<StructuralDynamics> MakeGroupedChain(int n, double k, double c);

// Returns an element between two DOFs. `from` is Feature::kGround for the
// ground.
LawTerm MakeElement(const std::string& name, const std::string& type,
                    int num_dofs, int from, int to,
                    const std::vector<double>& values);

// Returns a network of `features` with one hidden layer and small weights. Its
// output is a force on the first of two masses.
NetworkTerm MakeNetwork(std::vector<Feature> features, int hidden,
                        double input_scale);

// Returns two masses under ground motion with groups for stiffness, damping and
// mass (`m2`, fixed), a cubic spring, a Bouc-Wen element with its exponent
// fixed, and a small network with skip path. It has one term of every kind and
// is smooth enough for finite differences.
std::shared_ptr<StructuralDynamics> MakeSmallNonlinear();

// Returns a record without channels: samples of several sines of about unit
// size for every input, `step` apart.
IdentificationRecord MakeExcitedRecord(
    const StructuralDynamics& dynamics, Eigen::Index samples, double step,
    Interpolation interpolation = Interpolation::kLinear);

// Returns one channel at DOF `dof`, without values.
MeasuredChannel MakeChannel(const std::string& name, Quantity quantity,
                            int num_dofs, int dof);

// Fills the values of all channels from a free run: ideal sensors, plus noise
// of `noise` times each channel's spread. Returns the states, num_states x
// samples.
Matrix Simulate(const StructuralDynamics& dynamics, const Vector& theta,
                const Vector& start, double noise, uint64_t seed,
                IdentificationRecord* record);

// Returns a mode measured at the given DOFs. Without DOFs only its frequency is
// measured.
MeasuredMode MakeMeasuredMode(double frequency, std::vector<int> dofs = {},
                              std::vector<double> shape = {});

// Returns the derivative of a function of one variable at zero: central
// differences at h, h/2 and h/4, extrapolated twice (C. J. F. Ridders, Adv.
// Eng. Software 4 (1982) 75-76).
Vector Differentiate(const std::function<Vector(double)>& function, double h);

// The nonlinear structure with two training records of 31 and 24 samples and
// four channels each. Its sensors have gain, offset and delay, and missing
// samples. One channel is not fitted. The parameters differ from the best ones.
struct SmallFit {
  SmallFit(IdentificationRecord::Start start);

  // Returns the complete cost with scales, sigmas and decays set, cut into
  // segments.
  std::unique_ptr<Objective> Shoot(
      Eigen::Index segment_samples,
      const MultipleShooting::Options& options) const;

  IdentificationProblem problem;
  std::unique_ptr<ParameterLayout> layout;
  Vector free;
  std::vector<Matrix> states;  // of the truth
  std::vector<Vector> sigmas, scales;
  Vector decays;
};

}  // namespace testing
}  // namespace pinode

#endif  // TESTS_SUPPORT_ESTIMATE_TESTING_H_
