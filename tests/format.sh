#!/usr/bin/env bash
# Checks that every source is formatted as .clang-format says; `--fix` does it.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
cd -- "$root"
options=(--dry-run -Werror)
if [[ ${1:-} == --fix ]]; then
  options=(-i)
fi
find pinode apps tests data -type f \( -name '*.h' -o -name '*.cc' \) -print0 |
  xargs -0 --no-run-if-empty clang-format "${options[@]}"
