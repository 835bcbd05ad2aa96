"""Readers of the editor: settings, autosaves, scripts, episodes, the clipboard, the gallery."""

import dataclasses
import functools
import io
import json
import os
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from kinetix.level.codec import dumps, load_level, loads
from tests.attack.clock import PATIENCE
from tests.attack.levels import check_level, native_levels
from tests.attack.mutate import Mutator


def settings() -> tuple[bytes, ...]:
    from editor.base.settings import Settings

    kept = dataclasses.asdict(Settings()) | {
        "recents": ["/a/b.json"],
        "layouts": {"mine": "[Window][x]"},
        "keys": {"tool.circle": ["o"]},
        "controls": {"a": [0, 1]},
        "gallery_folders": ["/a"],
    }
    results = {"0" * 64: {"you": [3, 1], "x": [2, 2]}}
    names = {"/a/b.json": {"1": "wheel", "2": "arm"}}
    level_set = {"levels": {"/a/b.json": 2.5, "/a/c.json": 1}}
    return tuple(json.dumps(tree).encode() for tree in (kept, results, names, level_set))


def read_settings(data: bytes, folder: Path) -> None:
    from editor.base.settings import Settings
    from editor.documents.old_names import OldNames
    from editor.gallery.kept_set import WEIGHTS, KeptSet
    from editor.gallery.results import Results

    path = folder / "kept.json"
    path.write_bytes(data)
    settings = Settings.load(path)
    assert 0.0 <= settings.ui_scale <= 4.0
    assert 0.5 <= settings.text_scale <= 2.0
    assert all(isinstance(name, str) for name in settings.recents)
    assert isinstance(Results(path).players, tuple)
    assert all(isinstance(name, str) for name in OldNames(path).of(Path("/a/b.json")).values())
    low, high = WEIGHTS
    assert all(low <= weight <= high for weight in KeptSet(path).read().values())
    settings.save(folder / "again.json")


def autosaves() -> tuple[bytes, ...]:
    record = {"path": "/a/b.json", "format": "kinetix-level", "time": "2026-11-22T10:00:00+00:00"}
    record |= {"base": "0" * 64, "origin": ["RUNS/older/1.json", "PLACE/precious.json"]}
    return tuple(
        json.dumps(record | {"level": level.decode()}).encode() for level in native_levels()[:3]
    )


def read_autosave(data: bytes, folder: Path) -> None:
    """Copies that earlier runs left: read, told about, and never a way to remove other files."""
    from editor.documents import recovery

    runs, precious = folder / "autosave", folder / "precious.json"
    copy = runs / "older" / "1.json"
    copy.parent.mkdir(parents=True)
    precious.write_text("mine")
    places = (b"RUNS", str(runs).encode()), (b"PLACE", str(folder).encode())
    for word, place in places:
        data = data.replace(word, place)
    copy.write_bytes(data)
    found = recovery.find(runs)
    assert copy.is_file() or not found.unreadable
    for one in found.recoveries:
        one.summary()
        recovery.discard(one)
    assert precious.read_text() == "mine"


@functools.cache
def scripts() -> tuple[bytes, ...]:
    folder = Path(__file__).parents[1] / "editor" / "scripts"
    return tuple(path.read_bytes() for path in sorted(folder.glob("*.jsonl")))


def read_script(data: bytes, folder: Path) -> None:
    from kinetix.files.json_text import parse_strictly
    from kinetix.files.regular import read_text

    path = folder / "x.jsonl"
    path.write_bytes(data)
    for line in read_text(path, "script").splitlines():
        if line.strip():
            parse_strictly(line, "event")


@functools.cache
def traces() -> tuple[bytes, ...]:
    level = load_level("s/first_flight")
    steps, bodies = 5, len(level.bodies)
    rows: dict[str, Any] = {
        "position": (steps, bodies, 2),
        "velocity": (steps, bodies, 2),
        "angle": (steps, bodies),
        "angular_velocity": (steps, bodies),
        "motor": (steps, len(level.joints)),
        "thruster": (steps, len(level.thrusters)),
        "momentum": (steps, 2),
        "unified": (steps, 6),
        "intention": (steps, 6),
    }
    columns = ("reward", "total_reward", "distance", "kinetic_energy", "potential_energy")
    arrays = {name: np.zeros(shape, np.float32) for name, shape in rows.items()}
    arrays |= {name: np.zeros(steps, np.float32) for name in (*columns, "value", "entropy")}
    arrays |= {"step": np.arange(steps), "action": np.zeros((steps - 1, 6), np.int32)}
    texts = {"physics": "balanced", "player": "", "outcome": "won", "level": dumps(level)}
    scalars = {"perturbed": False, "seed": 0, "attempt": 0, "deterministic": False, "frame_skip": 2}
    arrays |= {name: np.array(value) for name, value in (texts | scalars).items()}
    packed, plain = io.BytesIO(), io.BytesIO()
    np.savez_compressed(packed, **arrays)
    np.savez(plain, **arrays)
    return packed.getvalue(), plain.getvalue()


def damaged_arrays(mutator: Mutator, sample: bytes) -> bytes:
    """Other types, shapes and numbers in an archive that is whole; or damage to its bytes."""
    random_ = mutator.random
    if random_.random() < 0.3:
        return mutator.damaged(sample)
    with np.load(io.BytesIO(sample)) as stored:
        arrays = {name: stored[name] for name in stored.files}
    name = random_.choice(list(arrays))
    array = arrays[name]
    match random_.randrange(7):
        case 0:
            del arrays[name]
        case 1:
            arrays[random_.choice(list(arrays))] = array
        case 2 if array.dtype.kind == "f":
            array = array.copy()
            array.flat[: random_.randrange(array.size + 1)] = random_.choice(
                (np.nan, np.inf, -np.inf, 1e30, -1e30, 1e-40)
            )
            arrays[name] = array
        case 3:
            arrays[name] = np.array(random_.choice((0, -1, 2**62, 1e300, np.nan, "x", True, b"x")))
        case 4:
            arrays[name] = array[None]
        case 5:
            arrays[name] = array[..., :0] if array.ndim else array[None][:0]
        case _:
            kind = random_.choice(("<f8", "<f2", "<i8", "<u1", "<c8", "<U3", "|S3"))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                arrays[name] = np.zeros(array.shape, kind)
    packed = io.BytesIO()
    np.savez(packed, **arrays)
    return packed.getvalue()


def read_trace(data: bytes, folder: Path) -> None:
    from editor.play.trace_files import read_trace, write_trace

    path = folder / "x.npz"
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # zipfile about names that stand twice
        found = read_trace(path)
    write_trace(found.trace, found.level, folder / "again.npz")


def read_page(data: bytes, folder: Path) -> None:
    """The page of an episode: nothing in a file can become a part of the page's own text."""
    from kinetix.pages.page import page_of
    from kinetix.pages.recorded import film_of_file

    path = folder / "x.npz"
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        page = page_of([film_of_file(path)])
    assert page.count("<script") == page.count("</script>") == _scripts_of_a_page()


@functools.cache
def _scripts_of_a_page() -> int:
    import importlib.resources

    player = importlib.resources.files("kinetix.pages").joinpath("player.html")
    return player.read_text(encoding="utf-8").count("<script")


@functools.cache
def clips() -> tuple[bytes, ...]:
    from editor.documents.commands import clip

    made = []
    for data in native_levels():
        level = loads(data.decode())
        copied = clip.copied(level, frozenset(body.id for body in level.bodies))
        if copied.bodies:
            made.append(clip.dumps(copied).encode())
    return tuple(made)


def read_clip(data: bytes, folder: Path) -> None:
    """Text of the clipboard: pasted, saved and opened again."""
    from editor.documents.commands import clip

    found = clip.loads(data.decode("utf-8", errors="surrogateescape"))
    level = load_level("s/first_flight").replace(size=None)
    pasted = clip.Paste(clip=found, shift=clip.shift_to(found, (2.5, 2.5))).apply(level)
    check_level(loads(dumps(pasted)))


def gallery() -> tuple[bytes, ...]:
    """The gallery's index and a thumbnail, each with its name in the first line."""
    return _gallery()


@functools.cache
def _gallery() -> tuple[bytes, ...]:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        _look(folder)
        files = [path for path in sorted((folder / "gallery").rglob("*")) if path.is_file()]
        return tuple(f"{p.relative_to(folder)}\n".encode() + p.read_bytes() for p in files)


def _look(folder: Path) -> None:
    """Look through a folder of two levels as the gallery does."""
    from editor.gallery.library import Library

    levels = folder / "levels"
    levels.mkdir(exist_ok=True)
    for k, data in enumerate(native_levels()[:2]):
        (levels / f"{k}.json").write_bytes(data)
        os.utime(levels / f"{k}.json", (1, 1))
    library = Library(folder)
    try:
        library.look((levels,))
        assert library.wait(PATIENCE), "the gallery's thread is dead"
        assert len(library.cards) == 2
        library.want(library.cards)
        assert library.wait(PATIENCE), "the gallery's thread is dead"
    finally:
        library.stop()


def read_gallery(data: bytes, folder: Path) -> None:
    """Damage the gallery's files and look whether its levels are shown as before."""
    for kept in (*_gallery(), data):
        name, _, content = kept.partition(b"\n")
        if name not in [one.partition(b"\n")[0] for one in _gallery()]:
            name = b"gallery/index.json"
        path = folder / name.decode()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    _look(folder)
