#!/usr/bin/env bash
# Fits to ambient records: profiles, universal files of several rates, and what
# loads that nobody measured leave nothing of.
#
#   tests/programs/ambient_limits_test.sh PROGRAM_DIR
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/three_storey_ambient" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$scratch"
cd -- "$scratch"
gzip -dc "$data/wind.csv.gz" >wind.csv
sed 's/wind.csv.gz/wind.csv/' three_storey_ambient.toml >wind.toml

tested=pinode_update
source "$here/testing.sh"

# Value FOLDER NAME KEY: of a parameter, from parameters.csv.
Value() {
  awk -F, -v name="$2" -v key="$3" '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    $1 == name { print $at[key] }' "$1/parameters.csv"
}

# An interval along the profile of each group: where the likelihood ratio comes
# to its 95 % point, hardly elsewhere than by the information where there is as
# much data, and around the truth; the 99 % one holds it.
Run 0 pinode_update --case=wind.toml --output_dir=profiles --profiles \
  --progress=false
awk '/"profiles": \[/ { inside = 1 } inside && /^  \]/ { exit }
  inside { gsub(/[",:]/, " ")
    if ($1 == "name") name = $2
    if ($1 ~ /^(lower|upper)9/) { printf "%s%s", sep, $2; sep = " " }
    if ($1 == "determination") { print " " name " " $2; sep = "" } }' \
  profiles/result.json >ends
[[ $(wc -l <ends) -eq 5 ]] || Fail "not five profiles"
while read -r lower upper lower99 upper99 name determination; do
  [[ $determination == determined ]] || Fail "$name is $determination"
  awk -v lower="$lower" -v upper="$upper" -v from="$lower99" -v to="$upper99" \
    -v linear_lower="$(Value profiles "$name" lower95)" \
    -v linear_upper="$(Value profiles "$name" upper95)" \
    -v value="$(Value profiles "$name" value)" 'BEGIN {
      width = linear_upper - linear_lower
      exit !(width > 0 && from < lower && lower < value && value < upper &&
             upper < to && (lower - linear_lower)^2 < (0.1 * width)^2 &&
             (upper - linear_upper)^2 < (0.1 * width)^2) }' ||
    Fail "$name: profile from $lower to $upper"
done <ends
awk '$5 ~ /^k/ { truth["k1"] = 0.25; truth["k2"] = -0.130434782609
    truth["k3"] = -0.0909090909091
    if (truth[$5] < $3 || truth[$5] > $4) exit 1 }' ends ||
  Fail "a storey is not within its 99 % interval"

# Two loggers, one at 100 and one at 50 samples a second, by universal files:
# text in double precision says what the tables say, digit by digit.
head -n 30001 wind.csv >fast.csv
awk 'NR == 1 || (NR > 30001 && NR % 2 == 0)' wind.csv >slow.csv
# AsUniversal NAME STEP: data sets 58 of the three columns, 12:x and so on.
AsUniversal() {
  awk -F, -v step="$2" '
    NR == 1 { next }
    { for (c = 1; c <= 3; ++c) y[c, NR - 1] = $c }
    END {
      for (c = 1; c <= 3; ++c) {
        printf "%6d\n%6d\n", -1, 58
        printf "wind on floor %d\nNONE\nNONE\nNONE\nNONE\n", c
        printf "%5d%10d%5d%10d NONE      %10d%4d NONE      %10d%4d\n",
          1, c, 0, 0, 10 + c, 1, 0, 0
        printf "%10d%10d%10d%13.5E%13.5E%13.5E\n", 4, NR - 1, 1, 0, step, 0
        printf "%10d%5d%5d%5d %-20s %-20s\n", 17, 0, 0, 0, "Time", "s"
        printf "%10d%5d%5d%5d %-20s %-20s\n", 12, 0, 0, 0, "Acceleration",
          "m/s^2"
        for (k = 0; k < 2; ++k)
          printf "%10d%5d%5d%5d %-20s %-20s\n", 0, 0, 0, 0, "NONE", "NONE"
        for (k = 1; k < NR; ++k)
          printf "%20.12E%s", y[c, k], k % 4 == 0 || k == NR - 1 ? "\n" : ""
        printf "%6d\n", -1
      }
    }' "$1.csv" >"$1.uff"
}
AsUniversal fast 0.01
AsUniversal slow 0.02
sed '/^\[\[record\]\]/,$d' wind.toml | tee tables.toml >universal.toml
sed -n '/^\[\[record\]\]/,$p' wind.toml >record
{
  sed 's/wind/fast/' record
  sed 's/wind/slow/; s/sampling_rate_hz = 100/sampling_rate_hz = 50/' record
} >>tables.toml
for name in fast slow; do
  sed "s/wind.csv/wind.uff/; s/wind/$name/; s/^sampling_rate_hz = 100/time = \"t\"/
    s/\"a\\([123]\\)\"/\"1\\1:x\"/" record
done >>universal.toml
for name in tables universal; do
  Run 0 pinode_update --case=$name.toml --output_dir=$name --progress=false
done
[[ $(grep -c '"lines"' universal/result.json) -eq 2 ]] || Fail "not two records"
for name in k1 k2 k3 c_mass c_stiffness; do
  for key in value lower95; do
    awk -v a="$(Value tables $name $key)" -v b="$(Value universal $name $key)" \
      'BEGIN { exit !(a != "" && (a - b)^2 <= (1e-6 * a)^2) }' ||
      Fail "$name, $key: $(Value universal $name $key) by universal files"
  done
done

# One sensor and forces of any spectrum, as many as sensors: in a band around the
# first mode its peak is the structure's or the wind's. Nothing of the groups is
# told, whatever the fit has done to them, and one sentence says so.
{
  sed '/^  \[\[record.channel\]\]/,$d' wind.toml
  sed -n '/column   = "a3"/,$p' wind.toml | sed '1i\  [[record.channel]]'
} >one.toml
# Open NAME LINE...: one sensor, with these lines of [record.ambient].
Open() {
  local name=$1
  shift
  { cat one.toml; printf '  [record.ambient]\n'; printf '  %s\n' "$@"; } \
    >"$name.toml"
}
Open top 'dofs = ["u3"]' 'knots = 12' 'band_hz = [2.0, 4.0]'
Open finer 'dofs = ["u3"]' 'knots = 25' 'band_hz = [2.0, 4.0]'
Open finest 'dofs = ["u3"]' 'knots = 200' 'band_hz = [2.0, 4.0]'
Open all 'dofs = ["u1", "u2", "u3"]' 'knots = 25' 'band_hz = [2.0, 4.0]'
# No mode is in these bands, so that spectra are as smooth as the loads are: the
# fit finds something, here a mode where there is none.
Open below 'band_hz = [0.9, 2.0]'
Open above 'band_hz = [13.0, 20.0]'
for name in top finer finest all below above; do
  Run 1 pinode_update --case=$name.toml --output_dir="open_$name" \
    --progress=false
  head -n 1 stdout >said
  grep -q "^Not usable: .*unmeasured loads .*explain" said &&
    grep -q "determine" said || Fail "$name: nothing of what loads explain"
done
# Nor do three sensors beside all modes, where loads leave a fiftieth.
cp wind.toml beside.toml
printf '  [record.ambient]\n  band_hz = [13.0, 20.0]\n' >>beside.toml
Run 1 pinode_update --case=beside.toml --output_dir=beside --progress=false
head -n 1 stdout | grep -q "^Not usable: none of 'k1', .* determined by the data" ||
  Fail "three sensors beside all modes: $(head -n 1 stdout)"
# The one sensor tells of all where the loads' spectrum is smoother than modes.
Run 0 pinode_update --case=one.toml --output_dir=one --progress=false
awk -v k="$(Value one k1 value)" 'BEGIN { exit !((k - 0.25)^2 < 0.03^2) }' ||
  Fail "k1 by one sensor is $(Value one k1 value)"
