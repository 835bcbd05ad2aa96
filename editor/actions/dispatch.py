"""From events and time to actions: key chords, the pointer, the queue, the clock."""

import functools
import os
from pathlib import Path
from typing import Final

from editor.actions.base import Action, Context, contexts, reached, selecting
from editor.actions.editing import context
from editor.actions.editing.context import Table
from editor.actions.editing.pointer import move_wheel, pinch, use_pointer
from editor.actions.files import address, external_change, quitting, recording
from editor.actions.gallery import gallery, many_files
from editor.actions.playing import play
from editor.actions.table import ACTIONS, BY_ID
from editor.actions.training import train
from editor.actions.watching import agents, watch
from editor.agents.folders import agent_folder
from editor.base.camera import Point
from editor.base.controls import PAD, PAD_ACTIONS
from editor.base.events import (
    NO_MODIFIERS,
    DropEvent,
    FocusEvent,
    InputEvent,
    KeyEvent,
    PadEvent,
    PinchEvent,
    PointerEvent,
    QuitEvent,
    TextEvent,
    WheelEvent,
)
from editor.base.prompts import MenuQuestion
from editor.documents.commands.base import EntityId
from editor.session import Session
from kinetix.errors import CommandError

MODIFIER_KEYS: Final = frozenset(
    f"{side} {name}" for side in ("left", "right") for name in ("ctrl", "shift", "alt", "meta")
)
SETTINGS_SECONDS: Final = 1.0
"""Interval at which changed settings are written [s]."""
IDLE: Final = 0.2
"""After a frame that took so long nothing goes on; the next one may be far [s]."""
OUTSIDE_SECONDS: Final = 2.0
"""Interval at which the file in front is checked for changes from outside [s]."""

_ELSEWHERE: Final = {
    Context.EDIT: "Stop playing first: Esc.",
    Context.PLAY: "Play the level first: Space.",
    Context.LEVEL: "Close the gallery first: Esc.",
    Context.GALLERY: "Open the gallery first: Ctrl+G.",
}
"""Messages for actions of another context."""


def chords(session: Session, action: Action) -> tuple[str, ...]:
    """Return the chords of an action, rebound ones included."""
    return tuple(session.settings.keys.get(action.id, action.keys))


def find(session: Session, chord: str) -> Action | None:
    """Find the action of a chord now: that of the narrowest context that keys reach first.

    An exact binding wins over one that matches when Shift or Alt is ignored.
    """
    able = [each for each in ACTIONS if not (each.seen and session.view.covered)]
    usable = [each for context in reached(session) for each in able if each.context is context]
    own = (action for action in usable if chord in chords(session, action))
    varied = (action for action in usable if chord in action.variants)
    return next(own, None) or next(varied, None)


def available(session: Session, action: Action) -> bool:
    """Return whether an action can be done now."""
    return action.context in contexts(session) and action.enabled(session)


def refusal(session: Session, action: Action) -> str:
    """Return why an action cannot be done now; empty when it can."""
    if available(session, action):
        return ""
    if action.context not in contexts(session):
        return _ELSEWHERE.get(action.context, "Not possible here.")
    if action.refusal:
        return action.refusal
    if action.enabled is selecting and not session.selection:
        return "Select something first."
    return _ELSEWHERE[Context.PLAY if session.editing else Context.EDIT]


def run(session: Session, action_id: str) -> bool:
    """Do an action now.

    Args:
        session: The app.
        action_id: Its id.

    Returns:
        Whether it was enabled.

    Raises:
        CommandError: No action has this id.
    """
    if action_id not in BY_ID:
        raise CommandError(f"there is no action {action_id!r}; there are {', '.join(BY_ID)}")
    action = BY_ID[action_id]
    if not available(session, action):
        return False
    if session.driver.active and action_id not in ("edit.cancel", "edit.undo"):
        session.driver.cancel()
    session.messages.crashes.note(action_id)
    with session.guard():
        action.run(session)
    return True


def handle(session: Session, event: InputEvent) -> bool:
    """Take one event that the toolkit does not want for itself.

    Returns:
        Whether it meant something.
    """
    match event:
        case KeyEvent():
            return _key(session, event)
        case TextEvent(text=text):
            return _drawing(session) and session.driver.text(text)
        case PointerEvent():
            with session.guard():
                use_pointer(session, event, _table(session))
        case WheelEvent():
            move_wheel(session, event)
        case PinchEvent():
            pinch(session, event)
        case PadEvent():
            return _pad(session, event)
        case FocusEvent(focused=False):
            session.release_all()
            session.hands.modifiers = NO_MODIFIERS
        case DropEvent(path=path):
            _dropped(session, Path(path))
        case QuitEvent():
            run(session, "file.quit")
        case _:
            return False
    return True


def open_menu_of(session: Session, entity: EntityId, at: Point) -> None:
    """Ask what to do with an entity, as a right click on it does.

    Args:
        session: The app.
        entity: Its id, or the name of a part of the arena.
        at: Where the menu opens [px].
    """
    context.open_menu_of(session, entity, at, _table(session))


def _table(session: Session) -> Table:
    return Table(words=functools.partial(_words, session), run=functools.partial(run, session))


def _words(session: Session, action_id: str) -> tuple[str, str]:
    """Return label and first chord of an action."""
    action = BY_ID[action_id]
    chosen = chords(session, action)
    return action.label, chosen[0] if chosen else ""


def _dropped(session: Session, path: Path) -> None:
    """An agent goes to the viewer, folders and level sets to the gallery, a file is opened."""
    folder = agent_folder(path)
    if folder is not None:
        agents.choose_agent(session, folder)
        session.view.front = "agents"
    elif os.path.isdir(path):
        gallery.include_folder(session, path)
        session.gallery.open = True
    else:
        address.open_any(session, str(path))


def _key(session: Session, event: KeyEvent) -> bool:
    session.hands.modifiers = event.modifiers
    if not event.pressed:
        session.hands.held.discard(event.key)
        return True
    if session.hands.capture is not None:
        if event.key not in MODIFIER_KEYS and not event.repeat:
            session.hands.capture(event.chord)
        return True
    if Context.LEVEL in reached(session):
        session.hands.held.add(event.key)
    if _drawing(session) and session.driver.active:
        if event.key == "backspace":
            session.driver.backspace()
            return True
        if event.key in ("return", "enter") and session.driver.accept():
            return True
    action = find(session, event.chord)
    if action is None or (event.repeat and not _repeats(action)):
        return False
    driving = Context.PLAY in reached(session) and not event.modifiers.prefix
    if driving and event.key in session.control_keys:
        return True
    return run(session, action.id)


def _pad(session: Session, event: PadEvent) -> bool:
    """A gamepad's sticks and buttons are held like keys; three of its buttons do something."""
    if not event.pressed:
        session.hands.held.discard(event.control)
        return True
    if Context.LEVEL not in reached(session):
        return False
    action = PAD_ACTIONS.get(event.control)
    if action is None:
        session.hands.held.add(event.control)
        return event.control in PAD
    return run(session, "run.play_human" if session.editing and action == "run.pause" else action)


def _drawing(session: Session) -> bool:
    """Return whether keys and text reach a tool in Edit."""
    return Context.EDIT in reached(session)


def _repeats(action: Action) -> bool:
    """Return whether holding the key does the action again and again."""
    repeating = ("transform.", "run.step", "edit.undo", "edit.redo", "gallery.move", "view.zoom")
    return action.id.startswith(repeating)


def update(session: Session, seconds: float) -> None:
    """Let a frame pass: do what is queued, then let time pass.

    Args:
        session: The app.
        seconds: Time since the last frame [s].
    """
    work(session)
    advance(session, seconds)


def work(session: Session) -> None:
    """Do what is queued."""
    for item in session.take_queue():
        if isinstance(item, str):
            with session.guard():
                run(session, item)
        elif callable(item):
            with session.guard():
                item()
        else:
            session.execute(item)


def advance(session: Session, seconds: float) -> None:
    """Let time pass: take finished jobs, play on, save copies.

    Args:
        session: The app.
        seconds: Time since the last call [s].
    """
    before = session.time
    session.time += seconds
    session.messages.expire()
    with session.guard():
        session.worker.poll()
        session.fetches.poll()
        session.library.poll()
        session.evaluator.poll()
    debugging = session.view.debug_draw and bool(session.settings.debug_draw)
    session.playback.simulator.keep_contacts = debugging or session.viewer.timeline_open
    again = session.settings.restart_automatically and not session.viewer.rival.goes_on
    session.playback.restart_automatically = again
    # Two players begin together: the one that is ready waits. So does all play for an answer.
    asked = any(not isinstance(prompt, MenuQuestion) for prompt in session.prompts)
    passed = 0.0 if asked or session.viewer.rival.preparing else seconds
    with session.guard():
        session.playback.tick(passed, agents.action_now(session), session.hands.pull)
    # What is measured or compared is shown step by step, and so are the renderer's pictures.
    exact = debugging or session.viewer.rival.active or session.settings.renderer_picture
    if exact:
        session.motion.moment = None
    else:
        session.motion.advance(session.playback, seconds)
    if session.attended:
        audible = session.settings.sound
        session.sound.listen(session.playback, session.time, audible=audible)
    with session.guard():
        many_files.go_on(session)
    with session.guard():
        recording.follow(session)
        quitting.update_leaving(session)
        watch.update_viewer(session, passed)
        train.update_training(session)
        play.note_end(session)
    with session.guard():
        session.autosaves.follow(session.tabs.documents)
    with session.guard():
        paths = (tab.document.path for tab in session.tabs)
        session.autosaves.open_files(path for path in paths if path is not None)
    if seconds >= IDLE or _passed(before, session.time, SETTINGS_SECONDS):
        with session.guard():
            session.keeper.save()
        with session.guard():
            session.kept_set.keep(session.gallery.tray)
    if _passed(before, session.time, OUTSIDE_SECONDS):
        with session.guard():
            external_change.check(session)


def _passed(before: float, now: float, period: float) -> bool:
    return int(before / period) != int(now / period)
