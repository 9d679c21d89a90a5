#!/usr/bin/env bash
# From healthy records to a verdict with the programs alone.
#
#   tests/programs/damage_test.sh PROGRAM_DIR
#
# The healthy state is that of data/three_storey; what changed is simulated from
# its updated model with a tenth of the second storey's stiffness lost, and 2 %
# noise.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/three_storey" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$scratch"
cd -- "$scratch"

tested=pinode_damage
source "$here/testing.sh"

# With the initial value of the group NAME in CASE replaced.
WithInitial() {
  awk -v name="name = \"$2\"" -v value="$3" '
    /^\[/ { inside = 0 }
    $0 == name { inside = 1 }
    inside && /^initial = / { $0 = "initial = " value }
    { print }' "$1"
}

# The records of CASE read the responses in FOLDER and the ground as before.
WithResponses() {
  sed -E -e "s|^( *file *= *)\"[^\"]*(train\|holdout).csv\"|\1\"$2/response_\2.csv\"|" \
    -e 's|^( *direction *= *"x")|\1\n  file = "GROUND"|' "$1" |
    awk '/response_train/ { ground = "train.csv" }
         /response_holdout/ { ground = "holdout.csv" }
         { sub("GROUND", ground); print }'
}

# Groups alone, which is quicker.
GroupsAlone() {
  printf '\n[damage]\nkinds = []\n' >>"$1"
}

Run 0 pinode_update --case=three_storey.toml --output_dir=D --progress=false
# 1 + alpha is 0.8697: the loss of a tenth is -0.08697.
WithInitial D/model.toml k2 -0.08697 >D/damaged.toml
Run 0 pinode_simulate --case=D/damaged.toml --output_dir=damaged \
  --noise_percent=2 --seed=3
Run 0 pinode_simulate --case=D/model.toml --output_dir=healthy \
  --noise_percent=2 --seed=4
# A tenth more mass on the second floor, and a second storey whose stiffness
# differs by sign: 15 % less than the healthy one's 3.39e6 N/m one way, as much
# more the other way.
{ cat D/model.toml; cat <<'END'; } >D/heavy.toml
[[group]]
name    = "added"
adds_to = "mass"
between = ["ground", "u2"]
scale   = 2000.0
initial = 0.1
free    = false
END
{ cat D/model.toml; cat <<'END'; } >D/open.toml
[[library]]
name    = "crack"
inputs  = ["d[u1,u2]"]
output  = "u2-u1"
acts_as = "force"
terms   = [{basis = "abs(d[u1,u2])", initial = -508500.0, free = false}]
END
for state in heavy open; do
  Run 0 pinode_simulate --case=D/$state.toml --output_dir=$state \
    --noise_percent=2 --seed=5
  WithResponses three_storey.toml $state >$state.toml
done
WithResponses three_storey.toml damaged >damaged.toml
WithResponses three_storey.toml healthy >healthy.toml

# Change of a group, in per cent.
Change() {
  awk -v group="$1" '$1 == group { print $2 }' stdout | head -1
}
Near() {
  awk -v a="$1" -v b="$2" -v limit="$3" \
    'BEGIN { exit !(a != "" && (a - b)^2 <= limit^2) }'
}

# Damage, in the storey that has it, by as much as it is.
Run 0 pinode_damage --baseline=D --case=damaged.toml --output_dir=damage \
  --progress=false
grep -qF '"verdict": "damage"' damage/damage.json || Fail "no damage"
[[ $(grep -c '"reason": "beyond_threshold"' damage/damage.json) -eq 1 ]] ||
  Fail "not one group that lost stiffness"
Near "$(Change k2)" -10 0.3 || Fail "change of k2: $(Change k2)"

# The same from a case that is built on the updated model.
WithResponses D/model.toml ../damaged |
  sed -e 's|"train.csv"|"../train.csv"|; s|"holdout.csv"|"../holdout.csv"|' \
    >D/again.toml
GroupsAlone D/again.toml
Run 0 pinode_damage --baseline=D --case=D/again.toml --output_dir=again \
  --progress=false
Near "$(Change k2)" -10 0.3 || Fail "change of k2 by model.toml: $(Change k2)"

# Nothing where nothing has changed; two baselines.
GroupsAlone healthy.toml
cp damaged.toml groups.toml
GroupsAlone groups.toml
Run 0 pinode_damage --baseline=D --case=healthy.toml --output_dir=none \
  --progress=false
grep -qF '"verdict": "no_damage"' none/damage.json || Fail "not healthy"
Run 0 pinode_damage --baseline=D,none --case=groups.toml --output_dir=both \
  --progress=false
grep -qF '"has_between_records": true' both/damage.json || Fail "one baseline"
grep -qF '"verdict": "damage"' both/damage.json || Fail "no damage beside two"

# A second baseline that is built on the first one's model: its groups begin
# where those have ended.
WithResponses D/model.toml ../healthy |
  sed -e 's|"train.csv"|"../train.csv"|; s|"holdout.csv"|"../holdout.csv"|' \
    -e 's|^initial = 0.0$|initial = 0.01|' >D/second.toml
Run 0 pinode_update --case=D/second.toml --output_dir=D2 --progress=false
Run 0 pinode_damage --baseline=D,D2 --case=groups.toml --output_dir=two \
  --progress=false
Near "$(Change k2)" -10 0.3 || Fail "change of k2 since D and D2: $(Change k2)"
Run 0 pinode_damage --baseline=D2,D --case=groups.toml --output_dir=swapped \
  --progress=false
Near "$(Change k2)" -10 0.3 || Fail "change of k2 since D2 and D: $(Change k2)"

# Other kinds of change are not taken for a loss of stiffness.
Run 0 pinode_damage --baseline=D --case=heavy.toml --output_dir=mass \
  --progress=false
grep -qF '"verdict": "other_change"' mass/damage.json || Fail "no added mass"
[[ $(grep -c '"reason": "beyond_threshold"' mass/damage.json) -eq 1 ]] ||
  Fail "not the mass alone"
Near "$(Change mass.u2)" 10 0.3 || Fail "added mass: $(Change mass.u2)"
Run 0 pinode_damage --baseline=D --case=open.toml --output_dir=crack \
  --progress=false
grep -qF '"verdict": "nonlinear"' crack/damage.json || Fail "not nonlinear"
grep -qF '"dof": "u2-u1"' crack/damage.json || Fail "not in the second storey"
grep -qF '"detected": true' crack/damage.json || Fail "not detected"
[[ $(grep -c '"damaged": true' crack/damage.json) -eq 0 ]] ||
  Fail "a group counts as changed"

# Without the healthy records kinds are not told apart, which is said.
mv train.csv away.csv
sed -e 's|"train.csv"|"away.csv"|' damaged.toml >moved.toml
Run 0 pinode_damage --baseline=D --case=moved.toml --output_dir=moved \
  --progress=false
grep -qF 'could not be told apart' stdout || Fail "nothing is said of kinds"
grep -qF 'could not be told apart' moved/damage.json || Fail "no remark"
mv away.csv train.csv

# What is wrong is said before anything is written.
Refused "--baseline=FOLDER is missing" --case=damaged.toml --output_dir=E
Refused "--case=FILE is missing" --baseline=D --output_dir=E
Refused "--output_dir=FOLDER is missing" --baseline=D --case=damaged.toml
Refused "nowhere: there is no such folder" --baseline=nowhere --case=damaged.toml \
  --output_dir=E
Refused "empty name" --baseline=D, --case=damaged.toml --output_dir=E
Refused "--threshold is" --baseline=D --case=damaged.toml --output_dir=E \
  --threshold=2
Refused "--false_alarm_rate is 0, expected" --baseline=D --case=damaged.toml \
  --output_dir=E --false_alarm_rate=0
sed -e 's/2000, 2000, 2000/2000, 2000, 2001/' damaged.toml >heavier.toml
Refused "M.mtx: cannot be the updated matrix" --baseline=D \
  --case=heavier.toml --output_dir=E
cp -r D turned
sed -i -e '/^dofs/s/"u1", "u2", "u3"/"u3", "u2", "u1"/' turned/model.toml
Refused "the DOFs of the case in another order" --baseline=turned \
  --case=damaged.toml --output_dir=E
sed -e 's/storey  = 2/storey  = 3/' damaged.toml >other.toml
Refused "group_k2.mtx: differs" --baseline=D --case=other.toml --output_dir=E
sed -e 's/"k2"/"k9"/' damaged.toml >unknown.toml
Refused "group 'k9'" --baseline=D --case=unknown.toml --output_dir=E
sed -i -e 's/"usable": true/"usable": false/' none/result.json
Refused "not usable" --baseline=none --case=damaged.toml --output_dir=E
echo '{' >none/result.json
Refused "is not a result" --baseline=none --case=damaged.toml --output_dir=E

# A stiffness that follows the temperature is some 3 % higher in the second
# record, which is colder while the frame shakes. That is no change.
cp -- "$data"/../three_storey_force/{temperature.toml,*.csv} .
Run 0 pinode_update --case=temperature.toml --output_dir=warm --progress=false
sed -e '/^name  = "temperature"$/,/^name  = "temperature_holdout"$/{
    /^name  = "temperature_holdout"$/!d; }' \
  -e 's/"holdout"/"train"/' temperature.toml >cold.toml
Run 0 pinode_damage --baseline=warm --case=cold.toml --output_dir=cold \
  --progress=false
grep -qF '"verdict": "no_damage"' cold/damage.json || Fail "not told from damage"
[[ $(awk '/"change": / { v = $2 + 0; n += (v < 1e-3 && v > -1e-3) }
    END { print n }' cold/damage.json) -eq 3 ]] ||
  Fail "temperature taken for a change"
