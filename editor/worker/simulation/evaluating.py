"""Evaluations in the background, their episodes opened again, training runs looked at."""

import dataclasses
from typing import Any

from editor.worker.requests import (
    BUILT_IN,
    AttemptPaths,
    Ending,
    Evaluate,
    Opened,
    OpenEpisode,
    Progress,
    Score,
    Standing,
    TracePaths,
)
from editor.worker.simulation.cast import Step, mind_of, player_of
from editor.worker.simulation.level_view import LevelView
from editor.worker.snapshots import Mind, Snapshot, Trace, channels_of
from kinetix.agents.environments import capacity_for, environment_for
from kinetix.agents.evaluate import (
    NamedLevel,
    RecordedStep,
    Settings,
    capacity_and_key,
    evaluate,
    record,
)
from kinetix.agents.identity import digest_of
from kinetix.agents.player import Player
from kinetix.agents.results import LevelFailure
from kinetix.agents.trajectories import attempt_paths, endings, parting
from kinetix.engine.spec import Capacity
from kinetix.environment.env import KinetixEnv
from kinetix.environment.state import document_slots
from kinetix.errors import KinetixError
from kinetix.level.codec import level_hash, load_level
from kinetix.level.model import Level
from kinetix.wording import plural

_SEGMENT = 4
"""Environment steps between two looks at whether the evaluation was cancelled: 128 episodes of
size l take some 60 ms a step with a transformer on two cores."""


def run_evaluation(request: Evaluate, progress: Progress) -> Standing:
    """Play every agent on every level; see `Evaluate`.

    A level that an agent cannot play is reported and left out, and so is an agent that cannot play
    at all; the others go on.

    Raises:
        KinetixError: No agent can play at all.
    """
    settings = Settings(
        attempts=request.attempts,
        seed=request.seed,
        physics=request.physics,
        deterministic=request.deterministic,
    )
    levels = [NamedLevel(name=level.name, source=level.source) for level in request.levels]
    each = len(levels) * request.attempts
    total = each * len(request.agents)
    scores: tuple[Score, ...] = ()
    failures: tuple[tuple[int, LevelFailure], ...] = ()
    errors: list[tuple[int, str]] = []
    standing = Standing(done=0, total=total, scores=())
    for number, ref in enumerate(request.agents):
        now: tuple[Score, ...] = ()
        failed: tuple[tuple[int, LevelFailure], ...] = ()
        try:
            player = player_of(ref)
            compiling = f"Compiling for {player.card.name}"
            progress.report(number / len(request.agents), compiling)
            for turn, step in enumerate(evaluate(player, levels, settings, segment=_SEGMENT)):
                now = tuple(Score(agent=number, result=result) for result in step.results)
                failed = tuple((number, failure) for failure in step.failures)
                done = number * each + step.done
                standing = Standing(
                    done=done,
                    total=total,
                    scores=scores + now,
                    errors=tuple(errors),
                    failures=failures + failed,
                )
                progress.share(standing)
                # Before the first turn comes back, its step is compiled.
                words = f"{done} of {plural(total, 'episode')}" if turn else compiling
                progress.report(done / total, words)
        except KinetixError as error:
            errors.append((number, str(error)))
        scores, failures = scores + now, failures + failed
    if errors and not scores and not failures:
        raise KinetixError(errors[0][1])
    return Standing(done=total, total=total, scores=scores, errors=tuple(errors), failures=failures)


def open_episode(request: OpenEpisode, progress: Progress) -> Opened:
    """Play one attempt of an evaluation again and keep every moment.

    Raises:
        KinetixError: The agent cannot be loaded or cannot play the level; the level is bad.
    """
    casting, source = request.casting, request.level.source
    player = player_of(casting.agent)
    level = source if isinstance(source, Level) else load_level(source)
    settings = Settings(
        attempts=casting.attempt + 1,
        seed=casting.seed,
        physics=request.physics,
        deterministic=casting.deterministic,
    )
    named = NamedLevel(name=request.level.name, source=source)
    capacity, _ = capacity_and_key(source)
    capacity = capacity_for(player.card, capacity, level=request.level.name)
    env = environment_for(player, capacity, physics=request.physics)
    progress.report(None, "Compiling the episode")
    recorder = _Recorder(level, capacity, env, player)
    for step in record(player, named, casting.attempt, settings):
        recorder.take(step)
        done = len(recorder.snapshots)
        progress.report(done / level.max_timesteps, f"Step {done - 1}")
    snapshots = tuple(recorder.snapshots)
    return Opened(
        level=level,
        trace=Trace(
            physics=request.physics,
            perturbed=False,
            snapshots=snapshots,
            actions=tuple(channels_of(snapshot.action) for snapshot in snapshots[1:]),
            player=player.card.name,
            seed=casting.seed,
            attempt=casting.attempt,
            deterministic=casting.deterministic,
            digest=digest_of(player),
        ),
    )


def trace_paths(request: TracePaths, progress: Progress) -> AttemptPaths:
    """Play all attempts on a level again and keep the way of the green shape.

    Raises:
        KinetixError: The agent cannot be loaded or cannot play the level; the level is bad.
    """
    casting, source = request.casting, request.level.source
    level = source if isinstance(source, Level) else load_level(source)
    settings = Settings(
        attempts=request.attempts,
        seed=casting.seed,
        physics=request.physics,
        deterministic=casting.deterministic,
    )
    named = NamedLevel(name=request.level.name, source=source)
    progress.report(None, "Playing the attempts")
    paths = None
    for known in attempt_paths(player_of(casting.agent), named, settings):
        progress.report(None, "Playing the attempts")
        paths = known
    assert paths is not None
    return AttemptPaths(
        level_hash=level_hash(level),
        step=paths.step,
        position=paths.position,
        outcomes=tuple(result.outcome for result in paths.results),
        parting=parting(paths),
        endings=tuple(Ending(**dataclasses.asdict(one)) for one in endings(paths)),
    )


class _Recorder:
    """Makes snapshots of recorded steps."""

    def __init__(self, level: Level, capacity: Capacity, env: KinetixEnv, player: Player) -> None:
        self.snapshots: list[Snapshot] = []
        self._level, self._capacity = level, capacity
        self._env = env
        self._scripted = player.card.name in BUILT_IN
        self._frame_skip = player.card.environment.frame_skip
        self._view: LevelView | None = None

    def take(self, step: RecordedStep) -> None:
        """Add a moment."""
        if self._view is None:
            slots = document_slots(step.state, self._level, self._capacity)
            self._view = LevelView(self._level, self._capacity, slots)
            self.snapshots.append(self._view.first(step.state, self._frame_skip))
            return
        assert step.action is not None
        result = step.result
        info: dict[str, Any] = {"reward": step.reward, "distance": step.distance}
        stepped = Step(state=step.state, info=info, unified=step.action)
        self.snapshots.append(
            self._view.after(
                self.snapshots[-1],
                stepped,
                outcome=None if result is None else result.outcome,
                mind=self._mind(step),
                memory=step.carry,
                contacts=True,
            )
        )

    def _mind(self, step: RecordedStep) -> Mind:
        said = step.reading
        if said is None:
            return mind_of(step.action, step.action, scripted=True)
        return mind_of(
            said.intention,
            step.action,
            value=float(said.value),
            entropy=float(said.entropy),
            chances=said.chances,
        )
