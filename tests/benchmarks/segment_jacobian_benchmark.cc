// The Jacobian of one shooting segment: SegmentPropagator's tangents beside
// ceres::DynamicAutoDiffCostFunction.
//
// A chain of four DOFs with a network 8-30-4: 8 states, and 402 columns, 8 of
// the segment's start and 394 of the weights; 20 steps of one sample each, the
// whole state observed at every one of them and at the end. What is promised is
// promised against Ceres' default of 4 derivatives a pass; wider passes, up to
// the registers of AVX-512, are measured beside it.

#include <benchmark/benchmark.h>
#include <ceres/dynamic_autodiff_cost_function.h>

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/integrate/segment.h"
#include "tests/benchmarks/chain_problem.h"
#include "tests/benchmarks/measure.h"
#include "tests/benchmarks/plain_chain.h"

namespace pinode {
namespace benchmarks {
namespace {

constexpr int kSteps = 20;
constexpr double kTolerance = 1e-9;
constexpr double kRequiredRatio = 10.0;

using Chain = PlainChain<4, false, false>;
constexpr int kRows = Chain::kStates * (kSteps + 1);
constexpr int kColumns = Chain::kStates + Chain::kParameters;
static_assert(kColumns == 402, "the size that the ratio is promised for");

// All states, the segment's start included, as residuals.
struct PlainSegment {
  const Chain* chain;

  template <typename T>
  bool operator()(T const* const* parameters, T* residuals) const {
    chain->Propagate(parameters[0], parameters[1], 0, kSteps, residuals);
    return true;
  }
};

template <int kStride>
std::unique_ptr<ceres::CostFunction> MakePlainCost(const Chain* chain) {
  auto cost = std::make_unique<
      ceres::DynamicAutoDiffCostFunction<PlainSegment, kStride>>(
      new PlainSegment{chain});
  cost->AddParameterBlock(Chain::kStates);
  cost->AddParameterBlock(Chain::kParameters);
  cost->SetNumResiduals(kRows);
  return cost;
}

// Jacobians as Ceres has them, row-major; read column-major they are
// transposed.
struct PlainResult {
  Vector residuals = Vector(kRows);
  Matrix by_start = Matrix(Chain::kStates, kRows);
  Matrix by_parameters = Matrix(Chain::kParameters, kRows);
};

void EvaluatePlain(const ceres::CostFunction& cost, const Vector& start,
                   const Vector& parameters, PlainResult* result) {
  const double* blocks[] = {start.data(), parameters.data()};
  double* jacobians[] = {result->by_start.data(), result->by_parameters.data()};
  CHECK(cost.Evaluate(blocks, result->residuals.data(), jacobians));
}

void CheckEqual(const Matrix& tangents, const Matrix& plain) {
  CHECK_EQ(tangents.rows(), plain.rows());
  CHECK_EQ(tangents.cols(), plain.cols());
  for (Eigen::Index j = 0; j < plain.cols(); ++j) {
    CHECK_LE((tangents.col(j) - plain.col(j)).norm(),
             kTolerance * plain.col(j).norm())
        << "the two ways differ in column " << j;
  }
}

void BM_SegmentJacobian(benchmark::State& state) {
  const std::unique_ptr<StructuralDynamics> dynamics =
      MakeChain(4, false, false);
  const Vector parameters = dynamics->Parameters();
  StructuralDynamics::Prepared prepared;
  std::string error;
  CHECK(dynamics->Prepare(parameters, &prepared, &error)) << error;
  std::vector<Observation> observations;
  for (Quantity quantity : {Quantity::kDisplacement, Quantity::kVelocity}) {
    for (int i = 0; i < 4; ++i) {
      observations.push_back(
          {QuantityName(quantity), quantity, Vector::Unit(4, i)});
    }
  }
  const ObservationMap observation(*dynamics, observations);
  const IntegrationGrid grid(0.0, 0.05, kSteps + 1, 1);
  const Vector start = Vector::LinSpaced(8, -1.5, 2.0);
  SegmentPropagator propagator(*dynamics, DerivativeMethod::kTangents);
  SegmentTangents tangents;
  const auto evaluate_tangents = [&]() {
    CHECK(propagator.Propagate(prepared, observation, grid, start, 0, kSteps,
                               false, SegmentColumns::kAll, &tangents));
  };

  const Chain chain(kStiffness, kDamping, NetworkArchitecture(), &grid);
  const std::unique_ptr<ceres::CostFunction> plain_costs[] = {
      MakePlainCost<4>(&chain), MakePlainCost<8>(&chain),
      MakePlainCost<16>(&chain)};
  std::vector<double> plain_seconds[3];
  PlainResult plain;

  evaluate_tangents();
  Matrix stacked(kRows, kColumns);
  stacked << tangents.jacobian(), tangents.end_sensitivity;
  for (const auto& cost : plain_costs) {
    EvaluatePlain(*cost, start, parameters, &plain);
    Matrix plain_stacked(kRows, kColumns);
    plain_stacked << plain.by_start.transpose(),
        plain.by_parameters.transpose();
    CheckEqual(stacked, plain_stacked);
  }

  // As many evaluations between two looks at the clock as take a millisecond or
  // so.
  constexpr int kBatch = 10;
  std::vector<double> tangent_seconds;
  for (auto _ : state) {
    double begin = CpuSeconds();
    for (int i = 0; i < kBatch; ++i) {
      evaluate_tangents();
      benchmark::DoNotOptimize(tangents.jacobian().data());
    }
    tangent_seconds.push_back((CpuSeconds() - begin) / kBatch);
    state.SetIterationTime(tangent_seconds.back());
    for (int p = 0; p < 3; ++p) {
      begin = CpuSeconds();
      EvaluatePlain(*plain_costs[p], start, parameters, &plain);
      benchmark::DoNotOptimize(plain.by_parameters.data());
      plain_seconds[p].push_back(CpuSeconds() - begin);
    }
  }

  const int strides[] = {4, 8, 16};
  for (int p = 0; p < 3; ++p) {
    Comparison comparison;
    const std::string stride = std::to_string(strides[p]);
    comparison.name = "segment Jacobian / autodiff, " + stride + " wide" +
                      (p == 0 ? " (default)" : "");
    comparison.reference_seconds = Median(plain_seconds[p]);
    comparison.pinode_seconds = Median(tangent_seconds);
    if (p == 0) {
      comparison.requirement = Comparison::Requirement::kAtLeast;
      comparison.limit = kRequiredRatio;
    }
    AddComparison(comparison);
    state.counters["plain" + stride + "_us"] =
        1e6 * comparison.reference_seconds;
    state.counters["ratio" + stride] = comparison.Ratio();
  }
  state.counters["pinode_us"] = 1e6 * Median(tangent_seconds);
}
BENCHMARK(BM_SegmentJacobian)
    ->Iterations(100)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace benchmarks
}  // namespace pinode
