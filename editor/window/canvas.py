"""The middle of the window: shows the level, turns the mouse into pointer events.

Edit draws the document as vectors; Play draws the simulated state the same way, with the picture
of the JAX renderer over it as soon as there is one.
"""

import dataclasses
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions import context
from editor.actions.view import shows_panels
from editor.base import events
from editor.base.camera import ARENA, Camera, Point
from editor.base.language import tr
from editor.base.overlay import Cursor
from editor.documents.commands.bodies import posed
from editor.drawing.agent_overlay import paint_ghost, paint_heat, paint_numbers, paint_reason
from editor.drawing.confetti import paint_confetti
from editor.drawing.debug_draw import paint_debug
from editor.drawing.futures_overlay import paint_futures
from editor.drawing.marks import CapPlace, Marker
from editor.drawing.minimap import Minimap
from editor.drawing.name_tags import paint_names
from editor.drawing.path_overlay import paint_paths
from editor.drawing.reasons import paint_legend, paint_places, paint_reasons
from editor.drawing.vectors import Painter, Placement, paint_level, poses_of
from editor.editing import gauges, picking
from editor.play.mode import Mode
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, TEXT, TITLE, Rgba, u32
from editor.toolkit.modes import MODE_LOOK, OUTCOME_LOOK
from editor.toolkit.textures import TextureStore
from editor.toolkit.widgets import font, probe, px
from editor.window.play_image import PlayImage
from editor.window.play_side import paint_side
from editor.window.waiting import paint_waiting
from editor.worker.recording import Snapshot
from kinetix.level.geometry import ARENA_WIDTH, FLOOR_TOP
from kinetix.level.model import Level
from kinetix.render.palette import KINETIX, PALETTES
from kinetix.render.style import STYLE

if TYPE_CHECKING:
    from editor.session import Session, Tab

_SETTLED_FRAME: Final = 6
_MARGIN: Final = 28.0
"""Room around the arena when it is shown whole [px at 100 %]."""
_PLAY_MARGIN: Final = 12.0
_SPLIT_MARGIN: Final = 20.0
_NOWHERE: Final = (-1e6, -1e6)
_BUTTONS: Final = {events.LEFT: 0, events.RIGHT: 1, events.MIDDLE: 2}
"""Our button numbers to Dear ImGui's."""

_CURSORS: Final = {
    Cursor.ARROW: imgui.MouseCursor_.arrow,
    Cursor.CROSS: imgui.MouseCursor_.arrow,
    Cursor.HAND: imgui.MouseCursor_.hand,
    Cursor.MOVE: imgui.MouseCursor_.resize_all,
    Cursor.ROTATE: imgui.MouseCursor_.hand,
    Cursor.RESIZE: imgui.MouseCursor_.resize_nwse,
    Cursor.REFUSED: imgui.MouseCursor_.not_allowed,
}


class Canvas:
    """Holds only what lasts between frames: which buttons are down and where the pointer was."""

    def __init__(self, textures: TextureStore) -> None:
        self.images = PlayImage()
        """The JAX renderer's pictures of what is played."""
        self._textures = textures
        self._minimap = Minimap()
        self._down: list[int] = []
        self._mouse = (0.0, 0.0)
        self._before_split: Camera | None = None
        self._cause: object = None
        """Inputs of the fit; when they change, an arena shown whole is fitted anew."""
        self.measuring = False
        """True if a panel is on the screen that is looked at together with the level."""
        self._unmeasured: tuple[Tab, Camera, int] | None = None
        """While such a panel is there: the tab, where it looked before, and `_asked` then."""
        self._asked = 0
        """Number of fits that something other than the canvas asked for."""
        self._refits = 0
        """For how many frames yet an arena shown whole is fitted to the viewport."""
        self._followed: dict[int, Camera] = {}
        """The camera of each document that shows its arena whole, as the canvas set it last."""
        self._edit_view: tuple[Tab, Camera, bool] | None = None
        """While a level is played: its tab, where Edit looked, and whether that was the arena."""
        self.area = ((0.0, 0.0), (1.0, 1.0))
        """Upper left corner and size of the canvas [px]."""
        self.hovered = False
        self._won_at: float | None = None
        self.caps: tuple[CapPlace, ...] = ()
        """Places of the key caps of the last frame."""

    def interact(self, session: "Session") -> None:
        """Lay out the canvas in the current window and take the mouse."""
        origin, space = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail()
        size = (max(space.x, 16.0), max(space.y, 16.0))
        buttons = (
            imgui.ButtonFlags_.mouse_button_left.value
            | imgui.ButtonFlags_.mouse_button_right.value
            | imgui.ButtonFlags_.mouse_button_middle.value
        )
        imgui.push_item_flag(imgui.ItemFlags_.no_nav.value, True)
        imgui.invisible_button("canvas", size, buttons)
        imgui.pop_item_flag()
        probe(session, "canvas")
        self.area = ((origin.x, origin.y), size)
        self.hovered = imgui.is_item_hovered()
        self._split(session)
        own = (size[0] / 2, size[1]) if self._before_split is not None else size
        self._look(session, (origin.x, origin.y), own)
        mouse = imgui.get_io().mouse_pos
        # A drag that began on the level goes on over the map.
        free = self.hovered and not self._down
        if not self._minimap.takes(session, (mouse.x, mouse.y), hovered=free):
            self._mouse_input(session)

    def refit(self) -> None:
        """Show the arena whole again, if it was, as soon as the panels stand where they stay."""
        self._refits = _SETTLED_FRAME
        self._asked += 1

    def _look(self, session: "Session", origin: Point, size: Point) -> None:
        """Choose the camera for the present viewport.

        An arena that is shown whole follows the window, the layouts, Play, and what is drawn over
        it on demand, and panels that measure. In Edit, all others that only come and go leave every
        point of the level where it is on the screen.
        """
        io, tab = imgui.get_io(), session.tab
        cause = (
            (io.display_size.x, io.display_size.y, px(1)),
            session.view.interface,
            not session.editing and shows_panels(session),
            self._before_split is not None,
            session.tab.moment is not None,
            session.viewer.paths is not None,
            session.view.debug_draw,
            None if session.editing else size,
        )
        if cause != self._cause:
            self._cause = cause
            self.refit()
        self._enter_and_leave(session)
        self._stand_beside(session)
        whole = self._follows(tab)
        if whole and (self._refits or not tab.fitted):
            camera = session.camera.with_viewport(origin, size)
            camera = camera.fitted(*ARENA, margin=self._margin(session))
            session.camera = camera.on_pixels(ARENA_WIDTH)
            # The layout needs some frames to settle; until then the viewport is not the last one.
            tab.fitted = tab.fitted or imgui.get_frame_count() > _SETTLED_FRAME
        else:
            session.camera = session.camera.moved_viewport(origin, size)
        if whole:
            self._followed[tab.document.number] = session.camera
        self._refits = max(self._refits - 1, 0)

    def _enter_and_leave(self, session: "Session") -> None:
        """Give Play a view of its own; after it the view of Edit is as it was."""
        tab = session.tab
        if not session.editing and self._edit_view is None:
            self._edit_view = (tab, tab.camera, self._follows(tab))
            self.refit()
        elif session.editing and self._edit_view is not None:
            (played, camera, whole), self._edit_view = self._edit_view, None
            played.camera, self._refits = camera, 0
            if played.moment is not None:
                # The strip over it takes room that the arena had.
                self.refit()
            if whole:
                self._followed[played.document.number] = camera

    def _stand_beside(self, session: "Session") -> None:
        """Fit the arena beside panels that measure; after them the view is as it was."""
        tab, before = session.tab, self._unmeasured
        if not session.editing:
            return
        if self.measuring:
            if before is None or before[0] is not tab:
                self._unmeasured = (tab, tab.camera, self._asked)
                self._refits = _SETTLED_FRAME
            return
        if before is None:
            return
        (measured, camera, asked), self._unmeasured = before, None
        if measured is not tab or asked != self._asked:
            self.refit()
        elif self._follows(tab):
            tab.camera, self._refits = camera, 0
            self._followed[tab.document.number] = camera

    def _follows(self, tab: "Tab") -> bool:
        """Return whether a tab shows its arena whole, and nobody has zoomed or panned since."""
        return not tab.fitted or tab.camera == self._followed.get(tab.document.number)

    def _margin(self, session: "Session") -> float:
        if self._before_split is not None:
            return px(_SPLIT_MARGIN)
        return px(_MARGIN if session.editing else _PLAY_MARGIN)

    def _split(self, session: "Session") -> None:
        """Give the left half to one player and the right half to the other, or all to one."""
        rival = session.viewer.rival
        wanted = not session.editing and session.viewer.arrangement == "side" and rival.active
        if wanted and self._before_split is None:
            self._before_split = session.camera
            session.tab.fitted = False
        elif not wanted and self._before_split is not None:
            session.camera, self._before_split = self._before_split, None

    def _mouse_input(self, session: "Session") -> None:
        """Make pointer events of Dear ImGui's mouse; a drag goes on outside the canvas."""
        io = imgui.get_io()
        mouse = (io.mouse_pos.x, io.mouse_pos.y)
        inside = self.hovered or bool(self._down)
        if self.hovered and (io.mouse_wheel or io.mouse_wheel_h):
            actions.handle(
                session,
                events.WheelEvent(
                    dx=io.mouse_wheel_h,
                    dy=io.mouse_wheel,
                    screen=mouse,
                    modifiers=_modifiers(),
                ),
            )
        if self._on_cap(session, mouse):
            return
        if session.editing and not session.driver.active and not self._down:
            # Every frame, as what lies under a resting pointer may change: handles follow.
            self._pointer(session, events.Pointer.MOVE, mouse if inside else _NOWHERE, 0)
        elif inside and mouse != self._mouse:
            self._pointer(session, events.Pointer.MOVE, mouse, self._down[0] if self._down else 0)
        for button, theirs in _BUTTONS.items():
            if imgui.is_mouse_clicked(theirs) and self.hovered:
                self._down.append(button)
                self._pointer(session, events.Pointer.PRESS, mouse, button)
            elif button in self._down and not imgui.is_mouse_down(theirs):
                self._down.remove(button)
                self._pointer(session, events.Pointer.RELEASE, mouse, button)
        if not inside:
            session.hands.cursor = None
        self._mouse = mouse
        if self.hovered and session.editing:
            imgui.set_mouse_cursor(_CURSORS[session.driver.feedback.cursor].value)

    def _on_cap(self, session: "Session", mouse: Point) -> bool:
        """Let a click on a key cap choose another key; whether the pointer is on one in Edit."""
        free = session.editing and session.tool.id == "select" and not session.driver.active
        if not (free and self.hovered and not self._down and session.settings.key_caps):
            return False
        found = next((cap for cap in self.caps if _inside(mouse, cap.low, cap.high)), None)
        if found is None:
            return False
        session.hovered, self._mouse = found.entity, mouse
        session.hands.cursor = session.camera.to_world(mouse)
        imgui.set_mouse_cursor(imgui.MouseCursor_.hand.value)
        if imgui.is_mouse_clicked(0):
            entity = found.entity
            session.queue(lambda: context.ask_key(session, entity, mouse))
        return not any(imgui.is_mouse_clicked(button) for button in (1, 2))

    def _pointer(
        self, session: "Session", kind: events.Pointer, mouse: tuple[float, float], button: int
    ) -> None:
        event = events.PointerEvent(
            kind=kind,
            world=session.camera.to_world(mouse),
            screen=mouse,
            button=button,
            modifiers=_modifiers(),
            time=session.time,
        )
        actions.handle(session, event)

    def paint(self, session: "Session") -> None:
        """Draw level and marks into the current window."""
        draw = imgui.get_window_draw_list()
        (x, y), (width, height) = self.area
        low, high = (x, y), (x + width, y + height)
        draw.push_clip_rect(low, high, True)
        draw.add_rect_filled(low, high, u32(COLOURS.backdrop))
        painter = Painter(
            draw=draw,
            camera=session.camera,
            palette=PALETTES.get(session.settings.palette, KINETIX),
            style=dataclasses.replace(
                STYLE, glyphs=session.settings.glyphs, patterns=session.settings.patterns
            ),
        )
        scene = session.scene
        where = Placement(level=scene, poses=poses_of(scene))
        marker = Marker(painter=painter, where=where)
        settings = session.settings
        grid = settings.grid_step if settings.grid_visible and session.editing else None
        painter.paper(grid=grid)
        paint_places(session, painter)
        snapshot = session.playback.snapshot if session.playback.active else None
        paint_level(
            painter,
            where,
            hidden=session.document.hidden if session.editing else (),
            thrust=snapshot.thruster.tolist() if snapshot is not None else None,
        )
        split = self._before_split is not None
        if settings.renderer_picture and not split:
            self._picture(session, painter)
        if session.view.debug_draw:
            paint_debug(session, painter, where)
        paint_reasons(session, painter, where)
        if settings.key_caps:
            self._key_caps(session, marker)
        if settings.names:
            hidden = session.document.hidden if session.editing else ()
            caps = self.caps if settings.key_caps else ()
            paint_names(painter, where, hidden=hidden, caps=caps)
        if session.editing:
            paint_paths(session, painter)
            self._edit_marks(session, marker)
        else:
            self._players(session, painter, where, split=split)
            self._play_marks(session, marker)
        if session.editing and not scene.bodies and not session.driver.active:
            self._teach(draw, session.camera)
        self._minimap.paint(session, draw, where, high)
        self._frame(session, draw)
        paint_legend(session, draw, (x + px(12), y + height - px(12)))
        draw.pop_clip_rect()

    def _picture(self, session: "Session", painter: Painter) -> None:
        """Lay the renderer's picture, when there is one, over the vectors inside the arena."""
        low, high = painter.square(ARENA_WIDTH)
        self.images.update(session, high[0] - low[0])
        picture = self.images.picture(session)
        if picture is not None:
            texture = self._textures.texture("play", picture.pixels, picture.stamp)
            painter.draw.add_image(texture, low, high)

    def _key_caps(self, session: "Session", marker: Marker) -> None:
        editing = session.editing
        pointed = () if session.hovered is None else (session.hovered,)
        self.caps = marker.key_caps(
            session.control_keys,
            () if editing else session.hands.held,
            hidden=session.document.hidden if editing else (),
            pointed=(*pointed, *session.selection, *session.highlighted) if editing else (),
        )

    def _edit_marks(self, session: "Session", marker: Marker) -> None:
        hovered = tuple(session.highlighted)
        if session.hovered is not None:
            hovered = (*hovered, session.hovered)
        marker.selection(session.selection, hovered)
        marker.marks(session.marks)
        if session.tool.id == "select" and not session.driver.active:
            level, metres = session.document.shown, session.metres
            if session.selection or level.bodies:
                marker.marks(gauges.marks_of(level, session.selection, metres))
                marker.marks(gauges.handles_of(level, session.selection, metres))
            marker.marks(picking.handles(level, session.selection, metres))

    def _players(
        self, session: "Session", painter: Painter, where: Placement, *, split: bool
    ) -> None:
        """Draw the agents: the second one as a ghost or in its own half, and their actions."""
        playback, rival = session.playback, session.viewer.rival
        snapshot, level = playback.snapshot, playback.level
        other = rival.shown(playback.engine_step) if rival.active else None
        heat = "heat" in session.settings.agent_overlay
        if split and level is not None:
            self._second_half(session, painter, level, other, heat=heat)
        elif other is not None and snapshot is not None and level is not None:
            paint_ghost(painter, level, snapshot, other)
        if snapshot is not None and "futures" in session.settings.agent_overlay:
            paint_futures(painter, snapshot)
        if heat and snapshot is not None:
            paint_heat(painter, where, snapshot)

    def _second_half(
        self,
        session: "Session",
        painter: Painter,
        level: Level,
        other: Snapshot | None,
        *,
        heat: bool,
    ) -> None:
        """Draw the second player's half: its moment, or the level's start until it has one."""
        (x, y), (width, height) = self.area
        camera = session.camera
        low, high = (x + width / 2, y), (x + width, y + height)
        draw = painter.draw
        draw.push_clip_rect(low, high, True)
        draw.add_rect_filled(low, high, u32(COLOURS.backdrop))
        right = dataclasses.replace(painter, camera=camera.with_viewport(low, (width / 2, height)))
        scene = level if other is None else posed(level, other)
        where = Placement(level=scene, poses=poses_of(scene))
        right.paper(grid=None)
        paint_level(right, where, thrust=None if other is None else other.thruster.tolist())
        if heat and other is not None:
            paint_heat(right, where, other)
        draw.add_line(low, (low[0], high[1]), u32(COLOURS.line), px(2))
        rival = session.viewer.rival
        if rival.failure:
            paint_reason(draw, (low, (width / 2, height)), "It cannot play", rival.failure)
        draw.pop_clip_rect()
        names = (session.playback.player or "You", rival.player)
        if session.viewer.other_physics:
            names = (session.playback.physics, session.viewer.other_physics)
        if rival.waiting and not rival.failure:
            names = (names[0], tr(f"{names[1]}, preparing …"))
        with font(FONTS.bold, TEXT):
            for name, left in zip(names, (x, low[0]), strict=True):
                extent = imgui.calc_text_size(name)
                at = (left + (width / 2 - extent.x) / 2, y + height - extent.y - px(8))
                draw.add_text(at, u32(COLOURS.text), name)

    def _play_marks(self, session: "Session", marker: Marker) -> None:
        pull = session.hands.pull
        if pull is None:
            return
        camera = session.camera
        a = camera.to_screen(marker.where.point(pull.body, pull.anchor))
        b = camera.to_screen(pull.target)
        orange = u32((0.95, 0.45, 0.05, 1.0))
        marker.draw.add_line(a, b, orange, px(2.5))
        marker.draw.add_circle_filled(a, px(4), orange)
        marker.draw.add_circle_filled(b, px(5), orange)

    def _teach(self, draw: imgui.ImDrawList, camera: Camera) -> None:
        """Say what to do with an empty level, as far as the paper over the floor has room."""
        (left, top), (right, floor) = (
            camera.to_screen((ARENA[0][0], ARENA[1][1])),
            camera.to_screen((ARENA[1][0], FLOOR_TOP)),
        )
        lines = (
            (FONTS.bold, TITLE, "An empty level", (0.2, 0.22, 0.27, 1.0)),
            (None, TEXT, "Draw shapes:  R rectangle   C circle   T triangle", _INK),
            (None, TEXT, "Join them:  J joint   W weld   H thruster", _INK),
            (None, TEXT, "Then Space plays: green has to touch blue, and never red.", _INK),
            (None, SMALL, "Ctrl+O opens a level    F1 shows every key", _INK),
        )
        top += (floor - top) * 0.36
        for face, size, english, colour in lines:
            words = tr(english)
            with font(face, size):
                extent = imgui.calc_text_size(words)
                if extent.x > right - left or top + extent.y > floor:
                    continue
                draw.add_text((left + (right - left - extent.x) / 2, top), u32(colour), words)
                top += extent.y + px(9)

    def _frame(self, session: "Session", draw: imgui.ImDrawList) -> None:
        """The mode as a coloured frame, a badge, and how the episode ended."""
        (x, y), (width, height) = self.area
        word, name = MODE_LOOK[session.mode]
        word, colour = tr(word), COLOURS.of(name)
        if not session.editing:
            inset = px(1.5)
            draw.add_rect(
                (x + inset, y + inset),
                (x + width - inset, y + height - inset),
                u32(colour),
                0.0,
                px(3),
            )
            self._episode(session, draw)
            return
        with font(FONTS.bold, SMALL):
            size = imgui.calc_text_size(word)
            low = (x + px(12), y + px(12))
            high = (low[0] + size.x + px(16), low[1] + size.y + px(8))
            draw.add_rect_filled(low, high, u32(colour), px(5))
            draw.add_text((low[0] + px(8), low[1] + px(4)), u32(COLOURS.backdrop), word)

    def _celebrate(self, session: "Session", draw: imgui.ImDrawList) -> None:
        """Let confetti fall over a win, where a person sees it happen."""
        settings, playback = session.settings, session.playback
        won = session.mode is Mode.ENDED and playback.outcome == "won"
        if not won:
            self._won_at = None
            return
        if self._won_at is None:
            self._won_at = session.time
        if session.attended and settings.win_effects and not settings.reduced_motion:
            low, high = session.camera.to_screen((0.0, 5.0)), session.camera.to_screen((5.0, 0.0))
            paint_confetti(draw, low, high, session.time - self._won_at)

    def _episode(self, session: "Session", draw: imgui.ImDrawList) -> None:
        """Draw what is to be said of the episode beside the arena."""
        (x, y), (width, _) = self.area
        playback = session.playback
        ended = playback.outcome if session.mode is Mode.ENDED else None
        if ended is not None:
            low, high = session.camera.to_screen((0.0, 5.0)), session.camera.to_screen((5.0, 0.0))
            r = px(3)
            outside = (low[0] - r, low[1] - r), (high[0] + r, high[1] + r)
            draw.add_rect(*outside, u32(COLOURS.of(OUTCOME_LOOK[ended][2])), px(4), px(3))
        paint_side(session, draw, self.area, split=self._before_split is not None)
        if "numbers" in session.settings.agent_overlay:
            paint_numbers(session, draw, x + width - px(12), y + px(12))
        self._celebrate(session, draw)
        if session.mode is Mode.PAUSED and playback.failure:
            paint_reason(draw, self.area, "Paused", playback.failure)
        paint_waiting(session, draw, self.area)


_INK: Final[Rgba] = (0.36, 0.39, 0.45, 1.0)


def _inside(point: Point, low: Point, high: Point) -> bool:
    return low[0] <= point[0] <= high[0] and low[1] <= point[1] <= high[1]


def _modifiers() -> events.Modifiers:
    io = imgui.get_io()
    return events.Modifiers(ctrl=io.key_ctrl, shift=io.key_shift, alt=io.key_alt)
