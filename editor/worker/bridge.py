"""The way from jobs to the simulation, which imports JAX when it is first needed."""

import sys
from typing import Any

from editor.worker.requests import Progress, Request
from editor.worker.yielding import without_pauses


def perform_in_simulation(request: Request, progress: Progress) -> Any:
    """Do a request in the simulation; imports JAX on the first call."""
    if "editor.worker.simulation.perform" not in sys.modules:
        progress.report(None, "Starting the simulation")
        with without_pauses():
            from editor.worker import simulation

            simulation.start()
    from editor.worker import simulation

    return simulation.perform(request, progress)


def keep_what_was_compiled() -> None:
    """Write the steps that were compiled to disk, where the simulation has been used at all.

    A tenth of a second for each. If the app or Play is left soon, they are there the next time.
    """
    if "editor.worker.simulation.perform" in sys.modules:
        from editor.worker.simulation import keep_programs

        keep_programs()
