"""Facts about an episode that films and pages carry: level, physics, player, draws."""

from kinetix.level.codec import level_hash
from kinetix.level.model import Level

_SHORT = 12
"""Digits of a digest that are shown."""


def facts_of(
    level: Level,
    physics: str,
    *,
    player: str = "",
    digest: str = "",
    draws: str = "",
    perturbed: bool = False,
) -> tuple[tuple[str, str], ...]:
    """Return the facts about an episode, in order.

    Args:
        level: Its level.
        physics: Physics preset or solver.
        player: Name of the agent; empty for a person.
        digest: Of the agent's parameters.
        draws: From `draws_of`.
        perturbed: Somebody pulled at a body or took over.
    """
    facts = [("level", f"{level.name}, {level_hash(level)[:_SHORT]}"), ("physics", physics)]
    if player:
        facts.append(("player", f"{player} {digest[:_SHORT]}".strip()))
    if player and draws:
        facts.append(("draws", draws))
    if perturbed:
        facts.append(("note", "somebody pulled at a body or took over"))
    return tuple(facts)


def draws_of(seed: int, attempt: int | None, *, deterministic: bool) -> str:
    """Return which draws an agent had, in words.

    Args:
        seed: Of an evaluation, or of the episode alone.
        attempt: Of the evaluation; None where there was none.
        deterministic: The likeliest actions were taken.
    """
    which = f"seed {seed}" if attempt is None else f"attempt {attempt}, seed {seed}"
    return f"{which}, {'likeliest actions' if deterministic else 'actions drawn from the policy'}"
