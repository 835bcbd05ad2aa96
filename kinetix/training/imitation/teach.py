"""A data set of wins on random levels: searched in batches, resumable."""

import dataclasses
import json
import os
import random
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import jax
import jax.numpy as jnp
import msgspec
import numpy as np

from kinetix.datasets.episode import RecordedEpisode, winning_plan
from kinetix.datasets.folder import read_manifest, writing
from kinetix.datasets.replays import checked
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.engine.presets import solver_named
from kinetix.environment.generators.documents import random_document
from kinetix.environment.generators.filters import noop_solved
from kinetix.environment.generators.machines import numbered_machine, random_machine
from kinetix.environment.params import EnvParams, static_env_params_of
from kinetix.environment.replay import playing_env
from kinetix.environment.reset import level_state, make_reset_fn_sample_kinetix_level
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.files.atomic import write_atomically
from kinetix.files.json_text import read_object
from kinetix.level.mirror import mirrored_level
from kinetix.level.model import InertiaModel, Level
from kinetix.level.sizes import parse_capacity
from kinetix.training.imitation.teacher import (
    ELITE,
    LENGTH,
    kicked,
    search_round,
    wins_again,
)
from kinetix.training.imitation.turns import KEPT, SearchBlock, search
from kinetix.training.progress_text import Say, say_nothing
from kinetix.version import __version__
from kinetix.wording import misfit, thousands

PROGRESS: Final = "teach.json"
SHARD: Final = 256
"""Levels that are sampled, searched and written together."""
_HOPELESS: Final = 4
"""The search gives up after this many shards without a win."""
_COPIES: Final = 2**20
"""Index of the random key for perturbed starts; rounds of a search have smaller ones."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class TeachConfig:
    """Levels to search, and the effort."""

    size: str
    """s, m, l, locomotion, or four capacities such as 12,4,6,2."""
    seed: int = 0
    """Equal seeds give equal levels."""
    physics: str = DEFAULT_PHYSICS
    """Physics preset or solver."""
    rounds: int = 2
    """Rounds after which a level is given up."""
    batch: int = 32
    """Levels that are searched at once."""
    copies: int = 2
    """Perturbed starts per level that are tried besides, each with a round that begins with the
    level's plan."""
    mirror: bool = True
    """True if the mirror images of all these are tried too."""
    machines: bool = False
    """True if the levels are random machines, not heaps of shapes."""

    def check(self) -> None:
        """Refuse what cannot work.

        Raises:
            KinetixError: One sentence that names the field.
        """
        sizes = parse_capacity(self.size)
        solver_named(self.physics)
        for name, least in (("rounds", 1), ("batch", 1), ("copies", 0)):
            if getattr(self, name) < least:
                raise KinetixError(f"{name}: expected at least {least}, got {getattr(self, name)}")
        if SHARD % self.batch:
            raise KinetixError(f"batch: expected a divisor of {SHARD}, got {self.batch}")
        if not (sizes.joints or sizes.thrusters):
            raise KinetixError(
                f"size {self.size!r}: has no joints and no thrusters: none of its levels can be won"
            )
        if self.machines:
            random_machine(random.Random(0), self.size)  # refuses sizes that have none


class Yield(msgspec.Struct, frozen=True, kw_only=True):
    """Counts of the levels so far."""

    levels: int = 0
    """Levels drawn."""
    trivial: int = 0
    """Of them, won by doing nothing: left out."""
    won: int = 0
    """Levels that were won by search, each with at least one episode in the data."""
    episodes: int = 0
    """Episodes written: those of perturbed starts count too."""
    steps: int = 0
    """Environment steps of these."""
    shards: int = 0
    seconds: float = 0.0
    """Duration of searching [s]."""

    @property
    def share(self) -> float:
        """Share of the levels that are not trivial that was won."""
        return self.won / max(self.levels - self.trivial, 1)

    @property
    def seconds_per_win(self) -> float:
        """Seconds of search per level won."""
        return self.seconds / max(self.won, 1)


def teach(
    config: TeachConfig,
    count: int,
    out: Path,
    *,
    report: Callable[[Yield], None] = lambda so_far: None,
    status: Say = say_nothing,
) -> Yield:
    """Search random levels until so many are won; what is there already counts.

    Args:
        config: What is searched.
        count: How many levels shall be won.
        out: Folder of the data set; the same one goes on where it stopped, within a shard too.
        report: Called after every shard.
        status: Takes words for what is under way, which the next ones may replace.

    Raises:
        KinetixError: The folder holds something else, or data of other settings.
    """
    config.check()
    with writing(out) as data:
        so_far = _resumed(config, out)
        if so_far.won >= count:
            return so_far
        searching = _Search(config, out, status)
        first = so_far.shards
        while so_far.won < count:
            if not so_far.won and so_far.shards - first >= _HOPELESS:
                raise KinetixError(
                    f"size {config.size!r}: none of {thousands(so_far.levels)} levels was won; "
                    "choose a larger size, or more --rounds"
                )
            began = time.monotonic()
            found, told = searching.shard(so_far.shards)
            # Of a stop between the two writes only this comes twice, and is known then.
            data.add(found)
            so_far = Yield(
                levels=so_far.levels + SHARD,
                trivial=so_far.trivial + told["trivial"],
                won=so_far.won + told["won"],
                episodes=so_far.episodes + len(found),
                steps=so_far.steps + sum(each.length for each in found),
                shards=so_far.shards + 1,
                seconds=so_far.seconds + time.monotonic() - began,
            )
            _note(config, so_far, out)
            (out / KEPT).unlink(missing_ok=True)
            report(so_far)
    return so_far


def _note(config: TeachConfig, so_far: Yield, out: Path) -> None:
    content = {"settings": dataclasses.asdict(config), "yield": msgspec.to_builtins(so_far)}
    write_atomically(out / PROGRESS, (json.dumps(content, indent=2) + "\n").encode())


def _resumed(config: TeachConfig, out: Path) -> Yield:
    path = out / PROGRESS
    if not os.path.isfile(path):
        if read_manifest(out).shards:
            raise KinetixError(f"{out}: holds episodes that are not a teacher's; choose another")
        _note(config, Yield(), out)
        return Yield()
    content = read_object(path, "run")
    try:
        so_far = msgspec.convert(content.get("yield"), Yield)
    except msgspec.ValidationError as error:
        raise KinetixError(f"{path}: $.yield: {misfit(error)}") from None
    if not so_far.levels and not read_manifest(out).shards:
        _note(config, so_far, out)  # nothing was found yet: other settings may begin
        return so_far
    for name, value in dataclasses.asdict(config).items():
        before = content.get("settings", {}).get(name)
        if before != value:
            raise KinetixError(
                f"{path}: this data set was begun with {name} = {json.dumps(before)}, now it is "
                f"{json.dumps(value)}; choose another folder"
            )
    return so_far


class _Search:
    """Draws levels and searches them, a shard's worth at a time."""

    def __init__(self, config: TeachConfig, out: Path, status: Say) -> None:
        self._config = config
        self._out = out
        self._status = status
        capacity = parse_capacity(config.size)
        static = static_env_params_of(capacity, physics=config.physics)
        self._env = playing_env(static)
        reset = make_reset_fn_sample_kinetix_level(EnvParams(), static)
        self._draw = jax.jit(jax.vmap(reset))

    def shard(self, index: int) -> tuple[list[RecordedEpisode], dict[str, int]]:
        """Search the levels of a shard.

        Returns:
            Episodes, and counts of levels: `trivial` and `won`.
        """
        key = jax.random.fold_in(jax.random.PRNGKey(self._config.seed), index)
        self._status(f"compiling and drawing {SHARD} levels")
        levels = self._drawn(index, key)
        self._status("leaving out what doing nothing wins")
        trivial = np.asarray(noop_solved(self._env, levels, EnvParams(), steps=LENGTH))
        levels = jax.tree.map(np.asarray, levels)
        todo = np.flatnonzero(~trivial)
        block = SearchBlock(
            levels=levels,
            todo=todo,
            key=key,
            batch=self._config.batch,
            rounds=self._config.rounds,
            identity=json.dumps([dataclasses.asdict(self._config), index, SHARD, __version__]),
        )
        plans = search(self._env, block, self._out / KEPT, self._status)
        dice = np.random.default_rng((self._config.seed, index))
        attempts = self._attempts(
            levels, plans, dice, jax.random.fold_in(key, _COPIES), index * SHARD
        )
        found = self._proven(attempts)
        won = len({episode.level.name for episode in found})
        return found, {"trivial": int(trivial.sum()), "won": won}

    def _drawn(self, index: int, key: Any) -> EnvState:
        if not self._config.machines:
            return self._draw(jax.random.split(key, SHARD))
        first, static = index * SHARD, self._env.static_env_params
        numbers = range(first, first + SHARD)
        levels = [numbered_machine(self._config.seed, self._config.size, k) for k in numbers]
        rows = [level_state(level, static) for level in levels]
        return jax.tree.map(lambda *x: np.stack([np.asarray(one) for one in x]), *rows)

    def _attempts(
        self,
        levels: EnvState,
        plans: dict[int, np.ndarray],
        dice: np.random.Generator,
        key: Any,
        first: int,
    ) -> list[tuple[Level, np.ndarray, int]]:
        """Return levels with the plans that may win them: as drawn, perturbed, and mirrored."""
        if not plans:
            return []
        chosen = jax.tree.map(lambda x: x[np.array(list(plans), int)], levels)
        attempts: list[tuple[Level, np.ndarray, int]] = []
        for copy in range(self._config.copies + 1):
            states, winners = chosen, list(plans.values())
            if copy:
                self._status(f"perturbed starts: {copy} of {self._config.copies} a level")
                states = kicked(chosen, dice)
                winners = self._adapted(states, winners, jax.random.fold_in(key, copy))
            for row, (number, plan) in enumerate(zip(plans, winners, strict=True)):
                state = jax.tree.map(lambda x, row=row: x[row], states)
                kind = "Machine" if self._config.machines else "Random"
                name = f"{kind} {self._config.size} {self._config.seed}-{first + number}"
                inertia: InertiaModel = "exact" if self._config.machines else "kinetix"
                level = random_document(state, name, inertia)
                attempts.append((level, plan, copy))
                if self._config.mirror:
                    attempts.append((mirrored_level(level), plan, copy))
        return attempts

    def _adapted(self, states: EnvState, plans: list[np.ndarray], key: Any) -> list[np.ndarray]:
        """The best plan for every start, of a round that begins with a plan for a like one."""
        found: list[np.ndarray] = []
        size = self._config.batch
        for start in range(0, len(plans), size):
            rows = np.arange(start, start + size) % len(plans)
            part = jax.tree.map(lambda x, rows=rows: x[rows], states)
            elite = np.repeat(np.stack([plans[k] for k in rows])[:, None], ELITE, axis=1)
            result = search_round(self._env, part, elite, jax.random.fold_in(key, start))
            found += list(np.asarray(result.elite)[:, 0])
        return found[: len(plans)]

    def _proven(self, attempts: list[tuple[Level, np.ndarray, int]]) -> list[RecordedEpisode]:
        """Episodes of the plans that win the levels as they are written."""
        static = self._env.static_env_params
        found: list[RecordedEpisode] = []
        for start in range(0, len(attempts), SHARD):
            batch = attempts[start : start + SHARD]
            self._status(f"playing them again: {start} of {len(attempts)} episodes")
            rows = [level_state(level, static) for level, _, _ in batch]
            # Always as many rows: one compilation.
            filled = [rows[k % len(rows)] for k in range(SHARD)]
            states = jax.tree.map(lambda *x: np.stack([np.asarray(one) for one in x]), *filled)
            plans = np.stack([batch[k % len(batch)][1] for k in range(SHARD)])
            won, steps = (np.asarray(x) for x in wins_again(self._env, states, jnp.asarray(plans)))
            winning = [
                winning_plan(
                    level,
                    plan[: steps[k]],
                    physics=str(static.physics),
                    frame_skip=static.frame_skip,
                    seed=self._config.seed,
                    attempt=copy,
                )
                for k, (level, plan, copy) in enumerate(batch)
                if won[k]
            ]
            # A batch rounds otherwise than a level that is played alone, as `dataset verify` does.
            found += [episode for episode in winning if checked(episode).replays]
        return found
