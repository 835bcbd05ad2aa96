"""Appearance of the app, as values: colours, fonts and icons. `theme.py` applies them."""

import dataclasses
from typing import Final

from imgui_bundle import icons_fontawesome_6 as fa
from imgui_bundle import imgui

Rgba = tuple[float, float, float, float]


def _hex(code: str, alpha: float = 1.0) -> Rgba:
    red, green, blue = (int(code[i : i + 2], 16) / 255 for i in (0, 2, 4))
    return red, green, blue, alpha


@dataclasses.dataclass(kw_only=True)
class Colours:
    """The colours of a theme. Text on any surface has a contrast of at least 4.5:1."""

    backdrop: Rgba
    """Behind everything, and the canvas around the arena."""
    surface: Rgba
    """Background of panels."""
    raised: Rgba
    """Menus, pop-ups, tool strip."""
    field: Rgba
    """Inputs and buttons."""
    field_hover: Rgba
    field_active: Rgba
    line: Rgba
    """Borders and separators."""
    text: Rgba
    muted: Rgba
    """Labels, hints, units."""
    faint: Rgba
    """Colour of the least important text: groups, numbers that rarely count."""
    accent: Rgba
    """Selection, focus, what is on."""
    accent_strong: Rgba
    """Filled buttons in the accent colour; their text is white."""
    play: Rgba
    replay: Rgba
    good: Rgba
    warn: Rgba
    bad: Rgba
    info: Rgba
    green: Rgba
    """Signs of green, blue and red shapes in lists."""
    blue: Rgba
    red: Rgba

    def of(self, name: str) -> Rgba:
        """Return a colour by its name, as tables keep it."""
        return getattr(self, name)

    def take(self, theme: "Colours") -> None:
        """Become the colours of a theme."""
        for field in dataclasses.fields(self):
            setattr(self, field.name, getattr(theme, field.name))


DARK: Final = Colours(
    backdrop=_hex("0f1115"),
    surface=_hex("191c22"),
    raised=_hex("21252d"),
    field=_hex("2a2f39"),
    field_hover=_hex("353b47"),
    field_active=_hex("414957"),
    line=_hex("2c313b"),
    text=_hex("e6e9ef"),
    muted=_hex("a6aebc"),
    faint=_hex("8e97a7"),
    accent=_hex("8f7dff"),
    accent_strong=_hex("6d59f0"),
    play=_hex("3ecf8e"),
    replay=_hex("f2b84b"),
    good=_hex("3ecf8e"),
    warn=_hex("f2b84b"),
    bad=_hex("ff6b6b"),
    info=_hex("62b0ff"),
    green=_hex("3dd15c"),
    blue=_hex("5c9eff"),
    red=_hex("ff7070"),
)
LIGHT: Final = Colours(
    backdrop=_hex("e4e7ed"),
    surface=_hex("f5f6f9"),
    raised=_hex("ffffff"),
    field=_hex("e7eaf0"),
    field_hover=_hex("dbe0e9"),
    field_active=_hex("ccd3df"),
    line=_hex("d2d7e0"),
    text=_hex("1a1d23"),
    muted=_hex("444b59"),
    faint=_hex("535b6a"),
    accent=_hex("5b45d8"),
    accent_strong=_hex("5b45d8"),
    play=_hex("0a6b41"),
    replay=_hex("7d5200"),
    good=_hex("0a6b41"),
    warn=_hex("7d5200"),
    bad=_hex("b3202a"),
    info=_hex("0b57a4"),
    green=_hex("0e8a34"),
    blue=_hex("1a62cc"),
    red=_hex("c93636"),
)
THEMES: Final = {"dark": DARK, "light": LIGHT}
COLOURS: Final = dataclasses.replace(DARK)
"""The colours of the present theme; `theme.apply` changes them. Read them when drawing."""


def alpha(colour: Rgba, opacity: float) -> Rgba:
    """Return the colour with another opacity."""
    return (*colour[:3], opacity)


def u32(colour: Rgba) -> int:
    """Return the colour as a draw list takes it."""
    return imgui.get_color_u32(imgui.ImVec4(*colour))


@dataclasses.dataclass(kw_only=True)
class Fonts:
    """Fonts of the current context; set by `theme.load_fonts`, None before."""

    regular: imgui.ImFont | None = None
    bold: imgui.ImFont | None = None
    mono: imgui.ImFont | None = None


FONTS: Final = Fonts()

TEXT: Final = 15.0
"""Size of running text at 100 % [px]."""
SMALL: Final = 13.0
TITLE: Final = 20.0
HUGE: Final = 34.0


class Icons:
    """One name per meaning, so that one sign always says the same thing."""

    select = fa.ICON_FA_ARROW_POINTER
    rectangle = fa.ICON_FA_SQUARE
    circle = fa.ICON_FA_CIRCLE
    triangle = fa.ICON_FA_CARET_UP
    joint = fa.ICON_FA_CIRCLE_DOT
    weld = fa.ICON_FA_SQUARE_PLUS
    thruster = fa.ICON_FA_ROCKET
    play = fa.ICON_FA_PLAY
    pause = fa.ICON_FA_PAUSE
    stop = fa.ICON_FA_STOP
    step = fa.ICON_FA_FORWARD_STEP
    step_back = fa.ICON_FA_BACKWARD_STEP
    reset = fa.ICON_FA_ROTATE_LEFT
    slower = fa.ICON_FA_BACKWARD
    faster = fa.ICON_FA_FORWARD
    undo = fa.ICON_FA_ARROW_ROTATE_LEFT
    redo = fa.ICON_FA_ARROW_ROTATE_RIGHT
    new = fa.ICON_FA_FILE
    open = fa.ICON_FA_FOLDER_OPEN
    save = fa.ICON_FA_FLOPPY_DISK
    folder = fa.ICON_FA_FOLDER
    up = fa.ICON_FA_ARROW_UP
    down = fa.ICON_FA_ARROW_DOWN
    rename = fa.ICON_FA_PEN
    level = fa.ICON_FA_CUBES
    gallery = fa.ICON_FA_IMAGES
    magnet = fa.ICON_FA_MAGNET
    grid = fa.ICON_FA_TABLE_CELLS
    eye = fa.ICON_FA_EYE
    eye_off = fa.ICON_FA_EYE_SLASH
    lock = fa.ICON_FA_LOCK
    unlock = fa.ICON_FA_LOCK_OPEN
    trash = fa.ICON_FA_TRASH_CAN
    error = fa.ICON_FA_CIRCLE_XMARK
    warning = fa.ICON_FA_TRIANGLE_EXCLAMATION
    info = fa.ICON_FA_CIRCLE_INFO
    good = fa.ICON_FA_CIRCLE_CHECK
    outliner = fa.ICON_FA_LIST_UL
    inspector = fa.ICON_FA_SLIDERS
    history = fa.ICON_FA_CLOCK_ROTATE_LEFT
    controls = fa.ICON_FA_KEYBOARD
    problems = fa.ICON_FA_STETHOSCOPE
    plots = fa.ICON_FA_CHART_LINE
    training = fa.ICON_FA_DUMBBELL
    debug = fa.ICON_FA_BUG
    log = fa.ICON_FA_TERMINAL
    search = fa.ICON_FA_MAGNIFYING_GLASS
    dice = fa.ICON_FA_DICE
    mutate = fa.ICON_FA_WAND_MAGIC_SPARKLES
    gear = fa.ICON_FA_GEAR
    help = fa.ICON_FA_CIRCLE_QUESTION
    fit = fa.ICON_FA_EXPAND
    camera = fa.ICON_FA_CAMERA
    export = fa.ICON_FA_FILE_EXPORT
    film = fa.ICON_FA_FILM
    trophy = fa.ICON_FA_TROPHY
    skull = fa.ICON_FA_BURST
    hourglass = fa.ICON_FA_HOURGLASS_END
    close = fa.ICON_FA_XMARK
    green = fa.ICON_FA_CIRCLE
    blue = fa.ICON_FA_BULLSEYE
    red = fa.ICON_FA_XMARK
    arena = fa.ICON_FA_BORDER_ALL
    anchor = fa.ICON_FA_ANCHOR
    user = fa.ICON_FA_GAMEPAD
    plus = fa.ICON_FA_PLUS
    duplicate = fa.ICON_FA_CLONE
    reorder = fa.ICON_FA_LAYER_GROUP
    agent = fa.ICON_FA_ROBOT
    better = fa.ICON_FA_CARET_UP
    worse = fa.ICON_FA_CARET_DOWN
    beside = fa.ICON_FA_TABLE_COLUMNS
    chip = fa.ICON_FA_MICROCHIP
    more = fa.ICON_FA_ELLIPSIS
