#!/usr/bin/env bash
# Static analysis: clang-tidy as .clang-tidy says, on the sources given, or on
# all of them.
#
#   tests/tidy.sh [FILE...]
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
files=()
for file in "$@"; do
  files+=("$(realpath -- "$file")")
done
cd -- "$root"

apps/install_packages.sh apps/packages.txt tests/packages.txt
cmake --preset dev
if [[ ${#files[@]} -eq 0 ]]; then
  mapfile -t files < <(find "$root/pinode" "$root/apps" "$root/tests" \
    \( -path "$root/tests/floors_fixture" -o \
    -path "$root/tests/consumer" \) -prune -o -name '*.cc' -print | sort)
fi
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build-dev --quiet
