"""The bundled levels, one function each: `scripts/build_levels.py` writes them to `levels/`."""
