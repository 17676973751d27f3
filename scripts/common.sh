# SPDX-License-Identifier: GPL-2.0-or-later
# shellcheck shell=bash
#
# Sourced by the scripts of this folder: the Debian packages that they need, configuring and building.
set -euo pipefail
export LC_ALL=C.UTF-8

project=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$project"

# What the program needs, what its reports need besides, what the tests need, what the
# benchmarks need (with DART, a hundred packages, tests beside it are built as well), and what only the long checks need.
packages_build=(g++ cmake ninja-build pkg-config
  libginac-dev libcln-dev libeigen3-dev libfmt-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev libtinyxml2-dev
  libkainjow-mustache-dev libmd-dev)
packages_report=(gnuplot-nox)
packages_test=(gnuplot-nox clang libgtest-dev librapidcheck-dev libmujoco-dev liborocos-kdl-dev liburdfdom-dev
  libsdformat-dev)
packages_bench=(libmujoco-dev liborocos-kdl-dev libdart-dev libsimbody-dev)
packages_check=(clang-format clang-tidy libclang-rt-dev chromium)

say() { printf '\n== %s\n' "$*"; }
fail() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

as_root() {
  if [[ $(id -u) == 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    fail "needs root or sudo for: $*"
  fi
}

# need_packages PACKAGE... installs those that are missing; does nothing, and asks for no rights, if all are there.
need_packages() {
  local package missing=()
  if ! command -v apt-get >/dev/null; then
    echo "no apt-get here; these Debian packages, or what stands for them, must be installed: $*" >&2
    return
  fi
  for package in "$@"; do
    if [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) != installed ]]; then missing+=("$package"); fi
  done
  if [[ ${#missing[@]} == 0 ]]; then return; fi
  say "installing ${missing[*]}"
  local install=(env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends
    -o Dpkg::Use-Pty=0 -o Acquire::Retries=3)
  # The list of packages may be missing or out of date: fetch it, then try again.
  if ! compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null || ! as_root "${install[@]}" "${missing[@]}" >/dev/null 2>&1; then
    as_root apt-get update -qq -o Acquire::Retries=3
    as_root "${install[@]}" "${missing[@]}" >/dev/null
  fi
}

# Jobs that the processors and the memory allow: one compiler of this project takes up to about 2 GB.
jobs_that_fit() {
  local cpus megabytes
  cpus=$(nproc)
  megabytes=$(awk '/^MemAvailable:/ { print int($2 / 1024) }' /proc/meminfo 2>/dev/null || true)
  local by_memory=$((${megabytes:-2000} / 2200))
  if ((by_memory < 1)); then by_memory=1; fi
  echo $((cpus < by_memory ? cpus : by_memory))
}

# configure FOLDER [CMAKE OPTION...]; several files of the generator at a time, which shortens a build from nothing; the
# compiler cache is used where there is one.
configure() {
  local folder=$1
  shift
  set -- -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=8 "$@"
  if command -v ccache >/dev/null; then set -- -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "$@"; fi
  mkdir -p "$folder"
  if ! cmake -S . -B "$folder" -G Ninja "$@" >"$folder/configure.log" 2>&1; then
    cat "$folder/configure.log" >&2
    fail "cannot configure $folder"
  fi
}

# build FOLDER [TARGET...]
build() {
  local folder=$1 target
  shift
  local options=()
  for target in "$@"; do options+=(--target "$target"); done
  cmake --build "$folder" --parallel "$(jobs_that_fit)" "${options[@]}"
}

# run_tests FOLDER [CTEST OPTION...] ends with the line "N passed, N failed"; status 1 if a test failed or none ran.
run_tests() {
  local folder=$1 status=0 log total failed skipped
  shift
  log=$folder/tests.log
  # Compiled code of earlier runs stays out of it.
  ANHOLON_CACHE=$(cd "$folder" && pwd)/cache ctest --test-dir "$folder" --parallel "$(jobs_that_fit)" --timeout 900 \
    --output-on-failure --no-tests=error "$@" 2>&1 | tee "$log" || status=$?
  read -r failed total < <(sed -nE 's/^[0-9]+% tests passed, ([0-9]+) tests? failed out of ([0-9]+)$/\1 \2/p' "$log") ||
    fail "no summary in $log"
  skipped=$(grep -cE '\*\*\*Skipped ' "$log" || true)
  printf '\n'
  if ((skipped > 0)); then printf '%d skipped\n' "$skipped"; fi
  printf '%d passed, %d failed\n' $((total - failed - skipped)) "$failed"
  if ((status == 0 && failed > 0)); then status=1; fi
  return $((status != 0))
}
