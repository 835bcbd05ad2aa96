"""The line at the bottom: mode, hint, pointer, selection, zoom, speed, jobs, unsaved changes."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, Icons, Rgba
from editor.toolkit.modes import MODE_LOOK
from editor.toolkit.widgets import px
from editor.window import hints
from editor.worker.jobs import PREPARATIONS, lane_of

if TYPE_CHECKING:
    from editor.session import Session


_CONSTANT: Final = ("Simulating", "Drawing")
"""Jobs that run all the time while something is played."""


class StatusBar:
    """Left: what to do. Right: numbers."""

    def draw(self, session: "Session") -> None:
        """Draw the line into the current window."""
        with widgets.font(None, SMALL):
            word, name = MODE_LOOK[session.mode]
            if session.gallery.open:
                word, name = "GALLERY", "info"
            widgets.badge(word, COLOURS.of(name))
            imgui.same_line(0, px(10))
            hint = hints.hint(session)
            space = imgui.get_window_width() - imgui.get_cursor_pos_x() - px(8)
            right = self._fitting(self.numbers(session), space - imgui.calc_text_size(hint).x)
            gap = px(18)
            while len(right) > 1 and self._width(right) > 0.8 * imgui.get_window_width():
                del right[0]
            width = self._width(right)
            widgets.raw(widgets.fitted(hint, space - width), COLOURS.muted)
            x = imgui.get_window_width() - width
            for words, tint in right:
                imgui.same_line(x)
                widgets.raw(words, tint)
                self._opens_problems(session, words)
                x += imgui.calc_text_size(words).x + gap

    def _fitting(self, parts: list[tuple[str, Rgba]], room: float) -> list[tuple[str, Rgba]]:
        """Return the numbers without as many of the quiet ones as the hint needs the room of."""
        kept = list(parts)
        quiet = [part for part in reversed(parts[:-1]) if part[1] in (COLOURS.faint, COLOURS.muted)]
        for part in quiet:
            if self._width(kept) <= room:
                break
            kept.remove(part)
        return kept

    def _width(self, parts: list[tuple[str, Rgba]]) -> float:
        """Return the width of some numbers beside each other [px]."""
        return sum(imgui.calc_text_size(words).x + px(18) for words, _ in parts)

    def _opens_problems(self, session: "Session", words: str) -> None:
        """Let a click on the counts of errors and warnings open the list."""
        if words[:1] not in (Icons.error, Icons.warning):
            return
        widgets.probe(session, "status.problems")
        if imgui.is_item_hovered():
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand.value)
            widgets.tooltip("Problems", "Click to see them.")
            if imgui.is_mouse_clicked(0):
                session.view.front = "problems"

    def numbers(self, session: "Session") -> list[tuple[str, tuple[float, float, float, float]]]:
        """Return the words at the right, in the window's language, and their colours."""
        c = COLOURS
        under_way, parts = [], []
        if session.recording is not None:
            under_way.append((f"{Icons.film} {tr('Recording')}", c.bad))
        jobs = [job for job in session.worker.jobs if job.title not in _CONSTANT]
        if jobs:
            job = jobs[0]
            share = f" {job.fraction:.0%}" if job.fraction is not None else ""
            ahead = lane_of(job.request) == PREPARATIONS
            words = job.title if ahead else job.message or job.title
            # With the share behind them they would be other words.
            under_way.append((f"{Icons.gear} {tr(words)}{share}", c.accent))
        if session.gallery.open:
            return under_way  # the rest is about the level behind it
        if session.hands.cursor is not None:
            x, y = session.hands.cursor
            parts.append((f"{x:.2f}, {y:.2f} m", c.muted))
        if session.selection:
            parts.append((f"{len(session.selection)} selected", c.text))
        errors = sum(issue.severity == "error" for issue in session.document.problems)
        warnings = sum(issue.severity == "warning" for issue in session.document.problems)
        if errors:
            parts.append((f"{Icons.error} {errors}", c.bad))
        if warnings:
            parts.append((f"{Icons.warning} {warnings}", c.warn))
        parts.append((f"{session.camera.zoom:.0%}", c.muted))
        snapshot = session.playback.snapshot
        if session.playback.active and snapshot is not None:
            kind = ", compiled for this level" if snapshot.tailored else ""
            kind = ", compiled quickly" if snapshot.quick else kind
            parts.append((f"{snapshot.milliseconds:.1f} ms/step{kind}", c.muted))
            parts.append((f"{session.playback.real_time_factor:.2f}× real time", c.muted))
        parts.append((f"{session.fps:.0f} fps", c.faint))
        document = session.document
        copied = session.autosaves.kept_at(document)
        if document.dirty and copied is not None:
            parts.append((f"copy kept {copied:%H:%M}", c.faint))
        kept = "saved" if document.path else "not saved yet"
        state = ("● unsaved", c.warn) if document.dirty else (kept, c.faint)
        parts.append(state)
        return [*under_way, *((tr(words), tint) for words, tint in parts)]
