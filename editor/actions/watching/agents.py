"""Actions of the viewer: load agents, let them play, give them seeds, compare, take over."""

import functools
import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor.agents.folders import about_agent, agents_in, is_agent_folder, is_run, run_of
from editor.agents.viewer import AgentSlot, Compare, SlotName, mismatch
from editor.base.prompts import Choice, FileQuestion, MenuQuestion
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import (
    BUILT_IN,
    PLANNER,
    AgentSummary,
    LoadAgent,
    Rehearse,
)
from editor.worker.snapshots import Action
from kinetix.bundled import named_agent
from kinetix.errors import CommandError
from kinetix.level.model import Level
from kinetix.paths import checkpoints_dir, user_agents_dir

RECENT_AGENTS: Final = 8
LONGEST_NAME: Final = 60
"""Characters of the name of an agent that is trained here."""


def choose_agent(session: Session, path: str | Path, slot: SlotName = "a") -> None:
    """Load an agent that the person has chosen: it stays, unless it is a run's newest one."""
    if slot == "a":
        session.viewer.follow_run = is_run(Path(path))
    load_agent(session, path, slot)


def show_checkpoint(session: Session, slot: SlotName, path: Path) -> None:
    """Take another checkpoint of a run; what plays restarts: same level, same random numbers."""
    load_agent(session, path, slot)
    if slot != "a":
        return
    session.viewer.follow_run = False  # The newest agent of a run is slot A's.
    if agent_playing(session):
        session.expected = session.viewer.slots["a"].job


def known_agents(session: Session) -> list[tuple[str, str]]:
    """Agents to choose from: (path, label), the app's own first."""
    folders = [*agents_in(checkpoints_dir()), *agents_in(user_agents_dir())]
    found = [(str(folder), folder.name) for folder in folders]
    recent = [
        (path, Path(path).name)
        for path in session.settings.recent_agents
        if is_agent_folder(Path(path)) and path not in dict(found)
    ]
    return [*found, *recent, *((name, name) for name in BUILT_IN)]


def load_agent(session: Session, path: str | Path, slot: SlotName = "a") -> None:
    """Load an agent into a slot; a toast shows when it is there, or why not.

    Args:
        session: The app.
        path: Its folder, a training run's, or the name of a bundled or a scripted agent.
        slot: Which place it takes.
    """
    path = str(path)
    if path not in BUILT_IN and not os.path.isdir(path):
        path = str(named_agent(path) or path)
    place = session.viewer.slots[slot]
    place.path, place.error, place.loading, place.passed_over = path, "", True, None
    place.job = session.worker.submit(
        LoadAgent(path=path),
        title="Loading the agent",
        done=functools.partial(_arrived, session, slot, path),
    )


def _arrived(session: Session, slot: SlotName, path: str, job: Job) -> None:
    """Take a loaded agent; where somebody waits for it to play, it does."""
    _loaded(session, slot, path, job)
    if session.take_expected(job):
        if job.state is JobState.DONE and not session.editing:
            if session.viewer.guest is not None:
                session.viewer.guest.summary = None
            restart(session)
        elif job.state is JobState.DONE and not _busy(session):
            play_agent(session)


def _busy(session: Session) -> bool:
    """Return whether somebody has begun something else while an agent was loaded."""
    return session.gallery.open or bool(session.prompts) or session.driver.active


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
    if slot == "a" and summary.ref.path not in BUILT_IN and not _same(before, summary):
        session.playback.physics = summary.physics
    if slot == "a" and is_run(Path(path)) and session.viewer.run.path != path:
        session.viewer.run.watch(path)
    if path not in BUILT_IN and run_of(Path(path)) is None:
        recents = [path, *(other for other in session.settings.recent_agents if other != path)]
        session.settings.recent_agents = recents[:RECENT_AGENTS]
    session.toast(f"Loaded {summary.name}. {_use(session, summary, slot)}", "success")
    if session.editing and slot == "a":
        _rehearse(session)


def _same(before: AgentSummary | None, after: AgentSummary) -> bool:
    """Return whether an agent is one that was there, from elsewhere: parameters, card, physics."""
    if before is None or not after.digest:
        return False
    known = before.digest, before.card_digest, before.physics
    return known == (after.digest, after.card_digest, after.physics)


def _use(session: Session, summary: AgentSummary, slot: SlotName) -> str:
    """Report what a loaded agent can play."""
    if slot != "a":
        return "It can be compared with agent A, or with you."
    if _unfit(summary, _level(session)):
        return "It cannot play this level: here F6 lets the planner play."
    return "F6 lets it play."


def _level(session: Session) -> Level:
    """Return the level in front: the one that is played, or edited."""
    level = session.playback.level if session.playback.active else session.document.level
    assert level is not None
    return level


def _unfit(summary: AgentSummary, level: Level) -> str:
    """Return why an agent cannot play a level; empty where it can."""
    return "" if summary.any_size else mismatch(summary, level)


def _rehearse(session: Session) -> None:
    """Compile ahead, so that F6 starts at once; errors are reported when it is played."""
    casting = session.viewer.casting("a")
    if casting is not None and session.document.level.bodies:
        session.worker.submit(
            Rehearse(
                level=session.document.level,
                physics=session.playback.physics,
                casting=casting,
                quick=session.quick,
            ),
            title="Preparing the agent",
        )


def clear_slot(session: Session, slot: SlotName) -> None:
    """Take the agent out of a slot; without B nothing is compared with A."""
    session.viewer.slots[slot] = AgentSlot()
    if slot == "b":
        session.viewer.rival.stop()
        session.viewer.compare = "off"


def choose(slot: SlotName) -> Callable[[Session], None]:
    """Return an action that asks which agent to put into a slot."""

    def run(session: Session) -> None:
        def answer(choice: str | None) -> None:
            if choice == "browse":
                browse(session, slot)
            elif choice is not None:
                choose_agent(session, choice, slot)

        known = known_agents(session)
        choices = tuple(Choice(id=path, label=label, detail=_where(path)) for path, label in known)
        browsing = Choice(id="browse", label="Another folder…")
        title = f"Agent {slot.upper()}"
        session.ask(MenuQuestion(title=title, choices=(*choices, browsing), at=None, answer=answer))

    return run


def _where(path: str) -> str:
    if path in BUILT_IN:
        return "knows the simulator" if path == PLANNER else "scripted"
    if Path(path).is_relative_to(user_agents_dir()):
        return "trained here"
    inside = Path(path).is_relative_to(checkpoints_dir())
    return "comes with the app" if inside else str(Path(path).parent)


def browse(session: Session, slot: SlotName) -> None:
    """Ask for the folder of an agent or of a training run."""

    def answer(path: Path | None) -> None:
        if path is not None:
            choose_agent(session, path, slot)

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Folder of an agent or of a training run",
            folder=_folder(session),
            answer=answer,
            describe=about_agent,
            wanted="an agent or a training run",
        )
    )


def _folder(session: Session) -> Path:
    recents = [Path(path).parent for path in session.settings.recent_agents]
    return next((path for path in recents if os.path.isdir(path)), checkpoints_dir())


def play_agent(session: Session) -> None:
    """Let agent A play the level, as soon as it is loaded.

    If none is chosen, or it sees one other size only, the planner plays.
    """
    viewer, place = session.viewer, session.viewer.slots["a"]
    if viewer.guest is not None:
        session.leave_play()  # The new player has the viewer's own random numbers and physics.
    if place.loading:
        session.expected = place.job
        return
    level = _level(session)
    if place.passed_over is not None and not _unfit(place.passed_over, level):
        _play_once_loaded(session, place.passed_over.ref.path)
        return
    summary = place.summary
    unfit = "" if summary is None else _unfit(summary, level)
    if summary is None or unfit:
        if summary is not None:
            session.toast(f"{summary.name}: {unfit} The planner plays instead.")
        elif session.training.running:
            session.toast("The agent that is being trained is not there yet: the planner plays.")
        _play_once_loaded(session, PLANNER)
        place.passed_over = summary
        return
    session.leave_play()
    session.gallery.open = False
    session.messages.hush()
    session.autosaves.keep(session.document)
    viewer.by_hand = False
    session.playback.play(level, viewer.cast(summary), player=summary.name)


def _play_once_loaded(session: Session, path: str) -> None:
    load_agent(session, path, "a")
    session.expected = session.viewer.slots["a"].job


def change_attempt(step: int) -> Callable[[Session], None]:
    """Make an action for another attempt, with other random numbers; what plays restarts."""

    def run(session: Session) -> None:
        set_draws(session, attempt=max(session.viewer.draws.attempt + step, 0))

    return run


def set_draws(
    session: Session,
    *,
    seed: int | None = None,
    attempt: int | None = None,
    deterministic: bool | None = None,
) -> None:
    """Give the agents other random numbers; an episode that an agent plays restarts.

    While an attempt of an evaluation is on show, it alone has them.
    """
    draws = session.viewer.draws
    draws.seed = draws.seed if seed is None else seed
    draws.attempt = draws.attempt if attempt is None else attempt
    draws.deterministic = draws.deterministic if deterministic is None else deterministic
    restart(session)


def restart(session: Session) -> None:
    """Restart the agent's episode with the present settings of the viewer."""
    playback = session.playback
    if playback.active and playback.casting is not None:
        refresh_cast(session)
        playback.reset()


def refresh_cast(session: Session) -> None:
    """Let the next episode have the seed and attempt that the viewer is set to, and agent A.

    An attempt that was opened from an evaluation keeps its own agent and draws.
    """
    playback, viewer = session.playback, session.viewer
    if playback.casting is None:
        return
    summary, guest = viewer.slots["a"].summary, viewer.guest
    if guest is not None and guest.summary is not None:
        summary = guest.summary
    if summary is not None:
        playback.cast(viewer.cast(summary), summary.name)


def switch_deterministic(session: Session) -> None:
    """Take the likeliest actions, or draw them."""
    set_draws(session, deterministic=not session.viewer.draws.deterministic)


def agent_playing(session: Session) -> bool:
    """Return whether an agent plays now."""
    return session.playback.active and session.playback.casting is not None


def take_over(session: Session) -> None:
    """Drive instead of the agent; again: hand back."""
    viewer = session.viewer
    if session.mode in (Mode.ENDED, Mode.REPLAY):
        raise CommandError(
            "The episode is over: Reset starts it again, Start Here goes on from the moment shown."
        )
    viewer.by_hand = not viewer.by_hand
    name = session.playback.player or "the agent"
    session.toast("You drive. T hands back." if viewer.by_hand else f"Handed back to {name}.")


def action_now(session: Session) -> Action | None:
    """Return the action of the next step: the held keys, or None where the agent is to choose."""
    if session.playback.casting is None or session.viewer.by_hand or any(session.action):
        return session.action
    return None


def compare(kind: Compare) -> Callable[[Session], None]:
    """Return an action that chooses how two players are shown."""

    def run(session: Session) -> None:
        viewer = session.viewer
        if kind != "off" and viewer.slots["b"].summary is None:
            raise CommandError("Choose an agent B first: the Agents panel has a place for it.")
        viewer.compare = kind
        viewer.compared_episode = -1

    return run
