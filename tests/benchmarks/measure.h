// Times and ratios.

#ifndef PINODE_TESTS_BENCHMARKS_MEASURE_H_
#define PINODE_TESTS_BENCHMARKS_MEASURE_H_

#include <ceres/cost_function.h>

#include <memory>
#include <string>
#include <vector>

namespace pinode {
namespace benchmarks {

// CPU time of this process, all threads, in seconds: on a shared machine the
// wall clock measures the neighbours as well.
double CpuSeconds();

// Of at least one value.
double Median(std::vector<double> values);

// What evaluations of cost functions have cost so far.
struct EvaluationTimes {
  double cost_seconds = 0.0;      // residuals alone
  double jacobian_seconds = 0.0;  // residuals with Jacobians
};

// A cost function under the stop watch.
class TimedCost final : public ceres::CostFunction {
 public:
  // `times` must outlive this object.
  TimedCost(std::unique_ptr<ceres::CostFunction> cost, EvaluationTimes* times);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  std::unique_ptr<ceres::CostFunction> cost_;
  EvaluationTimes* times_;
};

// One line of the table that closes a run.
struct Comparison {
  enum class Requirement { kNone, kAtLeast, kAtMost };

  std::string name;
  // Of the numerator and the denominator of the ratio, CPU seconds.
  double reference_seconds = 0.0;
  double pinode_seconds = 0.0;
  Requirement requirement = Requirement::kNone;
  double limit = 0.0;
  // The reference was stopped, or not run: its time is a lower bound, or
  // extrapolated.
  enum class Reference { kMeasured, kLowerBound, kExtrapolated };
  Reference reference = Reference::kMeasured;

  double Ratio() const { return reference_seconds / pinode_seconds; }
  bool IsMet() const;
};

void AddComparison(const Comparison& comparison);

// Prints all comparisons. Returns how many requirements are missed.
int PrintComparisons();

}  // namespace benchmarks
}  // namespace pinode

#endif  // PINODE_TESTS_BENCHMARKS_MEASURE_H_
