"""Level sets: manifests of levels with weights and a split into train and eval.

The README.md of levels describes the file. Free of JAX.
"""

from kinetix.level.sets.build import build_set, draw_split, split_set
from kinetix.level.sets.gather import (
    gather_levels,
    json_files,
    level_files,
    place_of,
    read_levels,
)
from kinetix.level.sets.manifest import (
    DEFAULT_SPLIT,
    LONGEST_NAME,
    MAX_LEVELS,
    VERSION,
    LevelSet,
    LoadedSet,
    SetEntry,
    SetLevel,
    Split,
    common_capacity,
)
from kinetix.level.sets.parts import distinct, evaluation_part, training_part
from kinetix.level.sets.paths import within_reach
from kinetix.level.sets.problems import issues_in_file, set_level_issues
from kinetix.level.sets.read import is_set_file, load_set, read_set
from kinetix.level.sets.write import dumps_set, inline_losses, save_set

__all__ = [
    "DEFAULT_SPLIT",
    "LONGEST_NAME",
    "MAX_LEVELS",
    "VERSION",
    "LevelSet",
    "LoadedSet",
    "SetEntry",
    "SetLevel",
    "Split",
    "build_set",
    "common_capacity",
    "distinct",
    "draw_split",
    "dumps_set",
    "evaluation_part",
    "gather_levels",
    "inline_losses",
    "is_set_file",
    "issues_in_file",
    "json_files",
    "level_files",
    "load_set",
    "place_of",
    "read_levels",
    "read_set",
    "save_set",
    "set_level_issues",
    "split_set",
    "training_part",
    "within_reach",
]
