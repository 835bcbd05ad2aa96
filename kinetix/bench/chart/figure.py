"""What all charts share: a figure without a window, the small print, the file."""

import os
import platform
from pathlib import Path
from typing import Any

from kinetix.errors import KinetixError


def new_figure(width: float, height: float) -> Any:
    """An empty figure of matplotlib.

    Args:
        width: In hundreds of pixels.
        height: The same.

    Raises:
        KinetixError: The extra `bench` is not installed.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise KinetixError("the chart is drawn by matplotlib: install the extra `bench`") from None
    figure = Figure(figsize=(width, height), dpi=100)
    FigureCanvasAgg(figure)
    return figure


def save_figure(figure: Any, file: Path, *, note: str, room: tuple[float, float]) -> None:
    """Write a figure as PNG, making its folder where there is none.

    Args:
        figure: From `new_figure`.
        file: Where to.
        note: Small print below.
        room: Lower and upper edge of what the axes may take, as shares of the height.
    """
    low, high = room
    figure.text(0.01, 0.004, note, fontsize=7, color="#555555", va="bottom")
    figure.tight_layout(rect=(0, low, 1, high))
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


def machine() -> str:
    """On what the figures were measured, in a few words."""
    return f"{platform.machine()}, {os.cpu_count()} cores"
