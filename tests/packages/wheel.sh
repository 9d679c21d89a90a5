#!/usr/bin/env bash
# Makes a wheel that holds the Python package, the programs and every library
# that they need, and tries it in a bare Debian 12 without a compiler.
#
#   tests/packages/wheel.sh [--build=FOLDER] [--output=FOLDER] [--only-make]
#
# --build: a build of the preset `portable`; build-portable, which is brought up
#   to date first, unless given.
# --output: where the wheel goes; BUILD/wheel unless given.
# --only-make: do not try it.
#
# Needs root, patchelf, debootstrap and Debian's archive; without the tools it is
# skipped (77). PINODE_BARE_ROOTS=FOLDER keeps the bare Debian for the next run.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/tests/packages/bundle.sh"
source "$root/tests/packages/bare_root.sh"
python=/usr/bin/python3
"$python" -c 'import setuptools, pip, wheel' 2>/dev/null || {
  echo "no pip (apt-get install python3-pip python3-setuptools python3-wheel): skipped" >&2
  exit 77
}
bundle_begin wheel "$@"

echo "== the package without libraries"
# pip leaves files beside setup.py.
mkdir -- "$scratch/checkout"
cp -- pyproject.toml setup.py CMakeLists.txt LICENSE "$scratch/checkout"
ln -s -- "$root/pinode" "$scratch/checkout/pinode"
PINODE_BUILD_DIR=$build "$python" -m pip wheel --quiet --no-build-isolation \
  --no-deps --no-index --wheel-dir "$scratch/plain" "$scratch/checkout"
"$python" -m wheel unpack --dest "$scratch" "$scratch"/plain/pinode-*.whl
tree=$(echo "$scratch"/pinode-*)
name=${tree##*/}
information=$tree/$name.dist-info

echo "== programs and libraries"
mkdir -p -- "$tree/pinode/bin" "$tree/$name.data/data"
cp -- "$scratch"/installed/bin/* "$tree/pinode/bin"
cp -r -- "$scratch/installed/share" "$tree/$name.data/data"
bundle_own_library "$tree/pinode.libs"
install -m 644 -- pinode/python/programs/_pinode_programs.py "$tree"
{
  echo "[console_scripts]"
  for program in "$tree"/pinode/bin/*; do
    echo "${program##*/} = _pinode_programs:main"
  done
} >"$information/entry_points.txt"
bundle_libraries "$tree" "$tree/pinode.libs"
bundle_check "$tree" "$tree/pinode.libs"
bundle_licences "$information/licenses"

echo "== what it says of itself"
level=$(bundle_level "$tree")
tag=manylinux_${level}_x86_64
sed -i "s/^Tag: \(.*\)-linux_x86_64\$/Tag: \1-$tag/" "$information/WHEEL"
# NumPy 2 needs an extension made with pybind11 2.12 or newer.
pybind11=$(sed -n 's/^pybind11_DIR:PATH=//p' "$build/CMakeCache.txt")
pybind11=$(sed -n 's/^set(PACKAGE_VERSION "\(.*\)").*/\1/p' \
  "$pybind11/pybind11ConfigVersion.cmake")
numpy=
if [[ $(printf '%s\n' "$pybind11" 2.12 | sort -V | head -n 1) != 2.12 ]]; then
  numpy=' (<2)'
fi
sed -i -e "s/^Requires-Dist: numpy\$/&$numpy/" \
  -e 's/^License: .*/License: BSD-3-Clause; with its libraries, some of which have the GPL, GPL-3.0-or-later/' \
  -e '/^License: /aLicense-File: licenses/README.txt' \
  "$information/METADATA"
grep -E '^(Name|Version|Requires-Python|Requires-Dist: numpy|License)' "$information/METADATA"
grep '^Tag' "$information/WHEEL"

rm -f -- "$tree/$name.dist-info/RECORD"
rm -f -- "$output"/pinode-*.whl
"$python" -m wheel pack --dest-dir "$output" "$tree" >/dev/null
wheel=$(echo "$output"/pinode-*.whl)
echo "$wheel: $(du -h -- "$wheel" | cut -f1), unpacked $(du -sh -- "$tree" | cut -f1), $(
  wc -l <"$bundle_table") libraries"
$try || exit 0

echo "== a bare Debian"
mkdir -- "$scratch/in"
cp -- "$wheel" tests/packages/{wheel_use.sh,app_use.py} "$scratch/in"
mkdir -- "$scratch/in/data"
cp -r -- data/three_storey "$scratch/in/data"
sed -n '/^```python$/,/^```$/{/^```$/q;/^```/d;p}' README.md >"$scratch/in/readme.py"
bare_root "$scratch/root" python3 python3-venv python3-numpy
cp -r -- "$scratch/in" "$scratch/root"
in_bare_root "$scratch/root" /in/wheel_use.sh bare
rm -rf -- "$scratch/root"

echo "== beside NumPy and SciPy with another BLAS"
bare_root "$scratch/root" python3 python3-venv python3-numpy python3-scipy \
  libopenblas0-pthread
# As pip of this machine sees them, with its settings.
mkdir -- "$scratch/in/index"
"$python" -m pip download --quiet --only-binary :all: --dest "$scratch/in/index" \
  "numpy${numpy//[ ()]/}" scipy >"$scratch/pip.log" 2>&1 ||
  rm -rf -- "$scratch/in/index"
cp -r -- "$scratch/in" "$scratch/root"
in_bare_root "$scratch/root" /in/wheel_use.sh blas
if [[ -d $scratch/in/index ]]; then
  in_bare_root "$scratch/root" /in/wheel_use.sh index
else
  echo "skipped: NumPy and SciPy of the index ($(tail -n 1 "$scratch/pip.log"))"
fi
rm -rf -- "$scratch/root"
echo "wheel: made, installed, used and removed"
