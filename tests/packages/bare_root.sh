# Functions for wheel.sh and tar.sh: a bare Debian to try things in. To be
# sourced; needs root, debootstrap and Debian's archive.
#
# PINODE_BARE_ROOTS names a folder where such roots are kept from run to run, as
# archives. Delete it to make them anew.

# bare_root FOLDER [PACKAGE...]: makes FOLDER a Debian 12 that has its essential
# packages, apt and these.
bare_root() {
  local folder=$1 suite=bookworm kept=
  shift
  mkdir -p -- "$folder"
  if [[ -n ${PINODE_BARE_ROOTS:-} ]]; then
    mkdir -p -- "$PINODE_BARE_ROOTS"
    kept=$PINODE_BARE_ROOTS/$(echo "$suite" "$@" | tr ' ' '_').tar
  fi
  if [[ ! -s $kept ]]; then
    local include
    include=$(echo "$@" | tr ' ' ',')
    PATH=$PATH:/usr/sbin debootstrap --variant=minbase \
      ${include:+--include="$include"} "$suite" "$folder" \
      "${PINODE_DEBIAN_MIRROR:-http://deb.debian.org/debian}" \
      >"$folder.log" 2>&1 || {
      tail -- "$folder.log" >&2
      return 1
    }
    rm -rf -- "$folder"/var/cache/apt/archives/*.deb
    [[ -n $kept ]] || return 0
    tar -C "$folder" -cf "$kept.partial" --one-file-system .
    mv -- "$kept.partial" "$kept"
  else
    tar -C "$folder" -xf "$kept"
  fi
}

# in_bare_root FOLDER COMMAND...: runs a command there, with /proc and /dev, and
# nothing of this shell's environment.
in_bare_root() {
  local folder=$1
  shift
  unshare --mount -- bash -c '
    mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" &&
      exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
        chroot "$0" "$@"' "$folder" "$@"
}
