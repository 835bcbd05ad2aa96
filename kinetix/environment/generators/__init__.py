"""Random levels, mutations of levels, and what is made from both."""

from kinetix.lazy import lazy_names

__getattr__, __dir__ = lazy_names(
    __name__,
    submodules=("documents", "filters", "locomotion", "mutators", "params", "sample", "starts"),
)
