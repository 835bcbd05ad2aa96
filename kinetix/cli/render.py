"""Draw a level as a picture (PNG), film an episode (GIF, MP4) or make a page of it (HTML)."""

import dataclasses
import itertools
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import msgspec
import tyro
from tyro.conf import Positional

from kinetix.cli.shared.attempts import check_attempt, decide_of, steps_of_attempt
from kinetix.cli.shared.terminal import announced
from kinetix.errors import KinetixError
from kinetix.files.atomic import check_target, replacing
from kinetix.files.folders import made_folder
from kinetix.level.geometry import ARENA_WIDTH, bounds, outside_arena
from kinetix.level.model import Level
from kinetix.render.captions import caption, write_caption
from kinetix.render.film import FILM_SUFFIXES, ffmpeg, write_film
from kinetix.wording import plural

if TYPE_CHECKING:
    import numpy as np
    from PIL import Image

    from kinetix.agents.evaluate import RecordedStep
    from kinetix.agents.player import Player
    from kinetix.environment.env import KinetixEnv
    from kinetix.environment.episode import EpisodeState
    from kinetix.environment.state import EnvState
    from kinetix.pages.film import Film

PAGE: Final = ".html"
SMALLEST, LARGEST = 16, 4096
"""Sides of a picture [px]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Render:
    """Draw a level, still or played."""

    level: Annotated[str, Positional, tyro.conf.arg(metavar="LEVEL")]
    """Level file, or the name of a bundled level (s/…, m/…, l/…)."""
    out: Annotated[Path, Positional, tyro.conf.arg(metavar="OUT")]
    """Picture (.png), film (.gif, .mp4) or page to play it on (.html) to write."""
    agent: str = "noop"
    """The player: an agent (directory or name), planner, noop, random, or solution."""
    rival: str | None = None
    """A second player of the same level beside the first, on a page."""
    steps: int | None = None
    """Environment steps to play: for a picture 0, for a film until the episode ends."""
    pixels: int = 500
    """Width and height."""
    physics: str | None = None
    """Physics preset or solver; by default the one of the agent or of the solution."""
    seed: int = 0
    """Seed of the agent's draws."""
    attempt: int | None = None
    """Show this attempt of kinetix eval under the seed, from 0: the same episode to the bit."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""
    overlay: bool = False
    """Write step, value and entropy of the agent, controls and outcome on the picture."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Moment:
    """An episode after some steps."""

    state: "EnvState"
    step: int
    action: tuple[float, ...]
    """The unified action that led here: four motors, two thrusters."""
    outcome: str
    """See `kinetix.environment.outcome.Outcome`; empty while the episode goes on."""
    value: float | None = None
    """Expected return before this step, if the player has a network."""
    entropy: float | None = None
    """Of its policy over the level's controls then [nat]."""
    controls: tuple[int, ...] = ()
    """Entries of the action that drive anything."""


def run(command: Render) -> int:
    """Play, draw, write.

    Raises:
        KinetixError: The file's ending is unknown, an option is out of range, an extra is missing.
        LevelError: The level is bad.
        CheckpointError: The agent is bad.
    """
    kind = command.out.suffix.lower()
    if kind not in (".png", PAGE, *FILM_SUFFIXES):
        raise KinetixError(f"{command.out}: expected a file that ends in .png, .gif, .mp4 or .html")
    if command.rival is not None and kind != PAGE:
        raise KinetixError(f"{command.out}: --rival needs a page, a file that ends in .html")
    if not SMALLEST <= command.pixels <= LARGEST:
        raise KinetixError(
            f"--pixels {command.pixels}: expected a number from {SMALLEST} to {LARGEST}"
        )
    if command.steps is not None and command.steps < 0:
        raise KinetixError(f"--steps {command.steps}: expected a number from 0")
    check_attempt(command.attempt, _players(command))
    if kind == ".mp4":
        ffmpeg()  # fail before playing, not after
    check_target(command.out)
    if kind == PAGE:
        _write_page(command)
        print(command.out)
        return 0
    showing = _showing(command, command.agent)
    moments = showing.moments
    _tell_what_is_outside(showing.level)
    made_folder(command.out.parent)
    if kind in FILM_SUFFIXES:
        with replacing(command.out) as path:
            comment = "; ".join(f"{what}: {told}" for what, told in showing.facts)
            rate = showing.per_second
            frames = _frames(moments, command, rate)
            write_film(path, frames, kind=kind, per_second=rate, comment=comment)
    else:
        *_, last = moments
        with replacing(command.out) as path:
            _picture(last, command).save(path, format="PNG")
    print(command.out)
    return 0


def _tell_what_is_outside(level: Level) -> None:
    """Report how much of a level lies outside pictures: they show the arena's square alone."""
    away = sum(outside_arena(bounds(body)) for body in level.bodies)
    if away:
        print(
            f"{away} of {plural(len(level.bodies), 'shape')} start outside the picture, which "
            f"shows x and y from 0 to {ARENA_WIDTH:g} m; a page (.html) and the editor show all",
            file=sys.stderr,
        )


@dataclasses.dataclass(frozen=True, kw_only=True)
class Showing:
    """A level, its player, and the episode as far as it is asked for, its start included."""

    level: Level
    slots: "np.ndarray"
    """Slots of the level's bodies in the states."""
    player: str
    per_second: float
    """Moments in a second of the world."""
    facts: tuple[tuple[str, str], ...]
    moments: Iterator[Moment]


def _showing(command: Render, agent: str) -> Showing:
    from kinetix.agents.environments import capacity_for, environment_for
    from kinetix.agents.films import steps_per_second
    from kinetix.agents.identity import digest_of
    from kinetix.agents.named import SOLUTION, load_player
    from kinetix.environment.replay import recorded_rows, solution_physics
    from kinetix.environment.reset import level_state
    from kinetix.environment.state import document_slots
    from kinetix.level.codec import load_document
    from kinetix.pages.facts import draws_of, facts_of

    document = load_document(command.level)
    solution = document.level.solution
    recorded: dict[str, Any] | None = None
    player: Player
    if agent == SOLUTION:
        own = solution_physics(document.level, command.level)
        assert solution is not None
        recorded = recorded_rows(list(solution.unrolled()))
        player = load_player("noop")
    else:
        player = load_player(agent)
        own = player.card.environment.physics
    capacity = capacity_for(player.card, document.capacity, level=document.level.name)
    physics = command.physics or own
    env = environment_for(player, capacity, physics=physics)
    environment = player.card.environment
    if recorded and solution:
        environment = msgspec.structs.replace(environment, frame_skip=solution.frame_skip)
        held = dataclasses.replace(env.static_env_params, frame_skip=solution.frame_skip)
        env = dataclasses.replace(env, static_env_params=held)
    steps = command.steps
    if steps is None:
        film = command.out.suffix.lower() in (*FILM_SUFFIXES, PAGE)
        steps = document.level.max_timesteps if film else 0
    start = level_state(command.level, env.static_env_params)
    moments = _played(command, env, start, player, recorded)
    name = SOLUTION if recorded else player.card.name
    draws = draws_of(command.seed, command.attempt, deterministic=command.deterministic)
    return Showing(
        level=document.level,
        slots=document_slots(start, document.level, capacity),
        player=name,
        per_second=steps_per_second(environment),
        facts=facts_of(
            document.level,
            physics,
            player=name,
            digest=digest_of(player),
            draws="" if recorded else draws,
        ),
        moments=_patient(itertools.islice(moments, steps + 1)),
    )


def _patient(moments: Iterator[Moment]) -> Iterator[Moment]:
    """Pass an episode on; report that its step is being compiled if the first ones take long."""
    with announced("preparing the player and the step"):
        yield from itertools.islice(moments, 2)
    yield from moments


def _played(
    command: Render,
    env: "KinetixEnv",
    start: "EnvState",
    player: "Player",
    recorded: dict[str, Any] | None,
) -> Iterator[Moment]:
    """Play the recorded solution, an attempt of an evaluation, or an episode of its own."""
    from kinetix.environment.episode import rollout
    from kinetix.environment.replay import next_row

    if recorded is not None:
        return _told(env, rollout(env, start, next_row, **recorded))
    if command.attempt is not None:
        return _attempted(env, steps_of_attempt(command, player, command.attempt))
    decide = decide_of(command, player)
    carry = player.policy.init_carry(1)
    played = rollout(env, start, decide, params=player.params, carry=carry, seed=command.seed)
    return _told(env, played)


def _film_of(command: Render, agent: str) -> "Film":
    """Return an episode for a page."""
    import numpy as np

    from kinetix.pages.film import Film

    showing = _showing(command, agent)
    slots, nothing = showing.slots, float("nan")
    poses: list[tuple[np.ndarray, np.ndarray]] = []
    told: list[tuple[Any, float | None, float | None]] = []
    outcome = ""
    for moment in showing.moments:
        # Of a state only the poses are kept: all of it is a hundred times as much.
        physics = moment.state.physics
        poses.append((np.asarray(physics.position)[slots], np.asarray(physics.rotation)[slots]))
        told.append((moment.action or (0.0,) * 6, moment.value, moment.entropy))
        outcome = moment.outcome
    position, angle = zip(*poses, strict=True)
    actions, value, entropy = zip(*told, strict=True)

    def curve(values: Sequence[float | None]) -> "np.ndarray":
        return np.array([nothing if value is None else value for value in values])

    return Film(
        level=showing.level,
        title=showing.player,
        seconds=np.arange(len(poses)) / showing.per_second,
        position=np.stack(position),
        angle=np.stack(angle),
        actions=np.array(actions),
        value=curve(value),
        entropy=curve(entropy),
        outcome=outcome,
        facts=showing.facts,
    )


def _players(command: Render) -> list[str]:
    return [command.agent] if command.rival is None else [command.agent, command.rival]


def _write_page(command: Render) -> None:
    from kinetix.pages.page import page_of

    page = page_of([_film_of(command, player) for player in _players(command)])
    made_folder(command.out.parent)
    with replacing(command.out) as path:
        path.write_text(page, encoding="utf-8")


def _told(env: "KinetixEnv", played: Iterator["EpisodeState"]) -> Iterator[Moment]:
    """Describe an episode's steps for pictures and pages."""
    import jax
    import numpy as np

    from kinetix.agents.live import read_policy

    read = jax.jit(read_policy, static_argnums=0)
    live = controls = None
    for now in played:
        if live is None:
            live = env.actions.live(now.state.world, now.state.labels)
            controls = tuple(np.flatnonzero(live).tolist())
            yield Moment(state=now.state, step=0, action=(), outcome="")
            continue
        reading = read(env, now.said, live) if "policy" in now.said else None
        yield Moment(
            state=now.state,
            step=int(now.step),
            action=tuple(float(value) for value in env.actions.unified(now.action)),
            outcome=now.outcome or "",
            value=None if reading is None else float(reading.value),
            entropy=None if reading is None else float(reading.entropy),
            controls=controls or (),
        )


def _attempted(env: "KinetixEnv", steps: "Iterator[RecordedStep]") -> Iterator[Moment]:
    """Describe the steps of an attempt of an evaluation."""
    import numpy as np

    controls: tuple[int, ...] = ()
    for count, now in enumerate(steps):
        if count == 0:
            live = env.actions.live(now.state.world, now.state.labels)
            controls = tuple(np.flatnonzero(live).tolist())
        reading = now.reading
        yield Moment(
            state=now.state,
            step=count,
            action=() if now.action is None else tuple(float(value) for value in now.action),
            outcome="" if now.result is None else now.result.outcome,
            value=None if reading is None else float(reading.value),
            entropy=None if reading is None else float(reading.entropy),
            controls=controls,
        )


def _frames(
    moments: Iterator[Moment], command: Render, per_second: float
) -> Iterator["np.ndarray"]:
    """The pictures of a film, the last one held."""
    import numpy as np

    from kinetix.agents.films import TAIL

    last = None
    for moment in moments:
        last = np.asarray(_picture(moment, command))
        yield last
    if last is not None:
        yield from itertools.repeat(last, round(TAIL * per_second))


def _picture(moment: Moment, command: Render) -> "Image.Image":
    """Draw one frame."""
    from PIL import Image

    from kinetix.agents.films import picture_of

    picture = Image.fromarray(picture_of(moment.state, command.pixels))
    if command.overlay:
        words = caption(
            moment.step,
            moment.action,
            moment.outcome,
            value=moment.value,
            entropy=moment.entropy,
            controls=moment.controls,
        )
        write_caption(picture, words)
    return picture
