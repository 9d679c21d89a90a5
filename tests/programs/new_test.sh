#!/usr/bin/env bash
# From the files of a logger to a verdict on damage, without editing a file.
#
#   tests/programs/new_test.sh PROGRAM_DIR
#
# The records are those of a frame of five storeys that awk integrates in steps
# of half a millisecond, with noise of 0.1 and 0.5 mg, as a German logger writes
# them. In the later state the second storey has lost 15 % of its stiffness.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
frame_data=$(cd -- "$here/../../data/frame" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"

tested=pinode_new
source "$here/testing.sh"

# GermanLog SEED SECONDS K1 ... K5: stiffnesses in kN/m; floors of 900 kN, the
# roof of 700 kN.
GermanLog() {
  local seed=$1 seconds=$2
  shift 2
  awk -v seed="$seed" -v seconds="$seconds" -v stiffness="$*" '
    function Gauss() {
      return sqrt(-2 * log(1 - rand())) * cos(2 * pi * rand())
    }
    function Ground(t,   i, sum) {
      sum = 0
      for (i = 1; i <= lines; ++i)
        sum += amplitude[i] * sin(omega[i] * t + phase[i])
      return sum * (t < 4 ? t * t / 16 : 1)
    }
    function Milli(value,   text) {
      text = sprintf("%.2f", value * 1000 / 9.80665)
      sub(/\./, ",", text)
      return text
    }
    BEGIN {
      pi = atan2(0, -1)
      srand(seed)
      n = split(stiffness, k, " ")
      for (i = 1; i <= n; ++i) m[i] = (i < n ? 900 : 700) / 9.80665
      lines = 90
      for (i = 1; i <= lines; ++i) {
        omega[i] = 2 * pi * (0.4 + (i - rand()) * 14 / lines)
        phase[i] = 2 * pi * rand()
        amplitude[i] = 0.12 / (1 + (omega[i] / 40) ^ 2)
      }
      print "Logger ACME DX-800;SN 00412;;;;;"
      print "Projekt;Rahmen Halle 5;;;;;"
      print "Sample rate [Hz];100;;;;;"
      print "Zeit;Boden;Etage 1;Etage 2;Etage 3;Etage 4;Etage 5"
      print "s;mg;mg;mg;mg;mg;mg"
      step = 0.0005
      for (s = 0; s < seconds / step; ++s) {
        t = s * step
        ground = Ground(t)
        # Damping in proportion to stiffness and to mass.
        for (i = 1; i <= n; ++i)
          force[i] = k[i] * (u[i] - u[i - 1] + 0.0012 * (v[i] - v[i - 1]))
        force[n + 1] = 0
        for (i = 1; i <= n; ++i)
          total[i] = (force[i + 1] - force[i]) / m[i] - 0.12 * v[i]
        if (s % 20 == 0) {
          row = sprintf("%.2f", t)
          sub(/\./, ",", row)
          row = row ";" Milli(ground + 0.001 * Gauss())
          for (i = 1; i <= n; ++i)
            row = row ";" Milli(total[i] + 0.005 * Gauss())
          print row
        }
        for (i = 1; i <= n; ++i) v[i] += step * (total[i] - ground)
        for (i = 1; i <= n; ++i) u[i] += step * v[i]
      }
    }'
}

GermanLog 1 20 180000 170000 150000 140000 120000 >before.csv
GermanLog 2 20 180000 144500 150000 140000 120000 >after.csv
frame=(--storeys=5 "--weights=900, 900, 900, 900, 700 kN")

# The whole way.
Run 0 pinode_new before.csv --later=after.csv "${frame[@]}" --case=frame.toml
grep -q "before.csv: .*'Boden' is the base, 'Etage 1' is on floor 1" stdout ||
  Fail "the places are not printed"
next="pinode_damage --baseline=frame_result --case=frame_later.toml"
grep -qF -- "$next" stdout || Fail "the next steps are not printed"
for file in frame.toml frame_later.toml; do
  [[ -s $file ]] || Fail "no $file"
  Run 0 pinode_check --case=$file
done
[[ $(grep -c '^  \[\[record.channel\]\]' frame.toml) -eq 5 ]] || Fail "channels"
Run 0 pinode_update --case=frame.toml --output_dir=frame_result --progress=false
Run 0 pinode_damage --baseline=frame_result --case=frame_later.toml \
  --output_dir=frame_damage --progress=false
grep -q '"message": "Damage: k2 (-1[45]\(\.[0-9]*\)\? %) lost stiffness' \
  frame_damage/damage.json || Fail "expected damage in k2"
# The damping of the second storey is in proportion to its stiffness.
! grep -q "model lacks something" frame_damage/damage.json ||
  Fail "the model lacks something"
Groups frame_damage | awk '
  $1 == "c2" { found = $2 > -0.19 && $2 < -0.11 } END { exit !found }' ||
  Fail "expected -15 % in c2"
Groups frame_damage | awk '
  $1 == "k2" { found = $2 > -0.16 && $2 < -0.14 }
  $1 ~ /^k[1345]$/ && ($2 > 0.01 || $2 < -0.01) { wrong = 1 }
  END { exit !(found && !wrong) }' || Fail "expected -15 % in k2 alone"

# Two records of one state: the second one is held out, in units of its own.
sed -e '5s/.*/s;g;g;g;g;g;g/' after.csv >later.csv
mkdir cases
Run 0 pinode_new before.csv later.csv "${frame[@]}" --case=cases/two.toml \
  --output_dir=check
grep -A2 'name = "later"' cases/two.toml | grep -q 'role = "holdout"' ||
  Fail "no record is held out"
grep -q 'file = "../before.csv"' cases/two.toml || Fail "paths"
[[ $(grep -c 'unit      = "g" ' cases/two.toml) -eq 6 ]] || Fail "units"
[[ -s check/check.json ]] || Fail "no check"

# A case that is there stays, unless it may be replaced.
cp frame.toml kept.toml
Refused "frame.toml exists; give --overwrite" before.csv "${frame[@]}" \
  --case=frame.toml
cmp -s frame.toml kept.toml || Fail "the case has changed"
Run 0 pinode_new before.csv "${frame[@]}" --case=frame.toml --overwrite
echo '[units]' >own.toml
# The form of the files goes into the case.
Run 0 pinode_new before.csv "${frame[@]}" --case=form.toml --decimal=, \
  --delimiter=';' --header_lines=5 --encoding=ISO-8859-1 \
  --time_unit=s
for line in 'decimal = ","' 'delimiter = ";"' 'header_lines = 5' \
    'encoding = "ISO-8859-1"' 'time_unit = "s"'; do
  grep -qF -- "$line" form.toml || Fail "form.toml lacks $line"
done
rm form.toml
Refused "--delimiter: 'x', expected" before.csv "${frame[@]}" --case=E \
  --delimiter=x
Refused "was not written by pinode_new" before.csv "${frame[@]}" \
  --case=own.toml --overwrite
[[ $(cat own.toml) == '[units]' ]] || Fail "a file of others was replaced"

# A question names the flag that answers it, and no case is left.
# Unclear TEXT ARGUMENT...
Unclear() {
  Refused "$@" --case=E
  [[ -z $(find . -name 'E*') ]] || Fail "a part of a case is left"
}
Edited() { sed -E -e "$1" before.csv >edited.csv; }

Unclear "no record"
Unclear "nothing.csv" nothing.csv "${frame[@]}"
Unclear "Give --storeys=5" before.csv --weights="900 kN"
Unclear "--storeys is '0'" before.csv --storeys=0 --weights="900 kN"
Unclear "Give --weights=" before.csv --storeys=5
Unclear "no unit" before.csv --storeys=5 --weights=900
Unclear "has 4 values, the building has 5 storeys" before.csv --storeys=5 \
  --weights="900, 900, 900, 700 kN"
Unclear "'Etage 5': the building has 4 storeys" before.csv --storeys=4 \
  --weights="900 kN"
Unclear "given twice" before.csv before.csv "${frame[@]}"
cp before.csv copy.csv
Unclear "a copy of" before.csv --later=copy.csv "${frame[@]}"
Unclear "no column 'Bodem'; did you mean 'Boden'?" before.csv "${frame[@]}" \
  --base=Bodem
Unclear "no column 'Etage'" before.csv "${frame[@]}" --sensors="Etage=1"
Unclear "floor from 1 to 5" before.csv "${frame[@]}" --sensors="Etage 1=7"
Unclear "--holdout" before.csv later.csv "${frame[@]}" --holdout=third.csv
Unclear "none would be left to fit" before.csv "${frame[@]}" --holdout=before.csv
Unclear "--damping_ratio is 2" before.csv "${frame[@]}" --damping_ratio=2
Unclear "--scale: no channel 'Etage 9'" before.csv "${frame[@]}" \
  --scale="Etage 9=2"
Unclear "--scale: 'Etage 1=0', expected one factor" before.csv "${frame[@]}" \
  --scale="Etage 1=0"

# A form of clock times that is not found, and its key.
awk -F';' -v OFS=';' '
  NR == 5 { $1 = "" }
  NR > 5 {
    sub(/,/, ".", $1)
    n = int(100 * $1 + 0.5)
    $1 = sprintf("12h%02dm%02d.%02d", n / 6000, int(n / 100) % 60, n % 100)
  }
  { print }' before.csv >clock.csv
Unclear 'set `time_format`' clock.csv "${frame[@]}"
Run 0 pinode_new clock.csv "${frame[@]}" --case=clock.toml \
  --time_format='%Hh%Mm%S.%f'
grep -qF 'time_format = "%Hh%Mm%S.%f"' clock.toml || Fail "no time_format"
cmp <(grep stiffness clock.toml) <(grep stiffness frame.toml) ||
  Fail "clock times make another case"

# Volts of sensors whose sensitivities are known.
awk -F';' -v OFS=';' '
  NR == 5 { gsub(/mg/, "V") }
  NR > 5 { sub(/,/, ".", $5); $5 = sprintf("%.4f", -4 * $5); sub(/\./, ",", $5) }
  { print }' before.csv >volts.csv
Unclear "give its sensitivity by --scale and --unit" volts.csv "${frame[@]}"
Run 0 pinode_new volts.csv "${frame[@]}" --case=volts.toml --unit=mg \
  --scale="Boden=2,Etage 1=2,Etage 2=2,Etage 3=-0.5,Etage 4=2,Etage 5=2"
[[ $(grep -cE 'scale     = 2(\.0)? ' volts.toml) -eq 5 ]] || Fail "five scales of 2"
[[ $(grep -c 'scale     = -0.5 ' volts.toml) -eq 1 ]] || Fail "a scale of -0.5"
[[ $(grep -c 'unit      = "mg" ' volts.toml) -eq 6 ]] || Fail "units of scales"
! grep -q 'the file says V' stdout || Fail "a scale explains another unit"
! grep -q 'upside down?' volts.toml || Fail "a negative scale is a sign"
cmp <(grep stiffness volts.toml) <(grep stiffness frame.toml) ||
  Fail "scales make another model"
# Without names, without units, and with names that say nothing.
Edited '4,$s/^[^;]*;//'
Unclear "Give --time=" edited.csv "${frame[@]}"
Run 0 pinode_new edited.csv "${frame[@]}" --sampling_rate_hz=100 \
  --case=rate.toml
Edited '1,5d'
Unclear "Give --base=" edited.csv "${frame[@]}" --time=column_1
Unclear "Give --sensors=\"column_3=FLOOR,column_4=FLOOR" edited.csv \
  "${frame[@]}" --time=column_1 --base=column_2
Edited '5d'
Unclear "has no stated unit of acceleration. Give --unit=" edited.csv "${frame[@]}"
Unclear "--unit: 'mm' is not a unit of acceleration" edited.csv "${frame[@]}" \
  --unit=mm
Edited '5s/mg$/mm/'
Unclear "'Etage 5' is in mm" edited.csv "${frame[@]}"
Edited '4s/Etage ([0-9])/acc_\1/g; s/(;[^;]*){2}$//'
Unclear "may be the number of a sensor or of a floor" edited.csv \
  --storeys=4 --weights="900 kN"
Edited '6,$s/^([0-9]*),([0-9])([0-9])/\1\2\30/; 6,$s/^0+([0-9])/\1/; 5s/s;/;/'
Unclear "Give --time_unit=ms" edited.csv "${frame[@]}"
# One sample, too few, and numbers that are none.
Edited '7,$d'
Unclear "edited.csv" edited.csv "${frame[@]}"
Edited '37,$d'
Unclear "31 samples, expected 64 or more" edited.csv "${frame[@]}"
Edited '500s/^([^;]*;)[^;]*/\1inf/'
Unclear "edited.csv:500" edited.csv "${frame[@]}"
Edited '500s/^([^;]*;)[^;]*/\1nan/'
Unclear "'Boden' misses 1 samples, the first one 4.94 s" edited.csv \
  "${frame[@]}"

# A sensor that is dead, and a folder that is not there.
Edited '6,$s/^([^;]*;[^;]*;)[^;]*/\11,0/'
Unclear "'Etage 1' has the same value in every sample" edited.csv "${frame[@]}"
Run 0 pinode_new edited.csv "${frame[@]}" --ignore="Etage 1" --case=four.toml
Run 2 pinode_new before.csv "${frame[@]}" --case=none/case.toml
grep -q "there is no folder none" stderr || Fail "the folder"

# Loads that nobody measured: no record can be predicted.
Run 0 pinode_new before.csv later.csv "${frame[@]}" --base=none --ignore=Boden \
  --case=ambient.toml
[[ $(grep -c 'excitation = "ambient"' ambient.toml) -eq 2 ]] || Fail "ambient"
! grep -q holdout ambient.toml || Fail "an ambient hold-out"

# Pounds and inches, a sensor upside down, and sensors on some of the floors.
Edited '4s/Etage 3/x/; 4s/;x;/;unten;/'
Run 0 pinode_new edited.csv --storeys=5 --weights="200 kip" --case=kip.toml \
  --sensors="unten=3,Etage 5=5"
grep -q '^force  = "kip"' kip.toml || Fail "kip"
grep -q '^length = "in"' kip.toml || Fail "in"
[[ $(grep -c '^  \[\[record.channel\]\]' kip.toml) -eq 2 ]] || Fail "channels"
awk -F';' -v OFS=';' 'NR > 5 {
    $4 = $4 ~ /^-/ ? substr($4, 2) : "-" $4 }
  { print }' before.csv >turned.csv
Run 0 pinode_new turned.csv "${frame[@]}" --case=turned.toml
grep -q "'Etage 2' moves opposite to the other floors" stdout || Fail "the sign"
! grep -q '^  sign' turned.toml || Fail "a sensor was turned"
Run 0 pinode_new turned.csv "${frame[@]}" --case=signed.toml \
  --sensors="Etage 1=1,Etage 2=-2,Etage 3=3,Etage 4=4,Etage 5=5"
[[ $(grep -c '^  sign      = -1' signed.toml) -eq 1 ]] || Fail "no sign"
! grep -q "moves opposite" stdout || Fail "the sign is asked for again"

# A deck with its exports in place of storeys, and forces in place of the base.
mkdir deck
cp -- "$frame_data"/frame.{inp,dof} "$frame_data"/*.{sti,mas}.gz \
  "$frame_data"/healthy_1.csv deck
deck=(--deck=deck/frame.inp "--force=fx=3153.1,fy=2151.2")
units=(--deck_units=N,m --factor=2 --unit=m/s^2 --force_unit=N)
sensors="a1x=1051.1,a1y=1051.2,a2x=1101.1,a2y=1101.2,a3x=1151.1,a3y=1151.2"
Unclear "Give --deck_units=" deck/healthy_1.csv "${deck[@]}"
Unclear "--deck_units is 'N,kg'" deck/healthy_1.csv "${deck[@]}" \
  --deck_units=N,kg
Unclear "Give --factor=2" deck/healthy_1.csv "${deck[@]}" --deck_units=N,m
Unclear "at which node and in which direction" deck/healthy_1.csv "${deck[@]}" \
  "${units[@]}"
Unclear "with a node of the deck" deck/healthy_1.csv "${deck[@]}" \
  "${units[@]}" --sensors="a1x=999999.1"
Unclear "expected one of them" deck/healthy_1.csv "${deck[@]}" "${units[@]}" \
  --storeys=3
cp deck/frame.inp alone.inp
Unclear "no matrices alone.sti" deck/healthy_1.csv --deck=alone.inp \
  "${units[@]}"
Run 0 pinode_new deck/healthy_1.csv "${deck[@]}" "${units[@]}" \
  --sensors="$sensors" --case=deck.toml
[[ $(grep -c '^changed_export' deck.toml) -eq 9 ]] || Fail "groups"
grep -q 'left out, because no element set has their name: .*mass_1.mas' stdout ||
  Fail "what was left out is not said"
grep -q 'pinode_update .* --deck=deck/frame.inp' stdout || Fail "next step"

# On a terminal, the questions and an answer that cannot be.
if ! command -v script >/dev/null; then
  echo "no terminal to test with (script of util-linux): questions skipped"
  exit 0
fi
printf '5\n900\n900, 900, 900, 900, 700 kN\n' |
  script -qec "$programs/pinode_new before.csv --case=asked.toml" /dev/null \
    >stdout
grep -q "has no unit" stdout || Fail "an answer that cannot be is not refused"
cmp <(sed 1,3d asked.toml) <(sed 1,3d frame.toml) || Fail "asked, and otherwise"
