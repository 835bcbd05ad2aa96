"""Rows of *Change keys*: an action, or the motors or thrusters that a key drives in Play."""

import dataclasses

from editor.actions import rebinding
from editor.actions.base import Action
from editor.actions.dispatch import chords
from editor.base.controls import DEFAULT_KEYS, Drive
from editor.session import Session


@dataclasses.dataclass(frozen=True)
class KeyedAction:
    """An action of the menus."""

    action: Action

    @property
    def name(self) -> str:
        """Name of its row."""
        return self.action.id

    @property
    def label(self) -> str:
        """Label of its row."""
        return self.action.label

    @property
    def tooltip(self) -> str:
        """More about it."""
        return self.action.tooltip

    @property
    def first(self) -> tuple[str, ...]:
        """Its keys at first."""
        return self.action.keys

    def chords(self, session: Session) -> tuple[str, ...]:
        """Return its keys now."""
        return tuple(chords(session, self.action))

    def takes(self, chord: str) -> bool:
        """Return whether a key can be one of its."""
        del chord
        return True

    def conflict(self, session: Session, chord: str) -> str:
        """Return the use of a chord that another one would conflict with."""
        return rebinding.conflict(session, self.action, chord)

    def changed(self, session: Session) -> bool:
        """Return whether it has other keys than at first."""
        return rebinding.changed(session, self.action)

    def bind(self, session: Session, chord: str) -> None:
        """Give it a key, and only that one."""
        rebinding.bind(session, self.action, chord)

    def unbind(self, session: Session) -> None:
        """Take its keys away."""
        rebinding.unbind(session, self.action)

    def reset(self, session: Session) -> None:
        """Give it its keys as at first, which nothing else has."""
        session.settings.keys.pop(self.action.id, None)


@dataclasses.dataclass(frozen=True)
class KeyedDrive:
    """Motors or thrusters that a key drives."""

    drive: Drive

    @property
    def name(self) -> str:
        """Name of its row."""
        return f"drive.{self.drive.channel}.{self.drive.value}"

    @property
    def label(self) -> str:
        """Label of its row."""
        return rebinding.drive_label(self.drive)

    @property
    def tooltip(self) -> str:
        """More about it: nothing."""
        return ""

    @property
    def first(self) -> tuple[str, ...]:
        """Its keys at first."""
        return tuple(rebinding.driving_keys(DEFAULT_KEYS, self.drive))

    def chords(self, session: Session) -> tuple[str, ...]:
        """Return its keys now."""
        return tuple(rebinding.driving_keys(session.control_keys, self.drive))

    def takes(self, chord: str) -> bool:
        """Return whether a key can drive: one by itself can, with Ctrl, Shift or Alt it cannot."""
        return "+" not in chord[:-1]

    def conflict(self, session: Session, chord: str) -> str:
        """Return the use of a driving key that another one would conflict with."""
        return rebinding.drive_conflict(session, self.drive, chord)

    def changed(self, session: Session) -> bool:
        """Return whether other keys drive it than at first."""
        return rebinding.drive_changed(session, self.drive)

    def bind(self, session: Session, chord: str) -> None:
        """Let a key drive it, and only that one."""
        rebinding.bind_drive(session, self.drive, chord)

    def unbind(self, session: Session) -> None:
        """Take its keys away."""
        rebinding.unbind_drive(session, self.drive)

    def reset(self, session: Session) -> None:
        """Give it its keys as at first, which nothing else has."""
        for chord in self.first:
            self.bind(session, chord)


Keyed = KeyedAction | KeyedDrive
