"""The middle of the window: the level and everything drawn over it.

Edit draws the document as vectors; Play draws the simulated state the same way, with the picture
of the JAX renderer over it as soon as there is one.
"""

import dataclasses
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.camera import ARENA, Camera
from editor.base.language import tr
from editor.documents.commands.bodies import posed
from editor.drawing.agent_overlay import (
    RING,
    Room,
    paint_ghost,
    paint_heat,
    paint_numbers,
    paint_reason,
)
from editor.drawing.confetti import paint_confetti
from editor.drawing.debug_draw import paint_debug
from editor.drawing.futures_overlay import paint_futures
from editor.drawing.key_plates import CapPlace, paint_key_caps
from editor.drawing.marks import Marker
from editor.drawing.minimap import Minimap
from editor.drawing.name_tags import paint_names
from editor.drawing.path_overlay import paint_paths
from editor.drawing.reasons import paint_legend, paint_places, paint_reasons
from editor.drawing.vectors import Painter, Placement, paint_level, poses_of
from editor.editing import gauges, picking
from editor.play.mode import Mode
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, TEXT, TITLE, Rgba, alpha, u32
from editor.toolkit.modes import MODE_LOOK, OUTCOME_LOOK
from editor.toolkit.textures import TextureStore
from editor.toolkit.widgets import broken, font, probe, px
from editor.window.framing import Framing
from editor.window.mouse import Mouse
from editor.window.play_image import PlayImage
from editor.window.play_side import paint_side
from editor.window.waiting import paint_waiting
from editor.worker.snapshots import Snapshot
from kinetix.level.geometry import ARENA_WIDTH, FLOOR_TOP
from kinetix.level.model import Level
from kinetix.render.palette import KINETIX, PALETTES
from kinetix.render.style import STYLE

if TYPE_CHECKING:
    from editor.session import Session

_COVERED: Final = 0.4
"""Share of the canvas's height that the agent's plate may take where it stands over an arena."""
_EDGE: Final = 12.0
"""Between the canvas's edge and what is written there [px at 100 %]."""


class Canvas:
    """Takes the mouse and paints the level, through the camera that its framing chooses."""

    def __init__(self, textures: TextureStore) -> None:
        self.images = PlayImage()
        """The JAX renderer's pictures of what is played."""
        self._textures = textures
        self._minimap = Minimap()
        self._mouse = Mouse()
        self.framing = Framing()
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
        self.framing.divide(session)
        own = (size[0] / 2, size[1]) if self.framing.split else size
        self.framing.choose(session, (origin.x, origin.y), own, held=self._mouse.dragging)
        mouse = imgui.get_io().mouse_pos
        # A drag that began on the level goes on over the map.
        free = self.hovered and not self._mouse.dragging
        if not self._minimap.takes(session, (mouse.x, mouse.y), hovered=free):
            self._mouse.take(session, self.caps, hovered=self.hovered)

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
        split = self.framing.split
        if settings.renderer_picture and not split:
            self._picture(session, painter)
        if session.view.debug_draw:
            paint_debug(session, painter, where)
        paint_reasons(session, painter, where)
        if settings.key_caps:
            self._key_caps(session, painter, where)
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
        paint_waiting(session, draw, self.area)
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

    def _key_caps(self, session: "Session", painter: Painter, where: Placement) -> None:
        editing = session.editing
        hidden = session.document.hidden if editing else ()
        pointed = () if session.hovered is None else (session.hovered,)
        snapshot = None if editing else session.playback.snapshot
        ringed = snapshot is not None and snapshot.mind is not None
        ringed = ringed and "heat" in session.settings.agent_overlay
        self.caps = paint_key_caps(
            painter,
            where,
            session.control_keys,
            () if editing else session.hands.held,
            hidden=hidden,
            pointed=(*pointed, *session.selection, *session.highlighted) if editing else (),
            # In Play they would jump about as the shapes move; nobody clicks them there.
            avoid=[b for b in where.level.bodies if b.id not in hidden] if editing else (),
            ring=px(RING) if ringed else 0.0,
        )

    def _edit_marks(self, session: "Session", marker: Marker) -> None:
        hovered = tuple(session.highlighted)
        if session.hovered is not None:
            hovered = (*hovered, session.hovered)
        marker.selection(session.selection, hovered)
        marker.marks(session.marks)
        if session.tool.id == "select" and not session.driver.active:
            level, metres = session.document.shown, session.metres
            loose = session.document.unlocked
            marker.marks(gauges.marks_of(level, loose, metres))
            marker.marks(gauges.handles_of(level, loose, metres))
            marker.marks(picking.handles(level, loose, metres))

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
            names = (session.playback.played_under, session.viewer.other_physics)
        if rival.preparing:
            names = (names[0], tr(f"{names[1]}, preparing …"))
        with font(FONTS.bold, TEXT):
            for name, left in zip(names, (x, low[0]), strict=True):
                extent = imgui.calc_text_size(name)
                at = (left + (width / 2 - extent.x) / 2, y + height - extent.y - px(8))
                low_left = (at[0] - px(8), at[1] - px(3))
                high_right = (at[0] + extent.x + px(8), y + height - px(5))
                draw.add_rect_filled(low_left, high_right, u32(alpha(COLOURS.raised, 0.92)), px(5))
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
        """Report what to do with an empty level, as far as the paper over the floor has room."""
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
        top, room = top + (floor - top) * 0.36, right - left - px(24)
        for face, size, english, colour in lines:
            with font(face, size):
                parts = broken(tr(english), room)
                extents = [imgui.calc_text_size(words) for words in parts]
                high = sum(extent.y + px(3) for extent in extents)
                if top + high > floor or any(extent.x > room for extent in extents):
                    continue  # half of a sentence is worse than none
                for words, extent in zip(parts, extents, strict=True):
                    draw.add_text((left + (right - left - extent.x) / 2, top), u32(colour), words)
                    top += extent.y + px(3)
                top += px(6)

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
            if width < px(_ROOM_FOR_BADGE) and high[0] > session.camera.to_screen(ARENA[0])[0]:
                return  # It would cover the level; the status line has it too.
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
        """Draw the words about the episode beside the arena."""
        (x, y), (width, height) = self.area
        playback = session.playback
        ended = playback.outcome if session.mode is Mode.ENDED else None
        if ended is not None:
            low, high = session.camera.to_screen((0.0, 5.0)), session.camera.to_screen((5.0, 0.0))
            r = px(3)
            outside = (low[0] - r, low[1] - r), (high[0] + r, high[1] + r)
            draw.add_rect(*outside, u32(COLOURS.of(OUTCOME_LOOK[ended][2])), px(4), px(3))
        said = paint_side(session, draw, self.area, split=self.framing.split)
        if "numbers" in session.settings.agent_overlay and width >= px(_ROOM_FOR_PLATE):
            share = 2 if self.framing.split else 1  # the numbers are the first player's
            right, top = x + width / share - px(_EDGE), y + px(_EDGE)
            arena, upper = session.camera.to_screen(ARENA[1])
            room = Room(
                beside=right - arena - px(_EDGE),
                across=right - said - px(_EDGE),
                above=upper - top,
                over=_COVERED * (height - px(_EDGE)) / share,
            )
            paint_numbers(session, draw, (right, top), room=room)
        self._celebrate(session, draw)
        if session.mode is Mode.PAUSED and playback.failure:
            paint_reason(draw, self.area, "Paused", playback.failure)


_ROOM_FOR_BADGE: Final = 440.0
"""Width of a canvas that shows the mode's badge over the level [px at 100 %]."""
_ROOM_FOR_PLATE: Final = 360.0
"""Width of a canvas that has room for the agent's plate beside the episode's [px at 100 %]."""
_INK: Final[Rgba] = (0.36, 0.39, 0.45, 1.0)
