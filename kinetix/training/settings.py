"""Sources of a configuration: preset, TOML file, single values; and back to TOML."""

import ast
import dataclasses
import difflib
import functools
import inspect
import itertools
import json
import os
import textwrap
import tomllib
from collections.abc import Container, Iterator, Mapping, Sequence, Set
from importlib import resources
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from kinetix.agents.card import AgentCard
from kinetix.agents.networks.config import OBSERVATIONS_OF_KIND, NetworkConfig
from kinetix.engine.spec import Capacity
from kinetix.errors import KinetixError, LevelError
from kinetix.files.regular import FileError, read_text
from kinetix.lazy import hint
from kinetix.level.sets import gather_levels
from kinetix.level.sizes import capacity_of, parse_capacity, size_name
from kinetix.training.config import ALGORITHM_DEFAULTS, CONFIGS, PpoConfig
from kinetix.wording import misfit

CONFIG = "config.toml"
"""A run's own configuration."""
START_FROM: Final = "start_from"
"""Table of a run's configuration: the agent that the run began from."""
NETWORK = "network"
"""Table of the network's options."""
_FROM_EMPTY: Final = "accel_start_from_empty"
"""Off where levels of some kind are named: ACCEL would not play one of them."""
_OF_ANOTHER_VERSION: Final = (
    "; another version wrote it, or somebody by hand: without its line the run goes on"
)
_PRESETS = resources.files("kinetix.training") / "presets"


def presets() -> list[str]:
    """Return names of the presets that come with the program."""
    return sorted(
        path.name.removesuffix(".toml")
        for path in _PRESETS.iterdir()
        if path.name.endswith(".toml")
    )


def preset_values(algorithm: str, preset: str) -> dict[str, Any]:
    """Return the fields, and the network's options, that a preset changes for an algorithm.

    Args:
        algorithm: As for `make_config`.
        preset: Its name.

    Raises:
        KinetixError: There is no such preset.
    """
    given = _given(algorithm, preset=preset, file=None, run=None)
    return given.fields | given.network


def make_config(
    algorithm: str,
    *,
    preset: str | None = None,
    file: Path | None = None,
    values: Mapping[str, Any] | None = None,
    run: Path | None = None,
) -> PpoConfig:
    """Put a configuration together; later sources win over earlier ones.

    Args:
        algorithm: "ppo", "sfl", "plr", "accel", "dr" or "bc".
        preset: Name of a preset.
        file: A TOML file: fields, a table `[network]`, and tables named after algorithms that hold
            for those alone.
        values: Single fields by name; options of the network without a prefix, or all of them as
            `network`, a `NetworkConfig` or a mapping.
        run: A run's directory; if it has a `config.toml`, that comes before everything else.

    Raises:
        KinetixError: Something is not known or out of range; the message says where.
    """
    if algorithm not in CONFIGS:
        raise KinetixError(f"algorithm: expected one of {', '.join(CONFIGS)}, got {algorithm!r}")
    values = _without_network(values or {})
    given = _given(algorithm, preset=preset, file=file, run=run)
    fields, network = given.fields, given.network
    known = {field.name for field in dataclasses.fields(CONFIGS[algorithm])} | set(_NETWORK_NAMES)
    for name, value in values.items():
        if name not in known:
            raise KinetixError(f"{name}: {algorithm} has no such field; {hint(name, known)}")
        (network if name in _NETWORK_NAMES else fields)[name] = value
    for field in dataclasses.fields(CONFIGS[algorithm]):
        # One level, say, may be named without making a list of it.
        if isinstance(field.default, tuple) and isinstance(fields.get(field.name), str):
            fields[field.name] = [fields[field.name]]
    _check_sources(fields)
    try:
        _complete(fields, known, fixed=fields.keys() - given.weak.difference(values))
    except LevelError as error:
        if not _of_elsewhere(fields, values, run):
            raise
        raise KinetixError(
            f"{error}; the run's {CONFIG} names it as seen from the folder in which the run was "
            "started: go on there, or name the levels again"
        ) from error
    _match(fields, network, values)
    try:
        fields[NETWORK] = msgspec.convert(network, NetworkConfig)
        config = msgspec.convert(
            {name: value for name, value in fields.items() if value is not None},
            CONFIGS[algorithm],
        )
    except (msgspec.ValidationError, ValueError) as error:
        raise KinetixError(f"{given.told}: {misfit(error)}") from None
    config.check()
    return config


def _without_network(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values with each option of a whole network beside them; single ones win."""
    network = values.get(NETWORK) or {}
    if not isinstance(network, NetworkConfig | Mapping):
        raise KinetixError(f"{NETWORK}: expected a NetworkConfig or a mapping, got {network!r}")
    options = network if isinstance(network, Mapping) else dataclasses.asdict(network)
    return {**options, **{name: value for name, value in values.items() if name != NETWORK}}


def _of_elsewhere(fields: dict[str, Any], flags: Mapping[str, Any], run: Path | None) -> bool:
    """Return whether a run's configuration names a relative path that is not here."""
    if run is None:
        return False
    named = [each for name in SOURCES if not flags.get(name) for each in fields.get(name) or ()]
    return any(not os.path.isabs(each) and not os.path.exists(each) for each in named)


def _match(fields: dict[str, Any], network: dict[str, Any], flags: Mapping[str, Any]) -> None:
    """Let the network follow the observation, or the observation a flag that names the network."""
    told = [name for name in ("kind", "observation_type") if flags.get(name) is not None]
    reads = OBSERVATIONS_OF_KIND.get(network.get("kind", ""), ())
    if fields.get("observation_type") not in reads:
        if told == ["kind"] and reads:
            fields["observation_type"] = reads[0]
        elif told == ["observation_type"]:
            network.pop("kind", None)
    observation = fields.get("observation_type", "symbolic_entity")
    network.setdefault("kind", _KIND_OF.get(observation, "entity_transformer"))


@dataclasses.dataclass(kw_only=True)
class _Given:
    """Values of all sources, the weakest first."""

    fields: dict[str, Any]
    network: dict[str, Any]
    weak: set[str]
    """Fields that have the preset's value: what is trained on wins over them."""
    told: str
    """The sources, in words."""


def _given(algorithm: str, *, preset: str | None, file: Path | None, run: Path | None) -> _Given:
    given = _Given(
        fields=dict(ALGORITHM_DEFAULTS.get(algorithm, {})),
        network={},
        weak=set(),
        told="training configuration",
    )
    for source in _sources(algorithm, preset=preset, file=file, run=run):
        own: dict[str, Any] = {}
        _take(own, given.network, source, algorithm)
        given.fields |= own
        given.weak = given.weak | own.keys() if source.weak else given.weak - own.keys()
        given.told = f"{given.told}, {source.where}"
    return given


class _Source(NamedTuple):
    content: dict[str, Any]
    where: str
    weak: bool = False
    advice: str = ""
    """Words for whoever meets an unknown name."""


def _sources(
    algorithm: str, *, preset: str | None, file: Path | None, run: Path | None
) -> Iterator[_Source]:
    """Tables of values and what they are from, weakest first."""
    stored = None if run is None else run / CONFIG
    if stored is not None and os.path.isfile(stored):
        content = _parse(_read(stored), str(stored))
        began = content.get("algorithm")
        if began is None:
            raise KinetixError(f"{stored}: does not say its algorithm; it is damaged")
        if began != algorithm:
            raise KinetixError(f"{stored}: this run was started with {began}, not {algorithm}")
        yield _Source(content, str(stored), advice=_OF_ANOTHER_VERSION)
    if preset is not None:
        yield _Source(_preset(preset), f"preset {preset!r}", weak=True)
    if file is not None:
        yield _Source(_parse(_read(file), str(file)), str(file))


SOURCES: Final = ("levels", "eval_levels", "data")
"""Fields that name files, folders and bundled levels."""


def _check_sources(fields: dict[str, Any]) -> None:
    """Turn paths into texts.

    Raises:
        KinetixError: One is neither.
    """
    for name in SOURCES:
        given = fields.get(name)
        if given is None:
            continue
        listed = given if isinstance(given, list | tuple) else [given]
        wrong = [each for each in listed if not isinstance(each, str | Path)]
        if wrong:
            raise KinetixError(
                f"training configuration: {name}: expected names of levels, files or folders, got "
                f"{wrong[0]!r:.60}"
            )
        fields[name] = [str(each) for each in listed]


def _complete(fields: dict[str, Any], known: Container[str], *, fixed: Set[str]) -> None:
    """Fill in what follows from other fields; levels and demonstrations win over what is not fixed.

    Those that are too large for the size set it; physics and frame skip are the demonstrations'.
    """
    needed: list[Capacity] = []
    if fields.get("levels"):
        fields["level_mode"] = "list"
        needed += [capacity_of(level.level) for level in gather_levels(fields["levels"])]
    if fields.get("eval_levels"):
        gather_levels(fields["eval_levels"])  # what is missing is told before anything compiles
    if fields.get("data"):
        # Here, so that a configuration of another algorithm needs no JAX.
        from kinetix.training.imitation.sources import origin_of

        origin = origin_of(tuple(fields["data"]))
        needed.append(origin.capacity)
        played = {"physics": origin.physics, "frame_skip": origin.frame_skip}
        fields |= {name: value for name, value in played.items() if name not in fixed}
    if fields.get("level_mode", "random") != "random" and _FROM_EMPTY in known:
        fields.setdefault(_FROM_EMPTY, False)
    if needed and "size" not in fixed:
        fields["size"] = _size_for(needed, fields.get("size"))
    if "size" in fields:
        parse_capacity(fields["size"])
    if fields.get("parity") == "kinetix-3":
        fields["physics"] = "jax2d"
        fields.setdefault("bootstrap_on_timeout", False)


def settings_of(card: AgentCard) -> dict[str, Any]:
    """Return the settings that an agent determines for a training that starts from it.

    These are its network, observation, action, frame skip, whether it normalises what it sees, and
    its size, where it plays no other.
    """
    own = None if card.plays_any_capacity or card.capacity is None else card.capacity.sizes
    size = {} if own is None else {"size": size_name(own) or _in_numbers(own)}
    return (
        dataclasses.asdict(card.network)
        | size
        | {
            "observation_type": card.observation.type,
            "action_type": card.action.type,
            "frame_skip": card.environment.frame_skip,
            "rms_norm": card.normalisation is not None,
        }
    )


def dumps_config(algorithm: str, config: PpoConfig) -> str:
    """Return a configuration as TOML; fields that are None are left out.

    Args:
        algorithm: Goes into the first line.
        config: The configuration.
    """
    content = dataclasses.asdict(config)
    network = content.pop(NETWORK)
    lines = [f'algorithm = "{algorithm}"']
    lines += [f"{key} = {toml_value(value)}" for key, value in content.items() if value is not None]
    lines += ["", f"[{NETWORK}]"]
    lines += [f"{key} = {toml_value(value)}" for key, value in network.items()]
    return "\n".join(lines) + "\n"


def as_table(config: PpoConfig) -> dict[str, Any]:
    """Return a configuration as plain values by name, the network's options under `network`.

    Args:
        config: The configuration.
    """
    return dataclasses.asdict(config)


def loads_config(text: str, file: str) -> tuple[str, dict[str, Any]]:
    """Return the inverse of `dumps_config`, as values for `make_config`.

    Args:
        text: The TOML text.
        file: Its name, for errors.

    Raises:
        KinetixError: It is not TOML.
    """
    content = _parse(text, file)
    network = content.pop(NETWORK, {})
    if not isinstance(network, dict):
        raise KinetixError(f"{file}: {NETWORK}: expected a table")
    content.pop(START_FROM, None)
    return str(content.pop("algorithm", "ppo")), content | network


def field_notes(owner: type) -> dict[str, str]:
    """Return the notes below each field of a dataclass, its bases' included.

    Args:
        owner: The dataclass; its source must be there.
    """
    notes: dict[str, str] = {}
    for kind in reversed(owner.__mro__[:-1]):
        body = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0]
        assert isinstance(body, ast.ClassDef)
        for field, note in itertools.pairwise(body.body):
            if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
                is_text = isinstance(note, ast.Expr) and isinstance(note.value, ast.Constant)
                notes[field.target.id] = str(note.value.value) if is_text else ""  # pyright: ignore
    return notes


def _size_for(needed: Sequence[Capacity], preferred: str | None) -> str:
    """Return the preferred size if it has room for everything, else the common one in numbers."""
    common = functools.reduce(Capacity.union, needed)
    if preferred is not None and parse_capacity(preferred).covers(common):
        return preferred
    return _in_numbers(common)


def _in_numbers(capacity: Capacity) -> str:
    return ",".join(map(str, dataclasses.astuple(capacity)))


def _take(fields: dict[str, Any], network: dict[str, Any], source: _Source, algorithm: str) -> None:
    content, where = source.content, source.where
    tables = {name: content.pop(name, {}) for name in (NETWORK, *CONFIGS)}
    for name in ("algorithm", START_FROM):
        content.pop(name, None)
    allowed = {field.name for field in dataclasses.fields(CONFIGS[algorithm])} - {NETWORK}
    for name, table in tables.items():
        if not isinstance(table, dict):
            raise KinetixError(f"{where}: {name}: expected a table")
    for table, names, target in (
        (content, allowed, fields),
        (tables[algorithm], allowed, fields),
        (tables[NETWORK], _NETWORK_NAMES, network),
    ):
        for name in table:
            if name not in names:
                near = difflib.get_close_matches(name, sorted(names), 1)
                hint = f"; did you mean {near[0]!r}?" if near else ""
                raise KinetixError(
                    f"{where}: {name!r} is not a field of {algorithm}{hint}{source.advice}"
                )
        target.update(table)


def _preset(name: str) -> dict[str, Any]:
    if name not in presets():
        raise KinetixError(f"preset: expected one of {', '.join(presets())}, got {name!r}")
    return _parse((_PRESETS / f"{name}.toml").read_text(encoding="utf-8"), name)


def _read(file: Path) -> str:
    try:
        return read_text(file, "run")
    except FileError as error:
        raise KinetixError(str(error)) from None


def _parse(text: str, file: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also numbers of thousands of digits
        raise KinetixError(f"{file}: not valid TOML: {error}") from None


def toml_value(value: Any) -> str:
    """Return a value as TOML writes it.

    Args:
        value: A number, a string, a boolean, or a sequence of these.
    """
    if isinstance(value, (tuple, list)):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    # What JSON writes of booleans, numbers and strings is TOML too.
    return json.dumps(value, ensure_ascii=False)


_NETWORK_NAMES = frozenset(field.name for field in dataclasses.fields(NetworkConfig))
_KIND_OF = {
    "symbolic_entity": "entity_transformer",
    "symbolic_flat": "flat_mlp",
    "symbolic_flat_padded": "permutation_invariant_mlp",
    "pixels": "cnn",
    "blind": "flat_mlp",
}
