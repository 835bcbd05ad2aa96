"""Actions of the Edit and Arrange menus."""

import math
from collections.abc import Callable, Iterable
from typing import Literal

from editor.base.prompts import TextQuestion
from editor.base.wording import plain_name, title_of
from editor.documents.commands import clip
from editor.documents.commands.base import Command, Selection
from editor.documents.commands.fields import PasteProperties, SetField
from editor.documents.commands.group import Mirror, Move, MoveEach, Remove, Reorder, Rotate
from editor.documents.commands.parts import PARTS
from editor.documents.commands.rigid import component, joined
from editor.documents.document import Document
from editor.editing.tools import TOOLS
from editor.session import Session
from editor.worker.jobs import Job
from editor.worker.requests import LoadAgent
from kinetix.errors import CommandError
from kinetix.level.geometry import bounds
from kinetix.level.model import MAX_NAME, Level
from kinetix.wording import plural

MIDDLE = (2.5, 2.5)
"""Place of new parts when the pointer is elsewhere [m]."""
PASTE_SHIFT = (0.1, 0.1)
"""Offset of a duplicate [m]."""
NUDGE_FINE = 0.1
"""Alt+arrow moves this fraction of a step."""
NUDGE_COARSE = 10
"""Shift+arrow moves this many steps."""


def undo(session: Session) -> None:
    """Take the last edit back."""
    if session.driver.cancel():
        return
    if session.document.undo() is None:
        session.complain("There is nothing to undo.")


def redo(session: Session) -> None:
    """Do the next edit again."""
    session.driver.cancel()
    if session.document.redo() is None:
        session.complain("There is nothing to redo.")


def copy(session: Session) -> None:
    """Put the selection on the clipboard."""
    found = clip.copied(session.document.level, session.selection)
    if not (found.bodies or found.joints or found.thrusters):
        raise CommandError("Nothing that can be copied is selected.")
    session.clipboard.set(clip.dumps(found))


def cut(session: Session) -> None:
    """Copy, then delete; not what is locked, nor what could not be pasted.

    Raises:
        CommandError: No shape is selected.
    """
    ids = _unlocked(session)
    found = clip.copied(session.document.level, ids)
    if not found.bodies:
        raise CommandError(
            "Only shapes can be cut, with their joints and thrusters: Delete removes those alone."
        )
    session.clipboard.set(clip.dumps(found))
    before = {joint.id for joint in session.document.level.joints}
    if not session.execute(Remove(ids=tuple(body.id for body in found.bodies))).changed:
        return
    staying = sum(entity.id in ids for entity in session.document.level.entities())
    if staying == 1:
        session.complain("1 item was kept: it is attached to something that was not cut.")
    elif staying:
        session.complain(
            f"{staying} items were kept: they are attached to something that was not cut."
        )
    level = session.document.level
    lost = before - {joint.id for joint in (*level.joints, *found.joints)}
    if len(lost) == 1:
        session.complain("1 joint is gone: it led to what was not cut.")
    elif lost:
        session.complain(f"{len(lost)} joints are gone: they led to what was not cut.")


def paste(session: Session) -> None:
    """Put the clipboard's content at the pointer, or beside the original; a level gets a tab."""
    text = session.clipboard.get()
    level = clip.loads_level(text)
    if level is not None:
        document = Document(level)
        document.mark_unsaved()  # The clipboard will soon hold something else.
        session.open_tab(document)
        session.toast(f"Opened {title_of(level)} from the clipboard.", "success")
        return
    found = clip.loads(text)
    at = session.hands.cursor
    shift = PASTE_SHIFT if at is None else clip.shift_to(found, at)
    shift = clip.free_shift(found, shift, session.document.level, PASTE_SHIFT)
    session.execute(clip.Paste(clip=found, shift=shift))


def drop(part: str) -> Callable[[Session], None]:
    """Return an action that puts a part at the pointer, or into the middle of the arena."""

    def run(session: Session) -> None:
        found = PARTS[part][2]()
        shift = clip.shift_to(found, session.hands.cursor or MIDDLE)
        session.execute(clip.Paste(clip=found, shift=shift, verb="Drop"))

    return run


def duplicate(session: Session) -> None:
    """Copy and paste beside the original, without the clipboard.

    Raises:
        CommandError: No shape is selected.
    """
    found = clip.copied(session.document.level, session.selection)
    if not found.bodies:
        raise CommandError("Only shapes can be duplicated, with their joints and thrusters.")
    session.execute(clip.Paste(clip=found, shift=PASTE_SHIFT, verb="Duplicate"))


def rename(session: Session) -> None:
    """Ask for a name of the one thing that is selected; what it is takes the name away."""
    document, entity = session.document, session.selection[0]
    assert isinstance(entity, int)
    plain = plain_name(document.level.entity(entity))

    def answer(name: str | None) -> None:
        if name is not None:
            session.execute(named(document.level, entity, name), on=document)

    old = document.name_of(entity)
    session.ask(TextQuestion(title=f"Name of {plain}", text=old, accept="Rename", answer=answer))


def named(level: Level, entity: int, name: str) -> SetField:
    """Return the edit that gives an entity a name; nothing, or what it is, takes its name away.

    Raises:
        CommandError: The entity has been deleted meanwhile.
    """
    name = name.strip()[:MAX_NAME].rstrip()
    record = next((each for each in level.entities() if each.id == entity), None)
    if record is None:
        raise CommandError(f"The item to be named {name} no longer exists.")
    plain = plain_name(record)
    shown = name or plain
    return SetField(
        ids=(entity,), field="name", value=None if shown == plain else shown, shown=shown
    )


def can_rename(session: Session) -> bool:
    """Return whether exactly one thing is selected that can have a name."""
    only = session.selection[0] if len(session.selection) == 1 else None
    return session.editing and isinstance(only, int)


def paste_properties(session: Session) -> None:
    """Give the selection the properties of what was copied."""
    found = clip.loads(session.clipboard.get())
    sources = (*found.bodies[-1:], *found.joints[-1:], *found.thrusters[-1:])
    level = session.document.level
    for source in sources:
        kinds = {type(level.entity(i)) for i in session.selection if isinstance(i, int)}
        if type(source) in kinds:
            session.execute(PasteProperties(ids=session.selection, source=source))
            return
    raise CommandError("The clipboard has no properties for what is selected.")


def select_all(session: Session) -> None:
    """Select everything that is neither locked nor hidden."""
    document = session.document
    passed = document.locked | document.hidden
    session.selection = tuple(e.id for e in document.level.entities() if e.id not in passed)


def delete(session: Session) -> None:
    """Delete the selection with its joints and thrusters, and offer to undo that."""
    before = session.document.level
    ids = tuple(i for i in _unlocked(session) if not isinstance(i, str))
    if not ids:
        raise CommandError("Floor, walls and ceiling cannot be deleted.")
    if not session.execute(Remove(ids=ids)).changed:
        return
    after = session.document.level
    parts = []
    for kind, noun in (("bodies", "shape"), ("joints", "joint"), ("thrusters", "thruster")):
        count = len(getattr(before, kind)) - len(getattr(after, kind))
        if count:
            parts.append(f"{count} {noun}{'' if count == 1 else 's'}")
    session.toast(f"Deleted {', '.join(parts)}", action="edit.undo")


def cancel(session: Session) -> None:
    """Leave what is under way; again: back to Select; again: select nothing."""
    if session.driver.cancel():
        return
    if session.expected is not None and not session.expected.finished:
        _expect_nothing(session, session.expected)
    elif session.tool is not TOOLS["select"]:
        session.choose_tool("select")
    else:
        session.selection = ()


def _expect_nothing(session: Session, job: Job) -> None:
    """Wait no longer for a result; an agent that was chosen is loaded all the same."""
    session.expected = None
    if not isinstance(job.request, LoadAgent):
        job.cancel()


def _unlocked(session: Session) -> Selection:
    """Return the selection without locked things; report if some were left out.

    Raises:
        CommandError: All of it is locked.
    """
    selection, unlocked = session.selection, session.document.unlocked
    if selection and not unlocked:
        raise CommandError("What is selected is locked: unlock it first.")
    passed = len(selection) - len(unlocked)
    if passed:
        stay = "stays as it is" if passed == 1 else "stay as they are"
        session.complain(f"{plural(passed, 'locked thing')} {stay}.")
    return unlocked


def toggle_lock(session: Session) -> None:
    """Lock the selection: it is not picked, moved, turned or deleted; all locked: unlock it."""
    document, chosen = session.document, frozenset(session.selection)
    if chosen <= document.locked:
        document.locked -= chosen
    else:
        document.locked |= chosen


def toggle_hide(session: Session) -> None:
    """Hide the selection in Edit; all of it hidden: show it again.

    Raises:
        CommandError: Only parts of the arena are selected.
    """
    document = session.document
    chosen = frozenset(entity for entity in session.selection if isinstance(entity, int))
    if session.selection and not chosen:
        raise CommandError("Floor, walls and ceiling cannot be hidden.")
    if chosen <= document.hidden:
        document.hidden -= chosen
    else:
        document.hidden |= chosen
        session.selection = ()


def has_hidden(session: Session) -> bool:
    """Return whether something is hidden that can be shown again."""
    return session.editing and bool(session.document.hidden)


def show_all(session: Session) -> None:
    """Show everything again that is hidden."""
    session.document.hidden = frozenset()


def mirror(axis: Literal["x", "y"]) -> Callable[[Session], None]:
    """Return an action that mirrors the selection."""

    def run(session: Session) -> None:
        session.execute(Mirror(ids=_unlocked(session), axis=axis))

    return run


def reorder(step: Literal[1, -1]) -> Callable[[Session], None]:
    """Return an action that brings the selection forward or back."""

    def run(session: Session) -> None:
        session.execute(Reorder(ids=session.selection, step=step))

    return run


def nudge(x: int, y: int) -> Callable[[Session], None]:
    """Return an action that moves the selection by one step."""

    def run(session: Session) -> None:
        step = session.settings.nudge_step
        if session.hands.modifiers.alt:
            step *= NUDGE_FINE
        elif session.hands.modifiers.shift:
            step *= NUDGE_COARSE
        _unlocked(session)
        ids = moving_ids(session)
        shift = (x * step, y * step)
        session.execute(Move(ids=ids, shift=shift, merge_key=("nudge", ids)))

    return run


def moving_ids(session: Session) -> Selection:
    """Return the selected bodies with those jointed to them, unless that is switched off."""
    level, document = session.document.level, session.document
    ids = {body.id for body in level.bodies if body.id in document.unlocked}
    if session.settings.move_jointed:
        ids = component(level, ids)
    return tuple(b.id for b in level.bodies if b.id in ids and b.id not in document.locked)


def turn(degrees: float) -> Callable[[Session], None]:
    """Return an action that rotates the selected bodies; Shift makes 15° one degree."""

    def run(session: Session) -> None:
        step = math.copysign(1.0, degrees) if session.hands.modifiers.shift else degrees
        chosen = _unlocked(session)
        ids = tuple(body.id for body in session.document.level.bodies if body.id in chosen)
        command = Rotate(ids=ids, angle=math.radians(step), merge_key=("turn", ids))
        session.execute(command)

    return run


Box = tuple[float, float, float, float]
"""Left, bottom, right, top [m]."""


def align(label: str, axis: int, place: Callable[[Box], float]) -> Callable[[Session], None]:
    """Return an action that brings one line of every selected piece to that of the group's box.

    Args:
        label: What the history calls it.
        axis: 0 moves along x, 1 along y.
        place: The line of a box.
    """

    def run(session: Session) -> None:
        pieces = _pieces(session, 2)
        goal = place(_around(box for _, box in pieces))
        amounts = [goal - place(box) for _, box in pieces]
        session.execute(_moves(label, axis, pieces, amounts))

    return run


def distribute(label: str, axis: int) -> Callable[[Session], None]:
    """An action that makes the gaps between the selected pieces equal; the outer two stay."""

    def run(session: Session) -> None:
        pieces = sorted(_pieces(session, 3), key=lambda piece: sum(piece[1][axis::2]))
        boxes = [box for _, box in pieces]
        free = boxes[-1][axis] - boxes[0][axis + 2]
        free -= sum(box[axis + 2] - box[axis] for box in boxes[1:-1])
        gap, amounts, edge = free / (len(pieces) - 1), [0.0], boxes[0][axis + 2]
        for box in boxes[1:-1]:
            amounts.append(edge + gap - box[axis])
            edge += gap + box[axis + 2] - box[axis]
        session.execute(_moves(label, axis, pieces, [*amounts, 0.0]))

    return run


def _pieces(session: Session, least: int) -> list[tuple[Selection, Box]]:
    """The selected shapes with their boxes; jointed ones are one, unless nothing else is selected.

    Raises:
        CommandError: Fewer shapes than `least` are selected.
    """
    level, chosen = session.document.level, _unlocked(session)
    bodies = {body.id: body for body in level.bodies if body.id in chosen}
    pieces = [tuple(piece) for piece in joined(level, chosen)]
    if len(pieces) == 1:
        pieces = [(body_id,) for body_id in bodies]
    if len(bodies) < least:
        raise CommandError(f"Select at least {least} shapes.")
    if len(pieces) < least:
        raise CommandError(f"Select at least {least} shapes: jointed ones count as one.")
    return [(piece, _around(bounds(bodies[body_id]) for body_id in piece)) for piece in pieces]


def _around(boxes: Iterable[Box]) -> Box:
    left, bottom, right, top = zip(*boxes, strict=True)
    return min(left), min(bottom), max(right), max(top)


def _moves(
    label: str, axis: int, pieces: list[tuple[Selection, Box]], amounts: list[float]
) -> Command:
    shifts = tuple(
        (ids, (amount, 0.0) if axis == 0 else (0.0, amount))
        for (ids, _), amount in zip(pieces, amounts, strict=True)
        if abs(amount) > 1e-9
    )
    return MoveEach(shifts=shifts, label=label)
