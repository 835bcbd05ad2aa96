"""Retake the pictures of docs/pictures: the app itself, offscreen, driven by scripts.

python scripts/docs_pictures.py [NAME …]      all, or those named: editor gallery play …
"""

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PICTURES = ROOT / "docs" / "pictures"

Event = dict[str, object]


def shot(name: str) -> Event:
    """Return a picture of the window as it is now."""
    return {"do": "screenshot", "file": str(PICTURES / f"{name}.png")}


def click(widget: str) -> list[Event]:
    """Return a click on a widget."""
    return [{"do": "down", "widget": widget}, {"do": "up"}, {"do": "wait", "frames": 4}]


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
PLANNER: list[Event] = [
    ROVER,
    {"do": "agent", "dir": "planner", "slot": "a"},
    {"do": "wait_until", "what": "idle", "seconds": 600},
    {"do": "key", "key": "f6"},
    {"do": "wait_until", "what": "playing", "seconds": 600},
    {"do": "wait", "frames": 6},
    {"do": "move", "world": [0.2, 4.8]},
    {"do": "wait", "frames": 2},
    shot("planner"),
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
    *click("evaluate.s/goalkeeper.1"),
    {"do": "move", "world": [0.2, 4.8]},
    {"do": "wait", "frames": 40},
    shot("evaluate"),
]
WAYS: list[Event] = [
    {"do": "open", "file": "levels/s/parcel_drop.json"},
    {"do": "agent", "dir": "general", "slot": "a"},
    {"do": "action", "id": "level.evaluate"},
    {"do": "wait", "frames": 4},
    *click("evaluate.random"),
    *click("evaluate.run"),
    {"do": "wait_until", "what": "idle", "seconds": 1500},
    {"do": "wait", "frames": 4},
    *click("evaluate.s/parcel_drop.1"),
    *click("evaluate.ways"),
    {"do": "wait_until", "what": "idle", "seconds": 600},
    {"do": "move", "world": [0.2, 4.8]},
    {"do": "wait", "frames": 40},
    shot("ways"),
]
HEAT: list[Event] = [
    *GOALKEEPER,
    {"do": "agent", "dir": "general", "slot": "b"},
    {"do": "action", "id": "view.layout_evaluate"},
    {"do": "action", "id": "level.evaluate"},
    {"do": "wait", "frames": 8},
    *click("evaluate.source"),
    *click("evaluate.source.s"),
    *click("evaluate.noop"),
    *click("evaluate.random"),
    *click("evaluate.run"),
    {"do": "wait_until", "what": "idle", "seconds": 3000},
    {"do": "move", "world": [0.2, 4.8]},
    {"do": "wait", "frames": 60},
    shot("heat"),
]
WHY: list[Event] = [
    {"do": "open", "file": "levels/s/hang_on.json"},
    {"do": "agent", "dir": "general", "slot": "a"},
    {"do": "wait_until", "what": "idle", "seconds": 600},
    {"do": "key", "key": "f6"},
    {"do": "wait_until", "what": "playing", "seconds": 900},
    {"do": "wait", "frames": 40},
    {"do": "key", "key": "space"},
    {"do": "action", "id": "view.agents"},
    {"do": "wait", "frames": 10},
    *click("agents.overlay.attention"),
    *click("agents.overlay.saliency"),
    *click("agents.overlay.places"),
    {"do": "wait", "frames": 20},
    {"do": "wait_until", "what": "idle", "seconds": 900},
    {"do": "move", "world": [0.2, 4.8]},
    {"do": "wait", "frames": 30},
    shot("why"),
]
CURRICULUM_RUN = (
    "train accel --preset small --size s --num-train-envs 32 --outer-rollout-steps 1 "
    "--level-buffer-capacity 128 --total-timesteps 60000 --out"
)
"""A short curriculum, so that there are levels to see."""


def curriculum(run_folder: Path) -> list[Event]:
    """Return the picture of the levels that a curriculum keeps."""
    return [
        {"do": "open", "file": "levels/s/hang_on.json"},
        {"do": "agent", "dir": str(run_folder), "slot": "a"},
        {"do": "action", "id": "view.layout_evaluate"},
        {"do": "action", "id": "view.curriculum"},
        {"do": "wait", "frames": 150},
        {"do": "wait_until", "what": "idle", "seconds": 400},
        {"do": "wait", "frames": 200},
        {"do": "move", "widget": "curriculum.level.2"},
        {"do": "wait", "frames": 40},
        shot("curriculum"),
    ]


SEEDS = 3
"""Runs of one recipe whose curves are drawn beside each other."""
SEVERAL = (
    "train ppo --preset small --levels s/goalkeeper --total-timesteps 150000 "
    f"--seeds {SEEDS} --eval-freq 2 --out"
)


def seeds(run_folder: Path) -> list[Event]:
    """Return the picture of runs of one recipe under several seeds."""
    beside: list[Event] = []
    for seed in range(1, SEEDS):
        typed: Event = {"do": "text", "text": str(run_folder / f"seed_{seed}")}
        beside += [*click("training.beside"), typed, {"do": "key", "key": "return"}]
        beside += [{"do": "wait", "frames": 4}, *click("browser.accept")]
    return [
        {"do": "open", "file": "levels/s/goalkeeper.json"},
        {"do": "agent", "dir": str(run_folder / "seed_0"), "slot": "a"},
        {"do": "action", "id": "view.layout_evaluate"},
        {"do": "action", "id": "view.training"},
        {"do": "wait", "frames": 150},
        *beside,
        {"do": "wait_until", "what": "idle", "seconds": 400},
        {"do": "move", "world": [0.2, 4.8]},
        {"do": "wait", "frames": 200},
        shot("seeds"),
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


def trained(words: str, events: Callable[[Path], list[Event]]) -> None:
    """Train a little, and picture the run."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / words.split()[1]
        subprocess.run([sys.executable, "-m", "kinetix", *words.split(), str(out)], check=True)
        run(events(out), "--size", "1440x900")


def page() -> None:
    """Picture an episode's page in a browser, where there is one.

    Raises:
        CalledProcessError: The browser or the command failed.
    """
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        sys.stderr.write("page: left out: no Chromium is installed\n")
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "goal.html"
        words = ["render", "s/goalkeeper", str(path), "--agent", "goalkeeper", "--rival", "random"]
        subprocess.run([sys.executable, "-m", "kinetix", *words], cwd=ROOT, check=True)
        options = ("--headless", "--no-sandbox", "--disable-gpu", "--window-size=1100,1000")
        picture = f"--screenshot={PICTURES / 'page.png'}"
        profile = f"--user-data-dir={folder}/profile"
        # Some time of the page's own clock, so that the episode is under way.
        words = [browser, *options, profile, "--virtual-time-budget=900", picture, path.as_uri()]
        subprocess.run(words, check=True, capture_output=True)


SCRIPTS: dict[str, list[Event]] = {
    "editor": EDITOR,
    "gallery": GALLERY,
    "play": PLAY,
    "beside": BESIDE,
    "watch": WATCH,
    "planner": PLANNER,
    "compare": COMPARE,
    "evaluate": EVALUATE,
    "ways": WAYS,
    "heat": HEAT,
    "why": WHY,
}
OTHERS: dict[str, Callable[[], None]] = {
    "page": page,
    "seeds": lambda: trained(SEVERAL, seeds),
    "curriculum": lambda: trained(CURRICULUM_RUN, curriculum),
}


def main() -> None:
    """Take all pictures, or those that are named, and name the files."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    known = [*SCRIPTS, *OTHERS]
    wanted = sys.argv[1:] or known
    if unknown := [name for name in wanted if name not in known]:
        sys.exit(f"screenshots: no {', '.join(unknown)}; there are {', '.join(known)}")
    for name in wanted:
        if name in SCRIPTS:
            run(SCRIPTS[name], "--size", "1440x900")
        else:
            OTHERS[name]()
    for path in sorted(PICTURES.glob("*.png")):
        sys.stdout.write(f"{path.relative_to(ROOT)}\n")


if __name__ == "__main__":
    main()
