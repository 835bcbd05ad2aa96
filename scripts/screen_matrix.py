"""Show the app in every size, scale and theme: pictures and contact sheets in `out/screens`.

python -m scripts.screen_matrix [--only 1024x640] [--language de] [--no-play]
"""

import argparse
import itertools
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Final

from PIL import Image, ImageDraw

from editor.__main__ import end
from editor.base.language import spoken
from editor.base.settings import Settings
from editor.hosts.offscreen import OffscreenHost
from editor.hosts.replay import Replayer
from editor.session import Session

OUT: Final = Path(__file__).resolve().parents[1] / "out" / "screens"
SIZES: Final = ((1024, 640), (1440, 900), (2560, 1440))
SCALES: Final = (1.0, 1.5, 2.0)
THEMES: Final = ("dark", "light")
COLUMNS: Final = 3
TILE: Final = 960
"""Width of a picture on a contact sheet [px]."""

Event = dict[str, object]
Shots = list[Event | str]
"""Events, and between them names of pictures."""


def click(widget: str) -> Shots:
    """Return a click on a widget."""
    return [{"do": "down", "widget": widget}, {"do": "up"}, {"do": "wait", "frames": 4}]


def action(name: str, frames: int = 6) -> Shots:
    """Return an action, and time for its panel to come."""
    return [{"do": "action", "id": name}, {"do": "wait", "frames": frames}]


ESCAPE: Final[Event] = {"do": "key", "key": "escape"}
EDIT: Final[Shots] = [
    {"do": "open", "file": "l/rover_ridge"},
    {"do": "wait", "frames": 6},
    {"do": "down", "world": [4.75, 1.2]},
    {"do": "up"},
    {"do": "wait", "frames": 6},
    "edit",
    {"do": "down", "world": [4.75, 1.2], "button": 3},
    {"do": "up", "button": 3},
    {"do": "wait", "frames": 4},
    "context",
    ESCAPE,
    *click("menu.view"),
    "menu",
    ESCAPE,
    *action("app.palette"),
    {"do": "text", "text": "gravity"},
    "palette",
    ESCAPE,
    *action("app.help"),
    "help",
    ESCAPE,
    *action("app.preferences"),
    "preferences",
    *action("app.preferences"),
    *action("file.open"),
    "open",
    ESCAPE,
    *action("level.gallery"),
    {"do": "wait_until", "what": "idle", "seconds": 300},
    {"do": "wait", "frames": 30},
    "gallery",
    ESCAPE,
    *action("view.debug_draw"),
    "debug",
]
PLAY: Final[Shots] = [
    {"do": "open", "file": "s/goalkeeper"},
    {"do": "agent", "dir": "goalkeeper", "slot": "a"},
    {"do": "wait_until", "what": "idle", "seconds": 600},
    {"do": "key", "key": "space"},
    {"do": "wait_until", "what": "playing", "seconds": 600},
    {"do": "hold", "key": "right", "frames": 20},
    "play",
    ESCAPE,
    {"do": "key", "key": "f6"},
    {"do": "wait_until", "what": "playing", "seconds": 600},
    {"do": "wait_until", "what": "ended", "seconds": 60},
    {"do": "wait", "frames": 40},
    "won",
    *action("view.agents"),
    *action("view.timeline"),
    {"do": "wait", "frames": 30},
    "watch",
    ESCAPE,
    {"do": "wait", "frames": 4},
    *action("level.evaluate"),
    {"do": "wait", "frames": 6},
    "evaluate",
]


def take(
    size: tuple[int, int], scale: float, shots: Shots, folder: Path, **settings: object
) -> list[Path]:
    """Run a script in a window of its own.

    Args:
        size: Of the window [px].
        scale: Of the interface.
        shots: What to do and to picture.
        folder: Where the pictures go.
        settings: Fields of the settings besides.

    Returns:
        The pictures.
    """
    folder.mkdir(parents=True, exist_ok=True)
    pictures = [folder / f"{each}.png" for each in shots if isinstance(each, str)]
    lines = [
        {"do": "screenshot", "file": str(folder / f"{each}.png")} if isinstance(each, str) else each
        for each in shots
    ]
    session = Session(settings=Settings(**settings))  # pyright: ignore[reportArgumentType]
    host = OffscreenHost(session, size=size, scale=scale)
    try:
        with tempfile.TemporaryDirectory() as temporary:
            script = Path(temporary) / "events.jsonl"
            script.write_text("\n".join(map(json.dumps, lines)))
            Replayer(host, script).run()
    finally:
        for worker in (session.worker, session.evaluator, session.library):
            worker.stop()
        host.close()
    return pictures


def sheet(pictures: list[Path], path: Path) -> None:
    """Put pictures of one window side by side, each under its name."""
    images = []
    for each in pictures:
        with Image.open(each) as image:
            shrink = min(TILE / image.width, 1.0)
            images.append(image.convert("RGB").resize([round(n * shrink) for n in image.size]))
    width, height = images[0].width + 8, images[0].height + 26
    rows = -(-len(images) // COLUMNS)
    made = Image.new("RGB", (COLUMNS * width, rows * height), "white")
    pen = ImageDraw.Draw(made)
    for index, (image, source) in enumerate(zip(images, pictures, strict=True)):
        x, y = index % COLUMNS * width, index // COLUMNS * height
        pen.text((x + 4, y + 3), source.stem, fill="black", font_size=16)
        made.paste(image, (x + 4, y + 24))
    made.save(path)
    sys.stdout.write(f"{path}\n")


def main() -> None:
    """Take all pictures."""
    parser = argparse.ArgumentParser(description="Picture the app in every size, scale and theme.")
    parser.add_argument("--only", default="", help="a part of the names, such as 1024x640 or light")
    parser.add_argument("--language", default="en", help="of the interface, such as de")
    parser.add_argument("--no-play", action="store_true", help="leave out what is simulated")
    asked = parser.parse_args()
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    for name in ("XDG_STATE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_DOCUMENTS_DIR"):
        os.environ[name] = tempfile.mkdtemp()
    missing: set[str] = set()
    for size, scale, theme in itertools.product(SIZES, SCALES, THEMES):
        name = f"{size[0]}x{size[1]}_{scale:g}_{theme}_{asked.language}"
        if asked.only not in name:
            continue
        looks = {"theme": theme, "language": asked.language}
        pictures = take(size, scale, EDIT, OUT / name, **looks)
        if not asked.no_play:
            pictures += take(size, scale, PLAY, OUT / name, **looks)
        sheet(pictures, OUT / f"{name}.png")
        language = spoken()
        missing |= language.missing if language is not None else set()
    for words in sorted(missing):
        sys.stdout.write(f"not in {asked.language}: {words}\n")
    end(0)


if __name__ == "__main__":
    main()
