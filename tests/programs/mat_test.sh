#!/usr/bin/env bash
# MATLAB files in and out of every program; SciPy reads what they write, and
# finds there what stands in the other files of the folder.
#
#   tests/programs/mat_test.sh PROGRAM_DIR
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/three_storey" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$scratch"
cp -r -- "$data/../quarter_car" "$data/../three_storey_ambient" "$scratch"
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
Refused "'train.csv' holds a single matrix; leave out 'variable'" --case=csv.toml \
  --output_dir=E
sed 's/{file = "frame.mat", variable = "M"}/"frame.mat"/' matrices.toml >which.toml
Refused "5 matrices, expected 'variable'" --case=which.toml --output_dir=E

Run 0 pinode_update --case=three_storey.toml --output_dir=A --progress=false
Run 0 pinode_update --case=from_mat.toml --output_dir=B --progress=false --mat
[[ ! -e A/results.mat ]] || Fail "no results.mat without --mat"
Run 0 pinode_simulate --case=three_storey.toml --output_dir=S --mat
Run 0 pinode_check --case=from_mat.toml --output_dir=C --mat
cp stdout checked
Run 0 pinode_check --case=from_mat.toml --plan=2 --output_dir=P --mat
cp stdout planned
tested=pinode_check
Refused "exists" --case=from_mat.toml --output_dir=C
Refused "--mat needs --output_dir" --case=from_mat.toml --mat
Refused "--overwrite needs --output_dir" --case=from_mat.toml --overwrite
Run 0 pinode_check --case=from_mat.toml --output_dir=C --mat --overwrite

# Motion of a car, and of a building in the wind, from .mat as well.
/usr/bin/python3 - <<'END'
import numpy as np
import scipy.io

for path, zipped in (("quarter_car/drive", ""), ("three_storey_ambient/wind", ".gz")):
    table = np.genfromtxt(path + ".csv" + zipped, delimiter=",", names=True)
    scipy.io.savemat(path + ".mat", {"rec": {name: table[name] for name in table.dtype.names}})
END
sed '/"drive.csv"/,/^\[\[record\]\]/{
  s/"drive.csv"/"drive.mat"/
  s/^\( *\(time\|column\) *= \)"\([a-z]*\)"$/\1"rec.\3"/
}' quarter_car/quarter_car.toml >quarter_car/mat.toml
sed 's/"wind.csv.gz"/"wind.mat"/; s/= "\(a[123]\)"/= "rec.\1"/' \
  three_storey_ambient/three_storey_ambient.toml >three_storey_ambient/mat.toml
for folder in quarter_car three_storey_ambient; do
  grep -q '"rec\.' $folder/mat.toml || Fail "the case of $folder names fields"
done
Run 0 pinode_discover --case=quarter_car/quarter_car.toml --output_dir=Q \
  --progress=false
Run 0 pinode_discover --case=quarter_car/mat.toml --output_dir=R \
  --progress=false --mat
Run 0 pinode_modes --case=three_storey_ambient/three_storey_ambient.toml \
  --output_dir=V
Run 0 pinode_modes --case=three_storey_ambient/mat.toml --output_dir=W --mat
Run 0 pinode_damage --baseline=B --case=three_storey.toml --output_dir=D \
  --progress=false --mat

# Out: the same numbers as in the other files.
/usr/bin/python3 - <<'END'
import csv
import json
import pathlib
import re

import numpy as np
import scipy.io
import scipy.linalg


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


def texts(cells):
    """SciPy reads an empty text as an empty array."""
    return [cell if isinstance(cell, str) else "" for cell in np.atleast_1d(cells)]


def same_as_files(folder):
    """Reads results.mat of a folder back, and compares it with each of the others."""
    mat = scipy.io.loadmat(f"{folder}/results.mat", simplify_cells=True)
    compared = 0
    for path in pathlib.Path(folder).iterdir():
        name = path.stem
        if path.suffix == ".csv":
            for column, cells in table(path).items():
                field = np.atleast_1d(mat[name][re.sub(r"\W", "_", column)])
                if field.dtype == object or field.dtype.kind == "U":
                    assert texts(field) == cells, (path, column)
                else:
                    numbers = np.array([cell or "nan" for cell in cells], float)
                    assert np.array_equal(field, numbers, equal_nan=True), (path, column)
        elif path.suffix == ".mtx":
            matrix = scipy.io.mmread(path)
            full = matrix if isinstance(matrix, np.ndarray) else matrix.toarray()
            assert np.array_equal(np.atleast_2d(mat[name]), full), path
        elif path.suffix == ".json" and name != "checkpoint":
            assert json.loads(mat[name + "_json"]) == json.loads(path.read_text()), path
        else:
            continue
        compared += 1
    assert compared >= 2, folder
    return mat


response = same_as_files("S")["response_train"]
assert len(response["a3"]) == len(table("S/response_train.csv")["t"])
assert json.loads(same_as_files("D")["damage_json"])["verdict"] == "no_damage"

# The model before the fit: what eig makes of its matrices is what the table has.
check = same_as_files("C")
w2, shapes = scipy.linalg.eigh(check["K"], check["M"])
assert np.allclose(check["modes"]["frequency_hz"], np.sqrt(w2) / (2 * np.pi), rtol=1e-12)
assert np.allclose(np.abs(shapes.T @ check["M"] @ check["mode_shapes"]), np.eye(3), atol=1e-9)
modal_damping = np.diag(check["mode_shapes"].T @ check["C"] @ check["mode_shapes"])
assert np.allclose(check["modes"]["damping_ratio"], modal_damping / (2 * np.sqrt(w2)), rtol=1e-6)
said = pathlib.Path("checked").read_text()
for hz in check["modes"]["frequency_hz"]:
    assert f"{hz:.4g}" in said, hz
about = json.loads(check["check_json"])
assert about["schema"] == "pinode-check-1" and about["assessed"], about["message"]
assert about["dofs"] == ["u1", "u2", "u3"]
assert [r["name"] for r in about["records"]] == ["train", "holdout"]
for name, sigma in zip(check["expected"]["name"], check["expected"]["sigma"]):
    assert f"{1.96 * sigma:.2g}" in said, name

plan = same_as_files("P")
about = json.loads(plan["plan_json"])
assert about["all_determined"] and about["targets"] == ["k1", "k2", "k3"]
said = pathlib.Path("planned").read_text()
assert len(plan["sensors"]["name"]) == 2
for sensor in plan["sensors"]["name"]:
    assert f"  {sensor} " in said, sensor
# More sensors, more that they tell; all places tell most.
assert plan["sensors"]["typical"][1] < plan["sensors"]["typical"][0]
assert np.all(plan["deviations"]["all"] <= plan["deviations"]["planned"] * (1 + 1e-9))

# Equations and modes of what SciPy wrote are those of the same numbers as CSV.
found = same_as_files("R")
of_csv = json.load(open("Q/discover.json"))
of_mat = json.loads(found["discover_json"])
assert of_mat == of_csv and of_mat["equations"][0]["terms"], of_mat
assert texts(found["equations"]["lines"]) == open("R/equations.txt").read().splitlines()
assert np.array_equal(found["M"], np.diag([290.0, 40.0]))

modes = same_as_files("W")
of_csv = table("V/modes.csv")
assert len(modes["modes"]["frequency_hz"]) == 3
for name in ("frequency_hz", "damping_ratio", "u3_real"):
    assert np.array_equal(modes["modes"][name], np.array(of_csv[name], float)), name
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
