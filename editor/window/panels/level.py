"""The level as a whole: name, rules, how full it is, the arena."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from imgui_bundle import imgui

from editor.actions.files.file import NEW_LEVEL
from editor.base.language import tr
from editor.documents.commands.fields import SetLevelField
from editor.documents.tags import tags_of
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, Icons, u32
from editor.toolkit.widgets import px
from editor.window.panels.base import Panel
from editor.window.panels.fields import Editor
from editor.window.panels.inspector import role_segments
from editor.window.panels.texts import TextFields
from kinetix.level.model import MAX_DESCRIPTION, MAX_TITLE, Level
from kinetix.level.sizes import capacity_of, needed_capacity, size_name

if TYPE_CHECKING:
    from editor.session import Session

_SIZE_OPTIONS: Final = (
    ("auto", "Automatic"),
    ("s", "Small (s)"),
    ("m", "Medium (m)"),
    ("l", "Large (l)"),
    ("locomotion", "Locomotion"),
)
STANDARD_GRAVITY: Final = Level(name="x").gravity
_GRAVITIES: Final = (("Earth", -9.81), ("Moon", -1.62), ("None", 0.0))

Read = Callable[["Session", str], Any]
"""Makes the value of a field of what was typed; None: the field stays as it is."""


class LevelPanel(Panel):
    """Edits what belongs to no single entity."""

    id, title, icon = "level", "Level", Icons.level

    def __init__(self) -> None:
        self._editor = Editor()
        self._texts = TextFields()

    def draw(self, session: "Session") -> None:
        """Draw the sections."""
        self._editor.begin(session)
        self._texts.begin()
        level = session.document.shown
        with widgets.disabled(not session.editing):
            with widgets.property_table("level", label=0.38) as opened:
                if opened:
                    widgets.row("Name")
                    # The name that every new level has is none: typing gives one, not more of it.
                    new = level.name == NEW_LEVEL.name
                    name, hint = ("", NEW_LEVEL.name) if new else (level.name, "")
                    self._text(session, "name", name, _name, hint=hint, longest=MAX_TITLE)
                    widgets.row("Tags", "Words of a–z, 0–9, - and _, separated by spaces.")
                    self._text(session, "tags", " ".join(level.tags), _tags)
                    widgets.row("Time limit", "Environment steps; 30 of them take a second.")
                    with self._editor.level_resettable(session, "max_timesteps", 256) as room:
                        self._editor.level_field(session, "max_timesteps", width=room)
            self._description(session, level)
            if widgets.section("Gravity"):
                self._gravity(session)
            if widgets.section("Size"):
                self._size(session, level)
            if widgets.section("Arena"):
                self._arena(session, level)

    def _text(
        self,
        session: "Session",
        field: str,
        value: str,
        read: Read,
        *,
        hint: str = "",
        longest: int = 0,
    ) -> None:
        """A text that commits on Enter or when the field is left."""
        put = _setter(session, field)

        def commit(typed: str) -> None:
            stored = read(session, typed)
            if stored is not None:
                put(stored)

        self._texts.line(session, f"level.{field}", value, commit, hint=hint, longest=longest)

    def _description(self, session: "Session", level: Level) -> None:
        widgets.muted("Description")
        commit = _setter(session, "description")
        self._texts.area(
            session, "level.description", level.description, commit, longest=MAX_DESCRIPTION
        )

    def _gravity(self, session: "Session") -> None:
        gap = imgui.get_style().item_spacing.x
        with self._editor.level_resettable(session, "gravity", STANDARD_GRAVITY) as room:
            self._editor.level_field(session, "gravity.0", width=(room - gap) / 2)
            imgui.same_line()
            self._editor.level_field(session, "gravity.1", width=(room - gap) / 2)
        for index, (label, value) in enumerate(_GRAVITIES):
            if index:
                imgui.same_line()
            if imgui.small_button(tr(label)):
                session.queue(SetLevelField(field="gravity", value=(0.0, value)))
            widgets.probe(session, f"level.gravity.{label.lower()}")

    def _size(self, session: "Session", level: Level) -> None:
        current = level.size if isinstance(level.size, str) else "auto"
        if level.size is not None and not isinstance(level.size, str):
            current = "custom"
        options = _SIZE_OPTIONS + ((("custom", "Custom"),) if current == "custom" else ())
        with self._editor.level_resettable(session, "size", None) as room:
            imgui.set_next_item_width(room)
            picked = widgets.choice(session, "level.size", current, options)
        if picked is not None and picked != "custom":
            value = None if picked == "auto" else picked
            session.queue(SetLevelField(field="size", value=value))
        used, limit = needed_capacity(level), capacity_of(level)
        fits = size_name(limit) or "custom"
        if current == "auto":
            widgets.small(f"Fits size {fits}.")
        for label, name in (
            ("Polygons (with the arena)", "polygons"),
            ("Circles", "circles"),
            ("Joints", "joints"),
            ("Thrusters", "thrusters"),
        ):
            _counter(label, getattr(used, name), getattr(limit, name))

    def _arena(self, session: "Session", level: Level) -> None:
        widgets.muted("Floor")
        role_segments(session, "level.floor", ("floor",), level.arena.floor.role)
        changed, on = widgets.checkbox(
            session,
            "level.edit_arena",
            "Select floor and walls on the canvas",
            session.view.edit_arena,
        )
        if changed:
            session.view.edit_arena = on
        widgets.tooltip(
            "Edit arena", "Click floor, walls or ceiling to change their role and surface."
        )


def _setter(session: "Session", field: str) -> Callable[[Any], None]:
    """Return a call that sets a field of the level in front now, wherever that is by then."""
    document = session.document

    def put(value: Any) -> None:
        command = SetLevelField(field=field, value=value)
        session.queue(lambda: session.execute(command, on=document))

    return put


def _counter(label: str, used: int, limit: int) -> None:
    """Draw a count and its maximum, as words and a bar."""
    full = used > limit
    with widgets.font(None, SMALL):
        widgets.muted(label)
        words = f"{used} / {limit}"
        width = imgui.calc_text_size(words).x
        imgui.same_line(imgui.get_content_region_avail().x + imgui.get_cursor_pos_x() - width)
        widgets.text(words, COLOURS.bad if full else COLOURS.text)
    at, space = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
    share = min(used / limit, 1.0) if limit else float(used > 0)
    draw = imgui.get_window_draw_list()
    high = (at.x + space, at.y + px(3))
    draw.add_rect_filled((at.x, at.y), high, u32(COLOURS.field), px(2))
    if share > 0:
        colour = COLOURS.bad if full else COLOURS.accent
        draw.add_rect_filled((at.x, at.y), (at.x + space * share, high[1]), u32(colour), px(2))
    imgui.dummy((0, px(5)))


def _name(session: "Session", typed: str) -> str | None:
    """Return the name that was typed; says so where there is none."""
    name = typed.strip()
    if not name:
        session.toast("A level needs a name.", "warning")
    return name or None


def _tags(session: "Session", typed: str) -> list[str]:
    """Return the tags that were typed; says which words are none."""
    tags, refused = tags_of(typed)
    if refused:
        words = ", ".join(refused)
        session.toast(f"Not a tag: {words:.60}. A tag is a word of a–z, 0–9, - and _.", "warning")
    return tags
