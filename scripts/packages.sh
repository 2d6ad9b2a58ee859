# Debian packages of the project, and their installation. Sourced by quickstart and check.
# shellcheck shell=bash

build_packages=(
  build-essential autoconf automake pkg-config
  libmicrohttpd-dev libgnutls28-dev libsqlite3-dev libsundials-dev libsuitesparse-dev
  libopenblas-dev libgsl-dev libpng-dev zlib1g-dev libcairo2-dev libpango1.0-dev libjansson-dev
  libnlopt-dev libudunits2-dev libmd-dev libseccomp-dev check fonts-dejavu-core curl jq python3-yaml sqlite3
)
test_packages=(chromium calculix-ccx python3 procps openssl mandoc
  libmumps-seq-dev
  munge slurmctld slurmd slurm-client slurm-wlm-basic-plugins)
# An npm from elsewhere comes with a Node.js that conflicts with those of Debian.
command -v npm >/dev/null || build_packages+=(nodejs npm)

say() {
  printf '\n== %s\n' "$*"
}

# Installs what is missing of the named packages; as root, or through sudo.
install_packages() {
  local missing=() package root=()
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' ||
      missing+=("$package")
  done
  if [ "${#missing[@]}" -eq 0 ]; then
    echo "all ${#} packages are there"
    return 0
  fi
  echo "missing: ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "this needs root: run it as root, or install sudo" >&2
      return 1
    fi
    root=(sudo)
  fi
  "${root[@]}" apt-get update -q </dev/null
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -q --no-install-recommends "${missing[@]}" </dev/null
}

# configure_in DIR OPTION...: a fresh or renewed out-of-tree build directory.
configure_in() {
  local source=$PWD dir=$1
  shift
  mkdir -p "$dir"
  (cd "$dir" && "$source/configure" --quiet "$@")
}
