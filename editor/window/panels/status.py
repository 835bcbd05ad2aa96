"""The line at the bottom: mode, hint, pointer, selection, zoom, speed, jobs, unsaved changes."""

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor import actions
from editor.base.language import tr
from editor.play.mode import Mode
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, Icons, Rgba
from editor.toolkit.modes import MODE_LOOK
from editor.toolkit.widgets import px
from editor.window import hints
from editor.window.panels.under_way import SHOWS, Part, under_way

if TYPE_CHECKING:
    from editor.session import Session


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
            for part in right:
                imgui.same_line(x)
                widgets.raw(part.words, part.colour)
                self._follows_click(session, part)
                x += imgui.calc_text_size(part.words).x + gap

    def _fitting(self, parts: list[Part], room: float) -> list[Part]:
        """Return the numbers without as many of the quiet ones as the hint needs the room of."""
        kept = list(parts)
        quiet = (COLOURS.faint, COLOURS.muted)
        for part in [part for part in reversed(parts[:-1]) if part.colour in quiet]:
            if self._width(kept) <= room:
                break
            kept.remove(part)
        return kept

    def _width(self, parts: list[Part]) -> float:
        """Return the width of some numbers beside each other [px]."""
        return sum(imgui.calc_text_size(part.words).x + px(18) for part in parts)

    def _follows_click(self, session: "Session", part: Part) -> None:
        """Let a click on the status do what it offers."""
        if not part.action:
            return
        widgets.probe(session, f"status.{part.action}")
        if imgui.is_item_hovered():
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand.value)
            widgets.tooltip(actions.BY_ID[part.action].label, part.click)
            if imgui.is_mouse_clicked(0):
                session.queue(part.action)

    def numbers(self, session: "Session") -> list[Part]:
        """Return the words at the right, in the window's language, and their colours."""
        c = COLOURS
        doing = under_way(session)
        if session.gallery.open:
            return doing  # the rest is about the level behind it
        parts: list[Part] = []

        def tell(words: str, colour: Rgba) -> None:
            parts.append(Part(tr(words), colour))

        if session.hands.cursor is not None:
            x, y = session.hands.cursor
            tell(f"{x:.2f}, {y:.2f} m", c.muted)
        if session.selection:
            tell(f"{len(session.selection)} selected", c.text)
        parts += doing  # It stays where it is as the pointer comes to it, off the canvas.
        errors = sum(issue.severity == "error" for issue in session.document.problems)
        warnings = sum(issue.severity == "warning" for issue in session.document.problems)
        for icon, count, colour in (
            (Icons.error, errors, c.bad),
            (Icons.warning, warnings, c.warn),
        ):
            if count:
                parts.append(Part(f"{icon} {count}", colour, "view.problems", SHOWS))
        tell(f"{session.camera.zoom:.0%}", c.muted)
        snapshot = session.playback.snapshot
        if session.playback.active and snapshot is not None:
            kind = ", compiled for this level" if snapshot.tailored else ""
            kind = ", compiled quickly" if snapshot.quick else kind
            tell(f"{snapshot.milliseconds:.1f} ms/step{kind}", c.muted)
            if session.mode is Mode.PLAYING:
                tell(f"{session.playback.real_time_factor:.2f}× real time", c.muted)
        tell(f"{session.fps:.0f} fps", c.faint)
        document = session.document
        copied = session.autosaves.kept_at(document)
        if document.dirty and copied is not None:
            tell(f"copy kept {copied:%H:%M}", c.faint)
        kept = "saved" if document.path else "not saved yet"
        tell(*(("● unsaved", c.warn) if document.dirty else (kept, c.faint)))
        return parts
