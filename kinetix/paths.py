"""Paths of bundled levels and checkpoints, and of the user's own folders."""

import os
from pathlib import Path

import platformdirs

_PACKAGE = Path(__file__).resolve().parent
_CHECKOUT = _PACKAGE.parent
_APP = "kinetix-editor"


def _bundled(name: str) -> Path:
    installed = _PACKAGE / "_data" / name
    return installed if os.path.isdir(installed) else _CHECKOUT / name


def working_dir() -> Path:
    """The folder that the process stands in; the user's own where that one has been deleted."""
    try:
        return Path.cwd()
    except FileNotFoundError:
        home = Path.home()
        return home if os.path.isdir(home) else Path(home.anchor)


def levels_dir() -> Path:
    """Folder of the bundled levels (`s/`, `m/`, `l/`), in a checkout and in an installation."""
    return _bundled("levels")


def checkpoints_dir() -> Path:
    """Return the folder of the bundled agents."""
    return _bundled("checkpoints")


def docs_dir() -> Path:
    """Return the folder of the documents in a checkout; an installation has none."""
    return _bundled("docs")


def user_levels_dir() -> Path:
    """Return the folder of the user's own levels; it need not exist."""
    return Path(platformdirs.user_documents_dir()) / "Kinetix"


def user_agents_dir() -> Path:
    """Return the folder of agents that the editor trains; it need not exist."""
    return Path(platformdirs.user_data_dir(_APP, appauthor=False)) / "agents"


def cache_dir() -> Path:
    """Return the folder for what can be rebuilt (compiled functions, thumbnails)."""
    return Path(platformdirs.user_cache_dir(_APP, appauthor=False))


def config_dir() -> Path:
    """Return the folder for the user's settings."""
    return Path(platformdirs.user_config_dir(_APP, appauthor=False))


def state_dir() -> Path:
    """Return the folder for autosaves, logs and recent files."""
    return Path(platformdirs.user_state_dir(_APP, appauthor=False))
