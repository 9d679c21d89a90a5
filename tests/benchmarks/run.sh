#!/usr/bin/env bash
# Builds the release preset with its benchmarks, runs them, and ends with a
# table of ratios. Exit status 1 where a required ratio is missed.
#
#   tests/benchmarks/run.sh [--benchmark_filter=REGEX ...]
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
cd -- "$root"

apps/install_packages.sh apps/packages.txt tests/packages.txt
cmake --preset release -DPINODE_BUILD_BENCHMARKS=ON
cmake --build --preset release --parallel "$(nproc)" --target pinode_benchmarks
exec build-release/tests/benchmarks/pinode_benchmarks \
  --benchmark_counters_tabular=true "$@"
