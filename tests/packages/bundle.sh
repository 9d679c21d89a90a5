# Functions for wheel.sh and tar.sh: a folder of programs and libraries takes in
# every shared library that it needs. To be sourced where `root` is set.

# Libraries that stay outside. Every Debian 12 has them, and so has every system
# that a manylinux tag names (PEP 600).
bundle_outside='^(ld-linux-x86-64|lib(c|m|dl|rt|util|pthread|resolv|gcc_s|stdc\+\+))\.so\.'

# BLAS and LAPACK are Debian's ATLAS, whatever this machine has selected:
# libceres3 needs its libf77blas anyway, and wheels of two machines are alike.
bundle_blas=/usr/lib/x86_64-linux-gnu/atlas

# Packages whose code is compiled into pinode's own files.
bundle_compiled_in=(libceres-dev libeigen3-dev
  nlohmann-json3-dev libkainjow-mustache-dev libtomlplusplus-dev libjs-three
  pybind11-dev)

# bundle_begin KIND ARGUMENT...: reads the arguments of wheel.sh or tar.sh, checks
# the tools (without one the script ends with status 77, skipped), brings the build
# up to date and installs its programs and shared library in $scratch/installed.
# Sets build, output, scratch, try and bundle_table.
bundle_begin() {
  local kind=$1 argument tool component
  shift
  build=
  output=
  try=true
  for argument in "$@"; do
    case $argument in
      --build=*) build=$(cd -- "${argument#*=}" && pwd) ;;
      --output=*) output=$(realpath -- "${argument#*=}") ;;
      --only-make) try=false ;;
      *)
        echo "$0: unknown argument $argument" >&2
        exit 2
        ;;
    esac
  done
  local tools=(patchelf readelf strip file)
  if $try; then
    tools+=(debootstrap)
  fi
  for tool in "${tools[@]}"; do
    PATH=$PATH:/usr/sbin command -v "$tool" >/dev/null || {
      echo "no $tool (apt-get install binutils debootstrap file patchelf): skipped" >&2
      exit 77
    }
  done
  if $try && [[ $EUID -ne 0 ]]; then
    echo "only root can make a bare Debian (--only-make does without): skipped" >&2
    exit 77
  fi
  cd -- "$root"
  if [[ -z $build ]]; then
    cmake --preset portable
    cmake --build --preset portable --parallel "$(nproc)"
    build=$root/build-portable
  fi
  if grep -qE '^PINODE_((NATIVE|MPI):BOOL=ON|ARCH:STRING=.)' "$build/CMakeCache.txt"; then
    echo "$build is for this machine or for MPI: give a build of the preset portable" >&2
    exit 2
  fi
  output=${output:-$build/$kind}
  mkdir -p -- "$output"
  scratch=$(mktemp -d)
  trap 'rm -rf -- "$scratch"' EXIT
  bundle_table=$scratch/libraries
  # Files have the time of the commit, not of this run.
  SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null || date +%s)
  export SOURCE_DATE_EPOCH
  for component in programs shared; do
    cmake --install "$build" --prefix "$scratch/installed" \
      --component "$component" >/dev/null
  done
  # Debian's packages must have these; the bundle has a folder of licences.
  rm -f -- "$scratch/installed/share/doc"/*/{copyright,changelog.gz}
  find "$scratch/installed/share" -type d -empty -delete
}

# bundle_own_library FOLDER: copies libpinode there, with the builds for newer
# processors, under the name that the programs know. Nothing where they are
# linked with the static libraries.
bundle_own_library() {
  local library name
  name=$(readelf -d "$scratch/installed/bin/pinode_update" |
    sed -n 's/.*(NEEDED).*\[\(libpinode\.so.*\)\]$/\1/p')
  [[ -n $name ]] || return 0
  library=$(find "$scratch/installed" -name "$name" -not -path '*/glibc-hwcaps/*')
  install -D -m 755 -- "$library" "$1/$name"
  if [[ -d ${library%/*}/glibc-hwcaps ]]; then
    cp -r -- "${library%/*}/glibc-hwcaps" "$1"
  fi
}

# bundle_elf FOLDER: its ELF files, one a line.
bundle_elf() {
  find "$1" -type f -size +1k -print0 |
    xargs -0 -r file --no-pad --separator '|' -- |
    awk -F'|' '$2 ~ /^ ELF / {print $1}' | sort
}

# bundle_closure LIBRARIES FILE...: name and path of each shared library that the
# files need, directly or not. Libraries in the folder LIBRARIES come first.
bundle_closure() {
  local libraries=$1 file found
  shift
  found=$(for file in "$@"; do
    LD_LIBRARY_PATH=$libraries:$bundle_blas \
      /lib64/ld-linux-x86-64.so.2 --glibc-hwcaps-mask none --list "$file" ||
      {
        echo "$file: not all of its libraries are installed" >&2
        exit 1
      }
  done)
  awk '$2 == "=>" {print $1, $3}' <<<"$found" | sort -u |
    grep -vE "$bundle_outside"
}

# bundle_libraries TREE LIBRARIES: copies what the ELF files of TREE need into
# its folder LIBRARIES. Each name gets a hash of the content, as auditwheel does:
# another package of the process may bring another build of the same library.
# Writes name, path and new name of each to the file bundle_table.
bundle_libraries() {
  local tree=$1 libraries=$2 name path new hash file relative
  local files plain options=()
  mkdir -p -- "$libraries"
  mapfile -t files < <(bundle_elf "$tree")
  strip --strip-unneeded -- "${files[@]}"
  # The builds for newer processors need what the plain one needs.
  mapfile -t plain < <(printf '%s\n' "${files[@]}" | grep -v /glibc-hwcaps/)
  bundle_closure "$libraries" "${plain[@]}" >"$bundle_table.closure"
  : >"$bundle_table"
  while read -r name path; do
    hash=$(sha256sum <"$path" | cut -c1-8)
    new=${name%%.so*}-$hash.so${name#*.so}
    options+=(--replace-needed "$name" "$new")
    echo "$name $(realpath -- "$path") $new" >>"$bundle_table"
    if [[ $path == "$libraries"/* ]]; then
      # Our own: the builds for newer processors are found by the same name.
      while read -r file; do
        mv -- "$file" "$(dirname -- "$file")/$new"
      done < <(find "$libraries" -type f -name "$name")
    else
      install -m 755 -- "$path" "$libraries/$new"
    fi
  done <"$bundle_table.closure"
  while read -r file; do
    relative=$(realpath --relative-to "$(dirname -- "$file")" "$libraries")
    # One thing at a time: patchelf 0.14.3 of Debian 12 mixes up the names that one
    # call gives.
    if [[ $file == "$libraries"/* ]]; then
      patchelf --set-soname "$(basename -- "$file")" "$file"
    fi
    patchelf "${options[@]}" "$file"
    patchelf --set-rpath "\$ORIGIN/$relative" "$file"
  done < <(bundle_elf "$tree")
}

# bundle_check TREE LIBRARIES: every needed library is in LIBRARIES or outside,
# and none is there for nothing.
bundle_check() {
  local tree=$1 libraries=$2 file name used=$bundle_table.used
  : >"$used"
  while read -r file; do
    while read -r name; do
      if [[ -e $libraries/$name ]]; then
        echo "$name" >>"$used"
      elif ! grep -qE "$bundle_outside" <<<"$name"; then
        echo "$file needs $name, which is not in the bundle" >&2
        return 1
      fi
    done < <(readelf -d "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]$/\1/p')
  done < <(bundle_elf "$tree")
  if name=$(find "$libraries" -maxdepth 1 -type f -printf '%f\n' |
    grep -vxF -f "$used"); then
    echo "in the bundle for nothing: $name" >&2
    return 1
  fi
}

# bundle_symbols TREE PREFIX: the highest version of the symbols PREFIX_x.y that
# its ELF files ask for, without the prefix, and a file that asks for it.
bundle_symbols() {
  local file
  bundle_elf "$1" | while read -r file; do
    readelf --version-info --wide "$file" |
      sed -n '/Version needs section/,$p' |
      grep -oE "Name: $2_[0-9.]+" | sed "s|.*_|| ; s|\$| ${file##*/}|"
  done | sort -V | tail -n 1
}

# bundle_level TREE: the glibc that its ELF files need, as 2_36. The C++ library
# of a manylinux system is the one of GCC's release at that time, so what is
# asked of that may raise the level.
bundle_level() {
  local glibc cxx level
  glibc=$(bundle_symbols "$1" GLIBC)
  cxx=$(bundle_symbols "$1" GLIBCXX)
  echo "highest symbols: GLIBC_$glibc, GLIBCXX_$cxx" >&2
  level=${glibc%% *}
  # From auditwheel's table of policies: the first glibc of each GLIBCXX.
  case ${cxx%% *} in
    3.4.3[1-9]*)
      echo "GLIBCXX_$cxx is newer than the table in bundle_level: add it" >&2
      return 1
      ;;
    3.4.30) level=$(printf '%s\n' "$level" 2.35 | sort -V | tail -n 1) ;;
    3.4.29) level=$(printf '%s\n' "$level" 2.34 | sort -V | tail -n 1) ;;
  esac
  echo "${level/./_}"
}

# bundle_package FILE: the Debian package that a file is from. What was packaged
# below /lib is found by that name.
bundle_package() {
  { dpkg-query --search "$1" || dpkg-query --search "${1#/usr}"; } 2>/dev/null |
    head -n 1 | cut -d: -f1
}

# bundle_licences FOLDER: the copyright of everything in bundle_table and of what
# is compiled in, the licences that these name, and which sources they are from.
bundle_licences() {
  local folder=$1 name path new package packages=()
  mkdir -p -- "$folder"
  while read -r name path new; do
    [[ $name == libpinode.so.* ]] && continue
    package=$(bundle_package "$path")
    [[ -n $package ]] || {
      echo "$path is of no Debian package: its licence is not known" >&2
      return 1
    }
    packages+=("$package")
    echo "$new $package" >>"$bundle_table.packages"
  done <"$bundle_table"
  for package in "${bundle_compiled_in[@]}"; do
    if dpkg-query --status "$package" >/dev/null 2>&1; then
      packages+=("$package")
      echo "compiled-in $package" >>"$bundle_table.packages"
    fi
  done
  mapfile -t packages < <(printf '%s\n' "${packages[@]}" | sort -u)
  for package in "${packages[@]}"; do
    install -D -m 644 -- "/usr/share/doc/$package/copyright" \
      "$folder/$package/copyright"
  done
  mkdir -- "$folder/common-licenses"
  grep -rhoE '/usr/share/common-licenses/[A-Za-z]+(-[0-9.]*[0-9])?' "$folder" |
    sort -u | while read -r path; do
      [[ ! -f $path ]] || install -m 644 -- "$path" "$folder/common-licenses"
    done
  install -m 644 -- "$root/LICENSE" "$folder/pinode.txt"
  {
    cat <<'TEXT'
pinode itself has the licence in pinode.txt (BSD-3-Clause). The files beside it
hold libraries of Debian, listed below. Of these SuiteSparse' SPQR and the
supernodal part of CHOLMOD, which Ceres is linked with, have the GNU General
Public License, version 2 or later, and other parts have the LGPL. What is
distributed as a whole must therefore meet the GPL: whoever passes it on offers
the sources as well. They are Debian's, of the versions below, at
https://snapshot.debian.org/package/SOURCE/VERSION/, and pinode's own.

Each package's copyright is in the folder of its name, the texts of the usual
licences are in common-licenses.

TEXT
    printf '%-36s %-28s %s\n' library 'Debian package' 'source, version'
    sort -u -- "$bundle_table.packages" | while read -r new package; do
      printf '%-36s %-28s %s\n' "$new" "$package" "$(dpkg-query --show \
        --showformat='${source:Package} ${source:Version}\n' "$package" | head -n 1)"
    done
  } >"$folder/README.txt"
}
