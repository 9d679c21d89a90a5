#!/usr/bin/env bash
# Modes that pinode_modes finds in random structures under measured loads (white
# noise, sweeps, hammer blows, few sines), at noise from 1e-12 to 0.1 of each
# channel's standard deviation: invented, listed twice, missed.
#
#   tests/benchmarks/modes_loads.sh [RECORDS [SEED]]
#
# NumPy and SciPy, of PYTHON, default python3. With KEEP=FOLDER the records and
# results stay there.
set -euo pipefail

source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy, scipy" pinode_modes
"${PYTHON:-python3}" tests/benchmarks/modes_loads.py \
  --program "$build/apps/pinode_modes" --work "$work" \
  --records "${1:-100}" --seed "${2:-1}"
