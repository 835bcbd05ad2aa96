"""A step of one world as one program of a GPU, made from the same JAX source.

1. `program.py` reads the function's jaxpr into operations on arrays;
2. `forms.py` decides what is kept in registers, in memory, or not at all;
3. `writer.py` writes C++ (`elementwise.py`, `reading.py`: a row for each operation; `index.py`:
   places in arrays; `memory.py`: which arrays share a place);
4. `cuda.py` compiles it, `launch.py` puts it into a JAX program.
"""
