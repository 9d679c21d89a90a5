#!/usr/bin/env bash
# Installs the Debian packages that the given lists name and this machine lacks.
#
#   apps/install_packages.sh LIST...
#
# A list holds one package a line; `#` starts a comment. Nothing missing:
# nothing done, and neither root nor a network is needed.
set -euo pipefail

if [[ $# -eq 0 ]]; then
  echo "usage: $0 LIST..." >&2
  exit 2
fi

missing=()
while read -r package; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" \
    2>/dev/null || true)
  if [[ $status != installed ]]; then
    missing+=("$package")
  fi
done < <(sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' -- "$@")
if [[ ${#missing[@]} -eq 0 ]]; then
  exit 0
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "$0: neither root nor sudo; please install: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "Installing ${missing[*]}"
# Waits for another apt instead of failing on its lock.
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
  apt-get --quiet=2 -o DPkg::Lock::Timeout=300)
"${apt[@]}" update
"${apt[@]}" install --yes --no-install-recommends "${missing[@]}"
