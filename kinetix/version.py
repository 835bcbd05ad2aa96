"""The version of the installed package."""

import importlib.metadata

try:
    __version__ = importlib.metadata.version("kinetix-editor")
except importlib.metadata.PackageNotFoundError:
    __version__ = "unknown"  # the folder alone is on Python's path
