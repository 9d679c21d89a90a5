#!/usr/bin/env bash
# The board of verdicts: random structures with hidden faults, the cases of this
# project and of the measured data, one line each and a table of what was wrong,
# named and covered, pairs of states of random structures of which one may have
# lost stiffness, and measured frames and a beam in which nothing or much has
# changed.
#
#   tests/benchmarks/verdicts.sh [COUNT]
#
# COUNT structures (400) of verdicts/structures.py; needs NumPy and SciPy. Cases
# of measured data come from PINODE_MEASURED_DATA (../shared/data), where it is.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
cd -- "$root"
build=${PINODE_BUILD_DIR:-build-release}
if [[ -z ${PINODE_BUILD_DIR:-} ]]; then
  apps/install_packages.sh apps/packages.txt tests/packages.txt
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target pinode_update \
    pinode_damage_program
fi
update=$build/apps/pinode_update
python=${PYTHON:-python3}

echo "Random structures"
"$python" tests/benchmarks/verdicts/board.py "$update" "${1:-400}" \
  --jobs="${PINODE_JOBS:-$(nproc)}"

measured=${PINODE_MEASURED_DATA:-$root/../shared/data}
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
echo
echo "Cases"
for case in data/*/*.toml "$measured"/faults/verdict/*/*.toml; do
  [[ -f $case ]] || continue
  began=$SECONDS
  rm -rf -- "$work/out"
  "$update" --case="$case" --output_dir="$work/out" --progress=false \
    >"$work/log" 2>&1 || true
  name=$(basename -- "$(dirname -- "$case")")/$(basename -- "$case" .toml)
  "$python" - "$work/out/result.json" "$name" "$((SECONDS - began))" <<'END'
import json, sys
path, name, seconds = sys.argv[1:]
try:
    with open(path, encoding="utf-8") as file:
        result = json.load(file)
    first = [e["what"] for e in result["explanations"][:1]]
    print(f"  {name:45s} {result['verdict']:11s} {seconds:>4s} s  "
          f"{''.join(first)[:90]}")
except OSError:
    print(f"  {name:45s} refused     {seconds:>4s} s")
END
done

echo
echo "Damage of random structures"
"$python" tests/benchmarks/verdicts/damage_board.py "$build/apps" "${1:-400}" \
  --jobs="${PINODE_JOBS:-$(nproc)}"

echo
echo "Measured frames"
"$python" tests/benchmarks/verdicts/measured.py "$build/apps" "$measured"

echo
echo "Measured beam"
"$python" tests/benchmarks/verdicts/dropbear.py "$build/apps" "$measured"
