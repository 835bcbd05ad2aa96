"""Contact blocks by name: a new one is one file and one entry here."""

from kinetix.engine.solvers.direct.blocks.admm import Admm
from kinetix.engine.solvers.direct.blocks.base import AbstractBlock, Cone
from kinetix.engine.solvers.direct.blocks.pgs import Pgs

BLOCKS: dict[str, type[AbstractBlock]] = {block.name: block for block in (Pgs, Admm)}

__all__ = ["BLOCKS", "AbstractBlock", "Admm", "Cone", "Pgs"]
