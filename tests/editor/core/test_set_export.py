"""Level sets written as folders: what lies there already stays as it is."""

import pytest

from editor.gallery.export import SetPlan, export_set
from kinetix.level.codec import load_level, save_level
from kinetix.level.sets import load_set
from tests.editor.core.test_gallery import playable

PLAN = SetPlan(form="folder")


@pytest.fixture
def alpha(tmp_path):
    """A level outside of the folder of the set, and that folder."""
    folder = tmp_path / "set"
    folder.mkdir()
    path = tmp_path / "alpha.json"
    save_level(playable("Alpha", 1.0), path)
    return path, folder


def test_a_level_of_the_set_that_lies_in_its_folder_stays_there(alpha):
    """Also the second time: the same levels are the same set."""
    other, folder = alpha
    own = folder / "alpha.json"
    save_level(playable("Alpha", 2.2), own)
    before, levels = own.read_bytes(), {other: 1.0, own: 2.0}
    for _ in range(3):
        made = export_set(levels, PLAN, folder)
        assert len(made.levels) == 2
        assert own.read_bytes() == before
    loaded = load_set(folder / "set.json")
    assert [(each.path.name, each.weight) for each in loaded.levels] == [
        ("alpha_2.json", 1.0),
        ("alpha.json", 2.0),
    ]
    assert {path.name for path in folder.glob("alpha*")} == {"alpha.json", "alpha_2.json"}


@pytest.mark.parametrize("name", ["alpha.json", "ALPHA.json"])
def test_a_level_that_is_not_of_the_set_is_not_replaced(alpha, name):
    other, folder = alpha
    own = folder / name
    save_level(playable("Mine", 2.7), own)
    before = own.read_bytes()
    export_set({other: 1.0}, PLAN, folder)
    assert own.read_bytes() == before
    (written,) = load_set(folder / "set.json").levels
    assert written.path != own and load_level(written.path) == load_level(other)
    assert not list(folder.glob("*.bak*"))
