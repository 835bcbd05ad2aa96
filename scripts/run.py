"""Open the editor; without a display film a tour of it, or serve it: what `make run` does."""

import subprocess
import sys
from pathlib import Path

from editor.hosts.display import has_display

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "out"
TOUR = ROOT / "editor" / "assets" / "tour.jsonl"
EDITOR = [sys.executable, "-m", "editor"]
WITHOUT_DISPLAY = {"--serve", "--offscreen", "--bench", "--help", "-h"}
"""Options with which the editor needs none."""


def film() -> int:
    """Run the tour offscreen and tell which pictures it made."""
    print(
        "There is no display: filming a tour of the editor instead (about a minute) …\n"
        "To use the editor itself, in a browser here or on the other end of ssh:\n"
        "    make run ARGS=--serve",
        flush=True,
    )
    OUT.mkdir(exist_ok=True)
    for old in (*OUT.glob("tour*.png"), *OUT.glob("tour*.gif")):
        old.unlink()
    status = subprocess.call([*EDITOR, "--offscreen", "--replay", str(TOUR)], cwd=ROOT)
    for path in sorted((*OUT.glob("tour*.png"), *OUT.glob("tour*.gif"))):
        print(path)
    return status


def main() -> int:
    """Do what the command line says, or film the tour."""
    if has_display() or WITHOUT_DISPLAY & {*sys.argv[1:]}:
        return subprocess.call([*EDITOR, *sys.argv[1:]], cwd=ROOT)
    return film()


if __name__ == "__main__":
    raise SystemExit(main())
