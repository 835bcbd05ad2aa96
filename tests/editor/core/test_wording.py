"""Problems call things what lists and menus call them."""

import pytest

from editor.base.wording import describe as in_lists
from kinetix.level.codec import load_level
from kinetix.level.validate import describe as in_problems
from kinetix.paths import levels_dir
from kinetix.wording import plural


def test_one_of_a_thing_is_said_as_one():
    assert [plural(count, "layer") for count in (0, 1, 2)] == ["0 layers", "1 layer", "2 layers"]
    assert [plural(count, "policy", "policies") for count in (1, 3)] == ["1 policy", "3 policies"]


@pytest.mark.parametrize("name", ["l/rover_ridge", "l/skyhook", "s/goalkeeper"])
def test_one_name_for_one_thing(name):
    level = load_level(levels_dir() / f"{name}.json")
    assert len(list(level.entities())) > 2
    for entity in level.entities():
        assert in_problems(entity.id, entity).capitalize() == in_lists(level, entity.id)
