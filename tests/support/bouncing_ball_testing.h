// One mass whose acceleration is a library of functions, and a ball that
// bounces on a spring and a damper, with its motion in closed form.

#ifndef TESTS_SUPPORT_BOUNCING_BALL_TESTING_H_
#define TESTS_SUPPORT_BOUNCING_BALL_TESTING_H_

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/library_law.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {
namespace testing {

// One function of the displacement x[u] and the velocity v[u] of the mass, and
// its coefficient.
struct MassTerm {
  std::string function;
  double value = 0.0;
  double lower = Parameter().lower;
};

// Returns a unit mass whose acceleration is the sum of `terms`.
inline std::unique_ptr<StructuralDynamics> MakeMass(
    const std::vector<MassTerm>& terms) {
  StructuralModel model;
  model.dof_names = {"u"};
  model.mass = Matrix::Identity(1, 1);
  model.damping = model.stiffness = Matrix::Zero(1, 1);
  model.influence = model.support_mass_coupling = Matrix::Zero(1, 0);
  auto dynamics = std::make_unique<StructuralDynamics>(
      std::move(model), std::vector<InputSpec>());
  std::vector<LibraryFunction> functions(terms.size());
  LawTerm law;
  law.name = law.parameters.name = "law";
  law.type = "library";
  std::string error;
  for (size_t k = 0; k < terms.size(); ++k) {
    CHECK(LibraryFunction::Parse(terms[k].function, {"x[u]", "v[u]"},
                                 &functions[k], &error))
        << error;
    Parameter parameter;
    parameter.name = terms[k].function;
    parameter.value = terms[k].value;
    parameter.lower = terms[k].lower;
    law.parameters.parameters.push_back(std::move(parameter));
  }
  law.law = std::make_shared<LibraryLaw>(2, std::move(functions));
  law.features = {Feature::Displacement(0), Feature::Velocity(0)};
  law.outputs = Matrix::Identity(1, 1);
  law.acts_as = ActsAs::kAcceleration;
  CHECK(dynamics->AddLaw(std::move(law), &error)) << error;
  return dynamics;
}

// Returns a ball over a stop at x = -1. `values` are its acceleration in
// flight (negative), and the stiffness and the damping of the stop, each
// divided by the mass. The stop only pushes: both are at least 0.
inline std::unique_ptr<StructuralDynamics> MakeBall(const Vector& values) {
  return MakeMass({{"1", values[0]},
                   {"x[u] < -1 ? -(x[u]+1) : 0", values[1], 0.0},
                   {"x[u] < -1 ? -v[u] : 0", values[2], 0.0}});
}

// Motion in closed form of the ball of MakeBall that falls from rest at x = 0.
class BallPath {
 public:
  explicit BallPath(const Vector& values)
      : gravity_(-values[0]),
        decay_(0.5 * values[2]),
        frequency_(std::sqrt(values[1] - decay_ * decay_)),
        rest_(-gravity_ / values[1]) {}

  // Returns x and its velocity at a time that is not before that of the last
  // call.
  Vector At(double time) {
    while (true) {
      const double end = in_contact_ ? EndOfContact() : EndOfFlight();
      if (time - begin_ <= end) {
        Vector state(2);
        state << Height(time - begin_) - 1.0, Speed(time - begin_);
        return state;
      }
      const double speed = Speed(end);
      begin_ += end;
      height_ = 0.0;
      speed_ = speed;
      in_contact_ = !in_contact_;
    }
  }

 private:
  // Height over the stop. In contact it oscillates around the rest of the ball
  // on the spring.
  double Height(double t) const {
    if (!in_contact_) return height_ + speed_ * t - 0.5 * gravity_ * t * t;
    return rest_ + std::exp(-decay_ * t) * (Sine() * std::sin(frequency_ * t) -
                                            rest_ * std::cos(frequency_ * t));
  }
  double Speed(double t) const {
    if (!in_contact_) return speed_ - gravity_ * t;
    return std::exp(-decay_ * t) *
           ((decay_ * rest_ + frequency_ * Sine()) * std::cos(frequency_ * t) +
            (frequency_ * rest_ - decay_ * Sine()) * std::sin(frequency_ * t));
  }
  double Sine() const { return (speed_ - decay_ * rest_) / frequency_; }

  double EndOfFlight() const {
    return (speed_ + std::sqrt(speed_ * speed_ + 2.0 * gravity_ * height_)) /
           gravity_;
  }
  double EndOfContact() const {
    double low = 1.5 / frequency_;
    double high = 4.0 / frequency_;
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (Height(middle) < 0.0 ? low : high) = middle;
    }
    return low;
  }

  const double gravity_;
  const double decay_;
  const double frequency_;
  const double rest_;
  double begin_ = 0.0;
  double height_ = 1.0;
  double speed_ = 0.0;
  bool in_contact_ = false;
};

}  // namespace testing
}  // namespace pinode

#endif  // TESTS_SUPPORT_BOUNCING_BALL_TESTING_H_
