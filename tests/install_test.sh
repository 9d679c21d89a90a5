#!/usr/bin/env bash
# Installs a build, then builds and runs a project that finds it there.
#
#   tests/install_test.sh BUILD_DIR CXX_COMPILER
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=$(cd -- "$1" && pwd)
compiler=$2
scratch=$build/tests/install_test
prefix=$scratch/prefix

rm -rf -- "$scratch"
mkdir -p -- "$scratch/run"
cmake --install "$build" --prefix "$prefix" >"$scratch/install.log"

package=$(dirname -- "$(find "$prefix" -name pinodeConfig.cmake)")
for file in pinodeTargets.cmake pinodeConfigVersion.cmake; do
  if [[ ! -f $package/$file ]]; then
    echo "$file was not installed beside pinodeConfig.cmake"
    exit 1
  fi
done
# The package must work on another machine and without these two folders.
if grep -rnF -e '-march' -e "$root" -e "$build" -- "$package"; then
  echo "the package names a machine's instructions or a folder of this build"
  exit 1
fi

cmake -S "$root/tests/consumer" -B "$scratch/build" -G Ninja \
  -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON \
  -DPINODE_README="$root/README.md" \
  -DPINODE_LIBRARY_README="$root/pinode/README.md"
if grep -nF -e '-march' -e "$root/pinode" -- \
  "$scratch/build/compile_commands.json"; then
  echo "the consumer is not built from the installed package alone"
  exit 1
fi
cmake --build "$scratch/build"

# The shared library shows what is pinode's and nothing of what it was made with.
shared=$(find "$prefix" -name 'libpinode.so')
if [[ -n $shared ]]; then
  shown=$(nm --dynamic --defined-only --demangle "$shared" | cut -d' ' -f3-)
  if ! grep -q '^pinode::Identify(' <<<"$shown"; then
    echo "libpinode.so does not show pinode::Identify"
    exit 1
  fi
  if foreign=$(grep -v -e 'pinode::' <<<"$shown"); then
    echo "libpinode.so shows more than pinode's own:"
    head <<<"$foreign"
    exit 1
  fi
  name=$(objdump -p "$shared" | awk '$1 == "SONAME" {print $2}')
  if [[ $name != libpinode.so.[0-9]* ]]; then
    echo "libpinode.so is called '$name', expected a version"
    exit 1
  fi
fi

# In a folder of their own, with the paths that the README speaks of.
cd -- "$scratch/run"
ln -s -- "$root/data" data
for program in "$scratch/build/"{consumer,consumer_of_*,readme*,library_readme*}; do
  if [[ -f $program && -x $program ]]; then
    echo "Running ${program##*/}"
    "$program" | tee "printed_by_${program##*/}.txt"
  fi
done
# The results that stand beside the two programs.
"$root/tests/printed_results_test.py" "$root" --program=readme \
  printed_by_readme.txt README.md
"$root/tests/printed_results_test.py" "$root" --program=library_readme \
  printed_by_library_readme.txt pinode/README.md
for file in frame/result.json frame/report.html; do
  if [[ ! -s $file ]]; then
    echo "the program of the library's README has left no $file"
    exit 1
  fi
done
