#!/usr/bin/env bash
# MATLAB files in and out of the programs that write results; SciPy reads what
# they write.
#
#   tests/programs/mat_test.sh PROGRAM_DIR
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/three_storey" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$scratch"
cd -- "$scratch"

tested=pinode_update
source "$here/testing.sh"

# In: the training record as MATLAB would save it.
/usr/bin/python3 - <<'END'
import numpy as np
import scipy.io

train = np.genfromtxt("train.csv", delimiter=",", names=True)
scipy.io.savemat("train.mat", {"rec": {name: train[name] for name in train.dtype.names}})
END
sed '/^name  = "train"/,/^\[\[record\]\]/{
  s/"train.csv"/"train.mat"/
  s/= "\(t\|ag\|a[123]\)"$/= "rec.\1"/
}' three_storey.toml >from_mat.toml
grep -q '"rec.a3"' from_mat.toml || Fail "the case names fields of the structure"

# Matrices of a model and its groups, full and sparse.
/usr/bin/python3 - <<'END'
import numpy as np
import scipy.io
import scipy.sparse

k = [2432000.0, 3898500.0, 3091000.0]
storeys = [np.diag([1.0, 0, 0]), np.array([[1.0, -1, 0], [-1, 1, 0], [0, 0, 0]]),
           np.array([[0, 0, 0], [0, 1.0, -1], [0, -1, 1]])]
storeys = [k[i] * storeys[i] for i in range(3)]
scipy.io.savemat("frame.mat", {
    "M": 2000.0 * np.eye(3), "K": scipy.sparse.csc_matrix(sum(storeys)),
    **{f"K{i + 1}": storeys[i] for i in range(3)}})
END
sed 's/^storey  *= \([123]\)/matrix = {file = "frame.mat", variable = "K\1"}/
  /^\[model.shear_building\]/,/^$/d
  s/^damping = {ray/mass = {file = "frame.mat", variable = "M"}\nstiffness = {file = "frame.mat", variable = "K"}\n&/
  s/^dofs .*/&\ninfluence = {x = [1.0, 1.0, 1.0]}/' three_storey.toml >matrices.toml
Run 0 pinode_check --case=three_storey.toml
sed -n '/^ *1 /,/^ *3 /p' stdout >building
Run 0 pinode_check --case=matrices.toml
sed -n '/^ *1 /,/^ *3 /p' stdout | diff building - || Fail "other modes"
sed 's/"K2"/"K9"/' matrices.toml >none.toml
Refused "frame.mat: no matrix 'K9', expected 'variable' with one of" \
  --case=none.toml --output_dir=E
sed 's/"frame.mat", variable = "M"/"train.csv", variable = "M"/' matrices.toml \
  >csv.toml
Refused "'train.csv' has one matrix, expected no 'variable'" --case=csv.toml \
  --output_dir=E
sed 's/{file = "frame.mat", variable = "M"}/"frame.mat"/' matrices.toml >which.toml
Refused "5 matrices, expected 'variable'" --case=which.toml --output_dir=E

Run 0 pinode_update --case=three_storey.toml --output_dir=A --progress=false
Run 0 pinode_update --case=from_mat.toml --output_dir=B --progress=false --mat
[[ ! -e A/results.mat ]] || Fail "no results.mat without --mat"
Run 0 pinode_simulate --case=three_storey.toml --output_dir=S --mat
Run 0 pinode_damage --baseline=B --case=three_storey.toml --output_dir=D \
  --progress=false --mat

# Out: the same numbers as in the other files.
/usr/bin/python3 - <<'END'
import csv
import json

import numpy as np
import scipy.io


def table(path):
    with open(path) as lines:
        rows = list(csv.reader(lines))
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}


a = table("A/parameters.csv")
mat = scipy.io.loadmat("B/results.mat", simplify_cells=True)
assert list(mat["parameters"]["name"]) == a["name"], mat["parameters"]["name"]
b = mat["parameters"]["value"]
assert np.allclose(b, np.array(a["value"], float), rtol=1e-6), (a, b)
assert np.allclose(mat["K"], scipy.io.mmread("B/K.mtx").toarray(), rtol=0, atol=0)
assert json.loads(mat["result_json"]) == json.load(open("B/result.json"))
prediction = table("B/prediction_train.csv")
for name, cells in prediction.items():
    numbers = np.array([c or "nan" for c in cells], float)
    field = mat["prediction_train"][name.replace(".", "_")]
    assert np.array_equal(field, numbers, equal_nan=True), name
assert "checkpoint_json" not in mat

response = scipy.io.loadmat("S/results.mat", simplify_cells=True)["response_train"]
assert np.array_equal(response["a3"], np.array(table("S/response_train.csv")["a3"], float))
damage = scipy.io.loadmat("D/results.mat", simplify_cells=True)
assert json.loads(damage["damage_json"])["verdict"] == "no_damage", damage["damage_json"]
END

# A disk that is full stands as a limit to the size of a file, whose signal is
# ignored. NotWritten LIMIT FILE PROGRAM ARGUMENT...: status 1, one line that
# names the file, and no folder F.
trap '' XFSZ
NotWritten() {
  local limit=$1 file=$2 program=$3 status=0
  shift 3
  prlimit --fsize="$limit" "$programs/$program" "$@" >stdout 2>stderr ||
    status=$?
  [[ $status -eq 1 ]] || Fail "$program $*: status $status, expected 1"
  [[ $(wc -l <stderr) -eq 1 ]] || Fail "expected one line"
  grep -qF -- "$file: cannot" stderr || Fail "expected a line on $file"
  [[ ! -e F ]] || Fail "there is a folder F"
}
# Of so short records results.mat is the longest file.
for name in train holdout; do
  head -n 4 $name.csv >short && mv short $name.csv
done
Run 0 pinode_simulate --case=three_storey.toml --output_dir=T --mat
size=$(stat -c %s T/results.mat)
[[ $(find T -type f -size +$((size - 1))c) == T/results.mat ]] || Fail "longer files"
NotWritten $((size - 1)) results.mat pinode_simulate \
  --case=three_storey.toml --output_dir=F --mat
[[ -z $(find . -name 'F*') ]] || Fail "something partial is left"

# Of a fit the checkpoint stays beside where the folder would be, and nothing
# else.
cp -- "$data"/*.csv .
NotWritten 100000 prediction_train.csv pinode_update \
  --case=three_storey.toml --output_dir=F --mat --progress=false
grep -q -e '--resume' stderr || Fail "expected a word on --resume"
[[ $(find . -path './F*' -type f) == ./F.partial-*/checkpoint.json ]] ||
  Fail "something else is left than a checkpoint"
Run 0 pinode_update --case=three_storey.toml --output_dir=F --mat --resume \
  --progress=false
[[ -s F/results.mat && $(find . -name 'F*') == ./F ]] || Fail "not resumed"
