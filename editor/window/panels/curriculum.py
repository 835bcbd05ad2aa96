"""The levels that a curriculum keeps, over time: pictures, scores, ages, ancestors, what left."""

import bisect
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions.training import curriculum
from editor.agents.curriculum import CurriculumWatch, lineage, why_gone
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, Icons, alpha, u32
from editor.toolkit.textures import TextureStore
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from kinetix.training.curricula.pages import ListedLevel, PageHead
from kinetix.wording import plural, thousands

if TYPE_CHECKING:
    from editor.session import Session

_SIDE: Final = 92.0
"""Width and height of a picture [px at 100 %]."""
_LINES: Final = 3
"""Lines of text under a picture."""


class CurriculumPanel(Panel):
    """A slider over time, then a card per level, then what left since the page before."""

    id, title, icon = "curriculum", "Curriculum", Icons.reorder
    height = 300.0
    measures = True

    def __init__(self, textures: TextureStore) -> None:
        self._textures = textures

    def draw(self, session: "Session") -> None:
        """Draw the page on show, or say what there is to do."""
        watch = session.viewer.curriculum
        watch.open = session.view.settled
        if not session.viewer.run.path:
            self._nothing(
                session,
                "No training run is watched",
                "SFL, PLR and ACCEL write the history of their level buffer: watch such a run.",
            )
            return
        if watch.error:
            widgets.wrapped(watch.error, COLOURS.bad)
        page = watch.page
        if page is None:
            self._nothing(
                session,
                "This run keeps no levels",
                "Its folder has no history of a level buffer yet: SFL, PLR and ACCEL write one.",
            )
            return
        self._time(session, watch, page.head)
        if not imgui.begin_child("levels"):
            imgui.end_child()
            return
        self._cards(session, watch)
        if page.head.gone and widgets.section(f"Left since the page before ({page.head.left})"):
            for gone in page.head.gone:
                widgets.small(f"#{gone.serial}   {why_gone(gone)}")
        imgui.end_child()

    def _nothing(self, session: "Session", title: str, hint: str) -> None:
        widgets.empty_state(Icons.reorder, title, hint)
        width = px(190)
        space = imgui.get_content_region_avail().x
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max((space - width) / 2, 0))
        if widgets.button(session, "curriculum.watch", "Choose a run…", width=width):
            session.queue("agent.watch_run")

    def _time(self, session: "Session", watch: CurriculumWatch, head: PageHead) -> None:
        """Draw the slider over the pages, and the totals of the page."""
        following = watch.wanted is None
        changed, on = widgets.checkbox(session, "curriculum.follow", "Newest", following)
        if changed:
            watch.choose(None if on else head.update)
        imgui.same_line(0, px(10))
        last = max(len(watch.updates) - 1, 0)
        place = min(bisect.bisect_left(watch.updates, head.update), last)
        imgui.set_next_item_width(px(240))
        with widgets.disabled(len(watch.updates) < 2):
            moved, place = imgui.slider_int("###page", place, 0, max(last, 1), "")
        widgets.probe(session, "curriculum.page")
        widgets.tooltip("Time", "Pages that the run wrote.")
        if moved and place < len(watch.updates):
            watch.choose(watch.updates[place])
        imgui.same_line(0, px(12))
        imgui.align_text_to_frame_padding()
        steps = thousands(head.env_steps)
        widgets.muted(
            f"Update {head.update}, {head.algorithm}, {steps} environment steps: "
            f"the best {len(head.levels)} of {plural(head.filled, 'level')}; "
            f"{head.entered} came, {head.left} left since the page before"
        )

    def _cards(self, session: "Session", watch: CurriculumWatch) -> None:
        page = watch.page
        assert page is not None
        side, gap = px(_SIDE), px(8)
        with widgets.font(None, SMALL):
            line = imgui.get_text_line_height()
        width, height = side, side + _LINES * line + px(8)
        columns = max(1, int((imgui.get_content_region_avail().x + gap) / (width + gap)))
        for index, listed in enumerate(page.head.levels):
            if index % columns:
                imgui.same_line(0, gap)
            self._card(session, watch, index, listed, (width, height))

    def _card(
        self,
        session: "Session",
        watch: CurriculumWatch,
        index: int,
        listed: ListedLevel,
        size: tuple[float, float],
    ) -> None:
        page = watch.page
        assert page is not None
        at = imgui.get_cursor_screen_pos()
        pressed = imgui.invisible_button(f"level{index}", size)
        widgets.probe(session, f"curriculum.level.{index}")
        hovered = imgui.is_item_hovered()
        draw = imgui.get_window_draw_list()
        side = size[0]
        high = (at.x + side, at.y + side)
        if index < len(watch.thumbnails):
            picture = watch.thumbnails[index]
            texture = self._textures.texture(f"curriculum-{index}", picture, watch.stamp)
            white = u32((1.0, 1.0, 1.0, 1.0))
            draw.add_image_rounded(texture, (at.x, at.y), high, (0, 0), (1, 1), white, px(4))
        else:
            draw.add_rect_filled((at.x, at.y), high, u32(COLOURS.field), px(4))
        if hovered:
            draw.add_rect((at.x, at.y), high, u32(COLOURS.accent), px(4), px(2))
        age = page.head.update - listed.born
        rate = "no end yet" if listed.solve_rate is None else f"won {listed.solve_rate:.0%}"
        score = "-" if listed.score is None else f"{listed.score:.3f}"
        lines = (
            (f"#{listed.serial}  {score}", COLOURS.text),
            (f"{rate}, age {age}", COLOURS.muted),
            (
                f"from #{listed.ancestry[0]}" if listed.ancestry else "drawn at random",
                COLOURS.muted,
            ),
        )
        with widgets.font(None, SMALL):
            top = at.y + side + px(3)
            for words, colour in lines:
                draw.push_clip_rect((at.x, top), (at.x + side, top + px(20)), True)
                draw.add_text((at.x, top), u32(alpha(colour, 1.0)), tr(words))
                draw.pop_clip_rect()
                top += imgui.get_text_line_height()
        widgets.tooltip(f"Level #{listed.serial}", _facts(listed, page.head))
        if pressed:
            level = page.levels[index]
            session.queue(lambda: curriculum.play_level(session, level))


def _facts(listed: ListedLevel, head: PageHead) -> str:
    """Return all that is known of a level, for its tooltip."""
    learnable = "" if listed.learnability is None else f"learnability {listed.learnability:.3f}\n"
    rate = (
        "no episode ended on its last visit"
        if listed.solve_rate is None
        else f"won {listed.solve_rate:.0%} of {plural(listed.episodes, 'episode')}"
    )
    score = "unknown" if listed.score is None else f"{listed.score:.4f}"
    ancestors = lineage(listed)
    return (
        f"score {score}\n{learnable}{rate}\n"
        f"came in at update {listed.born}, {head.update - listed.born} ago"
        + (f"\n{ancestors}" if ancestors else "")
        + "\nClick: the newest agent plays it."
    )
