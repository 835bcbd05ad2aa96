"""The one bridge to JAX: does what the worker is asked for. Only `editor.jobs` imports it."""

from editor.simulation.perform import perform

__all__ = ["perform"]
