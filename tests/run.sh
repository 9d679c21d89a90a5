#!/usr/bin/env bash
# Everything that a change must pass: format, programs, cases and figures in the
# release build, the unit tests under the sanitizers, and what runs on several
# threads under the thread sanitizer.
#
#   tests/run.sh
#
# Runs from any directory, as root or with sudo (only to install packages that
# are missing), and as often as you like. The static analysis, which takes
# longer, is tests/tidy.sh.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
cd -- "$root"
jobs=$(nproc)
failed=()

# end_of_failures BUILD: prints the last lines of each test that has failed
# there. They stand at the end of the output, which may be all that is kept.
end_of_failures() {
  local logs=$1/Testing/Temporary name
  [[ -s $logs/LastTestsFailed.log ]] || return 0
  while read -r name; do
    echo "== the end of $name in $1"
    awk -v name="$name" '
      / Test: / { header = $0; sub(/^[0-9]+\/[0-9]+ Test: /, "", header)
                  shown = header == name }
      /^<end of output>/ { shown = 0 }
      shown' "$logs/LastTest.log" | tail -n 15 | cut -c 1-400
  done < <(cut -d: -f2- "$logs/LastTestsFailed.log" | head -n 5)
}

apps/install_packages.sh apps/packages.txt tests/packages.txt \
  pinode/site/packages.txt

echo "== format"
tests/format.sh || failed+=("format")

for preset in release asan tsan; do
  echo "== $preset"
  # Most sources include the same headers, parsed once. The test `includes` looks
  # at each source alone. The last preset builds a part without precompiled
  # headers.
  precompile=ON
  most=8
  if [[ $preset == release ]]; then
    most=16
  elif [[ $preset == tsan ]]; then
    precompile=OFF
  fi
  # A unit test runs once: under the sanitizers, if they can judge it.
  unit_tests=ON
  if [[ $preset == release ]]; then
    unit_tests=OFF
  fi
  apps/new_compiler.sh "build-$preset"
  cmake --preset "$preset" -DPINODE_PRECOMPILE="$precompile" \
    -DPINODE_UNIT_TESTS="$unit_tests" \
    -DPINODE_UNITY_LIBRARY=ON \
    -DPINODE_UNITY_BATCH="$(apps/unity_batch.sh "$jobs" "$most")"
  cmake --build --preset "$preset" --parallel "$jobs"
  ctest --preset "$preset" --parallel "$jobs" || failed+=("$preset")
done

if [[ ${#failed[@]} -gt 0 ]]; then
  for preset in "${failed[@]}"; do
    end_of_failures "build-$preset"
  done
  echo "failed: ${failed[*]}" >&2
  exit 1
fi
