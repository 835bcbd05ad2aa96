"""Scenes of the class "built": what people put together, one file per kind of question. No JAX."""
