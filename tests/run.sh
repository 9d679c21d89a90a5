#!/usr/bin/env bash
# Everything that a change must pass: format, the whole suite of the release
# build, the unit tests under the sanitizers, and what runs on several threads
# under the thread sanitizer.
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

apps/install_packages.sh apps/packages.txt tests/packages.txt \
  pinode/site/packages.txt

echo "== format"
tests/format.sh || failed+=("format")

# Many sources at a time, where there is memory for it: nobody changes one of
# them here.
batch=4
memory_kib=$(awk '/^MemTotal:/ {print $2}' /proc/meminfo)
if ((memory_kib / jobs > 3000000)); then
  batch=8
fi

for preset in release asan tsan; do
  echo "== $preset"
  # Parsed once, what most sources include. The other two presets still check
  # that each source includes what it uses.
  precompile=OFF
  if [[ $preset == release ]]; then
    precompile=ON
  fi
  cmake --preset "$preset" -DPINODE_PRECOMPILE="$precompile" \
    -DPINODE_UNITY_LIBRARY=ON -DPINODE_UNITY_BATCH="$batch"
  cmake --build --preset "$preset" --parallel "$jobs"
  ctest --preset "$preset" --parallel "$jobs" || failed+=("$preset")
done

if [[ ${#failed[@]} -gt 0 ]]; then
  echo "failed: ${failed[*]}" >&2
  exit 1
fi
