"""The right of the gallery: what is chosen, and the set being put together."""

import datetime
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor import actions
from editor.base.language import tr
from editor.gallery.card import Card
from editor.gallery.filing import any_bundled
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons
from editor.toolkit.widgets import px
from editor.window.browser import peek, thumbnail
from editor.window.hints import key_of
from editor.window.panels.gallery import dragging
from editor.window.panels.gallery.tray import SetTray
from kinetix.wording import plural

if TYPE_CHECKING:
    from editor.session import Session


class Side:
    """Two tabs: the chosen level, and the set."""

    def __init__(self) -> None:
        self._tray = SetTray()
        self._judged: tuple[list[Card], bool] = ([], False)
        """The cards that were chosen last, and whether one came with the app."""

    def dialog(self, session: "Session") -> None:
        """Ask how the set is to be exported, while that is asked."""
        self._tray.dialog(session)

    def draw(self, session: "Session") -> None:
        """Draw the selection, and the set being assembled."""
        with widgets.coloured(tab=COLOURS.surface, tab_selected=COLOURS.field):
            self._tabs(session)
        if dragging.dragging() and dragging.let_go_in_window():
            session.queue("gallery.add_to_set")

    def _tabs(self, session: "Session") -> None:
        gallery = session.gallery
        if imgui.begin_tab_bar("side"):
            opened = imgui.begin_tab_item(tr(f"{Icons.info}  Level###level"))[0]
            widgets.probe(session, "gallery.tab.level")
            if opened:
                self._details(session)
                imgui.end_tab_item()
            count = f" ({len(gallery.tray)})" if gallery.tray else ""
            opened = imgui.begin_tab_item(f"{Icons.reorder}  {tr('Set')}{count}###set")[0]
            widgets.probe(session, "gallery.tab.set")
            if dragging.let_go_here():
                session.queue("gallery.add_to_set")
            if opened:
                self._tray.draw(session)
                imgui.end_tab_item()
            imgui.end_tab_bar()

    def _details(self, session: "Session") -> None:
        chosen = session.gallery.chosen(session.library, session.results)
        if not chosen:
            widgets.empty_state(
                Icons.level,
                "Choose a level",
                "A double click opens it. Ctrl and Shift choose several; drag them onto Set.",
            )
            return
        if len(chosen) > 1:
            with widgets.font(FONTS.bold, 17):
                widgets.text(f"{len(chosen)} levels")
        else:
            self._one(session, chosen[0])
        imgui.dummy((0, px(6)))
        buttons = (
            ("gallery.open", "Open", Icons.open),
            ("gallery.add_to_set", "Add to the set", Icons.reorder),
            ("gallery.evaluate", "Evaluate", Icons.trophy),
            ("gallery.train", "Train on Them", Icons.training),
            ("gallery.rename", "Rename…", Icons.rename),
            ("gallery.duplicate", "Duplicate", Icons.duplicate),
            ("gallery.move_to", "Move to…", Icons.folder),
            ("gallery.delete", "Delete", Icons.trash),
        )
        for number, (action_id, label, icon) in enumerate(buttons):
            enabled = actions.available(session, actions.BY_ID[action_id])
            if action_id in ("gallery.rename", "gallery.delete"):
                enabled = enabled and not self._any_bundled(chosen)
            if number % 2:
                imgui.same_line(0, px(6))
            if widgets.icon_button(session, action_id, icon, label=label, enabled=enabled):
                session.queue(action_id)
            action = actions.BY_ID[action_id]
            widgets.tooltip(action.label, action.tooltip, key_of(session, action_id))

    def _any_bundled(self, chosen: list[Card]) -> bool:
        if self._judged[0] is not chosen:
            self._judged = (chosen, any_bundled([card.file for card in chosen]))
        return self._judged[1]

    def _one(self, session: "Session", card: Card) -> None:
        side = min(imgui.get_content_region_avail().x, px(280))
        level = peek(str(card.file.resolve()), card.modified_ns)
        if not isinstance(level, str):
            thumbnail(level, side)
        with widgets.font(FONTS.bold, 17):
            widgets.own_words(card.name)
        if card.fault:
            widgets.small(card.fault, COLOURS.bad)
            return
        widgets.small(_summary(card))
        if card.description:
            widgets.own_words(card.description)
        if card.tags:
            widgets.small("  ".join(f"#{tag}" for tag in card.tags), COLOURS.info)
        if card.errors or card.warnings:
            kinds = ((card.errors, "error"), (card.warnings, "warning"))
            parts = [plural(number, noun) for number, noun in kinds if number]
            colour = COLOURS.bad if card.errors else COLOURS.warn
            widgets.small(f"{Icons.warning}  {', '.join(parts)}", colour)
        for trial, record in sorted(session.results.of(card.sha256).items()):
            words = f"{trial.words}: won {record.solved} of {record.attempts}"
            widgets.small(words, COLOURS.good if record.solved else COLOURS.muted)
        when = datetime.datetime.fromtimestamp(card.modified_ns / 1e9)
        with widgets.font(None, SMALL):
            widgets.own_words(f"{card.file.name}   {when:%Y-%m-%d %H:%M}", COLOURS.faint)
        widgets.tooltip(card.file.name, card.path, own=True)


def _summary(card: Card) -> str:
    """Return the size and content in one line."""
    if card.fault:
        return card.fault
    parts = [
        plural(number, noun)
        for number, noun in (
            (card.bodies, "shape"),
            (card.joints, "joint"),
            (card.thrusters, "thruster"),
        )
        if number
    ]
    return f"Size {card.size}: {', '.join(parts) or 'empty'}"
