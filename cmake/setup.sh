# SPDX-License-Identifier: BSD-3-Clause
# Sourced by tests/run and the commands in examples/: installs what is missing and builds. Gives
# palpate_root, palpate_cores and palpate_mpiexec, which starts a rank on each core.

palpate_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# One line that says what cannot be had, and the end.
palpate_fail() {
  echo "palpate: $*" >&2
  exit 1
}

# palpate_listed_packages [<what needs them>…]: the packages of the list that are for this release;
# without arguments, all of them.
palpate_listed_packages() {
  local package release
  release=$(. /etc/os-release && echo "${VERSION_CODENAME-}")
  for package in $(awk -v asked=" $* " '/^#/ { next } /^[a-z]/ { needs = $1; $1 = "" }
      asked == "  " || index(asked, " " needs " ")' "$palpate_root/cmake/debian-packages.txt"); do
    case $package in
      */*"${release:-none}"*) echo "${package%/*}" ;;
      */*) ;;
      *) echo "$package" ;;
    esac
  done
}

palpate_install_packages() {
  palpate_install $(palpate_listed_packages)
}

# palpate_install <package>…: those that are not installed yet.
palpate_install() {
  command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
    palpate_fail "this script needs apt, of Debian 12, 13 or unstable" \
      "(see cmake/debian-packages.txt)."
  local package missing=
  for package in "$@"; do
    if [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" != installed ]; then
      missing+=" $package"
    fi
  done
  [ -n "$missing" ] || return 0

  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600)
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || palpate_fail "root or sudo is needed to install:$missing"
    apt=(sudo "${apt[@]}")
  fi
  echo "palpate: installing$missing"
  local log
  log=$(mktemp)
  # A stale list or one dead source is no reason to stop: the installation tells.
  "${apt[@]}" update >"$log" 2>&1 || true
  "${apt[@]}" install -y --no-install-recommends $missing >>"$log" 2>&1 </dev/null ||
    palpate_fail "apt could not install$missing:" \
      "$(grep -m 1 -E '^(E:|W: Failed to fetch)' "$log") (log: $log)"
  rm -f "$log"
}

# palpate_build <preset> [<target>…]
palpate_build() {
  local preset=$1
  shift
  # What is wrong goes to stderr.
  cmake --preset "$preset" >/dev/null ||
    palpate_fail "the preset $preset cannot be configured."
  cmake --build --preset "$preset" ${@:+--target "$@"} ||
    palpate_fail "the preset $preset cannot be built."
}

# Asked before OMP_NUM_THREADS is set, which nproc heeds.
palpate_cores=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc)
# The ranks are the parallelism, one a core: a threaded BLAS would only get in their way, and each
# has one thread for a large body.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

palpate_mpiexec=(mpiexec --oversubscribe --bind-to none -n "$palpate_cores")
if [ "$(id -u)" -eq 0 ]; then
  palpate_mpiexec+=(--allow-run-as-root)
fi
# A rank that waits for another one asks again and again: it lets whoever has something to do go
# first, such as ParaView's window beside it.
export OMPI_MCA_mpi_yield_when_idle=1
# What a rank says is enough.
export OMPI_MCA_orte_execute_quiet=1
