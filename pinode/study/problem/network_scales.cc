#include "pinode/study/problem/network_scales.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "pinode/base/logging.h"
#include "pinode/base/power_of_two.h"
#include "pinode/base/statistics.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/estimate/start/initial_states.h"

namespace pinode {
namespace {

// Share of the largest motion that is assumed where the lowest mode does not
// move: other modes may.
constexpr double kLeastShare = 0.1;

// Sizes of the motion in the training records.
struct MotionSizes {
  double displacement = 0.0;
  double velocity = 0.0;
  double time = 0.0;
  Vector inputs;

  double acceleration() const { return velocity * velocity / displacement; }
};

// Returns the RMS of `size` over the training records.
template <typename Size>
double OverRecords(const IdentificationProblem& problem, const Size& size) {
  double sum = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const double value = size(record);
    sum += value * value;
  }
  return std::sqrt(sum / std::max(1, problem.num_train_records()));
}

MotionSizes SizesOf(const IdentificationProblem& problem) {
  const int n = problem.dynamics->num_dofs();
  MotionSizes sizes;
  double displacements = 0.0;  // sums of squares
  double velocities = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const Vector scales = GuessStateScales(problem, record);
    displacements += std::pow(scales.head(n).maxCoeff(), 2);
    velocities += std::pow(scales.segment(n, n).maxCoeff(), 2);
  }
  sizes.displacement = std::sqrt(displacements / problem.num_train_records());
  sizes.velocity = std::sqrt(velocities / problem.num_train_records());
  sizes.time = OverRecords(problem, [](const auto& record) {
    const double begin = record.excitation->time(0);
    const double end = record.excitation->time(record.num_samples() - 1);
    return std::max(std::abs(begin), std::abs(end));
  });
  sizes.inputs.resize(problem.dynamics->num_inputs());
  for (int i = 0; i < sizes.inputs.size(); ++i) {
    sizes.inputs[i] = OverRecords(problem, [i](const auto& record) {
      return RmsOfPresent(record.excitation->samples().row(i).transpose());
    });
  }
  return sizes;
}

// Returns the lowest mode that deforms the model, its largest entry one; ones
// if the matrices have none.
Vector LowestMode(const StructuralModel& model) {
  // The units avoid extreme numbers in the roots of the mass.
  const double unit = PowerOfTwoBelow(model.mass.diagonal().maxCoeff());
  const double other = PowerOfTwoBelow(model.stiffness.diagonal().maxCoeff());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(
      model.stiffness / other, model.mass / unit);
  const Vector& values = solver.eigenvalues();
  const double largest = values.cwiseAbs().maxCoeff();
  for (int i = 0; solver.info() == Eigen::Success && i < values.size(); ++i) {
    if (!(values[i] > 1e-12 * largest)) continue;
    const Vector shape = solver.eigenvectors().col(i);
    return shape / shape.cwiseAbs().maxCoeff();
  }
  return Vector::Ones(model.num_dofs());
}

double SizeOf(const Feature& feature, const MotionSizes& sizes,
              const Vector& shape) {
  if (feature.kind == Feature::Kind::kTime) return sizes.time;
  if (feature.kind == Feature::Kind::kInput) {
    return sizes.inputs[feature.input];
  }
  const double share =
      std::abs(feature.Selector(static_cast<int>(shape.size())).dot(shape));
  return std::max(kLeastShare, share) *
         (feature.OnVelocity() ? sizes.velocity : sizes.displacement);
}

// Returns the size of one result that acts through `output`, one entry per DOF.
double SizeOf(const NetworkTerm& term, const Vector& output,
              const MotionSizes& sizes, const Matrix& mass) {
  const Vector weights = output.cwiseAbs();
  if (!(weights.sum() > 0.0)) return 1.0;
  return sizes.acceleration() *
         (term.acts_as == ActsAs::kForce
              ? weights.dot(mass.diagonal()) / weights.sum()
              : 1.0);
}

// Replaces sizes that are zero in these records by one.
Vector OneUnlessPositive(Vector scale) {
  for (double& value : scale) {
    if (!(value > 0.0) || !std::isfinite(value)) value = 1.0;
  }
  return scale;
}

bool IsToBeScaled(const NetworkTerm& term) {
  const NetworkArchitecture& architecture = term.network->architecture();
  return term.drawn && (architecture.input_scale.size() == 0 ||
                        architecture.output_scale.size() == 0);
}

bool HasMemoryToScale(const LawTerm& term) {
  const MemoryNetwork* network = AsMemoryNetwork(term);
  return network != nullptr && !network->shape().HasScales();
}

// Returns the term with the scales that it lacks.
LawTerm WithScales(LawTerm term, const MotionSizes& sizes, const Vector& shape,
                   const Matrix& mass) {
  MemoryNetworkShape scaled = AsMemoryNetwork(term)->shape();
  const auto set = [](double size, double* scale) {
    if (*scale > 0.0) return;
    *scale = size > 0.0 && std::isfinite(size) ? size : 1.0;
  };
  set(SizeOf(term.features[0], sizes, shape), &scaled.deformation);
  set(SizeOf(term.features[1], sizes, shape), &scaled.rate);
  const Vector weights = term.outputs.col(0).cwiseAbs();
  set(sizes.acceleration() * weights.dot(mass.diagonal()) / weights.sum(),
      &scaled.force);
  term.law = std::make_shared<MemoryNetwork>(scaled);
  return term;
}

// Sets the scales that the networks with memory lack.
void ScaleMemory(const MotionSizes& sizes, const Vector& shape,
                 StructuralDynamics* dynamics) {
  StructuralDynamics scaled(dynamics->model(), dynamics->inputs());
  std::string error;
  size_t law = 0;
  for (int t = 0; t < dynamics->num_terms(); ++t) {
    std::unique_ptr<Term> term = dynamics->term(t).Clone();
    if (term->kind() == TermKind::kLaw) {
      const LawTerm& described = dynamics->laws()[law++];
      if (HasMemoryToScale(described)) {
        term = MakeTerm(
            WithScales(described, sizes, shape, dynamics->model().mass));
      }
    }
    CHECK(scaled.AddTerm(std::move(term), &error)) << error;
  }
  *dynamics = std::move(scaled);
}

}  // namespace

bool HasNetworksToScale(const StructuralDynamics& dynamics) {
  const auto& networks = dynamics.networks();
  const auto& laws = dynamics.laws();
  return std::any_of(networks.begin(), networks.end(), IsToBeScaled) ||
         std::any_of(laws.begin(), laws.end(), HasMemoryToScale);
}

void ScaleNetworks(const IdentificationProblem& problem,
                   StructuralDynamics* dynamics) {
  if (problem.num_train_records() == 0 || !HasNetworksToScale(*dynamics)) {
    return;
  }
  const MotionSizes sizes = SizesOf(problem);
  // GuessStateScales has a smallest value for quantities without motion.
  constexpr double kNoMotion = 1e-200;
  if (!(sizes.displacement > kNoMotion) || !(sizes.velocity > kNoMotion)) {
    return;
  }
  const Vector shape = LowestMode(dynamics->model());
  const auto& laws = dynamics->laws();
  if (std::any_of(laws.begin(), laws.end(), HasMemoryToScale)) {
    ScaleMemory(sizes, shape, dynamics);
  }
  const StructuralModel& model = dynamics->model();
  for (size_t j = 0; j < dynamics->networks().size(); ++j) {
    const NetworkTerm& term = dynamics->networks()[j];
    if (!IsToBeScaled(term)) continue;
    Vector input = term.network->architecture().input_scale;
    Vector output = term.network->architecture().output_scale;
    if (input.size() == 0) {
      input.resize(static_cast<Eigen::Index>(term.features.size()));
      for (size_t i = 0; i < term.features.size(); ++i) {
        input[static_cast<Eigen::Index>(i)] =
            SizeOf(term.features[i], sizes, shape);
      }
    }
    if (output.size() == 0) {
      output.resize(term.outputs.cols());
      for (Eigen::Index i = 0; i < output.size(); ++i) {
        output[i] = SizeOf(term, term.outputs.col(i), sizes, model.mass);
      }
    }
    std::string error;
    CHECK(dynamics->SetNetworkScales(static_cast<int>(j),
                                     OneUnlessPositive(input),
                                     OneUnlessPositive(output), &error))
        << error;
  }
}

}  // namespace pinode
