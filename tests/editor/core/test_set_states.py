"""A trainer gets from an exported set the states that the editor plays, bit for bit."""

import jax
import numpy as np
import pytest

from editor.documents import files
from editor.gallery.export import SetPlan, export_set
from editor.worker.simulation.stepping import start_state
from kinetix.environment.params import static_env_params_from_size
from kinetix.environment.reset import make_reset_fn_list_of_levels
from kinetix.level.codec import resolve_path


@pytest.mark.parametrize("form", ["file", "folder"])
def test_a_set_starts_as_the_editor_does(tmp_path, form):
    path = resolve_path("s/first_flight")
    target = tmp_path / ("set.json" if form == "file" else "set")
    export_set({path: 1.0}, SetPlan(form=form), target)
    manifest = target if form == "file" else target / "set.json"
    static = static_env_params_from_size("s", physics="balanced")
    trained = make_reset_fn_list_of_levels(manifest, static)(jax.random.key(0))
    played = start_state(files.open_document(path).level, "balanced")
    assert jax.tree.structure(trained) == jax.tree.structure(played)
    for ours, theirs in zip(jax.tree.leaves(played), jax.tree.leaves(trained), strict=True):
        np.testing.assert_array_equal(np.asarray(ours), np.asarray(theirs))
