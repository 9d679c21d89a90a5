#!/usr/bin/env bash
# Makes everything of a release in one folder: the source archive, Debian packages,
# the wheel, the archive of the programs, the documentation site, and the SHA-256
# sums of them all. PUBLISHING.md says what to do with them.
#
#   tests/packages/release.sh [--output=FOLDER] [--parts=LIST] [--only-make]
#
# --output: an empty or new folder; build-release-files unless given.
# --parts: some of source,packages,wheel,tar,site; all unless given.
# --only-make: do not try packages, wheel and archive in a bare Debian.
#
# Builds in build-package and build-portable. Needs the Debian packages of
# apps/packages.txt, tests/packages.txt and pinode/site/packages.txt, and patchelf,
# debootstrap, lintian and mmdebstrap; root.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
cd -- "$root"
output=$root/build-release-files
parts=source,packages,wheel,tar,site
options=()
for argument in "$@"; do
  case $argument in
    --output=*) output=$(realpath -- "${argument#*=}") ;;
    --parts=*) parts=${argument#*=} ;;
    --only-make) options+=(--only-make) ;;
    *)
      echo "$0: unknown argument $argument" >&2
      exit 2
      ;;
  esac
done
for part in ${parts//,/ }; do
  case $part in
    source | packages | wheel | tar | site) ;;
    *)
      echo "$0: no part '$part', expected some of source,packages,wheel,tar,site" >&2
      exit 2
      ;;
  esac
done
wanted() { [[ ,$parts, == *,$1,* ]]; }

# A release is a commit whose documents name its version.
version=$(sed -n 's/^project(pinode VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
if [[ -n $(git status --porcelain --untracked-files=no) ]]; then
  echo "there are changes that are not committed: commit or stash them" >&2
  exit 1
fi
python3 tests/documents_test.py "$root"
grep -q "^## $version\b" CHANGELOG.md || {
  echo "CHANGELOG.md has no section '## $version'" >&2
  exit 1
}
if grep -q "^## $version (unreleased)" CHANGELOG.md; then
  echo "note: CHANGELOG.md still calls $version unreleased"
fi
mkdir -p -- "$output"
if [[ -n $(ls -A -- "$output") ]]; then
  echo "$output is not empty: remove what is in it, or give another --output" >&2
  exit 1
fi

# run COMMAND...: a part that is skipped (77) is missing from the release.
run() {
  "$@" || {
    echo "${1##*/} ended with status $?: no release" >&2
    exit 1
  }
}

if wanted source; then
  echo "== source"
  git archive --format=tar --prefix="pinode-$version/" HEAD |
    gzip --no-name --best >"$output/pinode-$version.tar.gz"
fi
if wanted packages; then
  echo "== Debian packages"
  run tests/packages/packages_test.sh "${options[@]}"
  cp -- build-package/packages/*.deb "$output"
fi
if wanted wheel || wanted tar || wanted site; then
  echo "== portable build"
  run cmake --preset portable
  run cmake --build --preset portable --parallel "$(nproc)"
fi
for part in wheel tar; do
  if wanted "$part"; then
    echo "== $part"
    run "tests/packages/$part.sh" --build="$root/build-portable" "${options[@]}"
    cp -- build-portable/"$part"/pinode-* "$output"
  fi
done
if wanted site; then
  echo "== site"
  run pinode/site/build.sh "$root/build-portable" "$root/build-portable/site"
  tar -C build-portable --transform "s|^site|pinode-$version-site|" \
    --exclude=.doctrees --sort=name --owner=0 --group=0 --numeric-owner \
    --mtime="@$(git log -1 --format=%ct)" -cf - site |
    gzip --no-name --best >"$output/pinode-$version-site.tar.gz"
fi

# Every file carries the version in its name.
for file in "$output"/*; do
  [[ ${file##*/} == *[-_]"$version"[-_.]* ]] || {
    echo "${file##*/} is not of version $version" >&2
    exit 1
  }
done
(cd -- "$output" && sha256sum -- * >SHA256SUMS && sha256sum --quiet --check SHA256SUMS)
echo "pinode $version, commit $(git rev-parse --short HEAD), in $output:"
(cd -- "$output" && ls -sh1 | tail -n +2)
