"""The menu of a right click: what lies there, and what one would do with it."""

import dataclasses
from collections.abc import Callable
from typing import Final

from editor.base.camera import Point
from editor.base.controls import key_caps
from editor.base.events import PointerEvent
from editor.base.prompts import Choice, MenuQuestion
from editor.documents.commands.base import Command, EntityId, Selection
from editor.documents.commands.fields import SetField, read_field, selected_records
from editor.editing.tools.select.idle import under_pointer
from editor.session import Session
from kinetix.errors import CommandError
from kinetix.level.model import (
    MOTOR_BINDINGS,
    THRUSTER_BINDINGS,
    ArenaBody,
    Body,
    Joint,
    Record,
    Thruster,
)

_ROLES: Final = (("green", "Make Green"), ("blue", "Make Blue"), ("red", "Make Red"))
_ARRANGING: Final = (
    "edit.cut",
    "edit.copy",
    "edit.duplicate",
    "edit.rename",
    "edit.mirror_horizontal",
    "edit.forward",
    "edit.back",
    "edit.lock",
    "edit.hide",
    "edit.show_all",
    "view.frame_selection",
    "edit.delete",
)
_EMPTY: Final = (
    "edit.paste",
    "edit.select_all",
    "tool.rectangle",
    "tool.circle",
    "tool.triangle",
    "part.wheel",
    "part.arm",
    "part.rope",
    "part.bridge",
    "view.fit",
    "view.grid",
    "snap.smart",
    "edit.show_all",
)
"""Rows for an empty place, by action."""

Run = Callable[[], None]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Table:
    """The action table, as the menu needs it."""

    words: Callable[[str], tuple[str, str]]
    """Label and chord of an action, by its id."""
    run: Callable[[str], object]
    """Does an action now."""


def open_menu(session: Session, event: PointerEvent, table: Table) -> None:
    """Ask what to do at a place.

    Args:
        session: The app.
        event: The click.
        table: The action table.
    """
    _open(session, under_pointer(session, event), event.screen, event.world, table)


def open_menu_of(session: Session, entity: EntityId, at: Point, table: Table) -> None:
    """Ask what to do with an entity.

    Args:
        session: The app.
        entity: Its id, or the name of a part of the arena.
        at: Where the menu opens [px].
        table: The action table.
    """
    _open(session, (entity,), at, session.hands.cursor, table)


def _open(session: Session, under: Selection, at: Point, place: Point | None, table: Table) -> None:
    runs: dict[str, Run] = {}
    choices: list[Choice] = []

    def add(key: str, label: str, run: Run, *, chord: str = "", gap: bool = False) -> None:
        runs[key] = run
        choices.append(Choice(id=key, label=label, chord=chord, separated=gap))

    document = session.document

    def answer(key: str | None) -> None:
        if key is not None:
            if session.document is not document:
                raise CommandError("Another level is in front by now; open the menu again.")
            runs[key]()

    for k, entity in enumerate(under):
        runs[str(k)] = _selecting(session, (entity,))
        name = session.document.name_of(entity)
        choices.append(Choice(id=str(k), label=name, ids=(entity,)))
    target = _target(session, under)
    for number, (label, command) in enumerate(_changes(session, target)):
        run = _executing(session, target, command)
        add(f"change.{label.lower()}", label, run, gap=number == 0)
    names = _names(target) if target else _EMPTY
    if not document.hidden:
        names = tuple(name for name in names if name != "edit.show_all")
    for number, action in enumerate(names):
        label, chord = table.words(action)
        run = _running(session, target or session.selection, place, table, action)
        add(action, label, run, chord=chord, gap=number == 0 and bool(choices))
    title = "Under the pointer" if under else "Here"
    session.ask(MenuQuestion(title=title, choices=tuple(choices), at=at, answer=answer))


def ask_key(session: Session, entity: int, at: tuple[float, float]) -> None:
    """Ask which key shall drive a joint or thruster.

    Args:
        session: The app.
        entity: Id of the joint or thruster.
        at: Where the menu opens [px].
    """
    document = session.document
    level = document.level
    thruster = any(thruster.id == entity for thruster in level.thrusters)
    field = "binding" if thruster else "motor.binding"
    first, count = (MOTOR_BINDINGS, THRUSTER_BINDINGS) if thruster else (0, MOTOR_BINDINGS)
    (record,) = selected_records(level, (entity,))
    present = read_field(record, field)
    keys = session.control_keys
    choices = tuple(
        Choice(
            id=str(binding),
            label="  ".join(key_caps(first + binding, keys)) or f"control {first + binding}",
            detail="now" if binding == present else "",
        )
        for binding in range(count)
    )

    def answer(choice: str | None) -> None:
        if choice is not None:
            command = SetField(ids=(entity,), field=field, value=int(choice))
            session.execute(command, on=document)

    title = f"Key of {document.name_of(entity)}"
    session.ask(MenuQuestion(title=title, choices=choices, at=at, answer=answer))


def _target(session: Session, under: Selection) -> Selection:
    """Return what the rows act on: the selection when it was clicked, else the uppermost thing."""
    if not under:
        return ()
    clicked = any(entity in session.selection for entity in under)
    return session.selection if clicked else under[:1]


def _names(target: Selection) -> tuple[str, ...]:
    """Return the actions for things: the arena's parts stay, and several have no one name."""
    if all(isinstance(entity, str) for entity in target):
        return ("view.frame_selection",)
    return tuple(name for name in _ARRANGING if name != "edit.rename" or len(target) == 1)


def _changes(session: Session, target: Selection) -> list[tuple[str, Command]]:
    """Return the changes of properties that fit all of some things."""
    records = selected_records(session.document.level, target)
    kinds = {type(record) for record in records}
    if not records or len(kinds) > 1:
        return []
    return [
        (label, SetField(ids=target, field=field, value=value))
        for label, field, value in _rows(records)
        if not all(read_field(record, field) == value for record in records)
    ]


def _rows(records: list[Record]) -> list[tuple[str, str, object]]:
    """Return label, field and value of each change; those that change nothing are left out."""
    first = records[0]
    if isinstance(first, Body | ArenaBody):
        rows: list[tuple[str, str, object]] = [(words, "role", role) for role, words in _ROLES]
        rows.append(("Take the Role Away", "role", "none"))
        if isinstance(first, Body):
            rows += [("Fix in Place", "fixed", True), ("Let It Move", "fixed", False)]
        return rows
    if isinstance(first, Joint):
        rows = [("Make a Hinge", "kind", "revolute"), ("Make a Weld", "kind", "fixed")]
        if all(isinstance(record, Joint) and record.kind != "fixed" for record in records):
            rows += [
                ("Add a Motor", "motor.on", True),
                ("Remove the Motor", "motor.on", False),
                ("Limit the Angle", "limits.on", True),
                ("Remove the Limits", "limits.on", False),
            ]
        return rows
    if isinstance(first, Thruster):
        return [("First Key", "binding", 0), ("Second Key", "binding", 1)]
    return []


def _selecting(session: Session, chosen: tuple[EntityId, ...]) -> Run:
    return lambda: setattr(session, "selection", chosen)


def _executing(session: Session, target: Selection, command: Command) -> Run:
    def run() -> None:
        session.selection = target
        session.execute(command)

    return run


def _running(
    session: Session, target: Selection, place: Point | None, table: Table, action: str
) -> Run:
    def run() -> None:
        session.selection = target
        # The pointer is over the menu by now; the place that was clicked is meant.
        session.hands.cursor = place
        table.run(action)

    return run
