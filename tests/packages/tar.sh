#!/usr/bin/env bash
# Makes an archive of the programs with every library that they need, which works
# from any folder, and tries it in a bare Debian 12.
#
#   tests/packages/tar.sh [--build=FOLDER] [--output=FOLDER] [--only-make]
#
# --build: a build of the preset `portable`; build-portable, which is brought up
#   to date first, unless given.
# --output: where the archive goes; BUILD/tar unless given.
# --only-make: do not try it.
#
# Needs root, patchelf, debootstrap and Debian's archive; without the tools it is
# skipped (77). PINODE_BARE_ROOTS=FOLDER keeps the bare Debian for the next run.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/tests/packages/bundle.sh"
source "$root/tests/packages/bare_root.sh"
bundle_begin tar "$@"

version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")
name=pinode-$version-linux-x86_64
tree=$scratch/$name
mkdir -p -- "$tree/bin"
cp -- "$scratch"/installed/bin/* "$tree/bin"
cp -r -- "$scratch/installed/share" "$tree"
bundle_own_library "$tree/lib"
bundle_libraries "$tree" "$tree/lib"
bundle_check "$tree" "$tree/lib"
bundle_licences "$tree/licences"
level=$(bundle_level "$tree")
cat >"$tree/README.txt" <<END_OF_README
pinode $version: programs for structural identification.

They run on any x86-64 Linux with glibc ${level/_/.} or newer (for
instance Debian 12), from any folder, and need no installation:

    bin/pinode_update --case=share/doc/pinode/examples/three_storey/three_storey.toml --output_dir=out

Documents are in share/doc/pinode, manual pages in share/man (man -M share/man
pinode_update). Figures in reports need gnuplot (Debian: gnuplot-nox).
licences/README.txt says what the libraries in lib/ are and under which terms
they may be passed on.
END_OF_README
rm -f -- "$output"/pinode-*.tar.gz
# In the same order and with the same times, the same bytes.
tar -C "$scratch" --sort=name --owner=0 --group=0 --numeric-owner \
  --mtime="@$SOURCE_DATE_EPOCH" -cf - "$name" | gzip --no-name --best \
  >"$output/$name.tar.gz"
echo "$output/$name.tar.gz: $(du -h -- "$output/$name.tar.gz" | cut -f1), unpacked $(
  du -sh -- "$tree" | cut -f1), $(wc -l <"$bundle_table") libraries"
$try || exit 0

echo "== a bare Debian"
bare_root "$scratch/root" python3 python3-venv python3-numpy
mkdir -- "$scratch/root/in"
cp -- "$output/$name.tar.gz" tests/packages/{tar_use.sh,app_use.py} \
  "$scratch/root/in"
in_bare_root "$scratch/root" /in/tar_use.sh
echo "tar: made, unpacked and used"
