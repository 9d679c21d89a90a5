#!/usr/bin/env bash
# Makes the Debian packages, has lintian look at them, installs them where
# nothing else is and uses them there. By hand; needs root, the Debian packages
# lintian and mmdebstrap, and Debian's archive.
#
#   tests/packages/packages_test.sh [--build=FOLDER] [--suite=bookworm] [--only-make]
#
# FOLDER: a build to pack; unless given build-package, which is brought up to
# date first (preset `package`: for any x86-64). Packages are left in
# FOLDER/packages. --only-make: they are not tried, and lintian and mmdebstrap are
# not needed.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
build=
suite=bookworm
try=true
for argument in "$@"; do
  case $argument in
    --build=*) build=$(cd -- "${argument#*=}" && pwd) ;;
    --suite=*) suite=${argument#*=} ;;
    --only-make) try=false ;;
    *)
      echo "$0: unknown argument $argument" >&2
      exit 2
      ;;
  esac
done

tools=(help2man)
if $try; then
  tools+=(lintian mmdebstrap)
fi
for tool in "${tools[@]}"; do
  command -v "$tool" >/dev/null || {
    echo "$0: no $tool (apt-get install lintian mmdebstrap help2man)" >&2
    exit 2
  }
done

cd -- "$root"
if [[ -z $build ]]; then
  cmake --preset package
  cmake --build --preset package --parallel "$(nproc)"
  build=$root/build-package
fi

echo "== cpack"
packages=$build/packages
rm -rf -- "$packages"
(cd -- "$build" && umask 022 && cpack -B "$packages" >"$build/cpack.log") ||
  { cat -- "$build/cpack.log"; exit 1; }
rm -rf -- "$packages/_CPack_Packages"
ls -l -- "$packages"
for name in pinode libpinode-dev python3-pinode; do
  compgen -G "$packages/${name}_*.deb" >/dev/null || {
    echo "$name was not made"
    exit 1
  }
done
$try || exit 0

echo "== lintian"
lintian --allow-root --tag-display-limit 0 --fail-on error "$packages"/*.deb |
  tee -- "$build/lintian.log"
if grep copyright "$build/lintian.log"; then
  echo "what the packages say of copyright is not in order"
  exit 1
fi

echo "== a clean $suite"
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
# What the machine's own apt is set up with.
mkdir -- "$scratch/in"
cp -- "$packages"/*.deb "$scratch/in"
cp -r -- "$root/data/three_storey" "$scratch/in/three_storey"
cp -- "$root/tests/packages/app_use.py" "$scratch/in"
sed -n '/^```cpp$/,/^```$/{/^```/d;p;/^}$/q}' "$root/README.md" >"$scratch/in/readme.cc"
sed -i 's|data/three_storey|/in/three_storey|' "$scratch/in/readme.cc"
cat >"$scratch/in/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.18)
project(user LANGUAGES CXX)
find_package(pinode 0.1 REQUIRED)
foreach(library pinode shared)
  add_executable(readme_${library} readme.cc)
  target_link_libraries(readme_${library} PRIVATE pinode::${library})
endforeach()
END
cat >"$scratch/in/use.sh" <<'END'
#!/bin/bash
# Inside.
set -eux
export DEBIAN_FRONTEND=noninteractive
cd /in
apt-get install --yes --no-install-recommends ./libpinode0*.deb ./pinode_*.deb \
  ./python3-pinode_*.deb
# The library for this processor, and the one for any.
if grep -qw avx2 /proc/cpuinfo; then
  ldd /usr/bin/pinode_update | grep 'glibc-hwcaps/x86-64-v3/libpinode'
fi
/lib64/ld-linux-x86-64.so.2 --glibc-hwcaps-mask none --list \
  /usr/bin/pinode_update | grep 'x86_64-linux-gnu/libpinode'
/lib64/ld-linux-x86-64.so.2 --glibc-hwcaps-mask none /usr/bin/pinode_update \
  --case=three_storey/three_storey.toml --output_dir=plain --progress=false
test -s plain/report.html
pinode_check --version
grep -q 'three.js authors' /usr/share/doc/libpinode0.*/copyright
grep -q 'SERVICES; LOSS OF USE' /usr/share/doc/libpinode0.*/copyright
test -s /usr/share/doc/pinode/case_files.md
test -s /usr/share/doc/pinode/recipes.md
test -s /usr/share/doc/pinode/first_case/README.md
test -s /usr/share/doc/pinode/matlab.md
pinode_check --case=/usr/share/doc/pinode/examples/three_storey/three_storey.toml
pinode_check --case=three_storey/three_storey.toml >check.txt
grep -q 'Every named parameter' check.txt
pinode_update --case=three_storey/three_storey.toml --output_dir=out --progress=false
test -s out/report.html
test -s /usr/share/bash-completion/completions/pinode_update
python3 app_use.py /usr/bin/pinode_app
/usr/bin/python3 -c '
import pinode
fit = pinode.read_case("/in/three_storey/three_storey.toml").identify()
assert fit.usable and abs(fit["k1"] - 0.25) < 0.01, fit
print(pinode.__version__, fit["k1"])'
apt-get install --yes --no-install-recommends ./libpinode*.deb cmake ninja-build g++
cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release
cmake --build build
build/readme_pinode | grep -q k1
build/readme_shared | grep -q k1
ldd build/readme_shared | grep libpinode.so.
apt-get purge --yes pinode python3-pinode 'libpinode*'
test ! -e /usr/bin/pinode_update
test ! -e /usr/lib/python3/dist-packages/pinode
test ! -e /usr/include/pinode
END
chmod +x "$scratch/in/use.sh"
mmdebstrap --variant=apt --mode=root \
  --customize-hook='mkdir "$1/in"' \
  --customize-hook="cp -a '$scratch/in/.' \"\$1/in\"" \
  --customize-hook='chroot "$1" /in/use.sh' \
  "$suite" "$scratch/root.tar"
echo "packages: made, checked, installed, used and removed"
