"""The one bridge to JAX: does what a job asks for. Only `editor.worker.jobs` imports it."""

from editor.worker.simulation.perform import perform
from kinetix.cores import use_all_cores

__all__ = ["perform", "start"]


def start() -> None:
    """Give JAX every core, before its first array: evaluations spread their episodes over them."""
    use_all_cores(unless_started=True)
