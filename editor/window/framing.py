"""The camera that shows the level: an arena that is shown whole follows everything that moves."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions.view import shows_panels
from editor.base.camera import ARENA, Camera, Point
from editor.toolkit.widgets import px
from kinetix.level.geometry import ARENA_WIDTH

if TYPE_CHECKING:
    from editor.session import Session, Tab

_SETTLED_FRAME: Final = 6
_MARGIN: Final = 28.0
"""Room around the arena when it is shown whole [px at 100 %]."""
_PLAY_MARGIN: Final = 12.0
_MOST_MARGIN: Final = 0.05
"""Of the viewport's smaller side."""
_SPLIT_MARGIN: Final = 20.0


class Framing:
    """Chooses the camera of every frame, and gives each its view back: Edit, Play, two halves."""

    def __init__(self) -> None:
        self.measuring = False
        """True if a panel is on the screen that is looked at together with the level."""
        self._before_split: tuple[Tab, Camera, bool] | None = None
        """While two halves are shown: the tab, where it looked before, and whether it followed."""
        self._cause: object = None
        """Inputs of the fit; when they change, an arena shown whole is fitted again."""
        self._unmeasured: tuple[Tab, Camera, int] | None = None
        """While such a panel is there: the tab, where it looked before, and `_asked` then."""
        self._asked = 0
        """Number of fits that something other than the canvas asked for."""
        self._refits = 0
        """For how many frames yet an arena shown whole is fitted to the viewport."""
        self._followed: dict[int, Camera] = {}
        """The camera of each document that shows its arena whole, as the canvas set it last."""
        self._left: tuple[Tab, Point, int] | None = None
        """After Play: the tab, the room that Edit had, frames until the panels stand still."""
        self._edit_view: tuple[Tab, Camera, bool] | None = None
        """While a level is played: its tab, where Edit looked, and whether that was the arena."""

    @property
    def split(self) -> bool:
        """True if two players have a half each."""
        return self._before_split is not None

    def refit(self) -> None:
        """Show the arena whole again, if it was, as soon as the panels stand where they stay."""
        self._refits = _SETTLED_FRAME
        self._asked += 1

    def divide(self, session: "Session") -> None:
        """Give the left half to one player and the right half to the other, or all to one."""
        rival = session.viewer.rival
        wanted = not session.editing and session.viewer.arrangement == "side" and rival.active
        if wanted and not self.split:
            tab = session.tab
            self._before_split = (tab, tab.camera, self._follows(tab))
            tab.fitted = False
        elif not wanted and self._before_split is not None:
            (tab, camera, whole), self._before_split = self._before_split, None
            tab.camera = camera
            if whole:
                self._followed[tab.document.number] = camera

    def choose(self, session: "Session", origin: Point, size: Point, *, held: bool = False) -> None:
        """Choose the camera for the present viewport.

        Nothing moves under a pointer that holds something.

        An arena that is shown whole follows the window, the layouts, Play, what is drawn over it on
        demand, the height of the row below, and panels that measure. In Edit, all others that only
        come and go leave every point of the level where it is on the screen.
        """
        io, tab = imgui.get_io(), session.tab
        cause = (
            (io.display_size.x, io.display_size.y, px(1)),
            session.view.interface,
            not session.editing and shows_panels(session),
            self.split,
            session.tab.moment is not None,
            session.viewer.ways is not None,
            session.view.debug_draw,
            None if session.editing else size,
        )
        if cause != self._cause:
            self._cause = cause
            self.refit()
        self._enter_and_leave(session)
        self._fit_what_is_left(session, size)
        self._stand_beside(session)
        whole = self._follows(tab)
        if whole and not held and (self._refits or not tab.fitted):
            camera = session.camera.with_viewport(origin, size)
            camera = camera.fitted(*ARENA, margin=self._margin(session, size))
            session.camera = camera.on_pixels(ARENA_WIDTH)
            # The layout needs some frames to settle; until then the viewport is not the last one.
            tab.fitted = tab.fitted or imgui.get_frame_count() > _SETTLED_FRAME
        else:
            session.camera = session.camera.moved_viewport(origin, size)
        if whole:
            self._followed[tab.document.number] = session.camera
        if not held:
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
                self._left = (played, camera.size, _SETTLED_FRAME)

    def _fit_what_is_left(self, session: "Session", size: Point) -> None:
        """Fit an arena that was whole before Play, if panels that Play has opened take its room."""
        if self._left is None:
            return
        tab, room, frames = self._left
        self._left = (tab, room, frames - 1) if frames > 1 else None
        if self._left is not None:
            return
        smaller = size[0] < room[0] - 1 or size[1] < room[1] - 1
        if smaller and session.editing and session.tab is tab:
            self._refits = _SETTLED_FRAME

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

    def _margin(self, session: "Session", size: Point) -> float:
        if self.split:
            return px(_SPLIT_MARGIN)
        return min(px(_MARGIN if session.editing else _PLAY_MARGIN), _MOST_MARGIN * min(size))
