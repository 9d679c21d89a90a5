// Benchmarks with their ratios; README.md says what is measured.
//
//   pinode_benchmarks [--benchmark_filter=REGEX]
//
// Exit status 1 where a required ratio is missed.

#include <benchmark/benchmark.h>

#include "tests/benchmarks/measure.h"

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return pinode::benchmarks::PrintComparisons() == 0 ? 0 : 1;
}
