"""The one bridge to JAX: does what a job asks for. Only `editor.worker.bridge` imports it."""

from editor.worker.simulation.perform import perform
from editor.worker.simulation.stepping import keep_programs
from kinetix.cores import stay_on_processor, use_all_cores

__all__ = ["keep_programs", "perform", "start"]


def start() -> None:
    """Give JAX every core, before its first array: evaluations spread their episodes over them.

    A GPU is left to trainings, which are processes of their own: one world is played at a time, and
    compiling for a GPU takes longer than a person waits for Play.
    """
    stay_on_processor()
    use_all_cores(unless_started=True)
