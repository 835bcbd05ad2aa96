"""The table of actions, its keys, and what the session does with them."""

import collections
import itertools
import math
import re

import pytest

from editor import actions
from editor.actions import ACTIONS, BY_ID, Context
from editor.actions.editing.fixes import fix_of
from editor.actions.files import examples
from editor.base.events import DropEvent, FocusEvent, PadEvent, QuitEvent
from editor.documents.commands import clip
from editor.documents.commands.fields import SetField, SetLevelField
from editor.documents.document import Document
from editor.editing.picking import handles
from editor.play.mode import Mode
from kinetix.errors import CommandError
from kinetix.level.codec import dumps, save_level
from kinetix.level.model import Body, Circle, Level, Limits, Polygon
from kinetix.paths import config_dir, levels_dir
from kinetix.scenes import SCENE_CLASSES
from kinetix.version import __version__
from tests.editor.core.helpers import SQUARE, Hand, a_level, a_session, texts

EXPECTED = re.findall(
    r"\S+",
    """
file.new file.open file.save file.save_as file.close_tab file.quit file.export file.screenshot
file.record edit.undo edit.redo edit.cut edit.copy edit.paste edit.paste_properties edit.duplicate
edit.select_all edit.delete edit.cancel edit.lock edit.hide edit.mirror_horizontal
edit.mirror_vertical edit.align_left edit.align_centre_x edit.align_right edit.align_top
edit.align_centre_y edit.align_bottom edit.distribute_x edit.distribute_y edit.forward edit.back
tool.select tool.rectangle tool.circle tool.triangle tool.joint tool.weld tool.thruster
transform.nudge_left transform.nudge_right transform.nudge_up transform.nudge_down
transform.rotate_ccw transform.rotate_cw transform.rotate_ccw_45 transform.rotate_cw_45
snap.smart snap.grid view.grid view.frame_selection view.fit view.actual_size view.toggle_ui
view.fullscreen view.debug_draw view.plots run.play_human run.pause run.step run.step_back
run.slower run.faster run.reset run.stop run.edit_from_here level.random level.mutate
level.mutate_menu level.permute level.previous level.next app.palette app.help
""",
)


def test_every_specified_action_is_there():
    assert set(EXPECTED) <= set(BY_ID)
    assert len(BY_ID) == len(ACTIONS)


def test_what_belongs_together_stands_together_and_quit_is_last():
    menus = {action.menu: [] for action in ACTIONS}
    for action in ACTIONS:
        menus[action.menu].append(action)
    for rows in menus.values():
        groups = [group for group, _ in itertools.groupby(row.group for row in rows) if group]
        assert len(groups) == len(set(groups)) and 1 <= len(groups) < 10
    assert menus["File"][-1].id == "file.quit"


def test_the_app_tells_its_version_and_where_it_keeps_what(session):
    assert actions.run(session, "app.about")
    (about,) = session.prompts
    assert __version__ in about.message and str(config_dir()) in about.message
    session.answer(about, "copy")
    assert session.clipboard.get() == about.message
    assert actions.run(session, "app.documents")
    (documents,) = session.prompts
    assert documents.message.endswith("index.md")


@pytest.mark.parametrize(
    ("key", "mods", "closer"),
    [
        ("=", {}, True),
        ("=", {"shift": True}, True),
        ("]", {}, True),
        ("[+]", {}, True),
        ("-", {}, False),
        ("[-]", {}, False),
    ],
)
def test_keys_zoom_where_the_pointer_is_or_in_the_middle(session, hand, key, mods, closer):
    before = session.camera
    hand.key(key, ctrl=True, **mods)
    assert (session.camera.zoom > before.zoom) == closer != (session.camera.zoom < before.zoom)
    assert session.camera.centre == pytest.approx(before.centre)
    hand.move((1.0, 1.0))
    there = session.camera.to_screen((1.0, 1.0))
    hand.key(key, ctrl=True, **mods)
    assert session.camera.to_screen((1.0, 1.0)) == pytest.approx(there)
    assert session.camera.centre != pytest.approx(before.centre)


def test_no_chord_means_two_things():
    for context in (Context.EDIT, Context.PLAY, Context.GALLERY):
        used = collections.Counter(
            chord
            for action in ACTIONS
            if action.context in (context, Context.GLOBAL)
            or (action.context is Context.LEVEL and context is not Context.GALLERY)
            for chord in (*action.keys, *action.variants)
        )
        assert [chord for chord, count in used.items() if count > 1] == []


def test_play_leaves_its_own_keys_alone(session):
    here = (Context.PLAY, Context.LEVEL, Context.GLOBAL)
    play = {k for a in ACTIONS if a.context in here for k in a.keys}
    assert not play & set(session.control_keys)


def test_every_action_has_words():
    for action in ACTIONS:
        assert action.label and action.menu
        assert re.fullmatch(r"[a-z]+\.[a-z_0-9]+", action.id)


@pytest.mark.parametrize("playing", [False, True])
@pytest.mark.parametrize("action_id", [a.id for a in ACTIONS])
def test_every_action_runs_or_is_disabled(action_id, playing):
    session = a_session()
    session.worker.submit = lambda *args, **kwargs: None
    session.selection = (1, 2, 3)
    if playing:
        actions.run(session, "run.play_human")
        actions.update(session, 0.1)
    actions.run(session, action_id)
    actions.update(session, 0.01)
    assert "Something went wrong" not in " ".join(texts(session))


def test_a_nudge_of_what_is_locked_says_so(session, hand):
    session.selection = (3,)
    actions.run(session, "edit.lock")
    hand.key("left")
    assert "What is selected is locked: unlock it first." in texts(session)


@pytest.mark.parametrize(
    "action",
    [
        "edit.delete",
        "edit.cut",
        "edit.mirror_horizontal",
        "transform.rotate_ccw",
        "edit.align_left",
    ],
)
def test_what_is_locked_stays_where_it_is(session, action):
    before = session.document.level
    session.selection = (2, 3)
    actions.run(session, "edit.lock")
    assert not handles(before, session.document.unlocked, session.metres)
    actions.run(session, action)
    assert session.document.level == before
    assert texts(session)[-1] == "What is selected is locked: unlock it first."


def test_what_is_locked_is_not_cut(session):
    session.document.locked = frozenset({1})
    session.selection = (1, 3)
    actions.run(session, "edit.cut")
    assert [body.id for body in session.document.level.bodies] == [1, 2, 4]
    assert [body.id for body in clip.loads(session.clipboard.get()).bodies] == [3]


def test_what_is_not_locked_is_changed_and_the_rest_is_told(session):
    session.selection = (3,)
    actions.run(session, "edit.lock")
    session.selection = (1, 3)
    kept = session.document.level.body(3)
    actions.run(session, "edit.mirror_horizontal")
    assert texts(session)[-1] == "1 locked thing stays as it is."
    actions.run(session, "edit.delete")
    assert [body.id for body in session.document.level.bodies if body.id in (1, 3)] == [3]
    assert session.document.level.body(3) == kept


def test_an_unknown_action_names_the_known_ones(session):
    with pytest.raises(CommandError, match=r"edit\.undo"):
        actions.run(session, "edit.undoo")


def test_keys_reach_their_actions(session, hand):
    hand.key("a", ctrl=True)
    assert len(session.selection) == 6
    hand.key("delete")
    assert list(session.document.level.entities()) == []
    assert "Deleted 4 shapes, 1 joint, 1 thruster" in texts(session)
    assert session.toasts[-1].action == "edit.undo"
    hand.key("z", ctrl=True)
    assert session.document.level == a_level()
    hand.key("y", ctrl=True)
    hand.key("z", ctrl=True)
    hand.key("z", ctrl=True, shift=True)
    assert session.document.level.bodies == ()


def test_rebound_keys_replace_the_default(session, hand):
    session.settings.keys["tool.circle"] = ["o"]
    hand.key("c")
    assert session.tool.id == "select"
    hand.key("o")
    assert session.tool.id == "circle"


def test_driving_keys_never_start_play(session, hand):
    for key in ("left", "right", "up", "down", "w", "a", "s", "d", "1", "2"):
        hand.key(key)
        assert session.mode is Mode.EDIT


@pytest.mark.parametrize("window", ["help", "keys", "preferences", "palette"])
def test_keys_and_buttons_leave_a_covered_level_alone(session, hand, window):
    session.selection = (1,)
    before = session.document.level
    setattr(session.view, window, True)
    for key in ("delete", "right", "space", "r", "f5", "f6"):
        hand.key(key)
    assert session.expected is None
    actions.handle(session, PadEvent(control="pad start", pressed=True))
    assert session.document.level is before
    assert (session.mode, session.selection, session.driver.active) == (Mode.EDIT, (1,), False)


def test_keys_of_a_covered_window_drive_nothing_and_work_everywhere_else(session, hand):
    actions.run(session, "run.play_human")
    session.view.preferences = True
    hand.down("left")
    actions.handle(session, PadEvent(control="pad a", pressed=True))
    hand.key("space")
    assert (session.action, session.mode) == ((0,) * 6, Mode.PLAYING)
    hand.key("f11")
    assert session.view.fullscreen
    hand.key("f1")
    session.view.help = session.view.preferences = False
    hand.down("left")
    assert session.action != (0,) * 6


def test_text_under_a_covering_window_is_no_size(session, hand):
    hand.key("r")
    hand.press((2.0, 2.0))
    assert session.driver.active
    session.view.help = True
    hand.type("7")
    hand.key("return")
    assert session.driver.active
    assert session.document.level.bodies == a_level().bodies


def test_playing_changes_nothing_in_the_document(session, hand):
    before = session.document.hash
    hand.key("space")
    hand.wait(0.1)
    assert session.mode is Mode.PLAYING
    hand.down("left")
    for _ in range(60):
        hand.wait()
    hand.up("left")
    assert session.playback.step_count > 20
    assert session.scene.body(3).position != session.document.level.body(3).position
    hand.key("delete")
    hand.key("r")
    hand.drag((2.0, 2.0), (3.0, 3.0))
    hand.key("escape")
    assert session.mode is Mode.EDIT
    assert session.document.hash == before
    assert len(session.document.history.entries) == 1
    assert session.scene == session.document.level


def test_a_message_offers_to_undo_what_it_tells_of_and_nothing_else(session):
    session.selection = (1,)
    actions.run(session, "edit.delete")
    actions.update(session, 0.1)
    assert session.toasts[-1].action == "edit.undo"
    first = session.tab
    session.open_tab(Document(a_level()))
    session.execute(SetField(ids=(1,), field="friction", value=0.9))
    actions.update(session, 0.1)
    assert session.toasts[-1].text.startswith("Deleted") and session.toasts[-1].action is None
    session.show_tab(session.tabs.index(first))
    actions.run(session, "edit.undo")
    session.selection = (1,)
    actions.run(session, "edit.delete")
    session.execute(SetField(ids=(2,), field="friction", value=0.9))
    actions.update(session, 0.1)
    assert session.toasts[-1].action is None


def test_undo_works_right_after_play(session, hand):
    session.selection = (3,)
    hand.key("delete")
    hand.key("space")
    hand.wait(0.5)
    hand.key("escape")
    hand.key("z", ctrl=True)
    assert session.document.level == a_level()


def test_held_keys_drive_until_the_window_loses_focus(session, hand):
    hand.key("space")
    hand.down("left")
    hand.down("1")
    assert session.action == (1, 0, 0, 0, 1, 0)
    hand.up("1")
    assert session.action == (1, 0, 0, 0, 0, 0)
    actions.handle(session, FocusEvent(focused=False))
    assert session.action == (0,) * 6


def test_edit_from_here_is_a_new_document(session, hand):
    before = session.document
    hand.key("space")
    for _ in range(30):
        hand.wait()
    row = [body.id for body in before.level.bodies].index(3)
    moved = tuple(session.playback.snapshot.position[row].tolist())
    actions.run(session, "run.edit_from_here")
    assert session.mode is Mode.EDIT
    assert session.document is not before
    assert session.document.dirty
    assert session.document.level.body(3).position == pytest.approx(moved)
    hand.key("z", ctrl=True)
    assert session.document.level.body(3).position == pytest.approx((4.0, 3.0))
    assert before.level == a_level()


def test_a_dragged_body_is_pulled_and_the_episode_marked(session, hand):
    hand.key("space")
    hand.wait(0.0)
    hand.press((4.0, 3.0))
    assert session.hands.pull.body == 3
    hand.hold((4.2, 3.0))
    hand.wait(0.1)
    assert session.playback.perturbed
    hand.release((4.2, 3.0))
    assert session.hands.pull is None


def test_ctrl_drag_while_paused_puts_a_body_elsewhere(session, hand):
    hand.key("space")
    hand.wait(0.0)
    hand.key("space")
    sent = []
    session.playback.simulator.advance = lambda actions, pull=None: sent.append(pull)
    hand.drag((4.0, 3.0), (3.0, 3.5), ctrl=True)
    (pull,) = sent
    assert pull.teleport
    assert pull.target == pytest.approx((3.0, 3.5))
    assert session.mode is Mode.PAUSED


def test_alignment_and_distribution(session):
    session.selection = (1, 2)
    actions.run(session, "edit.align_left")
    level = session.document.level
    lefts = [level.body(1).position[0] - 0.2, level.body(2).position[0] - 0.15]
    assert lefts == pytest.approx([1.8, 1.8], abs=1e-5)
    actions.run(session, "edit.undo")
    session.selection = (1,)
    actions.run(session, "edit.align_top")
    assert "Select at least 2 shapes." in texts(session)
    session.selection = (1, 2, 3)
    actions.run(session, "edit.distribute_y")
    assert "Select at least 3 shapes: jointed ones count as one." in texts(session)


def test_jointed_shapes_are_aligned_and_distributed_as_one(session):
    """The box with its wheel reaches from 1.8 to 2.35, between the blue circle and the green."""
    before = session.document.level
    for action, shift in (("align_right", 4.2 - 2.35), ("distribute_x", 2.5 - 2.075)):
        session.selection = (1, 2, 3, 4)
        actions.run(session, f"edit.{action}")
        level = session.document.level
        for body_id in (1, 2):
            x, y = before.body(body_id).position
            assert level.body(body_id).position == pytest.approx((x + shift, y), abs=1e-5)
        assert level.joints == before.joints
        actions.run(session, "edit.undo")


def test_distributed_gaps_are_equal():
    bodies = tuple(
        Body(id=k, shape=Circle(radius=r), position=(x, 2.0))
        for k, x, r in ((1, 0.5, 0.1), (2, 1.9, 0.3), (3, 2.6, 0.2), (4, 4.0, 0.4))
    )
    session = a_session(Level(name="x", bodies=bodies))
    session.selection = (1, 2, 3, 4)
    actions.run(session, "edit.distribute_x")
    placed = sorted(session.document.level.bodies, key=lambda b: b.position[0])
    gaps = [
        b.position[0] - b.shape.radius - a.position[0] - a.shape.radius
        for a, b in itertools.pairwise(placed)
    ]
    assert gaps == pytest.approx([gaps[0]] * 3, abs=1e-5)
    assert placed[0].position[0] == 0.5 and placed[-1].position[0] == 4.0


def test_cut_and_paste_at_the_pointer(session, hand):
    session.selection = (3,)
    hand.key("x", ctrl=True)
    assert len(session.document.level.bodies) == 3
    hand.move((1.5, 1.25))
    hand.key("v", ctrl=True)
    body = session.document.level.bodies[-1]
    assert body.position == pytest.approx((1.5, 1.25), abs=1e-5)
    assert body.role == "green"
    assert session.selection == (body.id,)


def test_what_is_pasted_twice_at_one_place_lies_beside_itself(session, hand):
    session.selection = (3,)
    actions.run(session, "edit.copy")
    hand.move((1.5, 1.25))
    for _ in range(3):
        actions.run(session, "edit.paste")
    places = [body.position for body in session.document.level.bodies[-3:]]
    assert len(set(places)) == 3
    assert places[0] == pytest.approx((1.5, 1.25), abs=1e-5)
    assert places[2] == pytest.approx((1.7, 1.45), abs=1e-5)


def test_the_text_of_a_level_file_is_pasted_as_a_level(session, hand):
    theirs = a_level().replace(name="From a chat")
    session.clipboard.set(f"\n{dumps(theirs)}")
    before = session.document
    hand.key("v", ctrl=True)
    assert session.document is not before
    assert session.document.level == theirs and session.document.path is None
    assert session.document.dirty  # the clipboard will hold something else
    session.clipboard.set(dumps(theirs)[:-40])
    hand.key("v", ctrl=True)
    assert "The level in the clipboard cannot be read." in texts(session)[-1]


def test_a_thruster_or_a_joint_alone_is_not_cut_as_it_could_not_be_pasted(session, hand):
    before = session.document.level
    for alone in ((5,), (6,), (5, 6)):
        session.selection = alone
        hand.key("x", ctrl=True)
        assert session.document.level == before
        assert "Only shapes can be cut" in texts(session)[-1]


def test_held_modifiers_are_switches_too(session, hand):
    actions.run(session, "transform.move_jointed")
    hand.drag((1.95, 2.0), (2.45, 2.5))
    assert session.document.level.body(2).position == pytest.approx((2.2, 2.0), abs=1e-5)
    actions.run(session, "tool.from_centre")
    actions.run(session, "tool.keep")
    hand.key("r")
    hand.drag((3.0, 1.0), (3.2, 1.1))
    body = session.document.level.bodies[-1]
    assert body.position == pytest.approx((3.0, 1.0), abs=1e-5)
    assert session.tool.id == "rectangle"


def test_an_episode_restarts_by_itself_when_asked(session, hand):
    session.playback.simulator.ends_at = 5
    actions.run(session, "run.restart_automatically")
    hand.key("space")
    for _ in range(30):
        hand.wait()
    assert session.mode is Mode.ENDED
    for _ in range(45):
        hand.wait()
    assert session.mode is Mode.PLAYING


def test_hidden_things_come_back(session, hand):
    session.selection = (3,)
    hand.key("h", ctrl=True)
    assert session.document.hidden == {3}
    hand.click((4.0, 3.0))
    assert session.selection == ()
    hand.key("h", ctrl=True)
    assert session.document.hidden == {3}
    hand.key("h", alt=True)
    assert session.document.hidden == frozenset()


def test_escape_goes_back_step_by_step(session, hand):
    session.selection = (3,)
    hand.key("c")
    hand.press((2.0, 2.0))
    hand.hold((2.5, 2.0))
    hand.key("escape")
    assert (session.driver.active, session.tool.id) == (False, "circle")
    hand.key("escape")
    assert session.tool.id == "select"
    hand.key("escape")
    assert session.selection == ()


class Bad:
    label = "Bad"
    merge_key = None

    def apply(self, level):
        raise RuntimeError("boom")


def test_an_exception_in_a_command_is_a_toast(session):
    session.queue(Bad())
    session.queue("edit.select_all")
    actions.update(session, 0.1)
    assert session.document.level == a_level()
    assert any("boom" in text for text in texts(session))
    assert len(session.selection) == 6


def test_toasts_go_by_themselves(session):
    session.toast("Hello")
    actions.update(session, 1.0)
    assert texts(session) == ["Hello"]
    actions.update(session, 10.0)
    assert texts(session) == []


def test_closing_with_changes_asks(session, hand, tmp_path):
    session.selection = (3,)
    hand.key("delete")
    actions.handle(session, QuitEvent())
    (prompt,) = session.prompts
    assert [c.label for c in prompt.choices] == ["Save", "Don't Save", "Cancel"]
    assert (prompt.default, prompt.cancel) == ("save", "cancel")
    session.answer(prompt, "cancel")
    assert not session.quitting
    actions.handle(session, QuitEvent())
    session.answer(session.prompts[-1], "save")
    (question,) = session.prompts
    assert question.purpose == "save"
    session.answer(question, tmp_path / "mine")
    assert (tmp_path / "mine.json").is_file()
    assert session.quitting


def test_closing_without_changes_asks_nothing(session):
    actions.handle(session, QuitEvent())
    assert session.quitting


def test_dont_save_quits(session, hand):
    session.selection = (3,)
    hand.key("delete")
    actions.handle(session, QuitEvent())
    session.answer(session.prompts[-1], "discard")
    assert session.quitting


def test_a_dropped_file_opens_in_a_tab(session, tmp_path):
    path = tmp_path / "level.json"
    save_level(a_level().replace(name="Dropped"), path)
    actions.handle(session, DropEvent(path=str(path)))
    assert [tab.document.title for tab in session.tabs] == ["Test", "level.json"]
    actions.handle(session, DropEvent(path=str(path)))
    assert len(session.tabs) == 2
    actions.handle(session, DropEvent(path=str(tmp_path / "none.json")))
    assert len(session.tabs) == 2
    assert "none.json" in session.prompts[-1].message


def test_the_next_level_of_the_folder(session, tmp_path):
    for name in ("a", "b", "c"):
        save_level(a_level().replace(name=name), tmp_path / f"{name}.json")
    actions.handle(session, DropEvent(path=str(tmp_path / "a.json")))
    actions.run(session, "level.next")
    assert session.document.title == "b.json"
    actions.run(session, "level.previous")
    actions.run(session, "level.previous")
    assert session.document.title == "c.json"


def test_saving_in_the_other_format_tells_what_is_lost(session, tmp_path):
    path = tmp_path / "theirs.json"
    save_level(a_level(), path, format="kinetix-env")
    actions.handle(session, DropEvent(path=str(path)))
    assert session.document.format == "kinetix-env"
    session.execute(SetLevelField(field="gravity", value=(0.0, -3.0)))
    actions.run(session, "file.save")
    (prompt,) = session.prompts
    assert "gravity" in prompt.message
    session.answer(prompt, "cancel")
    assert session.document.dirty
    actions.run(session, "file.save")
    session.answer(session.prompts[-1], "native")
    assert session.document.format == "kinetix-level"
    assert not session.document.dirty


ISSUES = {
    "E101": (a_level().replace(bodies=(a_level().bodies[3],), joints=(), thrusters=()), None),
    "E103": (
        a_level().replace(
            bodies=(*a_level().bodies, a_level().bodies[2].replace(id=20, position=(3.0, 1.0))),
            next_id=21,
        ),
        "Keep first",
    ),
    "E109": (a_level().replace(size="s"), "Switch to m"),
    "W205": (
        a_level().replace(joints=(a_level().joints[0].replace(limits=Limits(min=1.0, max=0.0)),)),
        "Swap limits",
    ),
    "W205 wide": (
        a_level().replace(joints=(a_level().joints[0].replace(limits=Limits(min=-4.0, max=4.0)),)),
        "Switch limits off",
    ),
    "E107 order": (
        a_level().replace(
            bodies=(
                a_level()
                .bodies[0]
                .replace(shape=Polygon(vertices=tuple(reversed(SQUARE.vertices))), id=1),
                *a_level().bodies[1:],
            )
        ),
        "Fix order",
    ),
    "E107 centre": (
        a_level().replace(
            bodies=(
                a_level()
                .bodies[0]
                .replace(shape=Polygon(vertices=tuple((x + 0.1, y) for x, y in SQUARE.vertices))),
                *a_level().bodies[1:],
            )
        ),
        "Recentre",
    ),
    "E108": (a_level().replace(bodies=a_level().bodies[1:], thrusters=()), "Delete"),
    "E108 thruster": (a_level().replace(bodies=a_level().bodies[1:], joints=()), "Delete"),
    "E110": (
        a_level().replace(thrusters=(a_level().thrusters[0].replace(binding=7),)),
        "Use binding 0",
    ),
    "W209": (
        a_level().replace(joints=(a_level().joints[0].replace(anchor_b=(0.05, 0.0)),)),
        "Re-anchor",
    ),
    "W207": (
        a_level().replace(
            bodies=tuple(body.replace(fixed=True) for body in a_level().bodies), joints=()
        ),
        "Delete",
    ),
    "W213": (
        a_level().replace(joints=(a_level().joints[0].replace(kind="fixed", reference_angle=0.5),)),
        "Hold as drawn",
    ),
    "W215": (
        a_level().replace(joints=(a_level().joints[0].replace(limits=Limits(min=1.0, max=2.0)),)),
        "Widen limits",
    ),
    "W217": (
        a_level().replace(
            joints=(
                *a_level().joints,
                a_level().joints[0].replace(id=50, kind="fixed", reference_angle=0.0),
            ),
            next_id=51,
        ),
        "Delete",
    ),
    "W215 turned": (
        a_level().replace(
            joints=(
                a_level()
                .joints[0]
                .replace(limits=Limits(min=-0.1, max=0.1), reference_angle=math.tau + 1),
            )
        ),
        "Widen limits",
    ),
}


@pytest.mark.parametrize("case", ISSUES)
def test_one_click_mends_a_problem(case):
    code, (level, label) = case[:4], ISSUES[case]
    session = a_session(level)
    issue = next(i for i in session.document.problems if i.code == code)
    fix = fix_of(session, issue)
    if label is None:
        assert fix is None
        free = next(b.id for b in level.bodies)
        session.selection = (free,)
        fix = fix_of(session, issue)
    assert fix is not None
    assert label is None or fix.label == label
    session.execute(fix.command)
    assert code not in {i.code for i in session.document.problems}
    actions.run(session, "edit.undo")
    assert code in {i.code for i in session.document.problems}


def test_the_record_of_the_state(session):
    session.selection = (3,)
    record = session.state_record()
    assert record | {"fps": 0, "level_hash": ""} == {
        "mode": "edit",
        "selection": [3],
        "dirty": False,
        "undo": None,
        "redo": None,
        "level_hash": "",
        "step": 0,
        "outcome": None,
        "fps": 0,
        "problems": [issue.code for issue in session.document.problems],
    }


@pytest.mark.peer
def test_selecting_everything_in_a_published_level_changes_nothing(peer, tmp_path):
    paths = sorted((peer / "levels").rglob("*.json"))
    assert len(paths) == 37
    for path in paths:
        session = a_session()
        hand = Hand(session)
        copy = tmp_path / path.name
        copy.write_bytes(path.read_bytes())
        actions.handle(session, DropEvent(path=str(copy)))
        for entity in session.document.level.entities():
            session.selection = (entity.id,)
            hand.wait()
        assert not session.document.dirty
        actions.run(session, "file.save")
        while session.prompts:
            session.answer(session.prompts[-1], "anyway")
        assert copy.read_bytes() == path.read_bytes()


def test_selecting_everything_in_a_bundled_level_changes_nothing(tmp_path):
    paths = [p for p in sorted(levels_dir().rglob("*.json")) if p.parent.name in ("s", "m", "l")]
    assert paths
    for path in paths:
        session = a_session()
        copy = tmp_path / path.name
        copy.write_bytes(path.read_bytes())
        actions.handle(session, DropEvent(path=str(copy)))
        for entity in session.document.level.entities():
            session.selection = (entity.id,)
        assert dumps(session.document.level) == path.read_text(encoding="utf-8")
        actions.run(session, "file.save")
        assert copy.read_bytes() == path.read_bytes()


def test_every_scene_of_the_suite_opens_as_a_clean_document(session):
    listed = [scene for group in SCENE_CLASSES for scene in examples.scenes(group)]
    assert len(listed) > 40
    for scene in listed:
        examples.open_scene(session, scene.id)
        assert session.document.level.bodies and not session.document.dirty
    assert len(session.tabs) == 1 + len(listed)


def test_a_scene_without_a_level_says_so(session):
    with session.guard():
        examples.open_scene(session, "Z9")
    assert "Z9" in session.toasts[-1].text and len(session.tabs) == 1
