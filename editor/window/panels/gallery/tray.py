"""The set being put together in the gallery, and the questions of its export."""

import dataclasses
import os
from pathlib import Path
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions.files import unsaved
from editor.actions.gallery import level_sets
from editor.base.language import tr
from editor.gallery.card import Card
from editor.gallery.export import SetPlan
from editor.gallery.kept_set import WEIGHTS
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, Icons, Rgba
from editor.toolkit.widgets import px
from kinetix.level.model import SizeName
from kinetix.wording import plural

if TYPE_CHECKING:
    from editor.session import Session

_AUTOMATIC: Final = "auto"
_LOOK_SECONDS: Final = 1.0
"""Interval at which it is looked for the files of the set while its export is asked [s]."""
_CLAMPED: Final = imgui.SliderFlags_.always_clamp.value
_SIZES: Final[dict[str, SizeName | None]] = {
    _AUTOMATIC: None,
    "s": "s",
    "m": "m",
    "l": "l",
    "locomotion": "locomotion",
}
_FLAGS: Final = (
    imgui.WindowFlags_.no_saved_settings.value
    | imgui.WindowFlags_.no_move.value
    | imgui.WindowFlags_.no_title_bar.value
    | imgui.WindowFlags_.no_docking.value
    | imgui.WindowFlags_.always_auto_resize.value
)


def _line(words: str, colour: Rgba) -> None:
    """Draw a sentence, wrapped within the dialog."""
    imgui.push_text_wrap_pos(px(430))
    widgets.text(words, colour)
    imgui.pop_text_wrap_pos()


class SetTray:
    """A list of levels with weights, and a dialog that writes it."""

    def __init__(self) -> None:
        self._list_open = False
        """True if a list of the dialog was open in the last frame: Esc was that one's."""
        self._before: dict[str, float] = {}
        """The set as it was before the weight that is being changed."""
        self._refused: tuple[float, int, dict[str, float], dict[str, str]] = (0.0, -1, {}, {})
        """Time, list and set of the last search for levels that no set takes."""

    def draw(self, session: "Session") -> None:
        """Draw the list into the current window."""
        tray = session.gallery.tray
        if not tray:
            widgets.empty_state(
                Icons.reorder,
                "A set for training",
                "Drag levels here, or choose some and press Ctrl+Shift+A. A set splits them into a "
                "part to train on and a part to evaluate on.",
            )
            return
        footer = imgui.get_frame_height() + px(12)
        imgui.begin_child("tray", (0, max(imgui.get_content_region_avail().y - footer, px(60))))
        flags = imgui.TableFlags_.sizing_stretch_prop.value
        if imgui.begin_table("levels", 3, flags):
            imgui.table_setup_column(tr("Level"), imgui.TableColumnFlags_.width_stretch.value)
            fixed = imgui.TableColumnFlags_.width_fixed.value
            imgui.table_setup_column(tr("Weight"), fixed, px(64))
            imgui.table_setup_column("", fixed, px(26))
            imgui.table_headers_row()
            paths = list(tray)
            clipper = imgui.ListClipper()
            clipper.begin(len(paths))
            while clipper.step():
                for path in paths[clipper.display_start : clipper.display_end]:
                    self._row(session, path, session.library.card(path))
            clipper.end()
            imgui.end_table()
        imgui.end_child()
        exporting = session.gallery.exporting is not None
        with widgets.disabled(exporting):
            label = "Exporting …" if exporting else "Export set…"
            if widgets.primary_button(session, "gallery.export", label):
                session.queue("level.export_set")
        imgui.same_line()
        if widgets.button(session, "gallery.empty", "Empty the set"):
            session.queue(lambda: level_sets.empty_set(session))

    def _row(self, session: "Session", path: str, card: Card | None) -> None:
        tray = session.gallery.tray
        imgui.table_next_row()
        imgui.table_next_column()
        imgui.align_text_to_frame_padding()
        gone = card is None and not os.path.isfile(path)
        bad = gone or (card is not None and bool(card.errors or card.fault))
        name = card.name if card is not None else Path(path).stem
        widgets.raw(name, COLOURS.bad if bad else COLOURS.text)
        widgets.tooltip(name, path, own=True)
        imgui.table_next_column()
        imgui.set_next_item_width(-1)
        changed, weight = imgui.drag_float(
            f"###weight-{path}", tray[path], 0.05, *WEIGHTS, "%.4g", _CLAMPED
        )
        widgets.probe(session, f"gallery.weight.{name}")
        if imgui.is_item_activated():
            self._before = dict(tray)
        widgets.tooltip(
            "Weight",
            "How often training draws it, compared with the others: .000001 to a million.",
        )
        if changed:
            tray[path] = weight
        if imgui.is_item_deactivated_after_edit():
            before = self._before
            session.queue(lambda: level_sets.weigh(session, before))
        imgui.table_next_column()
        if widgets.icon_button(session, f"gallery.drop.{path}", Icons.close):
            session.queue(lambda: level_sets.drop_from_set(session, path))

    def dialog(self, session: "Session") -> None:
        """The questions of the export, while `session.gallery.plan` is set."""
        gallery = session.gallery
        name = "###export-set"
        if gallery.plan is None or session.prompts:
            return
        if not imgui.is_popup_open(name):
            imgui.open_popup(name)
        viewport = imgui.get_main_viewport()
        centre = (viewport.pos.x + viewport.size.x / 2, viewport.pos.y + viewport.size.y / 2)
        imgui.set_next_window_pos(centre, 0, (0.5, 0.5))
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(20), px(16)))
        opened = imgui.begin_popup_modal(name, None, _FLAGS)[0]
        imgui.pop_style_var()
        if not opened:
            return
        done = self._questions(session, gallery.plan)
        closed = imgui.is_key_pressed(imgui.Key.escape, False) and not self._list_open
        self._list_open = imgui.is_popup_open("", imgui.PopupFlags_.any_popup_id.value)
        if done or closed:
            imgui.close_current_popup()
            if not done:
                gallery.plan = None
        imgui.end_popup()

    def _questions(self, session: "Session", plan: SetPlan) -> bool:
        """Draw the form; whether it was answered."""
        gallery = session.gallery
        with widgets.font(FONTS.bold, 18):
            widgets.text(f"Export {plural(len(gallery.tray), 'level')} as a set")
        imgui.dummy((px(420), px(2)))
        changes: dict[str, object] = {}
        with widgets.property_table("export") as opened:
            if opened:
                self._rows(session, plan, changes)
        if changes:
            gallery.plan = dataclasses.replace(plan, **changes)
        bad = self._refused_now(session)
        if bad:
            names = unsaved.listed(list(bad.values()))
            _line(f"{Icons.error}  {names}: with an error or gone, no set takes it.", COLOURS.bad)
            if widgets.button(session, "export.leave_out", "Leave out what has errors"):
                session.queue(lambda: level_sets.leave_out_refused(session))
        if not gallery.tray:
            _line(f"{Icons.error}  No level is in the set: put some into it first.", COLOURS.bad)
        changed = unsaved.unsaved_among(session, gallery.tray)
        if changed:
            names = unsaved.listed(changed)
            _line(f"{Icons.warning}  The set leaves unsaved changes out: {names}", COLOURS.warn)
            widgets.probe(session, "export.unsaved")
        imgui.dummy((0, px(6)))
        width = px(110)
        gap = imgui.get_style().item_spacing.x
        room = imgui.get_content_region_avail().x - 2 * width - gap
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(room, 0.0))
        if widgets.button(session, "export.cancel", "Cancel", width=width):
            gallery.plan = None
            return True
        imgui.same_line()
        with widgets.disabled(bool(bad) or not gallery.tray or not plan.name.strip()):
            if widgets.primary_button(session, "export.accept", "Choose where…", width=width):
                session.queue(lambda: level_sets.export_now(session))
                return True
        return False

    def _refused_now(self, session: "Session") -> dict[str, str]:
        """Return what cannot go into the set; files are looked for now and then."""
        tray, revision = session.gallery.tray, session.library.revision
        looked, listed, of, found = self._refused
        due = not 0.0 <= session.time - looked < _LOOK_SECONDS
        if due or listed != revision or of is not tray:
            found = level_sets.refused_in_set(session)
            self._refused = (session.time, revision, tray, found)
        return found

    def _rows(self, session: "Session", plan: SetPlan, changes: dict[str, object]) -> None:
        widgets.row("Name")
        changed, name = imgui.input_text("###export.name", plan.name)
        widgets.probe(session, "export.name")
        if changed:
            changes["name"] = name[:120]
        widgets.row("As", "One file carries its levels; in a folder they stay files of their own.")
        options = [("file", "One file"), ("folder", "A folder")]
        form = widgets.choice(session, "export.form", plan.form, options)
        if form is not None:
            changes["form"] = form
        widgets.row("For training", "Share of the levels; the others are for evaluation.")
        changed, share = imgui.slider_float("###export.split", 100 * plan.split, 0, 100, "%.0f %%")
        widgets.probe(session, "export.split")
        if changed:
            changes["split"] = min(max(share / 100, 0.0), 1.0)
        widgets.row("Seed", "What the split is drawn from: the same seed, the same split.")
        changed, seed = imgui.input_int("###export.seed", plan.seed)
        widgets.probe(session, "export.seed")
        if changed:
            changes["seed"] = min(max(seed, 0), 2**31 - 1)
        widgets.row("Size", "The common capacity: by default the largest of each.")
        current = plan.size or _AUTOMATIC
        labels = [(key, "As large as needed" if key == _AUTOMATIC else key) for key in _SIZES]
        picked = widgets.choice(session, "export.size", current, labels)
        if picked is not None:
            changes["size"] = _SIZES[picked]
