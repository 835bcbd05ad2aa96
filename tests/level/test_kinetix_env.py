"""kinetix-env's format: both array forms, the dialect of Kinetix.js, round trips, bad files."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from kinetix.engine.spec import Capacity
from kinetix.errors import LevelError
from kinetix.level.codec import dumps, load_document, loads, loads_document, save_level
from kinetix.level.kinetix_env.document import STANDARD_GRAVITY, lost_fields, parse_kinetix_env
from kinetix.level.kinetix_env.export import dump_tree, from_level
from kinetix.level.kinetix_env.to_level import to_level
from kinetix.level.model import Arena, ArenaBody, Level, Solution
from tests.level.strategies import levels
from tests.pace import share_of

OWN = Path(__file__).parent / "fixtures" / "kinetix_env"
PLAIN = (OWN / "cart_and_bell.json").read_text()


@pytest.fixture(scope="module")
def published(peer):
    return [load_document(path) for path in sorted((peer / "levels").rglob("*.json"))]


def imported(text, name="cart_and_bell"):
    return to_level(parse_kinetix_env(text), name=name)[0]


def entries(tree):
    """The active rows of each collection, in order."""
    state = tree["env_state"]
    return {
        kind: [row for row in state[kind] if row["active"]]
        for kind in ("polygon", "circle", "joint", "thruster")
    }


# --- the published files


@pytest.mark.peer
def test_published_files_are_rewritten_byte_for_byte(published, tmp_path):
    assert len(published) == 37
    for loaded in published:
        text = loaded.path.read_text()
        assert dump_tree(json.loads(text)) == text
        assert dumps(loaded.level, format="kinetix-env", source=loaded.source) == text
        save_level(loaded.level, tmp_path / "x.json", format="kinetix-env", source=loaded.source)
        assert (tmp_path / "x.json").read_bytes() == loaded.path.read_bytes()


@pytest.mark.peer
def test_published_files_load_in_half_a_second(peer):
    paths = sorted((peer / "levels").rglob("*.json"))
    assert share_of(0.5, lambda: [load_document(path) for path in paths]) <= 1


@pytest.mark.peer
def test_published_levels_survive_our_format_and_back(published):
    for loaded in published:
        native = loads(dumps(loaded.level))
        assert native == loaded.level
        assert native.inertia_model == "kinetix"
        assert not any(body.mass_properties for body in native.bodies)
        before = json.loads(loaded.source.text)
        after = json.loads(from_level(native, stem=native.name)[0])
        compare(before, after)


def compare(before, after):
    """Every field of every active entity, float32 for float32; derived ones within rounding."""
    shift = index_map(before), index_map(after)
    for kind, rows in entries(before).items():
        others = entries(after)[kind]
        assert len(rows) == len(others)
        for row, other in zip(rows, others, strict=True):
            assert list(row) == list(other)
            for key, value in row.items():
                compare_field(kind, key, value, other[key], shift)
    assert after["env_params"] == before["env_params"]
    assert after["static_env_params"] == before["static_env_params"]
    assert after["env_state"]["gravity"] == before["env_state"]["gravity"]


def index_map(tree):
    """Position of a body among the active ones of its kind, by global index."""
    state = tree["env_state"]
    bodies = [("p", row) for row in state["polygon"]] + [("c", row) for row in state["circle"]]
    counts = {"p": 0, "c": 0}
    places = {}
    for index, (kind, row) in enumerate(bodies):
        places[index] = kind, counts[kind]
        counts[kind] += row["active"]
    return places


def compare_field(kind, key, value, other, shift):
    if key in ("a_index", "b_index", "object_index"):
        assert shift[0][value] == shift[1][other]
    elif key in ("inverse_mass", "inverse_inertia"):
        assert other == pytest.approx(value, rel=1e-6)
    elif key == "global_position":  # derived
        assert math.dist(value.values(), other.values()) < 1e-6
    elif key in ("radius", "vertices", "n_vertices", "highlighted") and (kind, key) not in (
        ("polygon", "vertices"),
        ("polygon", "n_vertices"),
        ("circle", "radius"),
    ):
        return  # leftovers without a meaning
    else:
        assert other == value, (kind, key)


@pytest.mark.peer
def test_published_levels_have_the_common_facts_of_the_format(published):
    for loaded in published:
        level = loaded.level
        assert level.gravity == STANDARD_GRAVITY
        assert level.size in ("s", "m", "l")
        assert level.max_timesteps == 256
        assert all(getattr(level.arena, name).geometry is None for name in Arena.__struct_fields__)


@pytest.mark.peer
def test_gaps_between_slots_are_told(published):
    told = {
        one.level.name for one in published if "not carried: gaps between slots" in one.warnings
    }
    assert told == {"h9_morph_direction", "h10_morph_direction_2", "hard_lunar_lander"}


# --- our own files in kinetix-env's format


def test_both_array_forms_and_the_dialect_say_the_same():
    plain = imported(PLAIN)
    assert imported((OWN / "lists.json").read_text()) == plain
    assert imported((OWN / "by_size.json").read_text()) == plain
    assert len(plain.bodies) == 4
    assert [body.role for body in plain.bodies] == ["green", "blue", "none", "none"]
    assert plain.arena.floor == ArenaBody(friction=0.8)
    assert plain.joints[0].motor.speed == 2.0
    assert plain.joints[1].motor.on is False


def test_slots_with_gaps_become_bodies_in_order():
    document = parse_kinetix_env((OWN / "gaps.json").read_text())
    level, _, warnings = to_level(document, name="x")
    plain = imported(PLAIN)
    assert [body.position for body in level.bodies[2:]] == [
        plain.bodies[3].position,
        plain.bodies[2].position,
    ]
    assert [level.body(joint.b).position for joint in level.joints] == [
        plain.body(joint.b).position for joint in plain.joints
    ]
    assert set(warnings) == {
        "not carried: gaps between slots",
        "not carried: what unused slots hold",
        "not carried: highlights",
    }


@pytest.mark.parametrize("path", sorted(OWN.glob("*.json")), ids=lambda path: path.stem)
def test_own_files_are_rewritten_byte_for_byte(path):
    loaded = loads_document(path.read_text(), str(path))
    assert dumps(loaded.level, format="kinetix-env", source=loaded.source) == path.read_text()
    changed = loaded.level.replace(max_timesteps=99)
    text = dumps(changed, format="kinetix-env", source=loaded.source)
    assert json.loads(text)["env_params"]["max_timesteps"] == 99


def test_the_written_form_has_exactly_the_keys_of_a_published_file():
    tree = json.loads(from_level(Level(name="x", size="s"))[0])
    assert list(tree) == ["env_state", "env_params", "static_env_params"]
    state = tree["env_state"]
    assert [len(state[kind]) for kind in ("polygon", "circle", "joint", "thruster")] == [5, 2, 1, 1]
    assert [len(state[f"acc_{kind}_manifolds"]) for kind in ("rr", "cr", "cc")] == [8, 10, 1]
    unused = state["polygon"][4]
    assert unused == {
        "position": {"0": 0.0, "1": 0.0}, "rotation": 0.0, "velocity": {"0": 0.0, "1": 0.0},
        "angular_velocity": 0.0, "inverse_mass": 0.0, "inverse_inertia": 0.0, "friction": 1.0,
        "restitution": 0.0, "collision_mode": 1, "active": False, "n_vertices": 4,
        "vertices": {str(k): {"0": 0.0, "1": 0.0} for k in range(4)}, "radius": 0.0, "role": 0,
        "density": 1.0, "highlighted": False,
    }  # fmt: skip
    assert state["circle"][0]["n_vertices"] == 0
    assert state["joint"][0]["global_position"] == {"0": 256.0, "1": 256.0}
    assert state["gravity"] == {"0": 0.0, "1": -9.8100004196167}
    assert tree["static_env_params"]["num_polygons"] == 5


@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(levels(max_bodies=5))
def test_ours_to_the_peer_and_back_keeps_what_both_can_say(level):
    level = level.unnamed()
    level = level.replace(
        name="x", description="", tags=(), solution=None, inertia_model="kinetix",
        bodies=tuple(b.replace(fixed=True, mass_properties=None) for b in level.bodies),
    )  # fmt: skip
    text, lost = from_level(level, stem="x")
    back = imported(text, "x")
    assert ("automatic motors" in lost) == any(j.motor and j.motor.auto for j in level.joints)
    order = [b.id for b in level.bodies if b.shape.kind == "polygon"]
    order += [b.id for b in level.bodies if b.shape.kind == "circle"]
    for own_id, other in zip(order, back.bodies, strict=True):
        assert level.body(own_id).replace(id=0) == other.replace(id=0)
    assert back.gravity == level.gravity
    assert back.max_timesteps == level.max_timesteps
    assert [j.limits for j in back.joints] == [
        None if j.limits and j.limits == j.limits.replace(on=False, min=0, max=0) else j.limits
        for j in level.joints
    ]
    assert [t.replace(id=1, body=1) for t in back.thrusters] == [
        t.replace(id=1, body=1) for t in level.thrusters
    ]
    for name in Arena.__struct_fields__:
        assert getattr(back.arena, name) == getattr(level.arena, name)


def test_masses_that_do_not_follow_from_the_shape_are_kept():
    tree = json.loads(PLAIN)
    tree["env_state"]["circle"][0]["inverse_mass"] *= 2
    level = imported(json.dumps(tree))
    heavy = next(body for body in level.bodies if body.mass_properties)
    assert heavy.shape.kind == "circle"
    again = json.loads(from_level(level)[0])["env_state"]["circle"][0]
    assert again["inverse_mass"] == pytest.approx(
        tree["env_state"]["circle"][0]["inverse_mass"], rel=1e-6
    )


def test_a_moved_wall_is_kept_as_geometry():
    tree = json.loads(PLAIN)
    tree["env_state"]["polygon"][1]["position"]["0"] = float(np.float32(-0.05))
    level = imported(json.dumps(tree))
    assert level.arena.left_wall.geometry.position == (np.float32(-0.05), 0.0)
    assert level.arena.right_wall.geometry is None
    again = json.loads(from_level(level)[0])
    assert again["env_state"]["polygon"][1] == tree["env_state"]["polygon"][1]


def test_what_the_peer_loses_is_named():
    level = loads((OWN.parent / "v1" / "everything.json").read_text())
    level = level.replace(
        solution=Solution(physics="jax2d", frame_skip=2, actions=((1, (0,) * 6),)),
    )
    assert lost_fields(level, stem="everything") == (
        "automatic motors", "gravity", "max_timesteps", "name", "description", "tags", "solution",
        "how masses follow from shapes (they stay as numbers)",
    )  # fmt: skip


def test_the_contact_list_is_read_in_pairs():
    tree = json.loads(PLAIN)
    for k, contact in enumerate(tree["env_state"]["acc_rr_manifolds"]):
        contact["penetration"] = float(k)
    document = parse_kinetix_env(json.dumps(tree))
    assert [c.penetration for c in document.polygon_contacts] == list(map(float, range(18)))
    assert "not carried: contacts" in to_level(document, name="x")[2]
    assert document.capacity == Capacity(polygons=6, circles=3, joints=2, thrusters=2)


def changed(path, value):
    """The file with one value changed; `path` is a list of keys."""
    tree = json.loads(PLAIN)
    place = tree
    for key in path[:-1]:
        place = place[key]
    if value is KeyError:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return json.dumps(tree)


STATE = "env_state"
JOINT = (STATE, "joint", 0)
CIRCLE = (STATE, "circle", 0)
BAD = {
    "index": ((*JOINT, "a_index"), 9, r"\$\.env_state\.joint\[0\]\.a_index: .* 0 ≤ x < 9, got 9"),
    "negative": ((*JOINT, "b_index"), -1, r"joint\[0\]\.b_index: expected 0 ≤ x < 9, got -1"),
    "unused": ((*JOINT, "b_index"), 8, r"joint\[0\]\.b_index: expected a body in use, got slot 8"),
    "itself": ((*JOINT, "b_index"), 4, r"joint\[0\]\.b_index: expected another body"),
    "binding": ((*JOINT, "motor_binding"), 4, r"motor_binding: expected 0 ≤ x < 4, got 4"),
    "string": ((*JOINT, "motor_speed"), "1", r"motor_speed: expected a number, got \"1\""),
    "flag": ((*JOINT, "active"), 2, r"active: expected true or false, got 2"),
    "whole": ((*JOINT, "a_index"), 1.5, r"a_index: expected a whole number"),
    "nan": ((*CIRCLE, "rotation"), math.nan, r"circle\[0\]\.rotation: expected a finite"),
    "vector": ((*CIRCLE, "position", "1"), math.inf, r"position\[1\]: expected a finite"),
    "short vector": ((*CIRCLE, "position", "1"), KeyError, r"position: expected an array of 2"),
    "array keys": ((*CIRCLE, "position"), {"0": 1, "2": 1}, r"position: expected an array with"),
    "role": ((*CIRCLE, "role"), 4, r"circle\[0\]\.role: expected 0 ≤ x ≤ 3, got 4"),
    "radius": ((*CIRCLE, "radius"), 9.0, r"circle\[0\]\.radius: expected 0\.02 ≤ x ≤ 5, got 9"),
    "half fixed": ((*CIRCLE, "inverse_mass"), 0.0, r"circle\[0\]\.inverse_inertia: expected both"),
    "speed": ((*JOINT, "motor_speed"), 30.0, r"joint\[0\]\.motor_speed: expected -20 ≤ x ≤ 20"),
    "corners": ((STATE, "polygon", 4, "n_vertices"), 2, r"\[4\]\.n_vertices: expected 3 ≤ x"),
    "order": (
        (STATE, "polygon", 4, "vertices", "1"), {"0": 0.0, "1": 0.0},
        r"polygon\[4\]\.vertices: expected",
    ),
    "missing": ((*JOINT, "rotation"), KeyError, r'joint\[0\]: the key "rotation" is missing'),
    "unknown": ((*JOINT, "motor_auto"), True, r"joint\[0\]\.motor_auto: unknown key"),
    "list": ((STATE, "joint"), [], r"\$\.env_state\.joint: expected an array of at least 2"),
    "contacts": ((STATE, "acc_cr_manifolds"), 3, r"acc_cr_manifolds: expected an array, got 3"),
    "matrix": ((STATE, "collision_matrix"), KeyError, r'the key "collision_matrix" is missing'),
    "block": (("env_params",), KeyError, r'\$: the key "env_params" is missing'),
    "parameter": (("env_params", "dt"), KeyError, r'env_params: the key "dt" is missing'),
    "steps": (("env_params", "max_timesteps"), 0, r"max_timesteps: expected 1 ≤ x ≤ 100000"),
    "capacity": (("static_env_params", "num_polygons"), 10**9, r"num_polygons: .* ≤ 1024"),
    "arena": (("static_env_params", "num_polygons"), 3, r"num_polygons: expected x ≥ 4, got 3"),
    "floor": ((STATE, "polygon", 0, "inverse_mass"), 1.0, r"polygon\[0\]\.inverse_mass: "),
    "wall": ((STATE, "polygon", 1, "active"), False, r"polygon\[1\]\.active: expected true"),
    "size": (("env_params",), {"type": "size", "size": "xl", "params": None}, r"size: .* one of"),
}  # fmt: skip


@pytest.mark.parametrize(("field", "value"), [("role", 9), ("role", -9), ("collision_mode", 9)])
def test_unused_arena_rows_may_hold_anything(field, value):
    tree = json.loads(changed((STATE, "polygon", 1, "active"), False))
    tree[STATE]["polygon"][1][field] = value
    with pytest.raises(LevelError, match=r"polygon\[1\]\.active: expected true"):
        loads(json.dumps(tree))


@pytest.mark.parametrize("name", BAD)
def test_bad_files_get_one_sentence_with_the_path(name):
    path, value, sentence = BAD[name]
    with pytest.raises(LevelError, match=sentence) as caught:
        loads(changed(path, value), "mine.json")
    assert str(caught.value).startswith("mine.json: $")
    assert "\n" not in str(caught.value)


def test_stale_indices_of_unused_rows_do_not_matter():
    text = changed((STATE, "thruster", 0, "object_index"), 99)
    assert imported(text) == imported(PLAIN)


def test_keys_that_stand_twice_are_refused():
    for old in ('"a_index": 4', '"env_state": {', '"dt": '):
        assert old in PLAIN
        key = old.split(":")[0]
        with pytest.raises(LevelError, match="twice"):
            loads(PLAIN.replace(old, f"{key}: 1, {old}", 1))


def test_unknown_keys_at_the_top_are_ignored():
    assert imported('{"version": "1.0.0", ' + PLAIN[1:]) == imported(PLAIN)


# --- mends


def test_a_frame_off_the_centre_of_mass_is_mended_and_nothing_moves():
    tree = json.loads(PLAIN)
    state = tree["env_state"]
    slot = next(k for k, row in enumerate(state["polygon"]) if k > 3 and row["inverse_mass"] > 0)
    row = state["polygon"][slot]
    for k in range(row["n_vertices"]):
        row["vertices"][str(k)]["1"] += 0.02
    loaded = loads_document(json.dumps(tree), "shifted")
    assert loaded.warnings[0].startswith(f"mended: $.env_state.polygon[{slot}].vertices: ")
    plain = imported(PLAIN)
    body, before = loaded.level.bodies[0], plain.bodies[0]
    up = (-math.sin(before.angle) * 0.02, math.cos(before.angle) * 0.02)
    expected = (before.position[0] + up[0], before.position[1] + up[1])
    assert body.position == pytest.approx(expected, abs=1e-6)
    for corner, was in zip(body.shape.vertices, before.shape.vertices, strict=True):
        assert corner == pytest.approx(was, abs=1e-6)
    for joint, was in zip(loaded.level.joints, plain.joints, strict=True):
        assert joint.anchor_a == pytest.approx(
            (was.anchor_a[0], was.anchor_a[1] - 0.02) if was.a == body.id else was.anchor_a
        )
    # Written back untouched, the file is what it was.
    text = json.dumps(tree)
    assert dumps(loaded.level, format="kinetix-env", source=loaded.source) == text
