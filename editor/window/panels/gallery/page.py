"""The gallery: all levels as pictures, over the whole window; search, filters, sets."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions.gallery import gallery as doing
from editor.toolkit.appearance import COLOURS
from editor.toolkit.guarding import guarded
from editor.toolkit.textures import TextureStore
from editor.toolkit.widgets import px
from editor.window.panels.gallery.cards import CardGrid
from editor.window.panels.gallery.head import draw_head
from editor.window.panels.gallery.places import draw_places, listed
from editor.window.panels.gallery.side import Side

if TYPE_CHECKING:
    from editor.session import Session

_LEFT: Final = 214.0
_RIGHT: Final = 300.0
_LOOK_SECONDS: Final = 5.0
"""Interval at which the folders are read while the gallery is open [s]."""
_FLAGS: Final = (
    imgui.WindowFlags_.no_decoration.value
    | imgui.WindowFlags_.no_move.value
    | imgui.WindowFlags_.no_docking.value
    | imgui.WindowFlags_.no_saved_settings.value
)


class GalleryPage:
    """Fills the window's middle while `session.gallery.open`."""

    def __init__(self, textures: TextureStore) -> None:
        self._grid = CardGrid(textures)
        self._side = Side()
        self._looked = -_LOOK_SECONDS
        self._was_open = False
        self._revision = -1
        self.side = 0.0
        """Width of the column at the right, where the buttons of the set are [px]."""

    def animating(self, session: "Session") -> bool:
        """Return whether the next frame differs: levels or pictures are on their way."""
        library, exporting = session.library, session.gallery.exporting is not None
        return exporting or library.busy or self._grid.missing or self._revision != library.revision

    def draw(self, session: "Session") -> None:
        """Draw it over everything between the bars."""
        appearing = not self._was_open
        self._was_open = True
        self._grid.begin_frame()
        due = session.time - self._looked > _LOOK_SECONDS
        if due and not session.library.busy:
            self._looked = session.time
            doing.look(session)
        viewport = imgui.get_main_viewport()
        imgui.set_next_window_pos(viewport.work_pos)
        imgui.set_next_window_size(viewport.work_size)
        imgui.push_style_color(imgui.Col_.window_bg, imgui.ImVec4(*COLOURS.surface))
        imgui.push_style_var(imgui.StyleVar_.window_rounding, 0.0)
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(16), px(12)))
        opened = imgui.begin("###gallery", None, _FLAGS)[0]
        imgui.pop_style_var(2)
        imgui.pop_style_color()
        if opened:
            if appearing and not session.prompts:
                imgui.set_window_focus()
            with guarded(session):
                self._page(session)
        imgui.end()

    def closed(self) -> None:
        """Note that the gallery is not on the screen."""
        self._was_open = False
        self.side = 0.0

    def _page(self, session: "Session") -> None:
        gallery = session.gallery
        self._revision = session.library.revision
        if gallery.folder is not None and not session.library.busy:
            gallery.folder = gallery.folder if listed(session, gallery.folder) else None
        cards = gallery.shown(session.library, session.results)
        left = px(_LEFT) if imgui.get_content_region_avail().x > px(760) else 0.0
        draw_head(session, cards, places=left > 0)
        space = imgui.get_content_region_avail()
        gap = imgui.get_style().item_spacing.x
        right = px(_RIGHT) if space.x > px(980) or gallery.tray else 0.0
        self.side = right
        if left:
            imgui.begin_child("places", (left, space.y))
            draw_places(session)
            imgui.end_child()
            imgui.same_line()
        middle = max(space.x - left - right - gap * ((left > 0) + (right > 0)), px(180))
        imgui.begin_child("cards", (middle, space.y))
        self._grid.draw(session, cards)
        imgui.end_child()
        if right:
            imgui.same_line()
            imgui.begin_child("side", (right, space.y))
            self._side.draw(session)
            imgui.end_child()
        self._side.dialog(session)
