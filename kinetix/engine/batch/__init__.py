"""From one world to many: `vmap(step)` runs the solvers' own batched kernel, worlds last.

A solver's arrays carry the worlds on the last axis, so that inner loops run over worlds instead of
over a handful of bodies. A primitive of our own lets callers write for one world, batch with `vmap`
(nested too) and still hit that kernel; and it is traced once only, when a program is compiled.

Three ways to define a batch: `worlds_last` runs a kernel tile by tile, `worlds_first` a
function of the whole batch, `where_marked` a function of one world for the worlds that need it.
"""

from kinetix.engine.batch.marked import in_a_round, where_marked
from kinetix.engine.batch.tiles import TILE
from kinetix.engine.batch.worlds_first import worlds_first
from kinetix.engine.batch.worlds_last import worlds_last

__all__ = ["TILE", "in_a_round", "where_marked", "worlds_first", "worlds_last"]
