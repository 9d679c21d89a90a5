#!/usr/bin/env bash
# From a bare Debian 12 to the first report: installs what is missing, builds
# the programs, checks the three-storey case and updates its model.
#
#   apps/quickstart.sh
#
# Runs from any directory and as often as you like; everything it makes is
# under build-quickstart/.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
cd -- "$root"
build=$root/build-quickstart
case_file=data/three_storey/three_storey.toml
result=$build/three_storey_result

apps/install_packages.sh apps/packages.txt

cmake --preset quickstart
cmake --build --preset quickstart --parallel "$(nproc)"

echo
echo "== pinode_check: what the case holds, and what its sensors can see"
"$build/apps/pinode_check" --case="$case_file"

echo
echo "== pinode_update: the identification"
"$build/apps/pinode_update" --case="$case_file" --output_dir="$result" \
  --overwrite

echo
echo "The report: $result/report.html"
