"""A step of one world as one kernel of a GPU, made from the same JAX source.

1. `program.py` reads the function's jaxpr into blocks of operations (`model.py`); `rewriting.py`
   lists the operations that are replaced by others;
2. `forms.py` decides what is kept in registers, in memory, or not at all;
3. `writer.py` writes C++ with a `pen.py`: `blocks.py` finds an order of a block's `items.py`,
   `lanes.py` writes what the lanes share, `control.py` loops and conditionals, `parts.py` changes
   in place. Tables of operations: `elementwise.py`, `reading.py`, `reducing.py`. Where things are:
   `index.py`, `places.py`, `memory.py`;
4. `kernel.py` puts it into a kernel with as many lanes as suit the scene (`prelude.h`), `cuda.py`
   compiles it, `launch.py` calls it in a JAX program.
"""
