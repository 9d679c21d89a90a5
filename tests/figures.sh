#!/usr/bin/env bash
# Prints the table of figures that the project promises: what, asked, measured,
# pass or miss. A quarter of an hour on two cores, half of it benchmarks, after the
# build.
#
#   tests/figures.sh [--build=FOLDER] [--no-benchmarks] [--study] [--help]
#
#   --build=FOLDER    an existing build folder, with tests and benchmarks; by
#                     default the preset `release` is configured
#   --no-benchmarks   leaves out the ratios of CPU times
#   --study           adds the figures over many seeds; long
#
# Runs from any directory. What needs measured data that are not at hand prints
# `skipped`. What tests and benchmarks write goes to figures.log in the build
# folder. Exit status: 0 all met, 1 a figure is missed or a test failed, 2 usage.
set -euo pipefail

Usage() {
  sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//p}' -- "${BASH_SOURCE[0]}"
}

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=
benchmarks=1
study=
for argument in "$@"; do
  case $argument in
    --build=?*) build=${argument#--build=} ;;
    --no-benchmarks) benchmarks= ;;
    --study) study=1 ;;
    --help)
      Usage
      exit 0
      ;;
    *)
      echo "$0: unknown argument $argument; see --help" >&2
      exit 2
      ;;
  esac
done
if [[ -n $build ]]; then
  if [[ ! -f $build/CMakeCache.txt ]]; then
    echo "$0: $build is not a build folder" >&2
    exit 2
  fi
  build=$(cd -- "$build" && pwd)
fi
cd -- "$root"
jobs=$(nproc)

apps/install_packages.sh apps/packages.txt tests/packages.txt
if [[ -z $build ]]; then
  cmake --preset release >&2
  build=$root/build-release
fi
targets=(pinode_integrate_test pinode_discover_test pinode_cases_test)
if [[ -n $study ]]; then targets+=(pinode_studies); fi
if [[ -n $benchmarks ]]; then targets+=(pinode_benchmarks); fi
cmake --build "$build" --parallel "$jobs" --target "${targets[@]}" >&2

# The segment's Jacobian is promised for the native architecture and for plain
# -O2: whatever this build is, another is the other.
if [[ -n $benchmarks ]]; then
  other=$build/other_architecture
  native=OFF
  if ! grep -q '^PINODE_NATIVE:BOOL=ON' "$build/CMakeCache.txt"; then
    native=ON
  fi
  cmake -S . -B "$other" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DPINODE_NATIVE="$native" -DPINODE_BUILD_APPS=OFF \
    -DPINODE_BUILD_TESTS=OFF -DPINODE_BUILD_BENCHMARKS=ON >&2
  cmake --build "$other" --parallel "$jobs" --target pinode_benchmarks >&2
fi

log=$build/figures.log
: >"$log"
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
export PINODE_FIGURES=$scratch/figures
: >"$PINODE_FIGURES"
failed=()

# Runs a program that reports figures. A failed test is kept beside the table:
# it may have ended before its figures.
Run() {
  local status=0 name=${1##*/}
  echo "== $name" >&2
  echo "== $*" >>"$log"
  "$@" >"$scratch/out" 2>&1 || status=$?
  cat -- "$scratch/out" >>"$log"
  if [[ $status -ne 0 ]]; then
    local tests
    tests=$(sed -n 's/^\[  FAILED  \] \([^ ,]*\),\{0,1\}.*/\1/p' \
      "$scratch/out" | grep -v '^[0-9]*$' | sort -u || true)
    # A benchmark leaves with 1 for a ratio that is in the table.
    if [[ -n $tests ]]; then
      while read -r test; do failed+=("$name $test"); done <<<"$tests"
    fi
    if [[ $status -gt 1 ]]; then
      failed+=("$name ended with status $status")
    elif [[ -z $tests && $name != pinode_benchmarks ]]; then
      failed+=("$name")
    fi
  fi
}

Run "$build/pinode/integrate/pinode_integrate_test"
Run "$build/pinode/discover/pinode_discover_test" \
  --gtest_filter="*LassoReference*"
Run "$build/tests/pinode_cases_test"
# Statistics of ambient records are run by themselves, and so is what only
# prints how constants were tuned.
if [[ -n $study ]]; then
  Run "$build/tests/pinode_studies" \
    --gtest_filter="-ModesStudy.*:BridgeAmbientStudy.*:TuningStudy.*"
fi
if [[ -n $benchmarks ]]; then
  Run "$build/tests/benchmarks/pinode_benchmarks"
  Run "$other/tests/benchmarks/pinode_benchmarks" \
    --benchmark_filter=BM_SegmentJacobian
fi

awk -F '\t' '
  {
    verdict[NR] = $1; what[NR] = $2; asked[NR] = $3; measured[NR] = $4
    if (length($2) > width) width = length($2)
    ++count[$1]
  }
  END {
    format = "%-" width "s  %-16s  %-10s  %s\n"
    printf format, "figure", "asked", "measured", ""
    for (i = 1; i <= NR; ++i) {
      printf format, what[i], asked[i], measured[i], verdict[i]
    }
    printf "\n%d pass, %d miss, %d skipped\n", count["pass"], count["miss"],
      count["skipped"]
  }' "$PINODE_FIGURES"
if [[ ${#failed[@]} -gt 0 ]]; then
  echo
  echo "Failed; see $log:"
  printf '  %s\n' "${failed[@]}"
fi
if [[ ${#failed[@]} -gt 0 ]] || grep -q '^miss' "$PINODE_FIGURES"; then
  exit 1
fi
