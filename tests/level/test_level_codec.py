"""Our format: canonical text, strict reading, hashes, names of files."""

import dataclasses
import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kinetix.bundled import permutation_of
from kinetix.errors import LevelError
from kinetix.files.limits import LIMITS
from kinetix.level.canonical import VERSION, real_text, tree_text
from kinetix.level.codec import (
    dumps,
    level_hash,
    load_document,
    load_level,
    loads,
    resolve_path,
    save_level,
)
from kinetix.level.migrations import MIGRATIONS
from kinetix.level.model import Body, Circle, Joint, Level, Polygon, Thruster
from tests.level.strategies import levels

FIXTURES = Path(__file__).parent / "fixtures"
V1 = sorted((FIXTURES / "v1").glob("*.json"))
EVERYTHING = (FIXTURES / "v1" / "everything.json").read_text()
few = settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))


@few
@given(levels())
def test_text_there_and_back_changes_nothing(level):
    text = dumps(level)
    assert loads(text) == level
    assert dumps(loads(text)) == text
    assert level_hash(loads(text)) == level_hash(level)


def shuffled(tree, random):
    if isinstance(tree, dict):
        keys = list(tree)
        random.shuffle(keys)
        return {key: shuffled(tree[key], random) for key in keys}
    return [shuffled(item, random) for item in tree] if isinstance(tree, list) else tree


@few
@given(levels(max_bodies=2), st.randoms(use_true_random=False))
def test_the_order_of_keys_has_no_meaning(level, random):
    assert loads(json.dumps(shuffled(json.loads(dumps(level)), random))) == level


@few
@given(levels(max_bodies=2), st.data())
def test_defaults_may_be_left_out_and_unknown_keys_may_not(level, data):
    tree = json.loads(dumps(level))
    for key, default in (("description", ""), ("tags", ()), ("max_timesteps", 256)):
        if data.draw(st.booleans()):
            del tree[key]
            level = level.replace(**{key: default})
    assert loads(json.dumps(tree)) == level
    owner = data.draw(
        st.sampled_from([tree, tree["arena"], tree["arena"]["floor"], *tree["bodies"]])
    )
    owner["surprise"] = 1
    with pytest.raises(LevelError, match=r"surprise: unknown key"):
        loads(json.dumps(tree))


@pytest.mark.parametrize("path", V1, ids=lambda path: path.stem)
def test_fixtures_of_version_1_load_to_the_same_level_and_bytes(path):
    assert dumps(load_level(path)) == path.read_text()


def test_the_fixture_with_everything_holds_everything():
    level = loads(EVERYTHING)
    assert level.name == "Alles – tout, 全部"
    assert level.arena.left_wall.geometry.position == (np.float32(-0.05), 0.0)
    assert level.joints[0].motor.auto
    assert level.bodies[1].mass_properties.mass == np.float32(0.2)
    assert level.next_id == 40


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_reals_read_back_to_the_same_bits(value):
    text = real_text(value)
    assert np.float32(float(text)).tobytes() == np.float32(value).tobytes()
    assert "." in text or "e" in text


def test_shortest_digits_are_written():
    assert real_text(float(np.float32(0.4))) == "0.4"
    assert real_text(float(np.float32(math.pi / 4))) == "0.7853982"
    assert real_text(1e16) == "1e+16"


def test_the_layout_is_the_canonical_one():
    lines = EVERYTHING.splitlines()
    assert lines[:3] == ["{", '  "format": "kinetix-level",', '  "version": 1,']
    assert '      "shape": {"kind": "circle", "radius": 0.25},' in lines
    assert '  "gravity": [0.5, -3.7],' in lines
    assert EVERYTHING.endswith("}\n")
    assert tree_text({"actions": [[1, [0, 0]]], "bodies": []}) == (
        '{\n  "actions": [\n    [1, [0, 0]]\n  ],\n  "bodies": []\n}\n'
    )


def change(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


# Whole texts: (text, code, what the sentence says).
TEXTS = {
    "not json": (EVERYTHING[:300], "E001", r"\$: not JSON, line 15 column 3: Untermin"),
    "deep": ("[" * 100_000 + "]" * 100_000, "E001", "nested too deeply"),
    "digits": (change(EVERYTHING, "300", "3" * 5000), "E001", "thousands of digits"),
    "mark": ("\ufeff" + EVERYTHING, "E001", "byte-order mark"),
    "other": ('{"format": "tiled"}', "E002", r'\$\.format: expected "kinetix-level", got "tiled"'),
    "nearly": (
        '{"format": "kinetix-level-set", "levels": []}',
        "E002",
        r'expected "kinetix-level" \("kinetix-levelset" for a level set\), got "kinetix-level-set"',
    ),
    "nothing": ("{}", "E002", "kinetix-level.*env_state"),
    "set": ('{"format": "kinetix-levelset"}', "E002", "this is a level set"),
}
BOX = "[0.5, 0.1], [-0.5, 0.2], [-0.4, -0.2], [0.5, -0.1]"
CLOCKWISE = "[0.5, 0.1], [0.5, -0.1], [-0.4, -0.2], [-0.5, 0.2]"
DENT = "[0.5, 0.1], [-0.5, 0.2], [-0.4, -0.2], [-0.3, 0.1]"
THIN = "[0.5, 0.1], [0.5, 0.1001], [-0.4, -0.2], [0.5, -0.1]"
MILLION = "[" + "0," * 10**6 + "0]"
# Single changes of the fixture: (old, new, code, what the sentence says).
CHANGES = {
    "newer": ('"version": 1', '"version": 3', "E003", "newer than 2"),
    "key": ('  "next_id": 40,\n', "", "E004", 'the key "next_id" is missing'),
    "motor": ('"on": true, ', "", "E004", r'joints\[0\]\.motor: the key "on"'),
    "unknown": ('"friction"', '"fricton"', "E005", 'did you mean "friction"'),
    "twice": ('"a": 3', '"a": 3, "a": 1', "E005", r"joints\[1\]\.a: .*twice"),
    "twice on top": ('"next_id": 40', '"next_id": 39, "next_id": 40', "E005", r"next_id: .*twice"),
    "type": ('"angle": 0.7', '"angle": "0.7"', "E006", "a number, got"),
    "null": ('"fixed": true', '"fixed": null', "E006", "true or false, got null"),
    "optional": ('{"mass": 0.2, "inertia": 0.01}', "null", "E006", "leave the key out"),
    "pair": ("[0.5, -3.7]", "[0.5]", "E006", r"gravity: expected an array of 2"),
    "nan": ("-3.7", "NaN", "E007", r"gravity\[1\]: .* not finite"),
    "infinity": ("-3.7", "-1e999", "E007", "not finite"),
    "range": ('"friction": 0.1', '"friction": -1.0', "E007", "expected 0 ≤ x ≤ 10, got -1.0"),
    "choice": ('"role": "red"', '"role": "pink"', "E007", '"none" or "red", got "pink"'),
    "kind": ('"kind": "circle"', '"kind": "ring"', "E007", "shape.kind: expected"),
    "tag": ('"x_1"', '"Big"', "E007", r"tags\[1\]"),
    "same tag": ('"x_1"', '"unsolved"', "E007", r"tags\[1\]: expected each tag once"),
    "surrogate": ("全部", "\\ud800", "E007", "surrogate"),
    "many": ('["unsolved", "x_1"]', MILLION, "E007", "100 elements"),
    "same id": ('"id": 9', '"id": 3', "E008", r"bodies\[2\]\.id: .*bodies\[0\] has"),
    "id": ('"next_id": 40', '"next_id": 9', "E008", "x < next_id = 9, got 9"),
    "reference": ('"b": 1', '"b": 77', "E009", r"joints\[1\]\.b: .*77"),
    "pushed": ('"body": 3', '"body": 8', "E009", r"thrusters\[1\]\.body"),
    "itself": ('"b": 1', '"b": 3', "E010", "another body than a, got 3"),
    "winding": (BOX, CLOCKWISE, "E011", "clockwise"),
    "concave": (BOX, DENT, "E011", "convex"),
    "thin": (BOX, THIN, "E011", "closer than"),
    "centre": ("[-0.016666666, 0.26666668]", "[0.0, 0.3]", "E012", r"position \[.*vertices \[\["),
    "size": ('"circles": 3', '"circles": 0', "E013", r"\$\.size: the level needs 6,1,2,2"),
}
BAD = TEXTS | {
    name: (change(EVERYTHING, old, new), code, sentence)
    for name, (old, new, code, sentence) in CHANGES.items()
}


@pytest.mark.parametrize("name", BAD)
def test_bad_text_gives_one_sentence_with_code_and_path(name):
    text, code, sentence = BAD[name]
    start = time.process_time()
    with pytest.raises(LevelError, match=sentence) as caught:
        loads(text, "levels/lamp.json")
    assert time.process_time() - start < 2
    assert str(caught.value).startswith("levels/lamp.json: $")
    assert "\n" not in str(caught.value)
    assert caught.value.faults[0].code == code


def test_every_reading_code_has_a_case():
    assert {code for _, code, _ in BAD.values()} >= {f"E{k:03}" for k in range(1, 14)}


def test_several_faults_are_collected_up_to_twenty():
    tree = json.loads(EVERYTHING)
    tree["bodies"] = [{"id": k} for k in range(50)]
    with pytest.raises(LevelError, match="and 19 more") as caught:
        loads(json.dumps(tree))
    assert len(caught.value.faults) == 20
    assert caught.value.faults[0].path == "$.bodies[0].id"


def test_a_large_file_is_refused_unread(tmp_path):
    path = tmp_path / "large.json"
    with path.open("wb") as file:
        file.truncate(100 * 2**20)
    with pytest.raises(LevelError, match=f"at most {LIMITS['level'].largest >> 20} MiB"):
        load_level(path)


def test_no_text_is_written_that_is_too_large_to_be_read(tmp_path, monkeypatch):
    level = loads(EVERYTHING)
    limit = dataclasses.replace(LIMITS["level"], largest=len(dumps(level).encode()))
    monkeypatch.setitem(LIMITS, "level", limit)
    path = tmp_path / "x.json"
    save_level(level, path)
    before = path.read_bytes()
    with pytest.raises(LevelError, match=r"MiB of kinetix-env, got .*, or write it as kinetix-lev"):
        save_level(level, path, format="kinetix-env")
    with pytest.raises(LevelError, match=r"MiB of kinetix-level, got .*; give it fewer parts$"):
        save_level(level.replace(description=f"{level.description}."), path)
    assert path.read_bytes() == before


def test_a_file_of_kinetix_env_may_have_a_name_that_is_no_text(tmp_path):
    path = tmp_path / "x.json"
    save_level(loads(EVERYTHING), path, format="kinetix-env")
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/caf\xe9.json"))
    path.rename(odd)
    assert load_level(odd).name == "caf?"


def test_bytes_that_are_no_text_are_refused(tmp_path):
    path = tmp_path / "bytes.json"
    path.write_bytes(b"\xff\xfe{}")
    with pytest.raises(LevelError, match="UTF-8"):
        load_level(path)


@pytest.mark.parametrize("seed", range(200))
def test_mutated_files_never_crash(seed):
    rng = np.random.default_rng(seed)
    source = V1[1:][seed % 2] if seed % 4 < 2 else FIXTURES / "kinetix_env" / "cart_and_bell.json"
    data = bytearray(source.read_bytes())
    for _ in range(rng.integers(1, 4)):
        at = int(rng.integers(len(data)))
        match rng.integers(4):
            case 0:
                del data[at : at + int(rng.integers(1, 40))]
            case 1:
                data[at] = int(rng.integers(256))
            case 2:
                data[at:at] = data[: int(rng.integers(1, 200))]
            case _:
                digits = [k for k, byte in enumerate(data) if chr(byte).isdigit()]
                data[int(rng.choice(digits))] = ord(rng.choice(list("-9e.0")))
    try:
        loads(bytes(data), "mutant.json")
    except LevelError as error:
        assert str(error).startswith("mutant.json: $")


def test_migrations_have_no_gap():
    assert set(MIGRATIONS) == set(range(1, VERSION))


def test_reals_may_be_written_as_integers():
    level = loads(change(EVERYTHING, "[2.5, 3.0]", "[2, 3]"))
    assert level.bodies[1].position == (2.0, 3.0)
    assert isinstance(level.bodies[1].position[0], float)


# --- hash, names, saving


def test_the_hash_leaves_out_names_history_and_solution():
    level = loads((FIXTURES / "v1" / "cart_and_bell.json").read_text())
    same = level.replace(name="x", description="y", tags=("z",), solution=None, next_id=99)
    assert level_hash(same) == level_hash(level)
    assert level_hash(level.replace(max_timesteps=9)) != level_hash(level)
    named = level.replace(bodies=tuple(b.replace(name=f"B{b.id}") for b in level.bodies))
    assert level_hash(named) == level_hash(level)


def test_names_are_saved_and_without_them_the_file_is_of_version_1(tmp_path):
    text = (FIXTURES / "v1" / "cart_and_bell.json").read_text()
    level = loads(text)
    first, joint = level.bodies[0], level.joints[0]
    named = level.replace(
        bodies=(first.replace(name="Wagen 車"), *level.bodies[1:]),
        joints=(joint.replace(name="Rear axle"), *level.joints[1:]),
    )
    save_level(named, tmp_path / "named.json")
    saved = (tmp_path / "named.json").read_text()
    assert '"version": 2' in saved
    assert f'"id": {first.id},\n      "name": "Wagen 車",\n' in saved
    assert load_level(tmp_path / "named.json") == named
    assert dumps(named.unnamed()) == text
    assert level.unnamed() is level


@pytest.mark.parametrize("name", ['""', "null", "3", f'"{"x" * 61}"'])
def test_bad_names_are_refused(name):
    text = change(EVERYTHING, '"version": 1', '"version": 2')
    text = change(text, '"id": 3,', f'"id": 3, "name": {name},')
    with pytest.raises(LevelError, match=r"\$\.bodies\[0\]\.name"):
        loads(text)


def test_a_file_of_version_1_has_no_names():
    text = change(EVERYTHING, '"id": 3,', '"id": 3, "name": "Wedge",')
    with pytest.raises(LevelError, match=r"\$\.version: names .* version 2, this file says 1"):
        loads(text)


def test_kinetix_env_has_no_place_for_names(tmp_path):
    level = loads((FIXTURES / "v1" / "cart_and_bell.json").read_text())
    level = level.replace(
        thrusters=(), solution=None, tags=(), description="", name="b", inertia_model="kinetix"
    )
    named = level.replace(bodies=tuple(b.replace(name="Box") for b in level.bodies))
    lost = save_level(named, tmp_path / "b.json", format="kinetix-env")
    assert lost == ("names of shapes, joints and thrusters",)


def test_the_hash_does_not_see_ids():
    def level(a, b, c, d):
        return Level(
            name="x",
            bodies=(
                Body(id=a, shape=Circle(radius=1), position=(0, 0)),
                Body(id=b, shape=Circle(radius=2), position=(0, 0)),
            ),
            joints=(Joint(id=c, kind="fixed", a=a, b=b, anchor_a=(0, 0), anchor_b=(0, 0)),),
            thrusters=(Thruster(id=d, body=b, position=(0, 0)),),
        )

    assert level_hash(level(1, 2, 3, 4)) == level_hash(level(40, 7, 2, 9))
    swapped = level(1, 2, 3, 4)
    other = swapped.replace(joints=(swapped.joints[0].replace(a=2, b=1),))
    assert level_hash(other) != level_hash(swapped)


def test_names_of_files(tmp_path, monkeypatch):
    bundled = tmp_path / "bundled"
    (bundled / "s").mkdir(parents=True)
    (bundled / "s" / "cart.json").write_text(EVERYTHING)
    monkeypatch.setattr("kinetix.bundled.levels_dir", lambda: bundled)
    monkeypatch.chdir(tmp_path)
    for name in ("s/cart", "s/cart.json", "s/cart.permute3.json", "s/cart.permute12"):
        assert resolve_path(name) == bundled / "s" / "cart.json"
    for name in ("c.permute1", "d", "d.permute1"):
        (tmp_path / f"{name}.json").write_text(EVERYTHING)
    (tmp_path / "a.permute2").mkdir()
    (tmp_path / "a.permute2" / "e.json").write_text(EVERYTHING)
    files = {
        "c.permute1": "c.permute1",
        "d.permute1": "d.permute1",
        "d.permute2": "d",
        "a.permute2/e": "a.permute2/e",
    }
    for name, file in files.items():
        assert resolve_path(name) == resolve_path(f"{name}.json") == Path(f"{file}.json")
    assert permutation_of("d.permute1") is None and permutation_of("a.permute2/e") is None
    assert permutation_of("d.permute2.json") == 2
    for name in ("./s/cart", "s/none", str(tmp_path / "s" / "cart")):
        with pytest.raises(LevelError, match="no such file"):
            resolve_path(name)
    with pytest.raises(LevelError, match="got a folder"):
        resolve_path(bundled)
    for nowhere in (".", "..", "/"):
        with pytest.raises(LevelError, match="got a folder"):
            resolve_path(nowhere)
    with pytest.raises(LevelError, match="got an empty word"):
        resolve_path("")
    (tmp_path / "s").mkdir()
    (tmp_path / "s" / "cart.json").write_text(EVERYTHING)
    assert resolve_path("s/cart") == Path("s/cart.json")


def test_saving_and_loading_both_formats(tmp_path):
    level = loads((FIXTURES / "v1" / "cart_and_bell.json").read_text())
    assert save_level(level, tmp_path / "a.json") == ()
    assert load_document(tmp_path / "a.json").format == "kinetix-level"
    assert load_level(tmp_path / "a.json") == level
    lost = save_level(level, tmp_path / "b.json", "kinetix-env")
    rule = "how masses follow from shapes (they stay as numbers)"
    assert lost == ("name", "description", "tags", "solution", rule)
    loaded = load_document(tmp_path / "b.json")
    assert loaded.format == "kinetix-env"
    assert loaded.path == tmp_path / "b.json"
    with pytest.raises(LevelError, match="'kinetix-level' or 'kinetix-env'"):
        dumps(level, format="tiled")


@pytest.mark.parametrize("form", ["kinetix-level", "kinetix-env"])
def test_what_json_cannot_say_is_not_written(form, tmp_path):
    level = loads(EVERYTHING)
    bad = level.replace(bodies=(level.bodies[0].replace(angle=math.nan), *level.bodies[1:]))
    with pytest.raises(LevelError, match=r"cannot be written: \$\.bodies\[0\]\.angle"):
        save_level(bad, tmp_path / "x.json", format=form)
    with pytest.raises(LevelError, match=r"cannot be written: \$\.name"):
        save_level(level.replace(name="\ud800"), tmp_path / "x.json", format=form)
    assert not list(tmp_path.iterdir())
    assert level_hash(bad) != level_hash(level)


def test_reading_checking_and_saving_need_no_jax(tmp_path):
    script = """
import sys
from kinetix.level.codec import load_document, save_level
from kinetix.level.sets import build_set
from kinetix.level.sets import gather_levels, save_set
from kinetix.level.validate import validate
for path in sys.argv[2:]:
    validate(load_document(path).level)
    save_level(load_document(path).level, sys.argv[1] + "/x.json", format="kinetix-env")
save_set(build_set(gather_levels(sys.argv[3:]), name="x", folder=__import__("pathlib").Path("/")),
         sys.argv[1] + "/set.json")
assert not {"jax", "flax"} & set(sys.modules), "jax was loaded"
"""
    cart = str(FIXTURES / "v1" / "cart_and_bell.json")
    peer = str(FIXTURES / "kinetix_env" / "gaps.json")
    subprocess.run([sys.executable, "-c", script, str(tmp_path), cart, peer], check=True)


def test_an_off_centre_polygon_is_told_what_it_should_be():
    square = Polygon(vertices=((1.0, 1.0), (0.0, 1.0), (0.0, 0.0), (1.0, 0.0)))
    level = Level(name="x", bodies=(Body(id=1, shape=square, position=(1, 1), angle=math.pi / 2),))
    with pytest.raises(LevelError, match=r"position \[0\.5, 1\.5\] and vertices \[\[0\.5, 0\.5\]"):
        loads(dumps(level))
    loads(dumps(level.replace(bodies=(level.bodies[0].replace(fixed=True),))))


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"max_timesteps": 0}, "max_timesteps"),
        ({"gravity": (0, 0, 1)}, "gravity"),
        ({"size": "xl"}, "size"),
        ({"tags": ("My Tag",)}, r"tags\[0\]"),
        ({"gravity": (math.nan, 0.0)}, r"gravity\[0\]"),
    ],
)
def test_a_level_that_no_reader_takes_is_not_written_over_a_good_one(tmp_path, changes, path):
    level = load_level("s/goalkeeper")
    file = tmp_path / "mine.json"
    save_level(level, file)
    for wrong in (level.replace(**changes), level.replace(bodies=(*level.bodies, level.bodies[0]))):
        with pytest.raises(LevelError, match=rf"cannot be written: \$\.({path}|bodies)"):
            save_level(wrong, file)
    assert load_level(file) == level


def test_numbers_of_numpy_are_written_as_numbers(tmp_path):
    level = load_level("s/goalkeeper").replace(max_timesteps=np.int64(50))
    save_level(level, tmp_path / "mine.json")
    assert load_level(tmp_path / "mine.json").max_timesteps == 50


def test_what_is_no_name_of_a_file_is_told_as_what_it_is():
    with pytest.raises(LevelError, match="a level already"):
        load_level(load_level("s/first_flight"))
    with pytest.raises(LevelError, match="expected a path or a name, got int"):
        load_level(3)


def test_a_level_and_its_path_in_the_wrong_order_are_told_so(tmp_path):
    with pytest.raises(LevelError, match=r"the order is save_level\(level, path\)"):
        save_level(tmp_path / "x.json", Level(name="x"))


@pytest.mark.parametrize("changes", [{"bodies": None}, {"joints": ({},)}])
def test_parts_of_a_level_that_are_none_are_named(changes, tmp_path):
    (kind,) = changes
    with pytest.raises(LevelError, match=rf"\$\.{kind}: expected a sequence of Kinetix's"):
        save_level(Level(name="x").replace(**changes), tmp_path / "x.json")


def test_a_number_where_a_vector_belongs_is_named():
    with pytest.raises(LevelError, match=r"Level\.gravity: expected a sequence, got 9\.8"):
        Level(name="x", gravity=9.8)
