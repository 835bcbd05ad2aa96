"""Evaluations: which levels, start, keep the results, open an attempt."""

import os
from pathlib import Path
from typing import Final

from editor.actions.evaluation.comparison import present
from editor.actions.files import file
from editor.actions.files.unsaved import tell_unsaved
from editor.actions.watching.agents import known_agents
from editor.agents.attempt_paths import Ways
from editor.agents.evaluation import Plan
from editor.agents.folders import about_agent
from editor.agents.viewer import Guest
from editor.base.prompts import Choice, FileQuestion, MenuQuestion
from editor.gallery.results import Record, Trial
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import (
    BUILT_IN,
    AgentSummary,
    Casting,
    EvaluatedLevel,
    LoadAgent,
    Opened,
    OpenEpisode,
    Standing,
    TracePaths,
)
from kinetix.errors import CommandError
from kinetix.level.codec import level_hash
from kinetix.level.model import Level
from kinetix.level.sets import gather_levels
from kinetix.level.validate import has_errors
from kinetix.paths import levels_dir, working_dir


def levels_named(session: Session, sources: tuple[str, ...]) -> list[tuple[EvaluatedLevel, str]]:
    """Return levels to evaluate on, with their hashes.

    Args:
        session: The app.
        sources: Folders, files, level sets, bundled names; empty: the level in front.

    Raises:
        LevelError: Something is missing or bad.
    """
    if not sources:
        document = session.document
        if document.path is not None and not document.dirty:
            sources = (str(document.path),)
        else:
            level = document.level
            return [(EvaluatedLevel(name=level.name, source=level), document.hash)]
    levels = gather_levels([_name_of(Path(source)) for source in sources])
    return [
        (
            EvaluatedLevel(
                name=name, source=level.level if level.path is None else str(level.path)
            ),
            level.sha256,
        )
        for name, level in zip(
            _without_folder([level.name for level in levels]), levels, strict=True
        )
    ]


def _without_folder(names: list[str]) -> list[str]:
    """Return names without the folder that all whole paths among them have in common.

    A table is handed on; it does not tell where somebody keeps their files.
    """
    whole = [name for name in names if os.path.isabs(name)]
    if not whole:
        return names
    folder = os.path.commonpath([os.path.dirname(name) for name in whole])
    short = [os.path.relpath(name, folder) if name in whole else name for name in names]
    return short if len(set(short)) == len(names) else names


def sources_asked(session: Session) -> tuple[str, ...]:
    """Return the sources that the fields of *Evaluate* name; the gallery's are those chosen now.

    Raises:
        CommandError: Nothing is chosen in the gallery.
    """
    form = session.viewer.form
    if form.source != "chosen":
        return form.paths
    chosen = session.gallery.chosen(session.library, session.results)
    if not chosen:
        raise CommandError("Choose levels in the gallery first (Ctrl+G).")
    return tuple(card.path for card in chosen)


def _name_of(path: Path) -> str:
    """Return a bundled level by its name, so that results are called as on the command line."""
    resolved = path.resolve()
    if os.path.isfile(resolved) and resolved.is_relative_to(levels_dir().resolve()):
        return resolved.relative_to(levels_dir().resolve()).with_suffix("").as_posix()
    return str(path)


def evaluate(session: Session) -> None:
    """Show the panel that measures agents on levels."""
    session.view.front = "evaluate"


def start_evaluation(
    session: Session,
    agents: tuple[AgentSummary, ...],
    sources: tuple[str, ...],
    *,
    attempts: int,
    seed: int,
    physics: str,
    deterministic: bool,
) -> None:
    """Begin an evaluation in the background.

    Raises:
        CommandError: No agent is given, or the level in front has errors.
        LevelError: A level is missing or bad.
    """
    if not agents:
        raise CommandError("Choose an agent first: the Agents panel has a place for it.")
    if not sources and has_errors(session.document.problems):
        raise CommandError("The level has errors, so nobody can play it: Problems lists them.")
    levels = levels_named(session, sources)
    names = [level.name for level, _ in levels]
    if len(set(names)) != len(names):
        raise CommandError("Two of the levels have the same name: choose one folder or set.")
    session.autosaves.keep(session.document)
    plan = Plan(
        agents=agents,
        levels=tuple(level for level, _ in levels),
        hashes=tuple(sha256 for _, sha256 in levels),
        attempts=attempts,
        seed=seed,
        physics=physics,
        deterministic=deterministic,
    )
    session.viewer.evaluation.start(plan)
    tell_unsaved(session, [level.source for level in plan.levels if isinstance(level.source, str)])


def ask_contender(session: Session) -> None:
    """Ask for one more agent to measure, or for all checkpoints of a training run."""
    choices = []
    for path, label in known_agents(session):
        if path in BUILT_IN:
            continue
        choices.append(Choice(id=path, label=label))
        steps = steps_in(Path(path))
        if steps:
            some = f"{MOST_CHECKPOINTS} of {len(steps)} checkpoints"
            which = "every checkpoint" if len(steps) <= MOST_CHECKPOINTS else some
            choices.append(Choice(id=f"{_EVERY}{path}", label=f"{label}, {which}"))
    browsing = Choice(id="browse", label="Another folder…")

    def answer(choice: str | None) -> None:
        if choice == "browse":
            _browse_contender(session)
        elif choice is not None and choice.startswith(_EVERY):
            for path in spread(steps_in(Path(choice.removeprefix(_EVERY)))):
                add_contender(session, str(path))
        elif choice is not None:
            add_contender(session, choice)

    session.ask(
        MenuQuestion(title="Measure too", choices=(*choices, browsing), at=None, answer=answer)
    )


_EVERY: Final = "every:"
MOST_CHECKPOINTS: Final = 100
"""Checkpoints of a run that are measured at a time: a table of more cannot be read."""


def spread(steps: list[Path]) -> list[Path]:
    """Return as many checkpoints as are measured, evenly from the first to the last."""
    if len(steps) <= MOST_CHECKPOINTS:
        return steps
    last = len(steps) - 1
    return [steps[k * last // (MOST_CHECKPOINTS - 1)] for k in range(MOST_CHECKPOINTS)]


def steps_in(run: Path) -> list[Path]:
    """Return the folders of a training run's checkpoints, the oldest first."""
    folder = run / "checkpoints"
    found = [path for path in folder.glob("*") if path.name.isdecimal()]
    return sorted(found, key=lambda path: int(path.name))


def _browse_contender(session: Session) -> None:
    def answer(path: Path | None) -> None:
        if path is not None:
            add_contender(session, str(path))

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Folder of an agent or of a training run",
            folder=working_dir(),
            answer=answer,
            describe=about_agent,
            wanted="an agent or a training run",
        )
    )


def add_contender(session: Session, path: str) -> None:
    """Load an agent to be measured besides those of the slots."""

    def done(job: Job) -> None:
        if job.state is JobState.FAILED:
            session.toast(job.error, "error")
        elif job.state is JobState.DONE:
            known = session.viewer.contenders
            session.viewer.contenders = tuple(dict.fromkeys((*known, job.result)))

    session.worker.submit(LoadAgent(path=path), title="Loading the agent", done=done)


def show_paths(session: Session, level: int, agent: int) -> None:
    """Draw the ways of all attempts over their level; again: take them away.

    Args:
        session: The app.
        level: Index into the plan's levels.
        agent: Index into the plan's agents.
    """
    viewer = session.viewer
    plan = viewer.evaluation.plan
    if viewer.ways_of(level, agent) is not None or plan is None:
        viewer.ways = None
        return
    if not _bring(session, plan.levels[level].source):
        return
    request = TracePaths(
        level=plan.levels[level],
        casting=Casting(
            agent=present(session, plan.agents[agent]).ref,
            seed=plan.seed,
            deterministic=plan.deterministic,
        ),
        attempts=plan.attempts,
        physics=plan.physics_of(agent),
    )

    def done(job: Job) -> None:
        viewer.ways_pending = False
        if job.state is JobState.FAILED:
            session.toast(job.error, "error")
        elif job.state is JobState.DONE and job.result.level_hash != plan.hashes[level]:
            _refuse(session, plan, level)
        elif job.state is JobState.DONE:
            viewer.ways = Ways(plan=plan, level=level, agent=agent, paths=job.result)

    viewer.ways_pending = True
    session.evaluator.submit(request, title="Playing the attempts", done=done)


def _refuse(session: Session, plan: Plan, level: int) -> None:
    """Report that results of a level do not hold since it was changed."""
    name = plan.levels[level].name
    session.toast(f"{name} is another level by now; evaluate it again.", "error")


def open_attempt(
    session: Session, level: int, agent: int, attempt: int, *, at: int | None = None
) -> None:
    """Open an episode of the evaluation in the window, the same to the bit.

    Args:
        session: The app.
        level: Index into the plan's levels.
        agent: Index into the plan's agents.
        attempt: Which attempt, from 0.
        at: Environment step to stand still at; None: it plays from the start.
    """
    plan = session.viewer.evaluation.plan
    if plan is None:
        return
    summary = present(session, plan.agents[agent])
    casting = Casting(
        agent=summary.ref,
        seed=plan.seed,
        attempt=attempt,
        deterministic=plan.deterministic,
        digest=summary.digest,
    )
    source = plan.levels[level].source
    request = OpenEpisode(level=plan.levels[level], casting=casting, physics=plan.physics_of(agent))

    def done(job: Job) -> None:
        awaited = session.take_expected(job) and job.state is JobState.DONE
        if job.state is JobState.FAILED:
            session.toast(job.error, "error")
        elif awaited:
            if level_hash(job.result.level) != plan.hashes[level]:
                _refuse(session, plan, level)
                return
            _show(session, job.result, source, casting, summary)
            if at is not None and session.mode is Mode.REPLAY:
                session.playback.running = False
                session.playback.scrub(at)

    job = session.worker.submit(request, title="Opening the episode", urgent=True, done=done)
    session.expected = job


def _bring(session: Session, source: str | Level) -> bool:
    """Show a level that was evaluated; returns whether it is there."""
    if isinstance(source, str):
        return file.open_in_front(session, source)
    file.bring(session, source)
    return True


def _show(
    session: Session, opened: Opened, source: str | Level, casting: Casting, summary: AgentSummary
) -> None:
    if not _bring(session, source):
        return
    session.leave_play()
    _go_on_with(session, summary, casting)
    session.playback.replay(opened.trace, opened.level, casting, player=summary.name)
    session.playback.running = True
    session.view.front = "timeline"


def _go_on_with(session: Session, summary: AgentSummary, casting: Casting) -> None:
    """Let Reset and another attempt go on from an attempt: its agent, its draws."""
    viewer = session.viewer
    own = viewer.slots["a"].summary
    viewer.guest = Guest(
        summary=None if own is not None and own.ref == summary.ref else summary,
        seed=casting.seed,
        attempt=casting.attempt,
        deterministic=casting.deterministic,
    )


def keep_results(session: Session) -> None:
    """Note who solved what for the gallery, once an evaluation has come to its end.

    Of one that was cancelled or failed, the levels that were played to the end count.
    """
    fault = session.results.take_fault()
    if fault:
        session.toast(
            f"{fault}. Its results are not shown. The next result replaces the file; the old one "
            "is kept as a .bak file beside it",
            "warning",
        )
    ended = session.viewer.evaluation.ended
    while ended:
        plan, standing = ended.pop(0)
        solved = (_solved(plan, standing, number) for number in range(len(plan.agents)))
        found = {trial: records for trial, records in solved if records}
        if found:
            session.results.record_all(found)


def _solved(plan: Plan, standing: Standing, number: int) -> tuple[Trial, dict[str, Record]]:
    """Return what one agent of an evaluation solved."""
    agent = plan.agents[number]
    results = {
        score.result.level: score.result for score in standing.scores if score.agent == number
    }
    records = {
        sha256: Record(attempts=result.attempts, solved=result.solved)
        for level, sha256 in zip(plan.levels, plan.hashes, strict=True)
        if (result := results.get(level.name)) is not None
    }
    trial = Trial(
        player=agent.name,
        digest=agent.digest,
        physics=plan.physics_of(number),
        deterministic=plan.deterministic,
        seed=plan.seed,
        card=agent.card_digest,
    )
    return trial, records
