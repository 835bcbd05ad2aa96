"""Take the pictures of docs/pictures anew: the app itself, offscreen, driven by scripts."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PICTURES = ROOT / "docs" / "pictures"

Event = dict[str, object]


def shot(name: str) -> Event:
    """A picture of the window as it is now."""
    return {"do": "screenshot", "file": str(PICTURES / f"{name}.png")}


ROVER: Event = {"do": "open", "file": "levels/l/rover_ridge.json"}
EDITOR: list[Event] = [
    ROVER,
    {"do": "move", "world": [4.75, 1.2]},
    {"do": "down"},
    {"do": "up"},
    {"do": "wait", "frames": 10},
    shot("editor"),
    {"do": "action", "id": "edit.select_all"},
    shot("selection"),
    {"do": "action", "id": "app.help"},
    shot("help"),
    {"do": "key", "key": "escape"},
    {"do": "action", "id": "app.palette"},
    {"do": "wait", "frames": 3},
    {"do": "text", "text": "mirror"},
    shot("palette"),
    {"do": "key", "key": "escape"},
    {"do": "action", "id": "file.open"},
    {"do": "wait", "frames": 4},
    {"do": "down", "widget": "browser.clockwork.json"},
    {"do": "up"},
    {"do": "wait", "frames": 4},
    shot("open"),
    {"do": "key", "key": "escape"},
    {"do": "action", "id": "file.new"},
    {"do": "wait", "frames": 4},
    shot("empty"),
]
GALLERY: list[Event] = [
    ROVER,
    {"do": "action", "id": "level.gallery"},
    {"do": "wait_until", "what": "idle", "seconds": 120},
    {"do": "wait", "frames": 60},
    {"do": "down", "widget": "gallery.card.clockwork"},
    {"do": "up"},
    {"do": "wait", "frames": 6},
    shot("gallery"),
    {"do": "key", "key": "a", "mods": ["ctrl"]},
    {"do": "key", "key": "a", "mods": ["ctrl", "shift"]},
    {"do": "down", "widget": "gallery.tab.set"},
    {"do": "up"},
    {"do": "down", "widget": "gallery.export"},
    {"do": "up"},
    {"do": "wait", "frames": 6},
    shot("level_set"),
    {"do": "key", "key": "escape"},
    {"do": "key", "key": "escape"},
    {"do": "action", "id": "app.keys"},
    {"do": "wait", "frames": 4},
    {"do": "down", "widget": "keys.file.open"},
    {"do": "up"},
    {"do": "key", "key": "d", "mods": ["ctrl"]},
    {"do": "wait", "frames": 4},
    shot("keys"),
]
BESIDE: list[Event] = [
    {"do": "open", "file": "levels/s/goalkeeper.json"},
    {"do": "action", "id": "run.compare_physics"},
    {"do": "wait", "frames": 4},
    {"do": "down", "widget": "list.jax2d"},
    {"do": "up"},
    {"do": "key", "key": "space"},
    {"do": "wait_until", "what": "playing", "seconds": 400},
    {"do": "key", "key": "space"},
    {"do": "wait_until", "what": "idle", "seconds": 400},
    {"do": "key", "key": "space"},
    {"do": "hold", "key": "right", "frames": 44},
    {"do": "key", "key": "space"},
    {"do": "wait_until", "what": "idle", "seconds": 60},
    {"do": "wait", "frames": 10},
    shot("beside"),
]
PLAY: list[Event] = [
    ROVER,
    {"do": "key", "key": "space"},
    {"do": "wait_until", "what": "playing", "seconds": 400},
    {"do": "action", "id": "app.palette"},
    {"do": "wait", "frames": 3},
    {"do": "text", "text": "debug drawing: trails"},
    {"do": "key", "key": "return"},
    {"do": "hold", "key": "right", "frames": 30},
    {"do": "key", "key": "space"},
    {"do": "wait", "frames": 3},
    shot("play"),
]


GOALKEEPER: list[Event] = [
    {"do": "open", "file": "levels/s/goalkeeper.json"},
    {"do": "agent", "dir": "checkpoints/goalkeeper", "slot": "a"},
]
WATCH: list[Event] = [
    *GOALKEEPER,
    {"do": "wait_until", "what": "idle", "seconds": 400},
    {"do": "action", "id": "view.agents"},
    {"do": "key", "key": "f6"},
    {"do": "wait_until", "what": "playing", "seconds": 400},
    {"do": "action", "id": "view.timeline"},
    {"do": "wait_until", "what": "ended", "seconds": 60},
    {"do": "down", "widget": "timeline.track"},
    {"do": "up"},
    {"do": "move", "world": [1.0, 4.0]},
    {"do": "wait", "frames": 8},
    shot("watch"),
]
COMPARE: list[Event] = [
    *GOALKEEPER,
    {"do": "agent", "dir": "random", "slot": "b"},
    {"do": "wait_until", "what": "idle", "seconds": 400},
    {"do": "action", "id": "agent.compare_side"},
    {"do": "key", "key": "f6"},
    {"do": "wait_until", "what": "playing", "seconds": 400},
    {"do": "action", "id": "view.eye"},
    {"do": "action", "id": "view.plots"},
    {"do": "wait_until", "what": "ended", "seconds": 60},
    {"do": "wait_until", "what": "idle", "seconds": 400},
    {"do": "wait", "frames": 8},
    {"do": "action", "id": "run.step_back"},
    {"do": "wait_until", "what": "idle", "seconds": 60},
    {"do": "wait", "frames": 400},
    shot("compare"),
]
EVALUATE: list[Event] = [
    *GOALKEEPER,
    {"do": "action", "id": "level.evaluate"},
    {"do": "wait", "frames": 4},
    {"do": "down", "widget": "evaluate.random"},
    {"do": "up"},
    {"do": "wait", "frames": 2},
    {"do": "down", "widget": "evaluate.run"},
    {"do": "up"},
    {"do": "wait_until", "what": "idle", "seconds": 1500},
    {"do": "wait", "frames": 4},
    {"do": "down", "widget": "evaluate.s/goalkeeper.1"},
    {"do": "up"},
    {"do": "wait", "frames": 8},
    shot("evaluate"),
]
TRAINING = "train ppo --preset small --levels s/goalkeeper --total-timesteps 150000 --out"
"""A short training, so that there is one to watch."""


def training(run_folder: Path) -> list[Event]:
    """The picture of a run that is watched."""
    return [
        {"do": "open", "file": "levels/s/goalkeeper.json"},
        {"do": "agent", "dir": str(run_folder), "slot": "a"},
        {"do": "action", "id": "view.agents"},
        {"do": "action", "id": "view.training"},
        {"do": "wait", "frames": 150},
        {"do": "wait_until", "what": "idle", "seconds": 400},
        {"do": "wait", "frames": 330},
        shot("training"),
    ]


def run(events: list[Event], *options: str) -> None:
    """Run one script through the app.

    Raises:
        CalledProcessError: The app could not do it.
    """
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "events.jsonl"
        script.write_text("\n".join(json.dumps(event) for event in events))
        command = [sys.executable, "-m", "editor", "--offscreen", *options, "--replay", str(script)]
        subprocess.run(command, cwd=ROOT, check=True)


def main() -> None:
    """Take all pictures and name them."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    run(EDITOR, "--size", "1440x900")
    run(GALLERY, "--size", "1440x900")
    run(PLAY, "--size", "1440x900")
    run(BESIDE, "--size", "1440x900")
    for events in (WATCH, COMPARE, EVALUATE):
        run(events, "--size", "1440x900")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "goalkeeper"
        command = [sys.executable, "-m", "kinetix", *TRAINING.split(), str(out)]
        subprocess.run(command, cwd=ROOT, check=True)
        run(training(out), "--size", "1440x900")
    for path in sorted(PICTURES.glob("*.png")):
        sys.stdout.write(f"{path.relative_to(ROOT)}\n")


if __name__ == "__main__":
    main()
