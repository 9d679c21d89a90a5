#!/bin/bash
# Run by tar.sh inside a bare Debian, where /in has the archive.
set -euo pipefail

if command -v cc || command -v c++; then
  echo "there is a compiler: this is no bare Debian"
  exit 1
fi
# A name with a blank, and another one after the first run.
mkdir '/opt/some programs'
tar -C '/opt/some programs' -xzf /in/pinode-*.tar.gz
mv '/opt/some programs' '/opt/other programs'
cd '/opt/other programs'/pinode-*
case=share/doc/pinode/examples/three_storey/three_storey.toml
for program in bin/*; do
  "$program" --version | grep -q "^${program##*/} [0-9]"
  ldd "$program" >/tmp/libraries.txt
  if grep 'not found' /tmp/libraries.txt; then exit 1; fi
  if grep -vE "$PWD/(bin/\.\./)?lib/|linux-vdso|/ld-linux|/lib(c|m|dl|rt|util|pthread|resolv|gcc_s|stdc\+\+)\.so" /tmp/libraries.txt; then
    echo "$program takes these from the system"
    exit 1
  fi
  test -s "share/bash-completion/completions/${program##*/}"
done
if grep -qw avx2 /proc/cpuinfo && [[ -d lib/glibc-hwcaps ]]; then
  ldd bin/pinode_update | grep -q 'glibc-hwcaps/x86-64-v3/libpinode'
fi
bin/pinode_update --case="$case" --output_dir='/tmp/a result' --progress=false \
  >/tmp/update.txt
grep '^ *k1 ' /tmp/update.txt
test -s '/tmp/a result/report.html'
python3 /in/app_use.py bin/pinode_app
# Through a link, from elsewhere, and with all symbols asked for.
ln -s "$PWD/bin/pinode_check" /usr/local/bin
(cd / && LD_BIND_NOW=1 /usr/local/bin/pinode_check --case="$OLDPWD/$case" >/tmp/check.txt)
grep -q 'Every named parameter' /tmp/check.txt
for file in README.txt licences/pinode.txt licences/README.txt \
  licences/libspqr2/copyright licences/common-licenses/GPL-2 \
  share/doc/pinode/case_files.md; do
  test -s "$file"
done
