"""The whole window in German: nothing of the app's own words stays English."""

import re

from imgui_bundle import imgui

from editor import actions
from editor.base import language
from editor.toolkit.widgets import arrangement, caps
from editor.window.panels.preferences import PAGES
from kinetix.agents.agent import load_agent
from kinetix.bundled import agent_names
from kinetix.level.codec import save_level
from tests.editor.core.helpers import FakeSimulator, a_level

PANELS = ("outliner", "inspector", "level", "problems", "history", "controls", "plots", "timeline")
ALLOWED = re.compile(
    r"[/~].*|[\w+]{1,3}|Alt.*|Tab|Enter|Esc.*|F\d+.*|Deutsch|Kinetix|Mono|Test|[\d.,]+ .*|"
    r"[a-z0-9_+]+|\S+\+\S+.*|[sml]/.*|.*\.json"
)
"""Numbers with units, keys, names of physics, agents and levels, paths."""


def test_labels_of_fields_are_whole_in_german(make_gui, monkeypatch):
    cut, written = set(), arrangement.muted

    def noted(label):
        words = language.tr(label)
        if imgui.calc_text_size(words).x > imgui.get_content_region_avail().x:
            cut.add(words)
        written(label)

    monkeypatch.setattr(arrangement, "muted", noted)
    gui = make_gui(level=a_level(), size=(1280, 720))
    gui.session.settings.language = "de"
    gui.frames(40)
    cut.clear()  # while the panels are put up, some are narrow
    for selection in ((1,), (3,), (5,), (6,), ("floor",), (1, 2), ()):
        gui.session.selection = selection
        gui.frames(3)
    for panel in ("level", "agents"):
        gui.bring(panel)
    assert not cut


def test_panels_menus_and_settings_speak_german(make_gui):
    gui = make_gui(level=a_level())
    gui.session.playback.simulator = FakeSimulator()
    gui.session.settings.language = "de"
    gui.frames(4)
    for panel in PANELS:
        gui.bring(panel)
    for selection in ((1,), (3,), (5,), (6,), ("floor",), (1, 2), ()):
        gui.session.selection = selection
        gui.frames(3)
    for menu in ("file", "edit", "view", "run", "level", "agent", "tools", "arrange", "help"):
        gui.click(f"menu.{menu}")
        gui.key("escape")
    gui.session.view.preferences = True
    gui.frames(3)
    for page in (*PAGES, "Files", "Keys"):
        gui.click(f"preferences.{page}")
    gui.session.view.preferences = False
    gui.key("f1")
    gui.frames(4)
    gui.key("f1")
    gui.key("ctrl+o")
    gui.frames(4)
    gui.key("escape")
    for step in (0, 4, 10):
        gui.session.settings.guide_step = step
        gui.frames(4)
    gui.session.settings.guide_step = -1
    gui.key("space")
    gui.frames(20)
    gui.key("space")
    gui.key("e")
    gui.frames(4)
    spoken = language.spoken()
    assert spoken is not None
    agents = {load_agent(name).card.name for name in agent_names()}
    missing = {words for words in spoken.missing if not agents.issuperset(words.split(", "))}
    english = [words for words in missing if not ALLOWED.fullmatch(words)]
    assert sorted(english) == [], english
    assert not any("wrong" in line for line in gui.session.log.lines)


def test_the_language_is_chosen_in_preferences_and_stays(make_gui):
    gui = make_gui(level=a_level())
    gui.key("ctrl+,")
    gui.frames(3)
    gui.click("preferences.language")
    gui.click("preferences.language.de")
    gui.frames(3)
    assert language.tr("Undo") == "Rückgängig"
    # What is stored, sent and tested by name is English in every language.
    assert gui.session.document.history.undo_label is None
    gui.click("preferences.language")
    gui.click("preferences.language.en")
    gui.frames(3)
    assert language.tr("Undo") == "Undo"


def test_escape_closes_a_menu_without_a_crash(make_gui):
    gui = make_gui(level=a_level())
    for menu in ("file", "edit", "view"):
        gui.click(f"menu.{menu}")
        gui.frames(3)
        gui.key("escape")
        gui.frames(2)
    assert not any("IM_ASSERT" in line for line in gui.session.log.lines)


def test_two_chords_stand_below_each_other_where_a_column_is_narrow(make_gui, monkeypatch):
    """Strg Umschalt Z and Strg Y do not fit beside each other: neither is cut off."""
    drawn = []
    cap = caps.key_cap

    def key_cap(label, **options):
        cap(label, **options)
        drawn.append((label, imgui.get_item_rect_min().y))

    monkeypatch.setattr(caps, "key_cap", key_cap)
    gui = make_gui(size=(1280, 800))
    gui.session.settings.language = "de"
    gui.key("f1")
    gui.frames(4)
    drawn.clear()
    gui.frames(1)
    labels = [label for label, _ in drawn]
    chords = ["Strg", "Umschalt", "Z", "Strg", "Y"]
    at = next(k for k in range(len(labels)) if labels[k : k + 5] == chords)
    tops = [top for _, top in drawn[at : at + 5]]
    assert tops[0] == tops[2] and tops[3] == tops[4] > tops[2] + 5


def test_what_people_call_their_things_stays_as_it_is(make_gui):
    level = a_level()
    named = level.replace(bodies=(level.bodies[0].replace(name="Delete"), *level.bodies[1:]))
    gui = make_gui(level=named)
    gui.session.settings.language = "de"
    gui.frames(4)
    assert gui.session.document.spoken_name_of(1) == "Delete"
    assert gui.session.document.spoken_name_of("floor") == "Boden"
    assert language.tr("Saved New cart.json") == "New cart.json gespeichert"


def test_keys_are_found_by_the_words_on_the_screen_and_by_the_english_ones(make_gui):
    gui = make_gui(level=a_level())
    gui.session.settings.language = "de"
    gui.session.view.keys = True
    for typed in ("speichern", "save"):
        gui.frames(4)
        gui.click("keys.search")
        gui.key("ctrl+a")
        gui.text(typed)
        gui.frames(2)
        assert gui.shows("keys.file.save") and not gui.shows("keys.edit.delete"), typed


def test_names_of_levels_and_players_are_shown_as_they_are(make_gui, tmp_path, monkeypatch):
    """ "Nob of Quint" would be a form with two unknown words if it were translated."""
    folder = tmp_path / "documents" / "Kinetix"
    folder.mkdir(parents=True)
    save_level(a_level().replace(name="Nob of Quint"), folder / "nob of quint.json")
    monkeypatch.setattr("editor.actions.gallery.gallery.levels_dir", lambda: tmp_path / "none")
    gui = make_gui(level=a_level())
    gui.session.playback.simulator = FakeSimulator()
    gui.session.settings.language = "de"
    gui.key("ctrl+g")
    assert gui.session.library.wait(20)
    gui.frames(4)
    gui.key("ctrl+a")
    gui.frames(2)
    actions.run(gui.session, "gallery.add_to_set")
    gui.click("gallery.tab.set")
    gui.key("escape")
    gui.session.playback.play(gui.level, player="Nob of Quint")
    gui.frames(6)
    missing = language.spoken().missing
    assert not [words for words in missing if "Nob" in words or "nob" in words]


def test_the_arena_is_found_by_the_name_that_is_shown(make_gui):
    gui = make_gui(level=a_level())
    gui.session.settings.language = "de"
    gui.frames(4)
    assert not gui.shows("outliner.floor")  # the section is folded
    for words in ("Boden", "Floor"):
        gui.click("outliner.filter")
        gui.key("ctrl+a")
        gui.text(words)
        assert gui.shows("outliner.floor") and not gui.shows("outliner.ceiling")
