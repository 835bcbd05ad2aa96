"""Training from Python: one call from words to an agent."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from kinetix.agents.agent import Agent, load_agent
from kinetix.errors import KinetixError
from kinetix.training.config import PpoConfig, algorithm_of
from kinetix.training.loop import Report
from kinetix.training.origin import still_needed
from kinetix.training.progress_text import say_nothing
from kinetix.training.run import train as run_training
from kinetix.training.settings import CONFIG, make_config, settings_of


def train(
    config: PpoConfig | str = "ppo",
    out: str | Path = "runs/latest",
    *,
    preset: str | None = None,
    start_from: str | Path | Agent | None = None,
    report: Callable[[Report], None] | None = None,
    say: Callable[[str], None] | None = print,
    **fields: Any,
) -> Agent:
    """Train an agent, or go on with a training that was stopped.

    Args:
        config: A configuration (`make_config`), or the name of an algorithm: `ppo`, `sfl`, `plr`,
            `accel`, `dr`, `bc`.
        out: The run's directory; the same one goes on where it stopped.
        preset: `small` (the default, which fits a laptop), `specialist`, `general`, `paper` or
            `kinetix-3`; only with the name of an algorithm.
        start_from: An agent to fine-tune, in a run that has no checkpoint yet. With the name of an
            algorithm its network, observation, action, frame skip, normalisation and, of a flat
            network, size are taken over; a configuration must have them.
        report: Called after every update.
        say: Takes what there is to say besides.
        **fields: Hyper-parameters by name, such as `levels=("s/goalkeeper",)`; only with the name
            of an algorithm.

    Returns:
        The trained agent; `out` holds it too.

    Raises:
        KinetixError: A word or number is not allowed; the message names it.
    """
    if not isinstance(out, str | os.PathLike) or not os.fspath(out):
        raise KinetixError(f"out={out!r}: expected the run's directory")
    out = Path(out)
    teacher: Agent | None = None
    if start_from is not None and still_needed(out, say or say_nothing):
        teacher = start_from if isinstance(start_from, Agent) else load_agent(start_from)
    if isinstance(config, str):
        fresh = not os.path.isfile(out / CONFIG)
        algorithm = config
        like = {} if teacher is None else settings_of(teacher.card)
        config = make_config(
            algorithm, preset=preset or ("small" if fresh else None), values=like | fields, run=out
        )
    else:
        algorithm = algorithm_of(config)
    last = run_training(algorithm, config, out, teacher=teacher, report=report, say=say)
    return load_agent(last)
