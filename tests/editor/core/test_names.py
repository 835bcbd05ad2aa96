"""Names that the user gives belong to the level; those of earlier versions are taken over."""

import json

import numpy as np
import pytest

from editor.actions import run
from editor.actions.files import file, recover
from editor.base.controls import channel_name
from editor.base.prompts import Question, TextQuestion
from editor.documents import recovery
from editor.documents.autosaves import Autosaves
from editor.documents.commands import clip
from editor.documents.commands.fields import SetField
from editor.documents.commands.group import Move
from editor.documents.commands.level import ReplaceLevel
from editor.documents.document import Document
from editor.documents.old_names import OldNames
from editor.play.trace_files import read_trace, write_trace
from editor.session import Session
from editor.worker.snapshots import Trace
from kinetix.level.codec import load_level, save_level
from kinetix.level.validate import validate
from tests.editor.core.helpers import FakeSimulator, a_level, a_session


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "cart.json"
    save_level(a_level(), path)
    return path


def rename(session, entity, name):
    session.selection = (entity,)
    assert run(session, "edit.rename")
    prompt = session.prompts[-1]
    assert isinstance(prompt, TextQuestion)
    session.answer(prompt, name)


def stored(names):
    """Leave names as an earlier version did."""
    path = OldNames().path
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(names))
    return path


def test_a_name_is_an_edit_that_undo_takes_back_and_saving_keeps(session, path):
    assert file.open_path(session, path)
    rename(session, 1, "  Chassis ")
    assert session.document.name_of(1) == "Chassis"
    assert session.document.name_of(2) == "Circle 2"
    assert session.document.dirty
    assert run(session, "edit.undo")
    assert session.document.name_of(1) == "Rectangle 1"
    assert not session.document.dirty
    assert run(session, "edit.redo")
    assert run(session, "file.save")
    assert load_level(path).body(1).name == "Chassis"
    again = a_session()
    assert file.open_path(again, path)
    assert again.document.name_of(1) == "Chassis"
    assert not again.document.dirty


def test_a_name_goes_to_the_level_that_it_was_asked_for(session):
    session.document.commit(ReplaceLevel(level=a_level(), label="Start"))
    asked = session.document
    session.selection = (1,)
    run(session, "edit.rename")
    session.open_tab(Document(a_level()))
    session.answer(session.prompts[-1], "Crane")
    assert asked.level.entity(1).name == "Crane"
    assert session.document.level == a_level()


@pytest.mark.parametrize("nothing", ["Joint 5", "", "   "])
def test_its_plain_name_or_nothing_takes_a_name_away(session, path, nothing):
    file.open_path(session, path)
    rename(session, 5, "Rear axle")
    session.time += 5.0
    rename(session, 5, nothing)
    assert session.document.history.undo_label == "Name → Joint 5"
    assert session.document.level.entity(5).name is None
    assert not session.document.dirty


def test_a_name_keeps_the_recorded_solution_and_the_hash(session):
    level = load_level("s/first_flight")
    assert level.solution is not None
    session.document.commit(ReplaceLevel(level=level, label="Start"))
    before = session.document.hash
    rename(session, level.bodies[0].id, "Lander")
    assert session.document.level.solution is not None
    assert session.document.hash == before


def test_names_of_an_earlier_version_are_taken_over_and_its_file_goes(session, path, tmp_path):
    other = tmp_path / "other.json"
    save_level(a_level(), other)
    kept = stored(
        {str(path): {"1": "Chassis", "6": "Lift", "77": "Nobody"}, str(other): {"3": "Ball"}}
    )
    assert file.open_path(session, path)
    assert session.document.name_of(1) == "Chassis"
    assert session.document.name_of(6) == "Lift"
    assert not session.document.dirty  # nothing asks to be saved for what was only taken over
    assert str(path) in kept.read_text()  # and nothing is lost before it is saved
    assert run(session, "file.save")
    assert load_level(path).entity(6).name == "Lift"
    assert list(json.loads(kept.read_text())) == [str(other)]
    file.open_path(session, other)
    assert run(session, "file.save")
    assert not kept.exists()
    again = a_session()
    file.open_path(again, other)
    assert again.document.name_of(3) == "Ball"


def test_a_name_of_the_level_is_not_replaced_by_an_older_one(session, path):
    save_level(
        a_level().replace(bodies=(a_level().bodies[0].replace(name="New"), *a_level().bodies[1:])),
        path,
    )
    stored({str(path): {"1": "Old", "2": "Wheel"}})
    file.open_path(session, path)
    assert session.document.name_of(1) == "New"
    assert session.document.name_of(2) == "Wheel"


def test_work_that_an_earlier_version_left_unsaved_gets_its_names(session, path):
    earlier = Session(autosaves=Autosaves())
    file.open_path(earlier, path)
    earlier.execute(Move(ids=(1,), shift=(0.1, 0.0)))
    earlier.save_aside()
    earlier.autosaves.end()
    stored({str(path): {"1": "Chassis"}})
    (found,) = recovery.find().recoveries
    recover.restore(session, found)
    assert session.document.name_of(1) == "Chassis"
    assert session.document.dirty


def test_a_format_without_names_asks_before_it_drops_them(session, path):
    target = path.with_name("Test.json")
    save_level(a_level(), target, format="kinetix-env")
    file.open_path(session, target)
    rename(session, session.document.level.bodies[0].id, "Chassis")
    run(session, "file.save")
    question = session.prompts[-1]
    assert isinstance(question, Question)
    assert "names of shapes, joints and thrusters" in question.message


def test_copies_have_names_with_a_number(session):
    session.document.commit(ReplaceLevel(level=a_level(), label="Start"))
    rename(session, 2, "Wheel")
    session.selection = (2,)
    assert run(session, "edit.duplicate")
    assert [b.name for b in session.document.level.bodies if b.name] == ["Wheel", "Wheel 2"]
    copied = clip.copied(session.document.level, (2,))
    assert clip.loads(clip.dumps(copied)) == copied


def test_problems_and_controls_use_the_names():
    level = a_level()
    shifted = level.bodies[2].replace(position=(9.0, 1.0), name="Ball")
    named = level.replace(
        bodies=(*level.bodies[:2], shifted, level.bodies[3]),
        joints=(level.joints[0].replace(name="Rear axle"),),
    )
    messages = [issue.message for issue in validate(named)]
    assert "Ball lies outside the arena." in messages
    assert channel_name(named, 0) == "Rear axle"
    assert channel_name(named, 4) == "thruster 0"


def test_an_exported_episode_says_what_its_columns_are_called(tmp_path):
    level = a_level().replace(joints=(a_level().joints[0].replace(name="Rear axle"),))
    simulator = FakeSimulator()
    simulator.start(level, "balanced")
    simulator.advance([(1, 0, 0, 0, 0, 0)])
    trace = Trace(
        physics="balanced",
        perturbed=False,
        snapshots=tuple(simulator.take()),
        actions=((1, 0, 0, 0, 0, 0),),
        player="You",
    )
    write_trace(trace, level, tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as arrays:
        assert arrays["joint_names"].tolist() == ["Rear axle"]
        assert arrays["body_names"].tolist()[2] == "Green circle 3"
    assert read_trace(tmp_path / "a.npz").level == level


def test_arena_parts_and_several_things_have_no_name_to_change(session, path):
    file.open_path(session, path)
    for selection in ((), (1, 2), ("floor",)):
        session.selection = selection
        assert not run(session, "edit.rename")


def test_a_name_that_no_file_could_hold_is_refused(session):
    session.document.commit(ReplaceLevel(level=a_level(), label="Start"))
    for name in ("", "x" * 61, 3):
        session.execute(SetField(ids=(1,), field="name", value=name))
    assert session.document.level.unnamed() is session.document.level


@pytest.mark.parametrize("text", ["", "[]", '{"a": 1}', '{"a": {"x": "y", "3": 4}}'])
def test_a_broken_file_of_names_is_passed_over(tmp_path, text):
    path = tmp_path / "names.json"
    path.write_text(text)
    assert OldNames(path).of(tmp_path / "a") == {}


def test_scripted_runs_see_no_names(tmp_path):
    path = tmp_path / "names.json"
    path.write_text(json.dumps({str(tmp_path / "a"): {"1": "One"}}))
    assert OldNames(path).of(tmp_path / "a") == {1: "One"}
    assert OldNames(path, stored=False).of(tmp_path / "a") == {}
