"""Memory of the app between runs: plain values in one JSON file."""

import contextlib
import dataclasses
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self, get_type_hints

import msgspec
from msgspec import Meta

from editor.base.state_file import alone, read_state, state_fault, write_state
from kinetix.engine.names import DEFAULT_PHYSICS, PHYSICS
from kinetix.files.names import is_text
from kinetix.paths import config_dir
from kinetix.render.palette import PALETTES

RECENTS_MAX: Final = 10
_RECENT: Final = ("recents", "recent_agents")
"""Settings that list what was used, newest first."""
GRID_STEPS: Final = (0.05, 0.1, 0.25, 0.5)
"""Choices of the grid [m]."""
ANGLE_STEPS: Final = (5.0, 10.0, 15.0, 22.5, 30.0, 45.0)
"""Choices of what angles snap to [°]."""
LARGEST_SCALE: Final = 4.0
"""Of the interface: a stored scale beyond it is passed over."""
USUAL_SIZE: Final = (1440, 900)
"""Width and height of a window of which nobody says more [px]."""
LARGEST_SIDE: Final = 8192
"""Largest width and height of the window [px]; the largest screens have 7680."""
SCALES: Final = (0.75, 3.0)
"""Least and largest scale that the interface is drawn at."""
TEXT_SCALES: Final = (0.85, 1.0, 1.15, 1.3)
"""Choices of the size of the text."""

DEBUG_FIRST: Final = ("centres", "velocities", "contacts", "anchors", "limits")
"""Debug drawings that are switched on with the first debug drawing ever."""


def _one_of(names: Iterable[str]) -> str:
    """Return the pattern of what may be chosen: what a later version offers is passed over."""
    return f"^({'|'.join(map(re.escape, names))})$"


@dataclasses.dataclass(kw_only=True)
class Settings:
    """Preferences; every field has a default, an unknown or broken stored value is passed over."""

    recents: list[str] = dataclasses.field(default_factory=list)
    """Paths, newest first."""
    open_files: list[str] = dataclasses.field(default_factory=list)
    """Level files that were open when the app closed last; empty while it goes on."""
    front_file: str = ""
    """The one of them that was in front."""
    window_width: Annotated[int, Meta(ge=0, le=LARGEST_SIDE)] = 0
    """Width of the window when the app closed last [px]; 0: the usual one."""
    window_height: Annotated[int, Meta(ge=0, le=LARGEST_SIDE)] = 0
    """Height of the window when the app closed last [px]; 0: the usual one."""
    save_folder: str = ""
    """Folder of the level that was saved last, unless it came with the app."""
    export_folder: str = ""
    """Folder of the picture, film or other export that was written last."""
    snap_smart: bool = True
    snap_grid: bool = True
    grid_visible: bool = True
    key_caps: bool = True
    """True if the canvas shows the keys of joints and thrusters."""
    names: bool = False
    """True if the canvas shows the names of shapes, joints and thrusters."""
    renderer_picture: bool = False
    """True if Play shows the renderer's pictures, pixel by pixel as `kinetix render` makes them."""
    minimap: bool = False
    """True if the canvas has a small map of the arena in its corner."""
    grid_step: Annotated[float, Meta(ge=1e-3, le=10.0)] = 0.1
    """Distance of grid lines [m]."""
    angle_step_deg: Annotated[float, Meta(ge=0.1, le=180.0)] = 15.0
    nudge_step: Annotated[float, Meta(ge=1e-4, le=10.0)] = 0.05
    """Step of an arrow key [m]."""
    move_jointed: bool = True
    """True if jointed neighbours move with a dragged body."""
    from_centre: bool = False
    """True if rectangles grow from their centre (Alt as a switch)."""
    keep_tool: bool = False
    """True if a tool stays after it has made something."""
    physics: Annotated[str, Meta(pattern=_one_of(PHYSICS))] = DEFAULT_PHYSICS
    restart_automatically: bool = False
    language: Annotated[str, Meta(max_length=16)] = "en"
    """Code of the language of the interface; there is a file of words for each but English."""
    sound: bool = True
    """True if contacts and ends of episodes can be heard."""
    volume: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.6
    win_effects: bool = True
    """True if a win is shown by more than its word."""
    wheel: Literal["zoom", "pan"] = "zoom"
    """Effect of the wheel, or of two fingers on a trackpad, on the view; with Ctrl they zoom."""
    wheel_inverted: bool = False
    pinch: bool = True
    """True if two fingers that move apart zoom."""
    theme: Literal["dark", "light"] = "dark"
    """Colours of the window; those of levels are the palette's."""
    palette: Annotated[str, Meta(pattern=_one_of(PALETTES))] = "kinetix"
    glyphs: bool = True
    """Role marks on bodies."""
    patterns: bool = False
    ui_scale: Annotated[float, Meta(ge=0.0, le=LARGEST_SCALE)] = 0.0
    """0: as the display reports."""
    text_scale: Annotated[float, Meta(ge=0.5, le=2.0)] = 1.0
    """Size of the text besides the interface's: 0.85 to 1.3."""
    radians: bool = False
    """True if fields show angles in radians instead of degrees."""
    reduced_motion: bool = False
    layout: str = ""
    """The dock layout as the toolkit writes it."""
    layouts: dict[str, str] = dataclasses.field(default_factory=dict)
    """Layouts that the user has kept, by name."""
    keys: dict[str, list[str]] = dataclasses.field(default_factory=dict)
    """Rebound chords by action id."""
    controls: dict[str, list[int]] = dataclasses.field(default_factory=dict)
    """Rebound play keys: key -> [channel, value]."""
    gallery_folders: list[str] = dataclasses.field(default_factory=list)
    """Folders that the gallery shows besides the app's and the user's own."""
    recent_agents: list[str] = dataclasses.field(default_factory=list)
    """Folders of agents, newest first."""
    dataset: str = ""
    """The data set that an episode went to last."""
    agent_overlay: list[str] = dataclasses.field(
        default_factory=lambda: ["heat", "numbers", "futures"]
    )
    """Names of the agent's overlays that are on."""
    guide_step: Annotated[int, Meta(ge=-1, le=10)] = -1
    """Number of the guided first level's next step; 10: all are done, -1: it is not shown."""
    debug_draw: list[str] = dataclasses.field(default_factory=list)
    """Names of the debug drawings that are on."""

    @classmethod
    def load(cls, path: Path | None = None) -> Self:
        """Read the file; defaults where it is absent or says something else."""
        settings = cls()
        for name, value in _valid(read_state(path or settings_path())).items():
            setattr(settings, name, value)
        settings.recents = [path for path in settings.recents if is_text(path)]
        settings.recent_agents = [path for path in settings.recent_agents if is_text(path)]
        settings.open_files = [path for path in settings.open_files if is_text(path)]
        return settings

    def save(self, path: Path | None = None) -> None:
        """Write the file.

        Raises:
            LevelError: The file cannot be written.
        """
        write_state(path or settings_path(), dataclasses.asdict(self))

    def remember(self, path: Path) -> None:
        """Put a file on top of the recent ones."""
        name = str(path.resolve())
        self.recents = [name, *(other for other in self.recents if other != name)][:RECENTS_MAX]


class SettingsKeeper:
    """Writes settings when they have changed; what another window has changed meanwhile stays."""

    def __init__(
        self, settings: Settings, path: Path | None = None, *, stored: bool = True
    ) -> None:
        """Take the settings as they were read.

        Args:
            settings: What to keep.
            path: The file; by default the user's own.
            stored: Whether to write at all; scripted runs leave no traces.
        """
        self._settings = settings
        self._path = path
        self._stored = stored
        self._written = self._tried = dataclasses.asdict(settings)
        self.fault = state_fault(path or settings_path()) if stored else ""
        """Error of reading the file; empty if it could be read, or does not exist."""

    def save(self, *, again: bool = False) -> None:
        """Write what has changed since it was read or written last.

        Args:
            again: Whether to try also what could not be written before.

        Raises:
            LevelError: The file cannot be written; the next change tries again.
        """
        now = dataclasses.asdict(self._settings)
        changed = {name: value for name, value in now.items() if value != self._written[name]}
        if not changed or not self._stored or (now == self._tried and not again):
            return
        self._tried = now
        path = self._path or settings_path()
        with alone(path):
            # This window knows what the file held before it was broken.
            there = read_state(path, broken=now)
            theirs = _valid(there)
            for name in changed.keys() & theirs.keys():
                changed[name] = _merged(name, changed[name], self._written[name], theirs[name])
            write_state(path, there | changed)
        self._written = now


def _valid(stored: Mapping[str, Any]) -> dict[str, Any]:
    """Return those of the stored values that a field can have."""
    found = {}
    for name, kind in get_type_hints(Settings, include_extras=True).items():
        if name in stored:
            with contextlib.suppress(msgspec.ValidationError, UnicodeError):
                found[name] = msgspec.convert(stored[name], kind)
    return found


def _merged(name: str, mine: Any, before: Any, theirs: Any) -> Any:
    """Return a setting that this window has changed, with what another window has made of it."""
    if name in _RECENT:
        return _merged_recents(mine, before, theirs)
    if name == "gallery_folders":
        return list(merged_keys(*map(dict.fromkeys, (mine, before, theirs))))
    return merged_keys(mine, before, theirs) if isinstance(mine, dict) else mine


def _merged_recents(mine: list[str], before: list[str], theirs: list[str]) -> list[str]:
    """Recent paths of two windows: what this one forgot is gone, what the other one added stays."""
    added = [each for each in theirs if each not in before]
    return list(dict.fromkeys([*mine, *added]))[:RECENTS_MAX]


def merged_keys(
    mine: Mapping[str, Any], before: Mapping[str, Any], theirs: Mapping[str, Any]
) -> dict[str, Any]:
    """Return what the other window has, with what this one has added, changed and removed."""
    kept = {key: value for key, value in theirs.items() if key in mine or key not in before}
    changed = {key: v for key, v in mine.items() if key not in before or before[key] != v}
    return kept | changed


def settings_path() -> Path:
    """Return the path of the settings."""
    return config_dir() / "settings.json"
