"""What the viewer does: load agents, let them play, compare, take over, measure, watch runs."""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor import files
from editor.actions import file
from editor.evaluation import Plan
from editor.jobs import Job, JobState
from editor.playback import Mode
from editor.prompts import Choice, FileQuestion, MenuQuestion
from editor.recording import Action
from editor.requests import (
    SCRIPTED,
    AgentSummary,
    Casting,
    EvaluatedLevel,
    LoadAgent,
    Observe,
    Opened,
    OpenEpisode,
    Rehearse,
)
from editor.results import Record
from editor.session import Session
from editor.viewer import AgentSlot, Compare, SlotName
from kinetix.errors import CommandError, KinetixError
from kinetix.level.codec import level_hash
from kinetix.level.model import Level
from kinetix.level.sets import gather_levels
from kinetix.paths import checkpoints_dir, levels_dir

RECENT_AGENTS: Final = 8
_AGENT_FILES: Final = ("agent.json", "params.safetensors", "config.toml")
"""A folder with one of these is an agent or a training run."""


def is_agent_folder(path: Path) -> bool:
    """Whether a folder looks like an agent or a training run."""
    return path.is_dir() and any((path / name).is_file() for name in _AGENT_FILES)


def is_run(path: Path) -> bool:
    """Whether a folder is a training run's; choosing its agent watches the run too."""
    return (path / "checkpoints").is_dir() and (path / "metrics.jsonl").is_file()


def agent_folder(path: Path) -> Path | None:
    """The agent that a dropped or chosen path means: itself, or the folder that a file is in."""
    if is_agent_folder(path):
        return path
    if path.name in _AGENT_FILES and path.is_file():
        return path.parent
    return None


def known_agents(session: Session) -> list[tuple[str, str]]:
    """Agents to choose from: (path, label), the app's own first."""
    found = [
        (str(folder), folder.name)
        for folder in sorted(checkpoints_dir().glob("*"))
        if is_agent_folder(folder)
    ]
    recent = [
        (path, Path(path).name)
        for path in session.settings.recent_agents
        if is_agent_folder(Path(path)) and path not in dict(found)
    ]
    return [*found, *recent, *((name, name) for name in SCRIPTED)]


def load_agent(session: Session, path: str | Path, slot: SlotName = "a") -> None:
    """Load an agent into a slot; a toast says when it is there, or why not.

    Args:
        session: The app.
        path: Its folder, a training run's, or the name of a scripted agent.
        slot: Which place it takes.
    """
    path = str(path)
    place = session.viewer.slots[slot]
    place.path, place.error, place.loading = path, "", True
    session.worker.submit(
        LoadAgent(path=path),
        title="Loading the agent",
        done=functools.partial(_loaded, session, slot, path),
    )


def _loaded(session: Session, slot: SlotName, path: str, job: Job) -> None:
    place = session.viewer.slots[slot]
    if place.path != path:
        return
    place.loading = False
    if job.state is JobState.FAILED:
        # The agent that was there stays: a run may be caught while it writes.
        place.error = job.error
        session.toast(job.error, "error")
        return
    if job.state is not JobState.DONE:
        return
    before, summary = place.summary, job.result
    place.summary, place.error = summary, ""
    if before is not None and before.ref.path == path:
        if before.ref != summary.ref:
            session.toast(f"{summary.name}: newer parameters loaded.", "success")
        return
    if slot == "a" and summary.ref.path not in SCRIPTED:
        session.playback.physics = summary.physics
    if slot == "a" and is_run(Path(path)) and session.viewer.run.path != path:
        session.viewer.run.watch(path)
    if path not in SCRIPTED:
        recents = [path, *(other for other in session.settings.recent_agents if other != path)]
        session.settings.recent_agents = recents[:RECENT_AGENTS]
    use = "F6 lets it play." if slot == "a" else "It can be compared with agent A, or with you."
    session.toast(f"Loaded {summary.name}. {use}", "success")
    if session.editing and slot == "a":
        _rehearse(session)


def _rehearse(session: Session) -> None:
    """Compile ahead, so that F6 starts at once; whatever is wrong is said when it is played."""
    casting = session.viewer.casting("a")
    if casting is not None and session.document.level.bodies:
        session.worker.submit(
            Rehearse(
                level=session.document.level, physics=session.playback.physics, casting=casting
            ),
            title="Preparing the agent",
        )


def clear_slot(session: Session, slot: SlotName) -> None:
    """Take the agent out of a slot."""
    session.viewer.slots[slot] = AgentSlot()
    if slot == "b":
        session.viewer.rival.stop()


def choose(slot: SlotName) -> Callable[[Session], None]:
    """An action that asks which agent to put into a slot."""

    def run(session: Session) -> None:
        def answer(choice: str | None) -> None:
            if choice == "browse":
                browse(session, slot)
            elif choice is not None:
                load_agent(session, choice, slot)

        known = known_agents(session)
        choices = tuple(Choice(id=path, label=label, detail=_where(path)) for path, label in known)
        browsing = Choice(id="browse", label="Another folder…")
        title = f"Agent {slot.upper()}"
        session.ask(MenuQuestion(title=title, choices=(*choices, browsing), at=None, answer=answer))

    return run


def _where(path: str) -> str:
    if path in SCRIPTED:
        return "scripted"
    inside = Path(path).is_relative_to(checkpoints_dir())
    return "comes with the app" if inside else str(Path(path).parent)


def browse(session: Session, slot: SlotName) -> None:
    """Ask for the folder of an agent or of a training run."""

    def answer(path: Path | None) -> None:
        if path is not None:
            load_agent(session, path, slot)

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Folder of an agent or of a training run",
            folder=_folder(session),
            answer=answer,
        )
    )


def _folder(session: Session) -> Path:
    recents = [Path(path).parent for path in session.settings.recent_agents]
    return next((path for path in recents if path.is_dir()), checkpoints_dir())


def has_agent(session: Session) -> bool:
    """Whether there is an agent to play."""
    return session.viewer.slots["a"].summary is not None


def play_agent(session: Session) -> None:
    """Let agent A play the level; without one, ask which."""
    viewer = session.viewer
    casting, summary = viewer.casting("a"), viewer.slots["a"].summary
    if casting is None or summary is None:
        choose("a")(session)
        return
    level = session.playback.level if session.playback.active else session.document.level
    assert level is not None
    session.leave_play()
    session.gallery.open = False
    with session.guard():
        files.autosave(session.document)
    viewer.by_hand = False
    session.playback.play(level, casting, player=summary.name)


def change_attempt(step: int) -> Callable[[Session], None]:
    """An action that goes to another attempt, which has other draws; what plays starts anew."""

    def run(session: Session) -> None:
        set_draws(session, attempt=max(session.viewer.attempt + step, 0))

    return run


def set_draws(
    session: Session,
    *,
    seed: int | None = None,
    attempt: int | None = None,
    deterministic: bool | None = None,
) -> None:
    """Give the agents other draws; an episode that an agent plays starts anew."""
    viewer = session.viewer
    viewer.seed = viewer.seed if seed is None else seed
    viewer.attempt = viewer.attempt if attempt is None else attempt
    viewer.deterministic = viewer.deterministic if deterministic is None else deterministic
    restart(session)


def restart(session: Session) -> None:
    """Start the agent's episode anew with what the viewer is set to now."""
    playback = session.playback
    if playback.active and playback.casting is not None:
        refresh_cast(session)
        playback.reset()


def refresh_cast(session: Session) -> None:
    """Let the next episode have the agent, seed and attempt that the viewer is set to."""
    playback, viewer = session.playback, session.viewer
    casting, summary = viewer.casting("a"), viewer.slots["a"].summary
    if playback.casting is not None and casting is not None and summary is not None:
        playback.casting, playback.player = casting, summary.name


def switch_deterministic(session: Session) -> None:
    """Take the likeliest actions, or draw them."""
    set_draws(session, deterministic=not session.viewer.deterministic)


def agent_playing(session: Session) -> bool:
    """Whether an agent plays now."""
    return session.playback.active and session.playback.casting is not None


def take_over(session: Session) -> None:
    """Drive instead of the agent; again: hand back."""
    viewer = session.viewer
    viewer.by_hand = not viewer.by_hand
    name = session.playback.player or "the agent"
    session.toast("You drive. T hands back." if viewer.by_hand else f"Handed back to {name}.")


def action_now(session: Session) -> Action | None:
    """What is played now: the held keys, or None where the agent is to choose."""
    if session.playback.casting is None or session.viewer.by_hand or any(session.action):
        return session.action
    return None


def compare(kind: Compare) -> Callable[[Session], None]:
    """An action that chooses how two players are shown."""

    def run(session: Session) -> None:
        viewer = session.viewer
        if kind != "off" and viewer.slots["b"].summary is None:
            raise CommandError("Choose an agent B first: the Agents panel has a place for it.")
        viewer.compare = kind
        viewer.compared_episode = -1

    return run


def start_here(session: Session) -> None:
    """Play on from the moment on show."""
    playback = session.playback
    playback.branch()
    session.viewer.compared_episode = playback.episode


def can_start_here(session: Session) -> bool:
    """Whether the episode can be played on from the moment on show."""
    return session.playback.can_branch


def loop_from(session: Session) -> None:
    """Begin the loop at the moment on show."""
    _set_loop(session, first=session.playback.replay_index)


def loop_to(session: Session) -> None:
    """End the loop at the moment on show."""
    _set_loop(session, last=session.playback.replay_index)


def _set_loop(session: Session, *, first: int | None = None, last: int | None = None) -> None:
    playback = session.playback
    playback.look_back()
    old = playback.loop or (0, len(playback.moments) - 1)
    low = old[0] if first is None else first
    high = old[1] if last is None else last
    playback.loop = (low, high) if low < high else None


def clear_loop(session: Session) -> None:
    """Show the whole episode again."""
    session.playback.loop = None


def levels_named(session: Session, sources: tuple[str, ...]) -> list[tuple[EvaluatedLevel, str]]:
    """Levels to evaluate on, with their hashes.

    Args:
        session: The app.
        sources: Folders, files, level sets, bundled names; empty: the level in front.

    Raises:
        LevelError: Something is missing or bad.
    """
    if not sources:
        document = session.document
        if document.path is not None and not document.dirty:
            sources = (_name_of(document.path),)
        else:
            level = document.level
            return [(EvaluatedLevel(name=level.name, source=level), document.hash)]
    return [
        (
            EvaluatedLevel(
                name=level.name, source=level.level if level.path is None else str(level.path)
            ),
            level.sha256,
        )
        for level in gather_levels(sources)
    ]


def _name_of(path: Path) -> str:
    """A bundled level by its name, so that results are called as on the command line."""
    resolved = path.resolve()
    if resolved.is_relative_to(levels_dir().resolve()):
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
        CommandError: There is no agent.
        LevelError: A level is missing or bad.
    """
    if not agents:
        raise CommandError("Choose an agent first: the Agents panel has a place for it.")
    levels = levels_named(session, sources)
    names = [level.name for level, _ in levels]
    if len(set(names)) != len(names):
        raise CommandError("Two of the levels have the same name: choose one folder or set.")
    with session.guard():
        files.autosave(session.document)
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


def open_attempt(session: Session, level: int, agent: int, attempt: int) -> None:
    """Open an episode of the evaluation in the window, the same to the bit.

    Args:
        session: The app.
        level: Index into the plan's levels.
        agent: Index into the plan's agents.
        attempt: Which attempt, from 0.
    """
    plan = session.viewer.evaluation.plan
    if plan is None:
        return
    summary = plan.agents[agent]
    casting = Casting(
        agent=summary.ref, seed=plan.seed, attempt=attempt, deterministic=plan.deterministic
    )
    source = plan.levels[level].source
    request = OpenEpisode(level=plan.levels[level], casting=casting, physics=plan.physics)

    def done(job: Job) -> None:
        if job.state is JobState.FAILED:
            session.toast(job.error, "error")
        elif job.state is JobState.DONE:
            _show(session, job.result, source, casting, summary)

    session.worker.submit(request, title="Opening the episode", urgent=True, done=done)


def _show(
    session: Session, opened: Opened, source: object, casting: Casting, summary: AgentSummary
) -> None:
    if isinstance(source, str):
        if not file.open_path(session, source):
            return
    elif session.document.hash != level_hash(opened.level):
        raise CommandError("The level has changed since it was evaluated; evaluate it again.")
    session.leave_play()
    session.playback.replay(opened.trace, opened.level, casting, player=summary.name)
    session.playback.running = True
    session.view.front = "timeline"


def watch_run(session: Session, path: str | Path) -> None:
    """Point the viewer at a training run: its metrics live, its newest agent in slot A."""
    session.viewer.run.watch(str(path))
    session.view.front = "training"


def ask_run(session: Session) -> None:
    """Ask for the folder of a training run to watch."""

    def answer(path: Path | None) -> None:
        if path is not None:
            watch_run(session, path)

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Folder of a training run",
            folder=Path.cwd(),
            answer=answer,
        )
    )


def update_viewer(session: Session) -> None:
    """Let a frame pass: the rival keeps step, runs are looked at, results are kept."""
    viewer, playback = session.viewer, session.playback
    viewer.evaluation.tick()
    if viewer.evaluation.finished > viewer.recorded:
        viewer.recorded = viewer.evaluation.finished
        _record(session)
    viewer.run.tick(session.time, functools.partial(_newer, session))
    _rival(session)
    if viewer.eye_open:
        _look(session)
    if not playback.active:
        viewer.by_hand = False


def _newer(session: Session, steps: int) -> None:
    del steps
    if session.viewer.follow_run:
        load_agent(session, session.viewer.run.path, "a")


def _record(session: Session) -> None:
    evaluation = session.viewer.evaluation
    plan = evaluation.plan
    if plan is None:
        return
    for number, agent in enumerate(plan.agents):
        results = {result.level: result for result in evaluation.results(number)}
        records = {
            sha256: Record(attempts=result.attempts, solved=result.solved)
            for level, sha256 in zip(plan.levels, plan.hashes, strict=True)
            if (result := results.get(level.name)) is not None
        }
        session.results.record(agent.name, records)


def _rival(session: Session) -> None:
    """Start, advance or stop the second episode so that it belongs to the one on show."""
    viewer, playback = session.viewer, session.playback
    rival = viewer.rival
    if not playback.active or viewer.arrangement == "off" or playback.level is None:
        if rival.active:
            rival.stop()
        viewer.compared_episode = -1
        return
    if viewer.compared_episode != playback.episode and not _challenge(session, playback.level):
        return
    try:
        rival.tick(playback.engine_step)
    except KinetixError as error:
        session.toast(f"{rival.player}: {error}", "error")


def _challenge(session: Session, level: Level) -> bool:
    """Start the second episode: another agent, or the same player under another physics."""
    viewer, playback = session.viewer, session.playback
    other = viewer.other_physics
    if other:
        viewer.rival.start(
            level, other, playback.casting, player=other, mirror=lambda: playback.actions
        )
    else:
        casting, summary = viewer.casting("b"), viewer.slots["b"].summary
        if casting is None or summary is None:
            return False
        viewer.rival.start(level, playback.physics, casting, player=summary.name)
    viewer.compared_episode = playback.episode
    return True


def _look(session: Session) -> None:
    """Ask for what the agent sees of the moment on show, one moment at a time."""
    viewer, playback = session.viewer, session.playback
    level = playback.level if playback.active else session.document.level
    snapshot = playback.snapshot if playback.active else None
    if level is None or (snapshot is not None and snapshot.state is None):
        return
    summary = viewer.slots["a"].summary
    moment = snapshot if snapshot is not None else level
    if session.viewer.eye_pending or (viewer.eye_of is moment and viewer.eye_agent is summary):
        return
    session.viewer.eye_pending = True
    viewer.eye_of, viewer.eye_agent = moment, summary
    request = Observe(
        level=level,
        state=snapshot.state if snapshot is not None else None,
        agent=summary.ref if summary is not None else None,
    )
    session.worker.submit(request, title="Looking", done=functools.partial(_looked, session))


def _looked(session: Session, job: Job) -> None:
    session.viewer.eye_pending = False
    viewer = session.viewer
    if job.state is JobState.DONE:
        viewer.eye, viewer.eye_error = job.result, ""
        viewer.eye_stamp += 1
    elif job.state is JobState.FAILED:
        viewer.eye_error = job.error


def paused_by_failure(session: Session) -> str:
    """Why what is played stands still, or nothing."""
    playback = session.playback
    return playback.failure if playback.mode is Mode.PAUSED else ""
