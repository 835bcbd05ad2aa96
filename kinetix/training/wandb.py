"""Metrics for Weights & Biases, for those who have an account there and ask for it."""

import importlib
import math
import os
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from kinetix.errors import KinetixError
from kinetix.files.regular import read_text
from kinetix.training.config import PpoConfig
from kinetix.training.logging import STEPS

RUN_ID: Final = "wandb.id"
"""File in the run's directory that names the run there, so that it goes on as the same one."""


def check_package(config: PpoConfig) -> None:
    """Refuse a project where the package is not installed.

    Args:
        config: Names the project, or none.

    Raises:
        KinetixError: It names one that nothing could be sent to.
    """
    if config.wandb_project:
        wandb_package("wandb_project: ")


def wandb_package(wanted_by: str = "") -> Any:
    """Return the package, which is imported when it is first needed.

    Args:
        wanted_by: How the sentence begins where it is missing.

    Raises:
        KinetixError: It is not installed.
    """
    try:
        return importlib.import_module("wandb")
    except ImportError:
        raise KinetixError(
            f"{wanted_by}the package wandb is missing; pip install 'kinetix-editor[wandb]'"
        ) from None


class WandbSink:
    """Sends one row an update; nothing of the run depends on it."""

    def __init__(self, run: Path, config: PpoConfig, configuration: Mapping[str, Any]) -> None:
        """Begin the run there, or go on with it.

        Args:
            run: The run's directory.
            config: Names project, entity, group and tags.
            configuration: All hyper-parameters, as a table.

        Raises:
            KinetixError: The package is not installed.
        """
        wandb = wandb_package("wandb_project: ")
        known = run / RUN_ID
        if not os.path.isfile(known):
            known.write_text(uuid.uuid4().hex[:12], encoding="utf-8")
        self._wandb = wandb
        self._run = wandb.init(
            project=config.wandb_project,
            entity=config.wandb_entity or None,
            group=config.wandb_group or None,
            tags=list(config.wandb_tags) or None,
            name=run.name,
            dir=str(run),
            id=read_text(known, "run").strip(),
            resume="allow",
            config=dict(configuration),
        )
        # Rows that are made again after a kill carry the same number of steps, and an axis of our
        # own takes them where the service's counter refuses.
        self._run.define_metric("*", step_metric=STEPS)

    def write(self, metrics: Mapping[str, float]) -> None:
        """Send a row; numbers that are not finite are left out.

        Args:
            metrics: By name.
        """
        row = {name: value for name, value in metrics.items() if math.isfinite(value)}
        self._run.log(row)

    def film(self, steps: int, film: Path) -> None:
        """Send a film.

        Args:
            steps: Environment steps after which it was made.
            film: A GIF.
        """
        video = self._wandb.Video(str(film), format="gif")
        self._run.log({f"film/{film.stem}": video, STEPS: steps})

    def close(self) -> None:
        """Send what is buffered."""
        self._run.finish()
