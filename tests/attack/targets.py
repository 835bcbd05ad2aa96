"""Who reads files of others: one row a reader, with samples to damage and what must hold after."""

import dataclasses
import functools
import io
import json
import random
import shutil
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np

from kinetix.errors import LevelError
from kinetix.level.codec import dumps, level_hash, load_document, load_level, loads
from kinetix.level.json_schema import level_schema
from kinetix.level.kinetix_env_export import from_level
from kinetix.level.model import Level
from kinetix.level.sets import build_set, dumps_set, gather_levels, is_set_file, load_set
from kinetix.level.sizes import capacity_of
from kinetix.level.validate import validate
from kinetix.paths import checkpoints_dir, levels_dir
from tests.attack.mutate import Mutator

FIXTURES = Path(__file__).parents[1] / "level" / "fixtures"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Target:
    """A reader."""

    samples: Callable[[], tuple[bytes, ...]]
    """Good content, to be damaged."""
    read: Callable[[bytes, Path], object]
    """Reads damaged content by way of a folder of its own; raises only `KinetixError`."""
    damage: Callable[[Mutator, bytes], bytes] = Mutator.damaged
    """Does the damage."""
    weight: int = 100
    """How often it is attacked, compared with others; slow readers get less."""


@functools.cache
def native_levels() -> tuple[bytes, ...]:
    """Levels with every feature, and some of the bundled ones."""
    files = [*sorted((FIXTURES / "v1").glob("*.json")), *sorted(levels_dir().glob("[sm]/*.json"))]
    return tuple(path.read_bytes() for path in files[:24])


@functools.cache
def kinetix_env_levels() -> tuple[bytes, ...]:
    """The same in kinetix-env's form, and files with gaps and the other forms of arrays."""
    own = [path.read_bytes() for path in sorted((FIXTURES / "kinetix_env").glob("*.json"))]
    made = [from_level(load_level(name))[0].encode() for name in ("s/first_flight", "s/goalkeeper")]
    return (*own, *made)


@functools.cache
def level_sets() -> tuple[bytes, ...]:
    """A set that carries its levels, and one that names files beside it."""
    levels = gather_levels([levels_dir() / "s"])[:3]
    inline = build_set(
        [dataclasses.replace(each, path=None) for each in levels], name="x", folder=Path("/")
    )
    entry = {"path": "a.json", "sha256": levels[0].sha256, "tags": [], "weight": 1.0}
    named = {"format": "kinetix-levelset", "version": 1, "name": "x", "size": "s"}
    return (
        dumps_set(inline, inline=True).encode(),
        json.dumps(named | {"levels": [entry | {"split": "train"}]}).encode(),
    )


def _check_level(level: Level) -> None:
    """What holds of every level that a reader lets through."""
    text = dumps(level)
    assert loads(text) == level
    assert dumps(loads(text)) == text
    validate(level)
    level_hash(level)
    capacity_of(level)
    if level.solution is not None:
        assert sum(1 for _ in level.solution.unrolled()) == level.solution.steps <= 100_000


def _read_level(data: bytes, folder: Path) -> None:
    path = folder / "x.json"
    path.write_bytes(data)
    loaded = load_document(path)
    _check_level(loaded.level)
    if loaded.format == "kinetix-env":
        assert dumps(loaded.level, format="kinetix-env", source=loaded.source).encode() == data


SCHEMA_CANNOT_SAY = frozenset({"E003", "E008", "E009", "E010", "E011", "E012", "E013"})
"""What ties several values together, or is about other versions."""
_NOR_THESE = ("$.tags", "$.solution.actions")


@functools.cache
def _schema() -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(level_schema())


def _agree(data: bytes, folder: Path) -> None:
    """The JSON Schema, read by a program of others, says the same as our reader."""
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError):
        return
    if json.loads(data, object_pairs_hook=list) != json.loads(
        data, object_pairs_hook=lambda pairs: list(dict(pairs).items())
    ) or any(mark in data for mark in (b"NaN", b"Infinity")):
        return  # a key that stands twice, numbers that JSON does not have
    said = _schema().is_valid(tree)
    try:
        loads(data, "x")
    except LevelError as error:
        codes = {fault.code for fault in error.faults}
        beyond = codes <= SCHEMA_CANNOT_SAY or all(
            fault.code in SCHEMA_CANNOT_SAY
            or fault.path.startswith(_NOR_THESE)
            or "nested" in fault.message
            or "surrogate" in fault.message
            or "finite 32-bit" in fault.message
            or "digits" in fault.message
            or fault.message.startswith("expected a whole number")  # 1.0 is an integer to a schema
            for fault in error.faults
        )
        assert not said or beyond, f"only the schema accepts: {error}"
    else:
        assert said, "only the reader accepts"


def _read_set(data: bytes, folder: Path) -> None:
    path = folder / "set.json"
    path.write_bytes(data)
    (folder / "a.json").write_bytes((levels_dir() / "s" / "circus_act.json").read_bytes())
    is_set_file(path)
    loaded = load_set(path)
    for each in loaded.levels:
        _check_level(each.level)
        assert each.path is None or each.path.resolve().is_relative_to(folder.parent.resolve())


def _settings() -> tuple[bytes, ...]:
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
    return tuple(json.dumps(tree).encode() for tree in (kept, results, names))


def _read_settings(data: bytes, folder: Path) -> None:
    from editor.base.settings import Settings
    from editor.documents.old_names import OldNames
    from editor.gallery.results import Results

    path = folder / "kept.json"
    path.write_bytes(data)
    settings = Settings.load(path)
    assert 0.0 <= settings.ui_scale <= 4.0
    assert 0.5 <= settings.text_scale <= 2.0
    assert all(isinstance(name, str) for name in settings.recents)
    assert isinstance(Results(path).players, tuple)
    assert all(isinstance(name, str) for name in OldNames(path).of(Path("/a/b.json")).values())
    settings.save(folder / "again.json")


def _autosaves() -> tuple[bytes, ...]:
    record = {"path": "/a/b.json", "format": "kinetix-level", "time": "2026-11-22T10:00:00+00:00"}
    record |= {"base": "0" * 64, "origin": ["RUNS/older/1.json", "PLACE/precious.json"]}
    return tuple(
        json.dumps(record | {"level": level.decode()}).encode() for level in native_levels()[:3]
    )


def _read_autosave(data: bytes, folder: Path) -> None:
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
def _scripts() -> tuple[bytes, ...]:
    folder = Path(__file__).parents[1] / "editor" / "scripts"
    return tuple(path.read_bytes() for path in sorted(folder.glob("*.jsonl")))


def _read_script(data: bytes, folder: Path) -> None:
    from kinetix.files.json_text import parse_strictly
    from kinetix.files.regular import read_text

    path = folder / "x.jsonl"
    path.write_bytes(data)
    for line in read_text(path, "script").splitlines():
        if line.strip():
            parse_strictly(line, "event")


@functools.cache
def _traces() -> tuple[bytes, ...]:
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


def _damaged_arrays(mutator: Mutator, sample: bytes) -> bytes:
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


def _read_trace(data: bytes, folder: Path) -> None:
    from editor.play.trace_files import read_trace, write_trace

    path = folder / "x.npz"
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # zipfile about names that stand twice
        found = read_trace(path)
    write_trace(found.trace, found.level, folder / "again.npz")


AGENT = "unicyclist"


@functools.cache
def _agents() -> tuple[bytes, ...]:
    return ((checkpoints_dir() / AGENT / "agent.json").read_bytes(),)


def _read_agent(data: bytes, folder: Path) -> None:
    from kinetix.agents.agent import load_agent

    shutil.copytree(checkpoints_dir() / AGENT, folder / "agent", dirs_exist_ok=True)
    (folder / "agent" / "agent.json").write_bytes(data)
    load_agent(folder / "agent")


def _read_card(data: bytes, folder: Path) -> None:
    from kinetix.agents.card import read_card, write_card

    (folder / "agent.json").write_bytes(data)
    write_card(folder / "again.json", *read_card(folder / "agent.json"))


def _agent_arrays() -> tuple[bytes, ...]:
    files = [p for p in sorted((checkpoints_dir() / AGENT / "params").rglob("*")) if p.is_file()]
    root = checkpoints_dir() / AGENT
    return tuple(f"{path.relative_to(root)}\n".encode() + path.read_bytes() for path in files)


def _read_arrays(data: bytes, folder: Path) -> None:
    from kinetix.agents.agent import load_agent

    name, _, content = data.partition(b"\n")
    agent = folder / "agent"
    shutil.rmtree(agent, ignore_errors=True)
    shutil.copytree(checkpoints_dir() / AGENT, agent)
    files = {str(p.relative_to(agent)): p for p in agent.rglob("*") if p.is_file()}
    path = files.get(name.decode(errors="replace"), agent / "params" / "_METADATA")
    path.write_bytes(content)
    load_agent(agent)


def _metrics() -> tuple[bytes, ...]:
    row = {"timing/num_updates": 1, "timing/num_env_steps": 32, "loss/total": 0.5}
    return ("\n".join(json.dumps(row | {"timing/num_updates": k}) for k in range(1, 20)).encode(),)


def _read_metrics(data: bytes, folder: Path) -> None:
    from kinetix.training.logging import MetricsLog, read_metrics

    (folder / "metrics.jsonl").write_bytes(data)
    before = read_metrics(folder)
    MetricsLog(folder, updates=10**9).close()
    kept = [row for row in before if row["timing/num_updates"] <= 10**9]
    assert kept == read_metrics(folder)


@functools.cache
def _stored_state() -> tuple[bytes, ...]:
    """The files of a checkpoint with a state, each with its name in the first line."""
    from kinetix.training.resume import write_state

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_state(folder, _STATE, updates=1, seconds=0.5)
        files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
        return tuple(f"{p.relative_to(folder)}\n".encode() + p.read_bytes() for p in files)


_STATE = {"a": np.arange(6, dtype=np.float32), "b": np.ones((2, 2), np.int32)}


def _read_state(data: bytes, folder: Path) -> None:
    from kinetix.training.resume import read_newest

    checkpoint = folder / "checkpoints" / "32"
    names = []
    for stored in _stored_state():
        name, _, content = stored.partition(b"\n")
        path = checkpoint / name.decode()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        names.append(name)
    name, _, content = data.partition(b"\n")
    path = checkpoint / (name if name in names else b"progress.json").decode()
    path.write_bytes(content)
    found = read_newest(folder, lambda: _STATE, lambda text: None)
    assert found is not None
    for key, array in _STATE.items():
        np.testing.assert_array_equal(found[0][key], array)


def _configs() -> tuple[bytes, ...]:
    from kinetix.training.settings import dumps_config, make_config

    return tuple(dumps_config(a, make_config(a)).encode() for a in ("ppo", "plr"))


def _read_config(data: bytes, folder: Path) -> None:
    from kinetix.training.settings import make_config

    (folder / "config.toml").write_bytes(data)
    make_config("ppo", run=folder)


def _nothing() -> tuple[bytes, ...]:
    return (b"",)


def _command_line(data: bytes, folder: Path) -> None:
    from tests.attack.command_lines import run_words

    run_words(random.Random(data), folder)


TARGETS: dict[str, Target] = {
    "level": Target(samples=native_levels, read=_read_level, weight=400),
    "level of kinetix-env": Target(samples=kinetix_env_levels, read=_read_level, weight=200),
    "schema beside reader": Target(samples=native_levels, read=_agree, weight=200),
    "level set": Target(samples=level_sets, read=_read_set),
    "settings": Target(samples=_settings, read=_read_settings, weight=200),
    "autosave": Target(samples=_autosaves, read=_read_autosave),
    "script": Target(samples=_scripts, read=_read_script),
    "trace": Target(samples=_traces, read=_read_trace, damage=_damaged_arrays, weight=200),
    "agent.json": Target(samples=_agents, read=_read_card, weight=200),
    "agent": Target(samples=_agents, read=_read_agent, weight=4),
    "arrays of an agent": Target(samples=_agent_arrays, read=_read_arrays, weight=4),
    "metrics of a run": Target(samples=_metrics, read=_read_metrics),
    "state of a run": Target(samples=_stored_state, read=_read_state, weight=10),
    "config.toml of a run": Target(samples=_configs, read=_read_config),
    "command line": Target(samples=_nothing, read=_command_line, weight=60),
}
"""Every reader, by name."""
