#!/bin/bash
# Run by wheel.sh inside a bare Debian, where /in has the wheel:
#
#   wheel_use.sh bare    # installs, fits, removes; a minute is what it may take
#   wheel_use.sh blas    # with NumPy and SciPy, before and after, in one process
#   wheel_use.sh index   # NumPy and SciPy from /in/index, no system packages
set -euo pipefail

cd /in
now() { date +%s%N; }
began=$(now)
seconds() {
  local tenths=$((($(now) - began) / 100000000))
  echo "$((tenths / 10)).$((tenths % 10))"
}
fit='
import pinode
fit = pinode.read_case("/in/data/three_storey/three_storey.toml").identify()
assert fit.usable and abs(fit["k1"] - 0.25) < 0.01, fit
'

case $1 in
  bare)
    for tool in cc c++ gcc g++ clang cmake patchelf; do
      if command -v "$tool"; then
        echo "there is a $tool: this is no bare Debian"
        exit 1
      fi
    done
    python3 -m venv --system-site-packages v
    find v -type f -o -type l | grep -v __pycache__ | sort >before.txt
    v/bin/pip install --quiet --no-index pinode-*.whl
    echo "installed after $(seconds) s"
    v/bin/pinode_update --case=data/three_storey/three_storey.toml \
      --output_dir=out --progress=false >update.txt
    taken=$(seconds)
    echo "first fit after $taken s (asked: 60)"
    grep -q '^ *k1 ' update.txt
    test -s out/report.html
    python3 app_use.py v/bin/pinode_app
    v/bin/pip check
    v/bin/python readme.py >readme.txt
    grep -q k1 readme.txt
    v/bin/python -c "$fit
print(pinode.__version__, fit['k1'])"
    # The installed programs are the real ones, and a status is theirs.
    for program in v/lib/python3*/site-packages/pinode/bin/*; do
      name=${program##*/}
      v/bin/"$name" --version | grep -q "^$name [0-9]"
      test -s "v/share/bash-completion/completions/$name"
    done
    status=0
    v/bin/pinode_update --case=none.toml --output_dir=none 2>error.txt || status=$?
    test "$status" = 2
    grep -q none.toml error.txt
    # Every library is the wheel's own or the system's glibc and C++, and of our
    # own the build for this processor.
    site=$(echo v/lib/python3*/site-packages)
    for file in "$site"/pinode/bin/pinode_update "$site"/pinode/_pinode*.so; do
      ldd "$file" >libraries.txt
      if grep 'not found' libraries.txt; then exit 1; fi
      if grep -vE 'pinode\.libs/|linux-vdso|/ld-linux|/lib(c|m|dl|rt|util|pthread|resolv|gcc_s|stdc\+\+)\.so' libraries.txt; then
        echo "$file takes these from the system"
        exit 1
      fi
      if grep -qw avx2 /proc/cpuinfo && [[ -d $site/pinode.libs/glibc-hwcaps ]]; then
        grep -q 'glibc-hwcaps/x86-64-v3/libpinode' libraries.txt
      fi
    done
    # And the plain build, whatever the processor.
    /lib64/ld-linux-x86-64.so.2 --glibc-hwcaps-mask none \
      "$site"/pinode/bin/pinode_update --case=data/three_storey/three_storey.toml \
      --output_dir=plain --progress=false >plain.txt
    grep -q '^ *k1 ' plain.txt
    # All symbols are there, not only those that this fit has called.
    LD_BIND_NOW=1 v/bin/python -c 'import pinode'
    for licence in pinode.txt README.txt libspqr2/copyright common-licenses/GPL-2; do
      test -s "$site"/pinode-*.dist-info/licenses/$licence
    done
    # Removed, all of it.
    v/bin/pip uninstall --quiet --yes pinode
    find v -type f -o -type l | grep -v __pycache__ | sort >after.txt
    diff before.txt after.txt
    test ! -e "$site/pinode" && test ! -e "$site/pinode.libs"
    if ((${taken%.*} >= 60)); then
      echo "the first fit took $taken s, asked are 60"
      exit 1
    fi
    ;;
  blas)
    python3 -m venv --system-site-packages v
    v/bin/pip install --quiet --no-index pinode-*.whl
    use='
import numpy, scipy.linalg, scipy.sparse.linalg
a = numpy.random.default_rng(1).standard_normal((300, 300))
def check():
    q, r = scipy.linalg.qr(a)
    assert abs(numpy.matmul(q, r) - a).max() < 1e-11
    m = a @ a.T + numpy.eye(300)
    assert abs(numpy.linalg.solve(m, m) - numpy.eye(300)).max() < 1e-6
check()
'
    both='
check()
maps = open("/proc/self/maps").read()
assert "libopenblas" in maps and "pinode.libs/libatlas-" in maps, maps
print(fit["k1"])'
    v/bin/python -c "$use$fit$both" >first.txt
    v/bin/python -c "$fit$use$both" >last.txt
    v/bin/python -c "$fit
print(fit['k1'])" >alone.txt
    diff alone.txt first.txt
    diff alone.txt last.txt
    echo "k1 = $(cat alone.txt) alone, after and before NumPy and SciPy"
    ;;
  index)
    python3 -m venv w
    w/bin/pip install --quiet --no-index --find-links index pinode-*.whl scipy
    w/bin/pip check
    w/bin/python readme.py >readme.txt
    w/bin/python -c "import numpy, scipy.linalg
scipy.linalg.inv(numpy.eye(50) + 1)
$fit
scipy.linalg.inv(numpy.eye(50) + 1)
print('NumPy', numpy.__version__, 'SciPy', scipy.__version__, 'of the index: k1 =', fit['k1'])"
    ;;
esac
