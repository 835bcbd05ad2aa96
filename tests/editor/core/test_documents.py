"""Documents: previews, commits, dirty, ids; and undo and redo over any sequence of commands."""

import dataclasses
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from editor.documents.commands.bodies import AddBody
from editor.documents.commands.clip import Paste, copied
from editor.documents.commands.fields import SetField, SetLevelField
from editor.documents.commands.group import Mirror, Move, Remove, Reorder, Rotate, Scale, Stretch
from editor.documents.commands.joints import AddJoint
from editor.documents.commands.level import Permute, ReplaceLevel
from editor.documents.commands.thrusters import AddThruster
from editor.documents.document import Document, same_content
from kinetix.errors import CommandError
from kinetix.level.model import Body, Circle, Level, MassProperties, Polygon, Solution
from tests.editor.core.helpers import SQUARE, a_level

DISC = Body(id=1, shape=Circle(radius=0.2), position=(1.0, 1.0))
SOLVED = Solution(physics="balanced", frame_skip=2, actions=((10, (1, 0, 0, 0, 0, 0)),))


def test_a_preview_applies_to_the_committed_level_each_time():
    document = Document(a_level())
    for _ in range(5):
        document.preview(Move(ids=(3,), shift=(0.1, 0.0)))
    assert document.shown.body(3).position == pytest.approx((4.1, 3.0))
    assert document.level.body(3).position == pytest.approx((4.0, 3.0))
    document.discard_preview()
    assert document.shown == a_level()


def test_what_changes_nothing_makes_no_entry():
    document = Document(a_level())
    assert not document.commit(Move(ids=(3,), shift=(0.0, 0.0))).changed
    assert not document.commit(SetField(ids=(3,), field="role", value="green")).changed
    assert len(document.history.entries) == 1
    assert not document.dirty


def test_a_command_that_fails_leaves_the_document_alone():
    document = Document(a_level())
    with pytest.raises(CommandError):
        document.commit(SetField(ids=(3,), field="density", value=-1.0))
    with pytest.raises(CommandError):
        document.preview(SetField(ids=(3,), field="no_such", value=1))
    assert document.level == a_level()
    assert len(document.history.entries) == 1


def test_undoing_to_the_saved_state_is_clean():
    document = Document(a_level())
    document.commit(Move(ids=(3,), shift=(0.1, 0.0)))
    document.mark_saved()
    assert not document.dirty
    document.commit(Move(ids=(3,), shift=(0.1, 0.0)), time=5.0)
    assert document.dirty
    document.undo()
    assert not document.dirty
    document.undo()
    assert document.dirty
    document.redo()
    assert not document.dirty


def test_ids_are_never_given_twice_not_even_after_undo():
    document = Document(Level(name="x"))
    document.commit(AddBody(body=DISC))
    document.undo()
    outcome = document.commit(AddBody(body=DISC))
    assert outcome.created == (2,)
    document.commit(Remove(ids=(2,)))
    assert document.commit(AddBody(body=DISC)).created == (3,)
    assert document.level.next_id == 4


def test_the_id_counter_does_not_make_a_document_dirty():
    document = Document(Level(name="x"))
    before = document.hash
    document.commit(AddBody(body=DISC))
    document.undo()
    assert document.level.next_id == 2
    assert not document.dirty
    assert document.hash == before


def test_undo_restores_the_selection():
    document = Document(a_level())
    document.selection = (1, 3)
    document.commit(Remove(ids=(1, 3)))
    assert document.selection == ()
    document.undo()
    assert document.selection == (1, 3)


def test_what_does_not_exist_cannot_be_selected():
    document = Document(a_level())
    document.selection = (3, 99, "floor", 3)
    assert document.selection == (3, "floor")


def test_another_level_in_its_place_says_that_the_solution_is_dropped():
    document = Document(a_level().replace(solution=SOLVED))
    other = a_level().replace(thrusters=())
    (notice,) = document.commit(ReplaceLevel(level=other, label="Mutate")).notices
    assert "solution" in notice
    document.undo()
    assert document.level.solution == SOLVED
    alone = document.level.replace(solution=None)
    assert not document.commit(ReplaceLevel(level=alone, label="Forget it")).notices


def test_a_change_drops_the_recorded_solution_and_says_so():
    document = Document(a_level().replace(solution=SOLVED))
    assert document.commit(SetLevelField(field="name", value="Other")).notices == ()
    assert document.level.solution == SOLVED
    (notice,) = document.commit(Move(ids=(3,), shift=(0.1, 0.0))).notices
    assert "solution" in notice
    assert document.level.solution is None
    document.undo()
    assert document.level.solution == SOLVED


def test_imported_mass_properties_go_with_shape_and_density():
    held = a_level().bodies[2].replace(mass_properties=MassProperties(mass=1.0, inertia=0.5))
    level = a_level().replace(bodies=(held,), joints=(), thrusters=())
    document = Document(level)
    assert document.commit(SetField(ids=(3,), field="friction", value=0.5)).notices == ()
    assert document.level.body(3).mass_properties is not None
    (notice,) = document.commit(SetField(ids=(3,), field="density", value=0.5)).notices
    assert "mass properties" in notice
    assert document.level.body(3).mass_properties is None


def test_a_freed_body_is_recentred_with_the_rotated_shift():
    shape = Polygon(vertices=((1.0, 0.2), (0.0, 0.2), (0.0, 0.0), (1.0, 0.0)))
    fixed = Body(id=1, shape=shape, position=(2.0, 2.0), angle=math.pi / 2, fixed=True)
    document = Document(Level(name="x", bodies=(fixed,)))
    document.commit(AddThruster(body=1, point=(1.9, 2.5), direction=0.0))
    document.commit(SetField(ids=(1,), field="fixed", value=False))
    body = document.level.body(1)
    assert body.position == pytest.approx((1.9, 2.5), abs=1e-5)
    assert body.shape.vertices[0] == pytest.approx((0.5, 0.1), abs=1e-5)
    assert document.level.thrusters[0].position == pytest.approx((0.0, 0.0), abs=1e-5)


def test_problems_follow_every_change():
    document = Document(a_level())
    assert "E101" not in {issue.code for issue in document.problems}
    document.commit(SetField(ids=(3,), field="role", value="none"))
    assert "E101" in {issue.code for issue in document.problems}
    document.undo()
    assert "E101" not in {issue.code for issue in document.problems}


@dataclasses.dataclass(frozen=True)
class Broken:
    label: str = "Broken"
    merge_key: None = None

    def apply(self, level):
        raise CommandError("This never works.")


def command_of(level, kind, a, b, c):
    """A command on this level from a number and three shares of one."""
    bodies = [body.id for body in level.bodies] or [1]
    ids = tuple({bodies[int(x * (len(bodies) - 1))] for x in (a, b)})
    one, other = bodies[int(a * (len(bodies) - 1))], [*bodies, "floor"][int(b * len(bodies))]
    everything = [entity.id for entity in level.entities()] or [1]
    point = (5 * a, 5 * b)
    makers = (
        lambda: AddBody(body=DISC.replace(position=point)),
        lambda: AddBody(body=DISC.replace(shape=SQUARE, position=point)),
        lambda: Move(ids=ids, shift=(b - 0.5, c - 0.5)),
        lambda: Rotate(ids=ids, angle=8 * c - 4),
        lambda: Scale(ids=ids, factor=0.5 + c, pivot=point),
        lambda: Stretch(body=one, factors=(0.5 + b, 0.5 + c)),
        lambda: Mirror(ids=ids, axis="x" if c < 0.5 else "y"),
        lambda: Reorder(ids=ids, step=1 if c < 0.5 else -1),
        lambda: Remove(ids=(everything[int(c * (len(everything) - 1))],)),
        lambda: AddJoint(bodies=(one, other), point=point, kind="revolute" if c < 0.5 else "fixed"),
        lambda: AddThruster(body=one, point=point, direction=c),
        lambda: SetField(ids=ids, field="density", value=0.1 + 5 * c),
        lambda: SetField(ids=ids, field="fixed", value=c < 0.5),
        lambda: Paste(clip=copied(level, ids), shift=(0.1, 0.1)),
        lambda: Permute(seed=int(99 * c)),
        lambda: ReplaceLevel(level=a_level(), label="Replace"),
        Broken,
    )
    return makers[kind % len(makers)]()


SHARE = st.floats(0, 1)


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 16), SHARE, SHARE, SHARE), min_size=1, max_size=200),
    st.integers(1, 5),
)
def test_undoing_everything_gives_the_first_level_and_redoing_everything_the_last(rows, repeats):
    document = Document(a_level())
    first, entries = document.hash, 1
    for second, row in enumerate((rows * repeats)[:200]):
        before, count = document.level, len(document.history.entries)
        try:
            outcome = document.commit(command_of(document.level, *row), time=float(second))
        except CommandError:
            assert document.level == before
            assert len(document.history.entries) == count
            continue
        entries += outcome.changed
        assert len(document.history.entries) == entries
        if len(document.level.bodies) > 12:
            document.commit(Remove(ids=tuple(b.id for b in document.level.bodies[6:])))
            entries += 1
    last, last_level = document.hash, document.level
    while document.undo() is not None:
        pass
    assert document.hash == first
    assert same_content(document.level, a_level())
    while document.redo() is not None:
        pass
    assert document.hash == last
    assert document.level == last_level
    ids = [entity.id for entity in document.level.entities()]
    assert len(ids) == len(set(ids))
    assert document.level.next_id > max(ids, default=0)


def test_steps_there_and_back_at_once_leave_nothing_to_undo():
    document = Document(a_level())
    document.commit(Move(ids=(3,), shift=(0.1, 0.0)), time=0.0)
    for number, role in enumerate(("green", "blue", "none")):
        document.commit(SetField(ids=(1,), field="role", value=role), time=5.0 + number / 10)
    assert document.history.undo_label == "Move shape"
    assert document.history.redo_label is None
    document.undo()
    assert document.level.bodies == a_level().bodies
