"""A step of one world as one kernel of a GPU, made from the same JAX source.

1. `from_jaxpr.py` reads the function's jaxpr into blocks of operations (`ir.py`); `lowering.py`
   lists the operations that are replaced by others;
2. `storage.py` decides what is kept in registers, in memory, or not at all;
3. `writer.py` writes C++ with an `emitter.py`: `schedule.py` orders the operations of a block by
   their `dependencies.py`, `fusion.py` writes what the lanes share, `control_flow.py` loops and
   conditionals, `updates.py` changes in place. Tables of operations: `elementwise.py`,
   `indexing.py`, `reducing.py`. Where values are: `flat_index.py`, `buffers.py`, `allocation.py`;
4. `kernel.py` puts it into a kernel with as many lanes as suit the scene (`prelude.h`), `cuda.py`
   compiles it, `launch.py` calls it in a JAX program.
"""
