"""Everyday scenes: one file per class of things that people build. No JAX.

`catalogue` has the table of classes; names are imported from there.
"""
