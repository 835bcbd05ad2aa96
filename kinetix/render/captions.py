"""A line of words on a picture of an episode: step, controls, what the agent expects."""

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from PIL import Image

KEYS: Final = (("left", "right"), ("up", "down"), ("W", "S"), ("A", "D"), ("1", ""), ("2", ""))
"""The editor's keys for the entries of a unified action: positive, negative."""
_DRIVEN: Final = 0.05
"""A control below this counts as at rest."""


def caption(
    step: int,
    action: Sequence[float],
    outcome: str = "",
    *,
    value: float | None = None,
    entropy: float | None = None,
    controls: Collection[int] | None = None,
) -> str:
    """Return the caption of a picture.

    Args:
        step: Environment steps since the start.
        action: The unified action that led here: motors, then thrusters.
        outcome: How the episode ended, or nothing.
        value: What the agent expects of the future, where it has a network.
        entropy: Of its policy [nat].
        controls: Entries of the action that drive anything in the level; None: all.
    """
    held = [
        keys[driven < 0]
        for index, (keys, driven) in enumerate(zip(KEYS, action, strict=False))
        if abs(driven) > _DRIVEN and (controls is None or index in controls)
    ]
    said = [] if value is None else [f"value {value:+.2f}"]
    said += [] if entropy is None else [f"entropy {entropy:.2f}"]
    return "  ".join(word for word in (f"step {step}", *said, *held, outcome) if word)


def write_caption(picture: "Image.Image", words: str) -> None:
    """Write words into the upper left corner of a picture, on a dark plate.

    Args:
        picture: Changed in place.
        words: One line.
    """
    from PIL import ImageDraw

    draw = ImageDraw.Draw(picture, "RGBA")
    size = max(picture.width // 36, 9)
    box = draw.textbbox((size, size // 2), words, font_size=size)
    margin = size // 3
    draw.rectangle(
        (box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin), (0, 0, 0, 150)
    )
    draw.text((size, size // 2), words, fill=(255, 255, 255, 255), font_size=size)
