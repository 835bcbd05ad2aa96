"""The description of an agent: the content of `agent.json`."""

import dataclasses
import difflib
import json
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from kinetix.agents.networks.config import OBSERVATIONS_OF_KIND, NetworkConfig
from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.errors import CheckpointError
from kinetix.files.json_text import read_object
from kinetix.files.regular import FileError
from kinetix.level.model import MAX_ENTITIES
from kinetix.wording import misfit

FORMAT = "kinetix-agent"
VERSION = 1
MAX_FRAME_SKIP = 1000
"""Physics steps of one environment step, as in the recorded solution of a level."""
MAX_BINDINGS = 64
"""Action channels of either kind."""

_Count = Annotated[int, Meta(ge=0, le=MAX_ENTITIES)]
_Channels = Annotated[int, Meta(ge=1, le=MAX_BINDINGS)]
_Name = Annotated[str, Meta(max_length=1000)]


class _Part(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Base of the parts: immutable, unknown keys are errors."""


class ObservationCard(_Part, frozen=True, kw_only=True):
    """Observations of an agent."""

    type: str
    """Name of the observation, e.g. `symbolic_entity`."""
    options: dict[str, bool] = {}
    """Options of that observation that are not at their default."""


class ActionCard(_Part, frozen=True, kw_only=True):
    """Actions of an agent."""

    type: str
    """Name of the kind of action, e.g. `multi_discrete`."""


class CapacityCard(_Part, frozen=True, kw_only=True):
    """The sizes that the agent was trained with."""

    polygons: Annotated[int, Meta(ge=ARENA_BODIES, le=MAX_ENTITIES)]
    circles: _Count
    joints: _Count
    thrusters: _Count
    motor_bindings: _Channels = 4
    thruster_bindings: _Channels = 2

    @property
    def sizes(self) -> Capacity:
        """The engine's capacity of these sizes."""
        return Capacity(
            polygons=self.polygons,
            circles=self.circles,
            joints=self.joints,
            thrusters=self.thrusters,
        )


class EnvironmentCard(_Part, frozen=True, kw_only=True):
    """The environment that the agent was trained in."""

    physics: str = "balanced"
    """Physics preset or solver."""
    frame_skip: Annotated[int, Meta(ge=1, le=MAX_FRAME_SKIP)] = 2
    """Physics steps an action is held for."""
    dt: Annotated[float, Meta(ge=1e-6, le=1.0)] = 1 / 60
    """Physics step [s]."""
    dense_reward_scale: Annotated[float, Meta(ge=-1e6, le=1e6)] = 0.2
    """Weight of the distance reward."""
    parity: str | None = None
    """`kinetix-3` where everything was as in kinetix-env 3."""


class NormalisationCard(_Part, frozen=True, kw_only=True):
    """Running statistics of the observation's columns, by field (one field `""` for flat forms)."""

    count: float
    """Rows seen, of the field that has most."""
    mean: dict[str, list[float]]
    variance: dict[str, list[float]]
    counts: dict[str, float] = {}
    """Rows seen, by field; empty in older files, where all fields have `count`."""


class AgentCard(_Part, frozen=True, kw_only=True):
    """Everything about an agent but its parameters."""

    name: _Name
    description: str = ""
    observation: ObservationCard = ObservationCard(type="symbolic_entity")
    action: ActionCard = ActionCard(type="multi_discrete")
    capacity: CapacityCard | None = None
    """None where it is not known (agents of others): an entity agent plays any."""
    network: NetworkConfig = NetworkConfig()
    environment: EnvironmentCard = EnvironmentCard()
    training: dict[str, Any] = {}
    """Algorithm, hyper-parameters, seed, environment steps, wall time, code version."""
    normalisation: NormalisationCard | None = None
    results: dict[str, Any] = {}
    """Solve rates and the like."""

    def replace(self, **changes: Any) -> "AgentCard":
        """Return a copy with some fields changed."""
        return msgspec.structs.replace(self, **changes)

    @property
    def plays_any_capacity(self) -> bool:
        """True if what the agent sees has one form for all capacities (else it plays just one)."""
        return self.observation.type in ("symbolic_entity", "pixels", "blind", "simulator")

    def sees(self, capacity: Capacity) -> bool:
        """Return whether the agent has room for all that a level of this capacity has."""
        own = self.capacity
        return self.plays_any_capacity or own is None or own.sizes.covers(capacity)


class _File(AgentCard, frozen=True, kw_only=True):
    """An `agent.json`: the card, its format and what its parameters must be."""

    format: str
    version: int
    parameters: dict[str, list[int]]
    """Shape of every parameter, by its path in the tree."""
    digest: str
    """SHA-256 over all parameters in the order of their names."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Inventory:
    """Shapes and types that a checkpoint's arrays must have."""

    shapes: dict[str, tuple[int, ...]]
    """Shape of every parameter, by its path in the tree."""
    digest: str
    """SHA-256 over all parameters in the order of their names."""


def write_card(path: Path, card: AgentCard, inventory: Inventory) -> None:
    """Write an `agent.json`.

    Args:
        path: The file.
        card: The agent's description.
        inventory: What its arrays are.
    """
    content: dict[str, Any] = {"format": FORMAT, "version": VERSION}
    content |= msgspec.to_builtins(card)
    # With its defaults, which msgspec leaves out of dataclasses that it made itself.
    content["network"] = dataclasses.asdict(card.network)
    content["parameters"] = {name: list(shape) for name, shape in inventory.shapes.items()}
    content["digest"] = inventory.digest
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    path.write_text(text, encoding="utf-8")


def read_card(path: Path) -> tuple[AgentCard, Inventory]:
    """Read an `agent.json`.

    Args:
        path: The file.

    Raises:
        CheckpointError: The file is missing, not JSON, of another format or version, or has a value
            that is not allowed; the message names the file and the place in it.
    """
    content = read_json_object(path)
    if content.get("format") != FORMAT:
        raise CheckpointError(
            f"{path}: $.format: expected {FORMAT!r}, got {content.get('format')!r}"
        )
    version = content.get("version")
    if isinstance(version, bool) or not isinstance(version, int) or version < 1:
        raise CheckpointError(f"{path}: $.version: expected a whole number ≥ 1, got {version!r}")
    if version > VERSION:
        raise CheckpointError(
            f"{path}: $.version: this program reads up to {VERSION}, the file has {version}; "
            "a newer version of kinetix-editor is needed"
        )
    check_names(path, "$.network", content.get("network"), _NETWORK_NAMES)
    try:
        file = msgspec.convert(content, _File)
    except msgspec.ValidationError as error:
        raise CheckpointError(f"{path}: {misfit(error)}") from None
    except ValueError as error:
        raise CheckpointError(f"{path}: $.network: {error}") from None
    _check_network(path, file)
    names = (field.name for field in msgspec.structs.fields(AgentCard))
    card = AgentCard(**{name: getattr(file, name) for name in names})
    shapes = {name: tuple(shape) for name, shape in file.parameters.items()}
    return card, Inventory(shapes=shapes, digest=file.digest)


def read_json_object(path: Path) -> dict[str, Any]:
    """Return a JSON file whose top level is an object.

    Args:
        path: The file.

    Raises:
        CheckpointError: The file cannot be read, is too large, or does not hold an object.
    """
    try:
        return read_object(path, "agent")
    except FileError as error:
        raise CheckpointError(str(error)) from None


def check_names(path: Path, place: str, content: Any, allowed: frozenset[str]) -> None:
    """Refuse keys that mean nothing, with the nearest that does.

    Args:
        path: The file, for the sentence.
        place: JSON path of the object, for the sentence.
        content: The object.
        allowed: The keys that it may have.

    Raises:
        CheckpointError: `content` has another key, or is not an object.
    """
    if not isinstance(content, dict):
        raise CheckpointError(f"{path}: {place}: expected an object, got {content!r}")
    for name in content:
        if name not in allowed:
            near = difflib.get_close_matches(name, allowed, 1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise CheckpointError(f"{path}: {place}.{name}: unknown option{hint}")


_NETWORK_NAMES = frozenset(field.name for field in dataclasses.fields(NetworkConfig))


def _check_network(path: Path, card: AgentCard) -> None:
    allowed = OBSERVATIONS_OF_KIND[card.network.kind]
    if card.observation.type not in allowed:
        raise CheckpointError(
            f"{path}: $.observation.type: the network {card.network.kind} reads "
            f"{' or '.join(allowed)}, got {card.observation.type!r}"
        )
    if card.capacity is None and not card.plays_any_capacity:
        raise CheckpointError(
            f"{path}: $.capacity: missing; the width of {card.observation.type} depends on it"
        )
