#!/usr/bin/env bash
# Published records by their rules: fits each case of tests/benchmarks/measured
# on its training part and prints how well the test parts are predicted, beside
# what others have published. The test parts are read by this scorer alone, from
# the predictions that pinode has written. Exit status 1 where a figure is
# missed.
#
#   tests/benchmarks/measured.sh [CASE ...]
#
# The records are those of PINODE_MEASURED_DATA (default: ../shared/data beside
# the project); without them there is nothing to do.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
cd -- "$root"
data=${PINODE_MEASURED_DATA:-$root/../shared/data}
if [[ ! -d $data ]]; then
  echo "skipped: no measured records in $data (PINODE_MEASURED_DATA)"
  exit 0
fi
data=$(cd -- "$data" && pwd)

build=${PINODE_BUILD_DIR:-build-release}
if [[ -z ${PINODE_BUILD_DIR:-} ]]; then
  apps/install_packages.sh apps/packages.txt tests/packages.txt
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target pinode_update
fi
build=$(cd -- "$build" && pwd)

work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
cp tests/benchmarks/measured/*.toml "$work"
ln -s "$data" "$work/data"
missed=0
printf '%-28s %12s %12s   %s\n' "record" "here" "asked" "others"

# row NAME VALUE ASKED OTHERS
row() {
  local mark=""
  if awk -v v="$2" -v a="$3" 'BEGIN {exit !(v > a)}'; then
    mark="  missed"
    missed=1
  fi
  printf '%-28s %12s %12s   %s%s\n' "$1" "$2" "$3" "$4" "$mark"
}

# score CASE RECORD SKIP FACTOR: RMS error of the only channel of a prediction,
# without its first SKIP samples, times FACTOR.
score() {
  awk -F, -v skip="$3" -v factor="$4" '
    NR > 1 + skip {d = $2 - $3; sum += d * d; ++count}
    END {printf "%.4g", factor * sqrt(sum / count)}
  ' "$work/out_$1/prediction_$2.csv"
}

# fit CASE SECONDS: fits it; a row for the time.
fit() {
  local begin end
  begin=$(date +%s.%N)
  if ! "$build/apps/pinode_update" --case="$work/$1.toml" \
    --output_dir="$work/out_$1" --progress=false >"$work/$1.log" 2>&1; then
    tail -n 5 "$work/$1.log"
    missed=1
  fi
  end=$(date +%s.%N)
  row "$1, seconds" "$(awk -v a="$begin" -v b="$end" \
    'BEGIN {printf "%.1f", b - a}')" "$2" ""
}

silverbox() {
  fit silverbox 60
  row "  multisine, mV" "$(score silverbox multisine 50 1000)" 0.25 \
    "neural 1.49; ARX(2) 6.97; one cubic NARX 1.05"
  row "  arrow, mV" "$(score silverbox arrow 50 1000)" 0.33 \
    "neural 2.38; ARX(2) 14.4; NARX 1.77"
  row "  arrow without its end, mV" "$(score silverbox arrow_inside 50 1000)" \
    0.25 "neural 0.95; ARX(2) 6.63; NARX 1.04"
}

bouc_wen() {
  fit bouc_wen 60
  row "  multisine, 1e-7 m" "$(score bouc_wen multisine 0 1e7)" 3 \
    "best black box 75; the true parameters 2.4"
  row "  sweep, 1e-7 m" "$(score bouc_wen sweep 0 1e7)" 26 \
    "the true parameters 25.6: its output was filtered"
  # In the units of the equation, from the factors in the result.
  awk -F, '
    {value[$1] = $4}
    END {
      split("m c k device.a device.b device.g", name, " ")
      split("1.5 20 4e4 1 1 1", scale, " ")
      split("1 1 1 0 0 0", base, " ")
      split("2 10 5e4 5e4 800 -1100", truth, " ")
      for (i = 1; i <= 6; ++i) {
        v = scale[i] * (base[i] + value[name[i]])
        printf "%s %.3f\n", name[i], 100 * (v / truth[i] - 1)
      }
    }' "$work/out_bouc_wen/parameters.csv" |
    while read -r name error; do
      echo "$name ${error#-}"
    done >"$work/errors"
  while read -r name error; do
    row "  $name, error in %" "$error" 0.1 "white box 0.6 to 10"
  done <"$work/errors"
}

emps() {
  fit emps 60
  row "  test, mm" "$(score emps test 20 1000)" 4.0 \
    "black box 2.64; friction laws 3.5 to 3.9; published law 8.4"
}

for each in "${@:-silverbox bouc_wen emps}"; do
  for name in $each; do
    case $name in
      silverbox | bouc_wen | emps) "$name" ;;
      *)
        echo "no case '$name', expected silverbox, bouc_wen or emps" >&2
        exit 2
        ;;
    esac
  done
done
exit "$missed"
