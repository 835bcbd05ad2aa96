"""A comparison that was stored, read again. Free of JAX."""

import dataclasses
import os
from pathlib import Path
from typing import Any

import msgspec

from kinetix.agents.compare import FORMAT, Contender
from kinetix.agents.results import EpisodeResult, LevelFailure, LevelResult, Provenance
from kinetix.environment.outcome import Outcome
from kinetix.errors import KinetixError
from kinetix.files.json_text import read_json
from kinetix.files.regular import FileError, open_regular
from kinetix.wording import misfit


@dataclasses.dataclass(frozen=True, kw_only=True)
class StoredComparison:
    """Content of a file of `kinetix compare --out`."""

    contenders: tuple[Contender, ...]
    hashes: dict[str, str]
    """`level_hash` of each level, by name, in their order."""


class _Result(msgspec.Struct, frozen=True, kw_only=True):
    level: str
    error: str | None = None
    attempts: int = 0
    episodes: tuple[tuple[Outcome, int, float], ...] = ()


class _Policy(msgspec.Struct, frozen=True, kw_only=True):
    label: str
    agent: str
    digest: str
    physics: str
    seed: int
    attempts: int
    deterministic: bool
    frame_skip: int | None = None
    dense_reward_scale: float | None = None
    card_digest: str = ""
    results: tuple[_Result, ...]


class _Document(msgspec.Struct, frozen=True, kw_only=True):
    format: str
    version: int
    levels: dict[str, str]
    policies: tuple[_Policy, ...]


def is_comparison(path: Path) -> bool:
    """Return whether a file begins like a stored comparison; what cannot be read does not."""
    try:
        with open_regular(path, "kept") as file:
            return f'"{FORMAT}"'.encode() in file.read(200)
    except FileError:
        return False


def check_replaced(path: Path) -> None:
    """Refuse to replace a `.json` that is not a comparison, such as a level.

    Raises:
        KinetixError: The file holds something else.
    """
    there = path.suffix.lower() == ".json" and os.path.isfile(path) and os.path.getsize(path)
    if there and not is_comparison(path):
        raise KinetixError(f"{path}: is no comparison, and stays; choose another name")


def read_comparison(path: Path) -> StoredComparison:
    """Return a stored comparison; rates and means are recomputed from its attempts.

    Args:
        path: A `.json` that `kinetix compare --out` or the app wrote.

    Raises:
        KinetixError: The file cannot be read, is something else, or its parts do not fit each
            other.
    """
    tree: Any = read_json(path, "kept")
    if not isinstance(tree, dict) or tree.get("format") != FORMAT:
        raise KinetixError(f"{path}: expected a comparison that `kinetix compare --out` wrote")
    if tree.get("version") != 1:
        raise KinetixError(f"{path}: $.version: expected 1, got {tree.get('version')!r}")
    try:
        document = msgspec.convert(tree, _Document)
    except msgspec.ValidationError as error:
        raise KinetixError(f"{path}: {misfit(error)}") from None
    names = list(document.levels)
    contenders = []
    for k, policy in enumerate(document.policies):
        found = [one.level for one in policy.results]
        if found != names:
            raise KinetixError(
                f"{path}: $.policies[{k}].results: expected the levels {', '.join(names)}, "
                f"got {', '.join(found)}"
            )
        results = tuple(_result(one, policy, f"{path}: $.policies[{k}]") for one in policy.results)
        provenance = Provenance(
            agent=policy.agent,
            digest=policy.digest,
            physics=policy.physics,
            seed=policy.seed,
            attempts=policy.attempts,
            deterministic=policy.deterministic,
            frame_skip=policy.frame_skip,
            dense_reward_scale=policy.dense_reward_scale,
            card_digest=policy.card_digest,
        )
        contenders.append(Contender(label=policy.label, provenance=provenance, results=results))
    if not contenders or not names:
        raise KinetixError(f"{path}: expected at least one policy and one level")
    told = {
        (c.provenance.seed, c.provenance.attempts, c.provenance.deterministic): c.label
        for c in contenders
    }
    if len(told) > 1:
        raise KinetixError(f"{path}: expected one seed, mode and number of attempts for all")
    return StoredComparison(contenders=tuple(contenders), hashes=document.levels)


def _result(one: _Result, policy: _Policy, where: str) -> LevelResult | LevelFailure:
    if one.error is not None:
        return LevelFailure(level=one.level, error=one.error)
    if len(one.episodes) != policy.attempts:
        raise KinetixError(
            f"{where}: {one.level}: expected {policy.attempts} attempts, got {len(one.episodes)}"
        )
    episodes = [
        EpisodeResult(outcome=outcome, length=length, total_reward=reward)
        for outcome, length, reward in one.episodes
    ]
    return LevelResult.of(one.level, episodes)
