#!/usr/bin/env bash
# Makes everything ready that the Makefile's targets need: the system's OpenGL libraries and the
# virtual environment .venv. A second run only compares a stamp.
#
# Usage: scripts/setup.sh run|test        PYTHON=python3.13 picks the interpreter.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly purpose="${1:-run}"
readonly venv=".venv"
readonly stamp="$venv/.kinetix-setup"

say() { printf 'setup: %s\n' "$*" >&2; }

# --- system packages ---------------------------------------------------------------------------

wanted_packages() {
  # The tests need the editor's packages and their own.
  awk -v purpose="$purpose" '
    /^# run:/  { wanted = 1; next }
    /^# test:/ { wanted = (purpose == "test"); next }
    /^[a-z0-9]/ && wanted { print $1 }' scripts/system-packages.txt
}

missing_packages() {
  local package
  for package in "$@"; do
    [[ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" == installed ]] ||
      printf '%s ' "$package"
  done
}

install_packages() {
  local -a as_root=()
  if [[ "$(id -u)" != 0 ]]; then
    command -v sudo >/dev/null && sudo -n true 2>/dev/null || return 1
    as_root=(sudo -n)
  fi
  say "installing the system packages $*"
  { "${as_root[@]}" apt-get update -qq &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get install -y -qq --no-install-recommends "$@"; } </dev/null >/dev/null 2>&1
}

ensure_packages() {
  local missing
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    # Another system: the names differ, so look for the library itself.
    [[ "$(uname)" != Linux ]] || ldconfig -p 2>/dev/null | grep -q 'libEGL\.so\.1' ||
      say "OpenGL is missing; install what your system calls: $(wanted_packages | tr '\n' ' ')"
    return 0
  fi
  missing="$(missing_packages "$@")"
  # shellcheck disable=SC2086  # a list of words
  [[ -z "$missing" ]] || install_packages $missing ||
    say "please run: sudo apt-get install ${missing% }"
}

# --- the virtual environment -------------------------------------------------------------------

is_supported() {
  "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' >/dev/null 2>&1
}

find_python() {
  local candidate
  local -a candidates=(python3 python3.13 python3.12 python3.11 python3.14)
  [[ -z "${PYTHON:-}" ]] || candidates=("$PYTHON")
  for candidate in "${candidates[@]}"; do
    if is_supported "$candidate"; then printf '%s' "$candidate"; return; fi
    # A shim of pyenv refuses versions that are installed but not selected.
    for candidate in "${PYENV_ROOT:-$HOME/.pyenv}"/versions/*/bin/"$candidate"; do
      if is_supported "$candidate"; then printf '%s' "$candidate"; return; fi
    done
  done
  return 1
}

version_of() { "$1" -c 'import sys; print(*sys.version_info[:3], sep=".")' 2>/dev/null; }

ensure_venv() {
  local python
  if [[ -z "${PYTHON:-}" ]] && is_supported "$venv/bin/python"; then
    return
  fi
  if ! python="$(find_python)"; then
    # A machine without any Python: the system's own may be new enough.
    [[ -z "${PYTHON:-}" ]] && ensure_packages python3 python3-venv && python="$(find_python)" || {
      say "Python 3.11 to 3.14 is needed${PYTHON:+, and PYTHON=$PYTHON is none of them}"
      return 1
    }
  fi
  if [[ "$(version_of "$venv/bin/python")" == "$(version_of "$python")" ]]; then
    return
  fi
  # Debian's Python comes without what makes virtual environments.
  "$python" -c 'import ensurepip' 2>/dev/null || ensure_packages python3-venv
  say "making $venv with Python $(version_of "$python")"
  rm -rf "$venv"
  "$python" -m venv "$venv"
}

fingerprint() {
  # What decides whether the installed packages are still right; the folder, because the
  # installation is editable and points at it.
  { pwd; cat pyproject.toml scripts/setup.sh; } | cksum
}

ensure_dependencies() {
  if [[ "$(cat "$stamp" 2>/dev/null)" == "$(fingerprint)" ]]; then
    return
  fi
  say "installing the Python packages into $venv (minutes the first time)"
  "$venv/bin/python" -m pip install -q --disable-pip-version-check -e '.[dev]'
  fingerprint >"$stamp"
}

packages=()
while read -r package; do packages+=("$package"); done < <(wanted_packages)  # macOS's bash has no mapfile
ensure_packages "${packages[@]}"
ensure_venv
ensure_dependencies
