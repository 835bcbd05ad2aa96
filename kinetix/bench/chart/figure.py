"""Common parts of all charts: a figure without a window, the small print, the file."""

import os
import platform
from pathlib import Path
from typing import Any

from kinetix.errors import KinetixError


def new_figure(width: float, height: float) -> Any:
    """Return an empty figure of matplotlib.

    Args:
        width: In hundreds of pixels.
        height: The same.

    Raises:
        KinetixError: The extra `bench` is not installed.
    """
    try:
        import adjustText  # noqa: F401  # needed later, said now
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise KinetixError(f"no {error.name} to draw with: install the extra `bench`") from None
    figure = Figure(figsize=(width, height), dpi=100)
    FigureCanvasAgg(figure)
    return figure


def lay_out(figure: Any, *, note: str, room: tuple[float, float]) -> None:
    """Give the axes of a figure their places.

    Args:
        figure: From `new_figure`.
        note: Small print below.
        room: Lower and upper edge of what the axes may take, as shares of the height.
    """
    low, high = room
    figure.text(0.01, 0.004, note, fontsize=7, color="#555555", va="bottom")
    figure.tight_layout(rect=(0, low, 1, high))


def spread_labels(texts: list[Any]) -> None:
    """Move labels of one pair of axes off each other and off what they name, with thin lines back.

    Args:
        texts: Each at the point that it names; the axes must have their final places.
    """
    from adjustText import adjust_text

    if texts:
        adjust_text(
            texts,
            ax=texts[0].axes,
            expand=(1.15, 1.35),
            force_text=(0.3, 0.6),
            arrowprops={"arrowstyle": "-", "color": "#888888", "lw": 0.4},
            iter_lim=400,
        )


def save_figure(figure: Any, file: Path) -> None:
    """Write a figure as PNG, making its folder where there is none."""
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


def machine() -> str:
    """On what the figures were measured, in a few words."""
    return f"{platform.machine()}, {os.cpu_count()} cores"
