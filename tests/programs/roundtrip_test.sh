#!/usr/bin/env bash
# What one program writes, the others read.
#
#   tests/programs/roundtrip_test.sh PROGRAM_DIR
#
# pinode_simulate with and without noise; then pinode_update, whose model.toml
# goes through all three programs and must be the model that was found.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/three_storey" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$scratch"
cd -- "$scratch"
case=three_storey.toml

source "$here/testing.sh"

# Simulation: what is in the folder.
Run 0 pinode_simulate --case=$case --output_dir=clean --noise_percent=0
[[ $(ls -A clean | tr '\n' ' ') == \
  "response_holdout.csv response_train.csv simulate.json " ]] ||
  Fail "unexpected files: $(ls -A clean)"
[[ $(head -1 clean/response_train.csv) == t,a1,a2,a3 ]] ||
  Fail "header of a response: $(head -1 clean/response_train.csv)"
[[ $(wc -l <clean/response_train.csv) -eq $(wc -l <train.csv) ]] ||
  Fail "a response differs in length from its record"
for text in '"schema": "pinode-simulate-1"' "\"case\": \"$case\"" \
  '"noise_percent": 0.0' '"name": "holdout"'; do
  grep -qF "$text" clean/simulate.json || Fail "simulate.json lacks $text"
done

# The noise: as much as asked for, the same for the same seed only.
for run in first:7 again:7 other:8; do
  Run 0 pinode_simulate --case=$case --output_dir="${run%:*}" \
    --noise_percent=2 --seed="${run#*:}"
done
grep -qF '"seed": 7' first/simulate.json || Fail "simulate.json lacks the seed"
for record in train holdout; do
  cmp -s {first,again}/response_$record.csv ||
    Fail "$record: not the same for the same seed"
  ! cmp -s {first,other}/response_$record.csv ||
    Fail "$record: the same for another seed"
  # 3001 samples tell a standard deviation to 1.3 %.
  paste -d, {clean,first}/response_$record.csv | awk -F, '
    NR == 1 { channels = NF / 2 - 1; next }
    {
      ++samples
      for (c = 1; c <= channels; ++c) {
        signal = $(1 + c); noise = $(2 + channels + c) - signal
        s[c] += signal; ss[c] += signal^2; n[c] += noise; nn[c] += noise^2
      }
    }
    END {
      if (channels != 3) { print "no three channels"; exit 1 }
      for (c = 1; c <= channels; ++c) {
        ratio = sqrt((nn[c] - n[c]^2 / samples) / (ss[c] - s[c]^2 / samples))
        if (ratio < 0.019 || ratio > 0.021) {
          print "channel " c ": noise " 100 * ratio " %, expected 2 %"
          exit 1
        }
      }
    }' || Fail "$record: wrong noise"
done

# The case's own words where the flags say nothing.
{ cat $case; printf '\n[simulate]\nnoise_percent = 2\nseed = 7\n'; } >noisy.toml
Run 0 pinode_simulate --case=noisy.toml --output_dir=by_case
cmp -s {first,by_case}/response_train.csv ||
  Fail "[simulate] is not what the flags are"

# A folder of results is replaced only when told to, and as a whole.
echo "from before" >by_case/notes.txt
Run 2 pinode_simulate --case=$case --output_dir=by_case
[[ -s by_case/notes.txt ]] || Fail "replaced without --overwrite"
Run 0 pinode_simulate --case=$case --output_dir=by_case --overwrite
cmp -s {clean,by_case}/response_train.csv || Fail "--overwrite did not replace"
[[ ! -e by_case/notes.txt ]] || Fail "--overwrite left an old file"

# Identification, and the updated model as a case.
Run 0 pinode_update --case=$case --output_dir=D
grep -q '"usable": true' D/result.json || Fail "not usable"
Run 0 pinode_check --case=D/model.toml

Run 0 pinode_simulate --case=D/model.toml --output_dir=of_model
for record in train holdout; do
  # t, a1, a2, a3, time, a1_measured, a1_predicted, ..., a1_deviation, ...
  paste -d, {of_model/response,D/prediction}_$record.csv | awk -F, '
    NR == 1 {
      if ($0 != "t,a1,a2,a3,time,a1_measured,a1_predicted,a2_measured," \
                "a2_predicted,a3_measured,a3_predicted,a1_deviation," \
                "a2_deviation,a3_deviation") {
        print "columns " $0; exit failed = 1
      }
      next
    }
    {
      ++samples
      for (c = 1; c <= 3; ++c) {
        a = $(1 + c); b = $(5 + 2 * c)
        if (a == "" || b == "") { print "empty cell"; exit failed = 1 }
        difference = a > b ? a - b : b - a
        size = b < 0 ? -b : b
        if (difference > worst[c]) worst[c] = difference
        if (size > peak[c]) peak[c] = size
      }
    }
    END {
      if (failed) exit 1
      for (c = 1; c <= 3; ++c) {
        if (samples < 3000 || !(peak[c] > 1) || worst[c] > 1e-6 * peak[c]) {
          print "a" c ": differs by " worst[c] " of " peak[c]; exit 1
        }
      }
    }' || Fail "$record: model.toml does not give the prediction"
done

# Identified again, the model stays what it is. It cannot become better than it
# was, so the result may or may not be called usable; it must have converged.
status=0
"$programs/pinode_update" --case=D/model.toml --output_dir=E >stdout \
  2>stderr || status=$?
[[ $status -le 1 ]] || Fail "update of model.toml: status $status"
grep -q '"termination": "converged"' E/result.json ||
  Fail "update of model.toml did not converge"
awk -F, '
  $1 ~ /^(k[123]|c_mass|c_stiffness)$/ {
    ++groups
    if (!($4 > -1e-3 && $4 < 1e-3)) { print $1 " = " $4; exit bad = 1 }
  }
  END { if (bad || groups != 5) exit 1 }' E/parameters.csv ||
  Fail "the groups of model.toml do not stay zero: $(cat E/parameters.csv)"

HoldoutError() {
  awk '/"name": "holdout"/ { here = 1 }
    here && /"nrmse"/ { gsub(/[^-+.0-9e]/, "", $2); print $2; exit }' "$1"
}
awk -v a="$(HoldoutError D/result.json)" -v b="$(HoldoutError E/result.json)" \
  'BEGIN { exit !(a > 0.01 && a < 0.03 && (a - b)^2 < (1e-3 * a)^2) }' ||
  Fail "hold-out error $(HoldoutError D/result.json), from model.toml \
$(HoldoutError E/result.json)"
