#!/usr/bin/env bash
# By hand: fuzz_test.py and fuzz_bridges_test.py under the address and
# undefined-behaviour sanitizers, 2000 examples of each of their tests (48,000 in
# all), or EXAMPLES of each.
#
#   pinode/python/tests/fuzz_sanitized.sh [EXAMPLES]
#
# Builds the package by the preset asan (ten minutes on two cores, if nothing of
# it is there) and takes some minutes more. Exits 1 if a test fails, a sanitizer
# stops it, or memory is lost that the module asked for. What Python itself has
# still in hand at its end (constants, code, types; of NumPy as well) is a leak
# to the sanitizer, and is told apart by its stack, in which the module is not.
set -euo pipefail

examples=${1:-2000}
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../../.." && pwd)
cd -- "$root"
build=$root/build-asan
cmake --preset asan -DPINODE_PYTHON=ON >/dev/null
cmake --build --preset asan --parallel "$(nproc)" \
  --target pinode_python_package

log=$build/fuzz_sanitized
rm -f -- "$log".*
# The C++ library first, or the sanitizer would not know its exceptions.
runtime=$(clang++ -print-file-name=libclang_rt.asan-x86_64.so)
cxx=$(clang++ -print-file-name=libstdc++.so.6)
status=0
# Python's own allocator would hide what it is asked for.
LD_PRELOAD="$runtime $cxx" PYTHONMALLOC=malloc PYTHONDONTWRITEBYTECODE=1 \
  ASAN_OPTIONS="detect_leaks=1:allocator_may_return_null=1:log_path=$log" \
  UBSAN_OPTIONS="print_stacktrace=1" \
  LSAN_OPTIONS="max_leaks=0" \
  HYPOTHESIS_STORAGE_DIRECTORY="$build/hypothesis" \
  PYTHONPATH="$build/pinode/python" MPLBACKEND=Agg \
  PINODE_FUZZ_EXAMPLES="$examples" PINODE_SOURCE_DIR="$root" \
  PINODE_BUILD_DIR="$build" \
  /usr/bin/python3 -m pytest -q -s -p no:cacheprovider \
  pinode/python/tests/fuzz_test.py \
  pinode/python/tests/fuzz_bridges_test.py || status=$?

cat -- "$log".* 2>/dev/null >"$log" || true
# Blocks of the report are apart by empty lines.
lost=$(awk 'BEGIN { RS = "" } / leak of / && /pinode|pybind11/' "$log")
fault=$(grep -E 'runtime error:|ERROR: AddressSanitizer' "$log" || true)
if [[ -n $lost$fault ]]; then
  printf '%s\n' "$fault" "$lost"
  exit 1
fi
# The sanitizer's own status for Python's leaks alone is 1, too.
if [[ $status -ne 0 ]] && ! grep -q 'detected memory leaks' "$log"; then
  exit 1
fi
echo "nothing found in $examples examples of each test"
