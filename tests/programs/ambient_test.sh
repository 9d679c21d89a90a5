#!/usr/bin/env bash
# Ambient records that are not what they should be, and a verdict from modes
# alone.
#
#   tests/programs/ambient_test.sh PROGRAM_DIR
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/three_storey_ambient" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$scratch"
cd -- "$scratch"
gzip -dc "$data/wind.csv.gz" >wind.csv
sed -i 's/wind.csv.gz/wind.csv/' three_storey_ambient.toml

tested=pinode_update
source "$here/testing.sh"

Near() {
  awk -v a="$1" -v b="$2" -v limit="$3" \
    'BEGIN { exit !(a != "" && (a - b)^2 <= limit^2) }' || Fail "$1, expected $2"
}

# NAME PROGRAM: a case NAME.toml with the record as the awk PROGRAM, which sees
# columns $1 to $3, leaves it.
Spoil() {
  awk -F, -v OFS=, "NR > 1 { $2 } { print }" wind.csv >"$1.csv"
  sed "s/wind.csv/$1.csv/" three_storey_ambient.toml >"$1.toml"
}
Window() {
  sed "s/^excitation/window = [$1, $2]\n&/" three_storey_ambient.toml
}

# Said in one line, and nothing done.
Window 0.0 5.0 >short.toml
Refused "13.4 cycles of the model's lowest mode" --case=short.toml --output_dir=E
Spoil dead '$2 = 0.25'
Refused "channel 'a2': it has the same value in every sample" --case=dead.toml \
  --output_dir=E
Spoil copied '$3 = -2 * $1'
Refused "channel 'a3' is channel 'a1' again" --case=copied.toml \
  --output_dir=E
tested=pinode_modes
{
  cat three_storey_ambient.toml
  printf '[modes]\nmax_order = 200\n'
} >order.toml
Refused "order.toml:$(wc -l <order.toml): [modes] max_order: record 'wind': models of order 200" \
  --case=order.toml --output_dir=E
# Tables of other programs are theirs.
{
  cat three_storey_ambient.toml
  printf '[plan]\n'
} >plan.toml
Run 0 pinode_modes --case=plan.toml --output_dir=modes_plan
Refused "channel 'a2': it has the same value in every sample" --case=dead.toml --output_dir=E

# Said, and done: what is left is of use.
Spoil clipped '$2 = $2 > 0.4 ? 0.4 : $2 < -0.4 ? -0.4 : $2'
Spoil stuck '$2 = NR % 4 == 2 ? $2 : last; last = $2'
for state in clipped stuck; do
  Run 0 pinode_modes --case=$state.toml --output_dir=modes_$state
  grep -q "Channel 'u2' \(is clipped\|repeats itself\)" stdout ||
    Fail "nothing of a channel that is $state"
  Run 0 pinode_check --case=$state.toml
  grep -q "Channel 'a2' \(is clipped\|repeats itself\)" stdout ||
    Fail "nothing of a channel that is $state"
done
Run 0 pinode_modes --case=copied.toml --output_dir=modes_copied
grep -q "Channel 'u3' is channel 'u1' again" stdout || Fail "not copied"

# Two loggers of differing rates, one after the other: each record has lines of
# its own, and together they say what the whole record says.
head -n 30001 wind.csv >fast.csv
awk 'NR == 1 || (NR > 30001 && NR % 2 == 0)' wind.csv >slow.csv
{
  sed '/^\[\[record\]\]/,$d' three_storey_ambient.toml
  sed -n '/^\[\[record\]\]/,$p' three_storey_ambient.toml >record
  sed 's/wind/fast/' record
  sed 's/wind/slow/; s/sampling_rate_hz = 100/sampling_rate_hz = 50/' record
} >rates.toml
Run 0 pinode_update --case=rates.toml --output_dir=rates --progress=false
[[ $(grep -c '"lines"' rates/result.json) -eq 2 ]] || Fail "two records"
Near "$(awk '$1 == "k1" { print $3; exit }' stdout)" 0.25 0.01
Near "$(awk '$1 == "k2" { print $3; exit }' stdout)" -0.1304 0.01
Run 0 pinode_modes --case=rates.toml --output_dir=modes_rates
grep -q "^3 modes were found" stdout || Fail "not the three modes of both"

# A shaker whose force is measured, under the wind: its run by the model that is
# the truth, from rest, on top of the record. With it the storeys are known
# better than from wind alone; a force twice as large is seen, and so is one that
# is the other way round.
awk 'BEGIN {
  print "F"
  for (k = 0; k < 60000; ++k) {
    t = 0.01 * k
    print 300 * sin(6.283185307 * t * (2 + 0.01 * t)) * (t < 5 ? t / 5 : 1)
  }
}' >force.csv
WithForce() {
  sed 's/^excitation = "ambient"/'"$1"'interpolation = "band_limited"\
  [[record.force]]\
  dof = "u3"\
  column = "F"\
  unit = "N"\
  file = "force.csv"/' three_storey_ambient.toml
}
tested=pinode_simulate
{
  WithForce 'start = "rest"\
' | sed '/^\[\[group\]\]/,/^\[\[record/{/^\[\[record/!d;}
    s/wind.csv/force.csv/
    s/\[2432000, 3898500, 3091000\]/[3040000, 3390000, 2810000]/
    s/\[0.3661, 0.0002905\]/[0.523, 0.000415]/'
} >truth.toml
Run 0 pinode_simulate --case=truth.toml --output_dir=S
tested=pinode_update
paste -d, wind.csv S/response_wind.csv | awk -F, '
  NR == 1 { for (i = 4; i <= NF; ++i) at[$i] = i; print "a1,a2,a3"; next }
  { print $1 + $at["a1"] "," $2 + $at["a2"] "," $3 + $at["a3"] }' >both.csv
WithForce 'excitation = "ambient"\
' | sed 's/wind.csv/both.csv/' >both.toml
Run 0 pinode_check --case=both.toml
grep -q "measured loads, band_limited between samples: force_u3" stdout ||
  Fail "nothing of the measured load"
Run 0 pinode_update --case=both.toml --output_dir=both --progress=false
Near "$(awk '$1 == "k1" { print $3; exit }' stdout)" 0.25 0.004
Near "$(awk '$1 == "k2" { print $3; exit }' stdout)" -0.1304 0.004
grep -q '"by_measured_loads"' both/result.json || Fail "no measured loads"
grep -q '"coherence_probability"' both/result.json || Fail "no coherence"
grep -q "by measured loads" both/report.html || Fail "nothing in the report"
for scale in 2.0 -1.0; do
  sed "s/^  column = \"F\"/&\n  scale = $scale/" both.toml >wrong.toml
  Run 1 pinode_update --case=wrong.toml --output_dir=wrong --progress=false \
    --overwrite
  grep -q "its measured loads, still follows these loads" stdout ||
    Fail "a force that is $scale of itself"
done
for key in 'sigma = 1.0' 'scale = {initial = 1.0}'; do
  sed "s/^  column = \"F\"/&\n  $key/" both.toml >unknown.toml
  Refused "unknown.toml" --case=unknown.toml --output_dir=E
done
sed 's/unit = "N"/unit = "V"/' both.toml >volts.toml
Refused "a load in volts" --case=volts.toml --output_dir=E
for key in 'fit = false' 'sigma = 0.1' 'sigma_percent = 2'; do
  sed "s/^  column   = \"a2\"/&\n  $key/" both.toml >channel.toml
  Refused "its noise is found" --case=channel.toml --output_dir=E
done
sed 's/^excitation/role = "holdout"\n&/' both.toml >holdout.toml
Refused "cannot be predicted" --case=holdout.toml --output_dir=E
sed 's/^excitation/interpolation = "linear"\n&/' three_storey_ambient.toml \
  >idle.toml
Refused "no measured load" --case=idle.toml --output_dir=E
sed 's/^  quantity = "absolute_acceleration"/&\n  gain = {free = true}/' \
  both.toml >gain.toml
Refused "cannot be told" --case=gain.toml --output_dir=E
sed '/^interpolation/d' both.toml >between.toml
Refused "'interpolation' is missing" --case=between.toml --output_dir=E

# A structure that follows the temperature: the same motion at another rate is
# that of a frame as many times as stiff as the rate's square. Three thirds of the
# record as of 0, 10 and 20 degrees, 0.3 % a degree, give the slope; all of it as
# of -20 degrees is then no change, and one of 12 % where the temperature is wrong.
# NAME RATE TEMPERATURE: a record.
At() {
  sed "s/wind/$1/; s/sampling_rate_hz = 100/sampling_rate_hz = $2/" record
  printf '  [[record.covariate]]\n  name = "temperature"\n  %s\n\n' "$3"
}
awk 'NR == 1 || NR <= 20001' wind.csv >zero.csv
awk 'NR == 1 || (NR > 20001 && NR <= 40001)' wind.csv >ten.csv
awk -v OFS=, 'NR == 1 { print $0, "T"; next }
  NR > 40001 { print $0, n++ % 3000 ? "" : 20 + n / 1e4 - 1 }' wind.csv >twenty.csv
{
  sed '/^\[\[record\]\]/,$d
    s/\[2432000, 3898500, 3091000\]/[3040000, 3390000, 2810000]/' \
    three_storey_ambient.toml
  cat <<'END'
[[group]]
name    = "per_degree"
adds_to = "stiffness"
matrix  = [[6430000, -3390000, 0], [-3390000, 6200000, -2810000], [0, -2810000, 2810000]]
follows = {covariate = "temperature", reference = 20}

END
} >frost.toml
{ cat frost.toml; At zero 102.956 'value = 0'; At ten 101.489 'value = 10'
  At twenty 100 'column = "T"'; } >seasons.toml
Run 0 pinode_check --case=seasons.toml
grep -q "temperature: mean 19.9.*, from 19 to 20.8" stdout || Fail "no mean"
grep -q "temperature: 7 of 20000 samples are present" stdout || Fail "no gaps"
Run 0 pinode_update --case=seasons.toml --output_dir=seasons --progress=false
Near "$(awk '$1 == "per_degree" { print $3; exit }' stdout)" -0.003 0.0006
Near "$(awk '$1 == "k2" { print $3; exit }' stdout)" 0 0.01
grep -A1 '"covariates"' seasons/result.json | grep -q '"temperature": 10' ||
  Fail "no temperature in result.json"
{ cat frost.toml; At wind 105.83 'value = -20'; } >winter.toml
Run 0 pinode_damage --baseline=seasons --case=winter.toml --output_dir=winter \
  --progress=false
grep -qF '"verdict": "no_damage"' winter/damage.json || Fail "not healthy"
grep -q "Held at the baselines.* values.*: per_degree" winter/report.html ||
  Fail "nothing of what was held"
[[ $(grep -A8 '"per_degree"' winter/model.toml) == *"free = false"* ]] ||
  Fail "not held in model.toml"
Near "$(awk '$1 == "k1" { print $2; exit }' stdout)" 0 1.5
# What was held is held in the model that is written.
Run 0 pinode_update --case=winter/model.toml --output_dir=again --progress=false
Near "$(awk '$1 == "k1" { print $3; exit }' stdout)" 0 0.01
# A slope from another temperature is another slope.
sed 's/reference = 20/reference = 0/' winter.toml >from_zero.toml
tested=pinode_damage
Refused "follows temperature from 20, expected temperature from 0" \
  --baseline=seasons --case=from_zero.toml --output_dir=E
tested=pinode_update
sed 's/value = -20/value = 20/' winter.toml >wrong_winter.toml
Run 0 pinode_damage --baseline=seasons --case=wrong_winter.toml \
  --output_dir=wrong_winter --progress=false
Near "$(awk '$1 == "k1" { print $2; exit }' stdout)" 12 2
# One temperature alone.
Run 0 pinode_update --case=winter.toml --output_dir=alone --progress=false
grep -q "^Not determined by these records: .*per_degree" stdout ||
  Fail "a slope from one temperature"
Run 0 pinode_damage --baseline=alone --case=winter.toml --output_dir=open \
  --progress=false
grep -q "^Not determined by baseline 'alone': .*nothing is seen" stdout ||
  Fail "nothing of what the baseline leaves open"
sed '/record.covariate/,$d' winter.toml >forgotten.toml
Refused "no record has a covariate" --case=forgotten.toml --output_dir=E
{ cat frost.toml; At zero 102.956 'value = 0'; At wind 105.83 'value = -20' |
  sed '/record.covariate/,$d'; } >half.toml
Refused "record 'wind': it has no covariate 'temperature'" --case=half.toml \
  --output_dir=E
# Readings on either side of a window, none in it, at another rate; and a
# thermometer that stopped early.
sed '/name = "twenty"/s/$/\nwindow = [35.0, 55.0]\nresample_hz = 70/' \
  seasons.toml >window.toml
Run 0 pinode_check --case=window.toml
grep -q "temperature: mean 19.45, from 19.35 to 19.55" stdout || Fail "not filled"
awk -F, -v OFS=, 'NR > 10000 { $4 = "" } { print }' twenty.csv >stopped.csv
sed 's/twenty.csv/stopped.csv/' seasons.toml >stopped.toml
Refused "expected readings from begin to end" --case=stopped.toml --output_dir=E
sed 's/^  value = -20/  column = "a1"\n&/' winter.toml >both_ways.toml
Refused "'value' and 'column' are both given" --case=both_ways.toml --output_dir=E
tested=pinode_modes
Run 0 pinode_modes --case=winter.toml --output_dir=modes_winter
grep -q "the mean of temperature is -20" stdout || Fail "no mean with modes"
tested=pinode_update

# A verdict from modes alone: two stretches of the record as baselines, a third
# as it is and as if the second storey had lost a tenth, by the ratios of that
# frame's modes to the healthy one's (NumPy).
ByModes() {
  Run 0 pinode_modes --case="$1.toml" --output_dir="modes_$1"
  { sed '/^\[\[record\]\]/,$d; /^name    = "c_/,/^matrix/d' \
      three_storey_ambient.toml | awk '
        /^\[\[group\]\]/ { held = $0; next }
        held != "" { if ($0 ~ /^name/) print held; held = "" }
        { print }'
    cat "modes_$1/modes.toml"; } >"by_modes_$1.toml"
}
for stretch in "first 0.0 200.0" "second 200.0 400.0" "third 400.0 599.0"; do
  read -r name from to <<<"$stretch"
  Window "$from" "$to" >"$name.toml"
  ByModes "$name"
done
awk '
  BEGIN {
    ratio[1] = "0.98266616 0.9612952 1.00970587 1"
    ratio[2] = "0.99599111 1 0.93127807 0.95110204"
    ratio[3] = "0.96930353 0.97132 1 1.09081094"
  }
  /^\[\[mode\]\]/ { split(ratio[++mode], r, " ") }
  mode && /^frequency = / { $3 *= r[1] }
  mode && /^shape = / {
    for (i = 1; i <= NF; ++i) {
      for (dof = 1; dof <= 3; ++dof) {
        if ($i !~ "\"?u" dof "\"?$") continue
        end = $(i + 2); sub(/^[-0-9.e]+/, "", end)
        $(i + 2) = ($(i + 2) + 0) * r[dof + 1] end
      }
    }
  }
  { print }' by_modes_third.toml >by_modes_damaged.toml
cmp -s by_modes_third.toml by_modes_damaged.toml && Fail "nothing is damaged"
for name in first second; do
  Run 0 pinode_update --case=by_modes_$name.toml --output_dir=D_$name \
    --progress=false
done
Run 0 pinode_damage --baseline=D_first,D_second --case=by_modes_third.toml \
  --output_dir=healthy --progress=false
grep -qF '"verdict": "no_damage"' healthy/damage.json || Fail "not healthy"
Run 0 pinode_damage --baseline=D_first,D_second --case=by_modes_damaged.toml \
  --output_dir=damaged --progress=false
grep -qF '"verdict": "damage"' damaged/damage.json || Fail "no damage"
Near "$(awk '$1 == "k2" { print $2; exit }' stdout)" -10 2.0
