#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/dynamics/library_law.h"
#include "pinode/estimate/fit/fit_once.h"
#include "tests/support/gaussian_testing.h"

namespace pinode {
namespace {

constexpr double kGravity = 9.8;
constexpr double kStiffness = 5000.0;
constexpr double kDamping = 15.0;
constexpr double kNoise = 0.002;
constexpr double kFlightStep = 0.005;

// Height above the stop of a ball on its way, in closed form.
class BallPath {
 public:
  explicit BallPath(double height) : height_(height) {}

  // Returns the height at a time that is not before that of the last call.
  double At(double time) {
    while (true) {
      const double end = in_contact_ ? EndOfContact() : EndOfFlight();
      if (time - begin_ <= end) return Height(time - begin_);
      const double speed = Speed(end);
      begin_ += end;
      height_ = 0.0;
      speed_ = speed;
      in_contact_ = !in_contact_;
    }
  }

 private:
  // The oscillation around the rest of the ball on the spring.
  static constexpr double kRest = -kGravity / kStiffness;
  static constexpr double kDecay = 0.5 * kDamping;
  static double Frequency() { return std::sqrt(kStiffness - kDecay * kDecay); }
  double Sine() const { return (speed_ - kDecay * kRest) / Frequency(); }

  double Height(double t) const {
    if (!in_contact_) {
      return height_ + speed_ * t - 0.5 * kGravity * t * t;
    }
    const double w = Frequency();
    return kRest + std::exp(-kDecay * t) *
                       (Sine() * std::sin(w * t) - kRest * std::cos(w * t));
  }
  double Speed(double t) const {
    if (!in_contact_) return speed_ - kGravity * t;
    const double w = Frequency();
    return std::exp(-kDecay * t) *
           ((kDecay * kRest + w * Sine()) * std::cos(w * t) +
            (w * kRest - kDecay * Sine()) * std::sin(w * t));
  }
  double EndOfFlight() const {
    return (speed_ + std::sqrt(speed_ * speed_ + 2.0 * kGravity * height_)) /
           kGravity;
  }
  double EndOfContact() const {
    double low = 1.5 / Frequency();
    double high = 4.0 / Frequency();
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (Height(middle) < 0.0 ? low : high) = middle;
    }
    return low;
  }

  double begin_ = 0.0;
  double height_;
  double speed_ = 0.0;
  bool in_contact_ = false;
};

// Ball on a stop with unknown gravity, stiffness and damping.
std::shared_ptr<StructuralDynamics> MakeBall() {
  StructuralModel model;
  model.dof_names = {"u"};
  model.mass = Matrix::Identity(1, 1);
  model.damping = model.stiffness = Matrix::Zero(1, 1);
  model.influence = model.support_mass_coupling = Matrix::Zero(1, 0);
  auto dynamics = std::make_shared<StructuralDynamics>(
      std::move(model), std::vector<InputSpec>());
  const std::vector<std::pair<std::string, double>> terms = {
      {"1", -9.0},
      {"x[u] < -1 ? -(x[u]+1) : 0", 2000.0},
      {"x[u] < -1 ? -v[u] : 0", 5.0}};
  std::vector<LibraryFunction> functions(terms.size());
  LawTerm law;
  law.name = law.parameters.name = "ball";
  law.type = "library";
  std::string error;
  for (size_t k = 0; k < terms.size(); ++k) {
    CHECK(LibraryFunction::Parse(terms[k].first, {"x[u]", "v[u]"},
                                 &functions[k], &error))
        << error;
    Parameter parameter;
    parameter.name = terms[k].first;
    parameter.value = terms[k].second;
    if (k > 0) parameter.lower = 0.0;
    law.parameters.parameters.push_back(std::move(parameter));
  }
  law.law = std::make_shared<LibraryLaw>(2, std::move(functions));
  law.features = {Feature::Displacement(0), Feature::Velocity(0)};
  law.outputs = Matrix::Identity(1, 1);
  law.acts_as = ActsAs::kAcceleration;
  CHECK(dynamics->AddLaw(std::move(law), &error)) << error;
  return dynamics;
}

// Three bounces. Stiffness and damping begin at less than a half of the truth.
TEST(ImpactFit, FindsTheStop) {
  constexpr Eigen::Index kFlightSamples = 401;
  IdentificationRecord record;
  record.name = "flight";
  record.substeps = 10;
  record.start = IdentificationRecord::Start::kKnown;
  record.known_start = Vector::Zero(2);
  record.excitation =
      Excitation(0.0, kFlightStep, Matrix::Zero(0, kFlightSamples),
                 Interpolation::kLinear);
  MeasuredChannel channel;
  channel.observation = {"y", Quantity::kDisplacement, Vector::Unit(1, 0)};
  channel.values.resize(kFlightSamples);
  BallPath path(1.0);
  testing::Gaussian noise(11);
  for (Eigen::Index i = 0; i < kFlightSamples; ++i) {
    channel.values[i] = path.At(kFlightStep * static_cast<double>(i)) - 1.0 +
                        kNoise * noise.Next();
  }
  record.channels.push_back(std::move(channel));
  IdentificationProblem problem;
  problem.dynamics = MakeBall();
  problem.records.push_back(std::move(record));

  FitSummary summary;
  IdentifiedModel model;
  FitOnce(problem, IdentificationOptions(), nullptr, &summary, &model);
  EXPECT_EQ(summary.termination, Termination::kConverged) << summary.message;
  ASSERT_EQ(summary.parameters.size(), 3u);
  const double truth[] = {-kGravity, kStiffness, kDamping};
  for (size_t k = 0; k < 3; ++k) {
    const ParameterEstimate& estimate = summary.parameters[k];
    EXPECT_LT(std::abs(estimate.value - truth[k]), 3.0 * estimate.sigma)
        << estimate.name;
    EXPECT_LT(estimate.sigma, 0.02 * std::abs(truth[k])) << estimate.name;
  }
  EXPECT_NEAR(summary.records[0].channels[0].rmse, kNoise, 0.1 * kNoise);
}

}  // namespace
}  // namespace pinode
