"""The fields of the next evaluation: the panel shows them, the gallery evaluates by them."""

import dataclasses


@dataclasses.dataclass(kw_only=True)
class EvaluationForm:
    """Content of the fields of *Evaluate*."""

    source: str = "this"
    """Levels to measure: "this" one in front, a size ("s", "m", "l"), "chosen", "folder", or
    "set"."""
    paths: tuple[str, ...] = ()
    """The folder or file of these levels, where one was chosen; the gallery's are not kept."""
    attempts: int = 20
    """Per level and agent."""
    seed: int = 0
    physics: str = ""
    """Empty: each agent's own, as `kinetix eval` does."""
    scripted: tuple[str, ...] = ()
    """Names of the scripted agents that are measured too."""
    wanted: str = ""
    """Filter of the table's levels."""
