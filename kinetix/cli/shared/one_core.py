"""The option `--cores` of commands that one core is enough for."""

import dataclasses


@dataclasses.dataclass(frozen=True, kw_only=True)
class OneCore:
    """A command that computes on one core at most; JAX is not loaded for the number."""

    cores: int | None = None
    """Processor cores to use, as in all commands; one is enough for this one."""
