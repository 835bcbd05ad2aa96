#!/usr/bin/env bash
# Puts every peer into a virtual environment of its own below .bench-envs, where nothing of ours is.
# A second run only compares a stamp. What cannot be installed is said and left out.
#
# Usage: scripts/peers/install.sh [PEER …]        PYTHON=python3.11 picks the interpreter.
set -uo pipefail
cd "$(dirname "$0")/../.."

readonly folder=".bench-envs"
readonly python="${PYTHON:-.venv/bin/python}"

# jax 0.10.2 hangs now and then in MJX's steps of many worlds on processors; 0.9.0 does not.
requirements() {
  case "$1" in
    jax2d) echo "jax2d==1.0.1 kinetix-env==3.0.2" ;;
    box2d) echo "box2d==2.3.10 numpy" ;;
    pymunk) echo "pymunk==7.3.1 numpy" ;;
    mujoco) echo "mujoco==3.17.0 numpy" ;;
    mjx) echo "mujoco-mjx==3.17.0 mujoco==3.17.0 jax==0.9.0" ;;
    brax) echo "brax==0.14.2 mujoco-mjx==3.17.0 mujoco==3.17.0 jax==0.9.0" ;;
    *) return 1 ;;
  esac
}

install() {
  local peer="$1" wanted
  if ! wanted="$(requirements "$peer")"; then
    echo "peers: there is none called $peer" >&2
    return 1
  fi
  local venv="$folder/$peer"
  if [[ "$(cat "$venv/.installed" 2>/dev/null)" == "$wanted" ]]; then return; fi
  echo "peers: installing $wanted" >&2
  rm -rf "$venv"
  # shellcheck disable=SC2086  # a list of words
  if "$python" -m venv "$venv" &&
    "$venv/bin/python" -m pip install -q --disable-pip-version-check $wanted >&2; then
    echo "$wanted" >"$venv/.installed"
  else
    rm -rf "$venv"
    echo "peers: $peer could not be installed and is left out" >&2
  fi
}

mkdir -p "$folder"
[[ $# -gt 0 ]] || set -- jax2d box2d pymunk mujoco mjx brax
for peer in "$@"; do install "$peer" || exit 1; done
