"""The guided first level: each step is done by doing it, none is in anybody's way."""

import dataclasses

import pytest

from editor.actions import guide
from editor.base.settings import Settings, SettingsKeeper
from editor.documents.commands.fields import SetField
from editor.documents.commands.group import Move
from kinetix.paths import levels_dir
from tests.editor.core.helpers import a_session
from tests.editor.gui.windows import apart, rect


def card():
    return rect("###guide")


def arena(gui):
    return (*gui.screen(0.0, 5.0), *gui.screen(5.0, 0.0))


@pytest.fixture
def step(gui):
    return lambda: gui.session.settings.guide_step


def test_nobody_is_guided_who_has_not_asked(gui):
    assert not gui.shows("guide.next")
    assert gui.session.settings.guide_step == guide.CLOSED


def test_the_first_seven_steps_by_hand(gui, step):
    gui.session.queue("app.guide")
    gui.frames(4)
    assert step() == 0 and gui.shows("guide.next")
    gui.key("r")
    gui.drag((0.8, 1.0), (2.0, 1.4))
    assert step() == 1
    gui.key("c")
    gui.drag((0.9, 0.9), (1.1, 0.9))
    assert step() == 2
    gui.key("c")
    gui.drag((1.7, 0.9), (1.9, 0.9))
    assert step() == 3
    gui.key("j")
    gui.click_world(0.95, 1.02)
    assert step() == 4
    gui.key("j")
    gui.click_world(1.7, 1.02)
    assert step() == 5
    board = gui.level.bodies[0].id
    gui.session.queue(SetField(ids=(board,), field="role", value="green"))
    gui.frames(3)
    assert step() == 6
    gui.key("c")
    gui.drag((4.0, 1.0), (4.2, 1.0))
    assert step() == 6
    goal = gui.level.bodies[-1].id
    gui.session.queue(SetField(ids=(goal,), field="role", value="blue"))
    gui.frames(3)
    assert step() == 7
    # What is done stays done.
    gui.key("ctrl+z")
    gui.frames(3)
    assert step() == 7


def test_play_win_and_save_are_seen(gui, step, tmp_path, monkeypatch):
    session = gui.session
    session.settings.guide_step = 7
    gui.frames(2)
    assert step() == 7
    done = [False, False, False]
    steps = tuple(
        dataclasses.replace(each, done=lambda session, k=k: done[k])
        for k, each in enumerate(guide.STEPS[7:])
    )
    monkeypatch.setattr(guide, "STEPS", (*guide.STEPS[:7], *steps))
    for k in range(3):
        done[k] = True
        gui.frames(2)
        assert step() == 8 + k
    assert guide.current(session) is None and gui.shows("guide.next")
    gui.click("guide.close")
    assert not gui.shows("guide.next")


def test_steps_can_be_skipped_and_the_guide_left(gui, step):
    gui.session.queue("app.guide")
    gui.frames(4)
    gui.click("guide.next")
    assert step() == 1
    gui.click("guide.close")
    gui.frames(2)
    assert step() == guide.CLOSED and not gui.shows("guide.next")
    gui.session.queue("app.guide")
    gui.frames(4)
    assert step() == 0


def test_it_goes_on_at_the_next_start(gui, step, tmp_path):
    path = tmp_path / "settings.json"
    session = gui.session
    session.keeper = SettingsKeeper(session.settings, path)
    session.queue("app.guide")
    gui.frames(4)
    gui.click("guide.next")
    gui.click("guide.next")
    session.keeper.save()
    assert Settings.load(path).guide_step == 2


def test_the_first_start_offers_it_and_no_later_one(gui, step):
    session = gui.session
    session.settings.recents, session.settings.layout = [], ""
    guide.offer(session)
    gui.frames(3)
    assert step() == guide.OFFERED and gui.shows("guide.next")
    gui.click("guide.next")
    gui.frames(3)
    assert step() == 0
    session.settings.guide_step = guide.CLOSED
    session.settings.recents = ["/somewhere/level.json"]
    guide.offer(session)
    assert step() == guide.CLOSED


def test_a_guide_that_is_done_is_put_away_at_the_next_start(gui, step):
    gui.session.settings.recents = ["/somewhere/level.json"]
    gui.session.settings.guide_step = 4
    guide.offer(gui.session)
    assert step() == 4
    gui.session.settings.guide_step = len(guide.STEPS)
    guide.offer(gui.session)
    assert step() == guide.CLOSED


def test_a_level_that_is_open_stays_open(gui):
    gui.key("r")
    gui.drag((0.8, 1.0), (2.0, 1.4))
    level = gui.level
    gui.session.queue("app.guide")
    gui.frames(4)
    assert not gui.level.bodies
    assert level in [tab.document.level for tab in gui.session.tabs]


def test_a_level_that_is_looked_at_meanwhile_does_no_step(gui, step):
    gui.session.queue("app.guide")
    gui.frames(4)
    gui.open(levels_dir() / "l" / "rover_ridge.json")
    gui.frames(10)
    assert step() == 0


def test_every_step_names_an_action_that_exists():
    from editor.actions import BY_ID

    assert len(guide.STEPS) == 10
    assert all(each.action in BY_ID for each in guide.STEPS if each.action)


def test_moving_things_is_no_step(gui, step):
    gui.session.queue("app.guide")
    gui.frames(4)
    gui.key("r")
    gui.drag((0.8, 1.0), (2.0, 1.4))
    gui.session.queue(Move(ids=(gui.level.bodies[0].id,), shift=(0.1, 0.0)))
    gui.frames(4)
    assert step() == 1


@pytest.mark.parametrize("size", [(1280, 800), (1024, 640), (1920, 1080)])
def test_the_card_covers_nothing_that_a_step_is_about(make_gui, size):
    gui = make_gui(session=a_session(), size=size)
    gui.frames(40)
    gui.session.selection = (1,)
    for step in (5, 7, 8):
        gui.session.settings.guide_step = step
        gui.frames(6)
        assert apart(card(), arena(gui))
        assert card()[0] >= gui.probe("canvas").high[0] or card()[2] <= gui.probe("canvas").low[0]
        if size[0] > 1024:
            assert apart(card(), rect("###panel-inspector"))
    gui.key("space")
    gui.frames(20)
    assert gui.shows("guide.next") and apart(card(), arena(gui))


def test_the_offer_waits_while_a_level_is_played(make_gui):
    gui = make_gui(session=a_session())
    gui.session.settings.guide_step = guide.OFFERED
    gui.frames(4)
    assert gui.shows("guide.next")
    gui.key("space")
    gui.frames(4)
    assert not gui.shows("guide.next")
    gui.key("escape")
    gui.frames(4)
    assert gui.shows("guide.next")


def test_a_later_start_puts_a_guide_that_is_done_away_and_offers_none(gui):
    settings = gui.session.settings
    settings.layout, settings.recents, settings.guide_step = "as it is", [], len(guide.STEPS)
    for _ in range(2):
        guide.offer(gui.session)
        assert settings.guide_step == guide.CLOSED
