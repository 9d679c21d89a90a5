#include "tests/benchmarks/measure.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <utility>

#include "pinode/base/logging.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace benchmarks {
namespace {

std::vector<Comparison>& Comparisons() {
  static auto* comparisons = new std::vector<Comparison>;
  return *comparisons;
}

// A line of the table that tests/figures.sh makes.
void AppendRatio(const Comparison& c) {
  std::string what = "CPU time: " + c.name + ", " + PINODE_ARCHITECTURE;
  if (c.reference == Comparison::Reference::kLowerBound) {
    what += " (or more: the plain way was stopped)";
  }
  testing::AppendFigure(what,
                        c.requirement == Comparison::Requirement::kAtLeast
                            ? testing::AtLeast(c.limit)
                            : testing::AtMost(c.limit),
                        c.Ratio());
}

}  // namespace

double CpuSeconds() {
  timespec now;
  CHECK_EQ(clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now), 0);
  return static_cast<double>(now.tv_sec) +
         1e-9 * static_cast<double>(now.tv_nsec);
}

double Median(std::vector<double> values) {
  CHECK(!values.empty());
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

TimedCost::TimedCost(std::unique_ptr<ceres::CostFunction> cost,
                     EvaluationTimes* times)
    : cost_(std::move(cost)), times_(times) {
  *mutable_parameter_block_sizes() = cost_->parameter_block_sizes();
  set_num_residuals(cost_->num_residuals());
}

bool TimedCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const double begin = CpuSeconds();
  const bool ok = cost_->Evaluate(parameters, residuals, jacobians);
  (jacobians == nullptr ? times_->cost_seconds : times_->jacobian_seconds) +=
      CpuSeconds() - begin;
  return ok;
}

bool Comparison::IsMet() const {
  switch (requirement) {
    case Requirement::kNone:
      return true;
    case Requirement::kAtLeast:
      return Ratio() >= limit;
    case Requirement::kAtMost:
      return Ratio() <= limit;
  }
  return false;
}

void AddComparison(const Comparison& comparison) {
  Comparisons().push_back(comparison);
}

int PrintComparisons() {
  if (Comparisons().empty()) return 0;
  std::printf("\n%-58s %12s %12s %10s  %s\n", "CPU time", "reference", "pinode",
              "ratio", "required");
  int missed = 0;
  for (const Comparison& c : Comparisons()) {
    const char* mark = c.reference == Comparison::Reference::kLowerBound ? ">"
                       : c.reference == Comparison::Reference::kExtrapolated
                           ? "~"
                           : "";
    std::printf("%-58s %1s%9.4g s  %9.4g s  %1s%8.1f", c.name.c_str(), mark,
                c.reference_seconds, c.pinode_seconds, mark, c.Ratio());
    if (c.requirement != Comparison::Requirement::kNone) {
      std::printf(
          "  %s %g, %s",
          c.requirement == Comparison::Requirement::kAtLeast ? ">=" : "<=",
          c.limit, c.IsMet() ? "met" : "MISSED");
      AppendRatio(c);
    }
    std::printf("\n");
    missed += c.IsMet() ? 0 : 1;
  }
  std::printf(
      ">: the reference was stopped at its limit; ~: extrapolated, not run\n");
  return missed;
}

}  // namespace benchmarks
}  // namespace pinode
