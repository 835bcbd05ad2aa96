"""The outliner: everything in the level as a tree, with role, eye and lock."""

import dataclasses
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor import actions
from editor.base.controls import key_caps
from editor.base.language import tr
from editor.base.memoise import remembers
from editor.base.wording import ARENA_LABELS
from editor.documents.commands.base import EntityId
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, Icons, Rgba, u32
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from kinetix.level.model import MOTOR_BINDINGS, Body, Circle, Joint, Level, Thruster

if TYPE_CHECKING:
    from editor.session import Session


def _role_colour(role: str) -> Rgba:
    c = COLOURS
    return {"none": c.muted, "green": c.green, "blue": c.blue, "red": c.red}[role]


class Outliner(Panel):
    """Lists bodies with their joints and thrusters; a click selects."""

    id, title, icon = "outliner", "Outliner", Icons.outliner

    def __init__(self) -> None:
        self._filter = ""
        self._follow: tuple[EntityId, ...] = ()

    def draw(self, session: "Session") -> None:
        """Draw the filter and the tree."""
        level = session.document.shown
        cross = widgets.icon_width(Icons.close) + px(2) if self._filter else 1.0
        imgui.set_next_item_width(-cross)
        filtered = bool(self._filter)
        _, self._filter = widgets.input_line(
            "outliner.filter", f"{Icons.search}  Filter", self._filter
        )
        widgets.probe(session, "outliner.filter")
        if filtered and widgets.clear_button(session, "outliner.filter"):
            self._filter = ""
        # The rows scroll under the filter, which stays; padding leaves them their round corners.
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(4), px(1)))
        imgui.begin_child("rows", None, imgui.ChildFlags_.always_use_window_padding.value)
        imgui.pop_style_var()
        if not level.bodies:
            widgets.empty_state(
                Icons.level, "No shapes yet", "Press R, C or T and drag on the canvas to draw one."
            )
        scroll = self._follow != session.selection
        self._follow = session.selection
        imgui.push_style_var(imgui.StyleVar_.item_spacing, imgui.ImVec2(px(6), px(1)))
        hanging = parts_of(level)
        found = [self._body(session, body, hanging[body.id], scroll) for body in level.bodies]
        if level.bodies:
            imgui.dummy((0, px(6)))
        found.append(self._arena(session, level))
        imgui.pop_style_var()
        if self._filter and not any(found):
            words = f"Nothing here is called {self._filter}."
            widgets.empty_state(Icons.search, "No results", words)
        imgui.end_child()

    def _shows(self, words: str) -> bool:
        return self._filter.lower() in words.lower()

    def _body(self, session: "Session", body: Body, hanging: "Hanging", scroll: bool) -> bool:
        """Draw a body with its joints and thrusters unless it is filtered out; True if drawn."""
        call = session.document.spoken_name_of
        parts = (body, *hanging.joints, *hanging.thrusters)
        if self._filter and not self._shows(" ".join([body.role, *(call(p.id) for p in parts)])):
            return False
        if not self._out_of_sight(session, body.id, scroll):
            icon = Icons.circle if isinstance(body.shape, Circle) else Icons.rectangle
            if not isinstance(body.shape, Circle) and len(body.shape.vertices) == 3:
                icon = Icons.triangle
            self._row(session, body.id, icon, call(body.id), _role_colour(body.role), scroll)
        imgui.indent(px(18))
        for joint in hanging.listed:
            if not self._out_of_sight(session, joint.id, scroll):
                self._joint(session, joint, scroll)
        for thruster in hanging.thrusters:
            if not self._out_of_sight(session, thruster.id, scroll):
                self._thruster(session, thruster, scroll)
        imgui.unindent(px(18))
        return True

    def _out_of_sight(self, session: "Session", entity: EntityId, scroll: bool) -> bool:
        """Leave room for a row that nobody sees: a level may have a thousand.

        The row to scroll to counts as seen; so does the next one above and below, for the keyboard.
        """
        if scroll and session.selection[-1:] == (entity,):
            return False
        at, height = imgui.get_cursor_screen_pos(), _row_height()
        near = (at.x + 1, at.y + 2 * height)
        if imgui.is_rect_visible((at.x, at.y - height), near):
            return False
        imgui.dummy((0, height))
        return True

    def _joint(self, session: "Session", joint: Joint, scroll: bool) -> None:
        icon = Icons.weld if joint.kind == "fixed" else Icons.joint
        motor = joint.motor
        driven = joint.kind != "fixed" and motor is not None and motor.on
        caps = key_caps(motor.binding, session.control_keys) if driven and motor else ()
        name = session.document.spoken_name_of(joint.id)
        self._row(session, joint.id, icon, name, COLOURS.muted, scroll, keys=caps)

    def _thruster(self, session: "Session", thruster: Thruster, scroll: bool) -> None:
        caps = key_caps(MOTOR_BINDINGS + thruster.binding, session.control_keys)
        name = session.document.spoken_name_of(thruster.id)
        self._row(session, thruster.id, Icons.thruster, name, COLOURS.muted, scroll, keys=caps)

    def _row(
        self,
        session: "Session",
        entity: EntityId,
        icon: str,
        name: str,
        tint: Rgba,
        scroll: bool,
        *,
        keys: tuple[str, ...] = (),
    ) -> None:
        selected = entity in session.selection
        imgui.push_id(f"row-{entity}")
        start = imgui.get_cursor_screen_pos()
        height = _row_height()
        caps = "  ".join(keys)
        signs = px(48) if isinstance(entity, int) else 0.0
        room = imgui.get_content_region_avail().x - px(36) - signs
        shown = widgets.fitted(name, room - (imgui.calc_text_size(caps).x if caps else 0.0))
        flags = (
            imgui.SelectableFlags_.allow_overlap.value
            | imgui.SelectableFlags_.allow_double_click.value
        )
        if imgui.selectable("###row", selected, flags, (0, height))[0]:
            self._choose(session, entity)
            if imgui.is_mouse_double_clicked(0):
                session.queue("edit.rename")
        if imgui.is_item_clicked(imgui.MouseButton_.right.value) and session.editing:
            at = imgui.get_mouse_pos()
            session.queue(lambda: actions.open_menu_of(session, entity, (at.x, at.y)))
        widgets.probe(session, f"outliner.{entity}")
        hovered = imgui.is_item_hovered()
        if hovered:
            session.highlighted = (entity,)
        if shown != name:
            widgets.tooltip(name, own=True)
        if scroll and selected and entity == session.selection[-1]:
            _bring_into_view()
        draw = imgui.get_window_draw_list()
        middle = start.y + (height - imgui.get_text_line_height()) / 2
        hidden = entity in session.document.hidden
        ink = COLOURS.faint if hidden else COLOURS.text
        widgets.sign(draw, (start.x + px(4), middle), u32(tint), icon)
        draw.add_text((start.x + px(28), middle), u32(ink), shown)
        x = start.x + px(28) + imgui.calc_text_size(shown).x + px(8)
        with widgets.font(None, SMALL):
            draw.add_text((x, middle + px(1)), u32(COLOURS.faint), caps)
        if isinstance(entity, int):
            self._flags(session, entity, start, height, hovered)
        imgui.pop_id()

    def _flags(
        self, session: "Session", entity: int, start: imgui.ImVec2, height: float, hovered: bool
    ) -> None:
        document = session.document
        right = start.x + imgui.get_content_region_avail().x
        for offset, name, on, icons in (
            (px(46), "hidden", entity in document.hidden, (Icons.eye, Icons.eye_off)),
            (px(22), "locked", entity in document.locked, (Icons.unlock, Icons.lock)),
        ):
            near = (
                imgui.is_mouse_hovering_rect((start.x, start.y), (right, start.y + height))
                and imgui.is_window_hovered()
            )
            if not (on or hovered or near):
                continue
            imgui.set_cursor_screen_pos((right - offset, start.y + px(1)))
            if widgets.icon_button(
                session,
                f"outliner.{entity}.{name}",
                icons[1] if on else icons[0],
                tint=COLOURS.warn if on else COLOURS.faint,
                height=height - px(2),
            ):
                session.queue(lambda name=name: _toggle(session, name, entity))
            widgets.tooltip("Show" if on and name == "hidden" else name.capitalize())
        imgui.set_cursor_screen_pos((start.x, start.y + height))
        imgui.dummy((0, 0))

    def _choose(self, session: "Session", entity: EntityId) -> None:
        io = imgui.get_io()
        if io.key_ctrl or io.key_shift:
            kept = tuple(other for other in session.selection if other != entity)
            chosen = kept if entity in session.selection else (*kept, entity)
        else:
            chosen = (entity,)
        session.queue(lambda: setattr(session, "selection", chosen))

    def _arena(self, session: "Session", level: Level) -> bool:
        """The sides of the arena: under a heading that folds, or those that the filter finds."""
        if not self._filter and not widgets.section("Arena", opened=False):
            return False
        found = False
        for name, label in ARENA_LABELS.items():
            called = tr(label)
            if self._shows(f"{label} {called}"):
                role = getattr(level.arena, name).role
                self._row(session, name, Icons.arena, called, _role_colour(role), False)
                found = True
        return found


@dataclasses.dataclass(kw_only=True)
class Hanging:
    """The joints and thrusters of a body."""

    joints: list[Joint] = dataclasses.field(default_factory=list)
    listed: list[Joint] = dataclasses.field(default_factory=list)
    """Those that stand under it: under their second body, so that each is listed once."""
    thrusters: list[Thruster] = dataclasses.field(default_factory=list)


@remembers(2)
def parts_of(level: Level) -> dict[int, Hanging]:
    """Return the joints and thrusters of each body."""
    found = {body.id: Hanging() for body in level.bodies}
    for joint in level.joints:
        ends = [e for e in dict.fromkeys((joint.a, joint.b)) if isinstance(e, int) and e in found]
        for end in ends:
            found[end].joints.append(joint)
        if ends:
            found[ends[-1]].listed.append(joint)
    for thruster in level.thrusters:
        if thruster.body in found:
            found[thruster.body].thrusters.append(thruster)
    return found


def _row_height() -> float:
    return imgui.get_text_line_height() + px(8)


def _bring_into_view() -> None:
    """Scroll to the last widget unless it is seen whole already."""
    top = imgui.get_window_pos().y
    bottom = top + imgui.get_window_size().y
    if imgui.get_item_rect_min().y < top or imgui.get_item_rect_max().y > bottom:
        imgui.set_scroll_here_y(0.5)


def _toggle(session: "Session", name: str, entity: int) -> None:
    current: frozenset[EntityId] = getattr(session.document, name)
    setattr(session.document, name, current ^ {entity})
