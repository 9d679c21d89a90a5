#!/usr/bin/env bash
# Reads large text files with pinode and with pandas' C engine, each in a process
# of its own and on one core.
#
#   tests/benchmarks/text_speed.sh BUILD_DIR [MEGABYTES]
#
# BUILD_DIR is a build with PINODE_BUILD_BENCHMARKS. The files, 1000 megabytes
# each unless MEGABYTES says otherwise, stand in BUILD_DIR/text_speed and are
# deleted at the end.
set -euo pipefail

if [[ $# -lt 1 ]]; then
  echo "usage: $0 BUILD_DIR [MEGABYTES]" >&2
  exit 2
fi
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
folder=$1/text_speed
mkdir -p -- "$folder"
trap 'rm -rf -- "$folder"' EXIT
echo "pinode"
"$1/tests/benchmarks/pinode_text_speed" "$folder" "${2:-1000}"
python=/usr/bin/python3
if ! "$python" -c 'import pandas' 2>/dev/null; then
  echo "pandas is not installed (python3-pandas): nothing to compare with"
  exit 0
fi
for name in plain german clock; do
  "$python" "$here/text_speed.py" "$folder/$name.csv"
done
