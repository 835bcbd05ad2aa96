"""What people build: one file per class of things, scenes drawn by a seed. No JAX.

`catalogue` has the table of classes; names are imported from there.
"""
