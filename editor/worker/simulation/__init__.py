"""The one bridge to JAX: does what a job asks for. Only `editor.worker.jobs` imports it."""

from editor.worker.simulation.perform import perform

__all__ = ["perform"]
