"""Preferences in one window; both themes can be read."""

import ast
import dataclasses
from pathlib import Path

import pytest

import editor
from editor.base.settings import Settings
from editor.session import Session
from editor.toolkit.appearance import COLOURS, DARK, LIGHT, THEMES
from editor.window.panels.preferences import PAGES
from kinetix.render import palette
from tests.editor import days


def contrast(one, other):
    return palette.contrast(*([255 * c for c in colour[:3]] for colour in (one, other)))


@pytest.mark.parametrize("name", THEMES)
@pytest.mark.parametrize("ink", ["text", "muted", "faint", "good", "warn", "bad", "info", "accent"])
@pytest.mark.parametrize("ground", ["backdrop", "surface", "raised"])
def test_words_can_be_read_on_every_ground(name, ink, ground):
    theme = THEMES[name]
    assert contrast(getattr(theme, ink), getattr(theme, ground)) >= 4.5


@pytest.mark.parametrize("name", THEMES)
def test_words_can_be_read_in_fields_and_on_buttons(name):
    theme = THEMES[name]
    for ground in (theme.field, theme.field_hover, theme.field_active):
        assert contrast(theme.text, ground) >= 4.5
    assert contrast(theme.muted, theme.field) >= 4.5
    assert contrast((1.0, 1.0, 1.0), theme.accent_strong) >= 4.5
    for sign in (theme.green, theme.blue, theme.red):
        assert contrast(sign, theme.surface) >= 3.0


def opened(make_gui):
    gui = make_gui(size=(1280, 900))
    gui.frames(40)
    gui.key("ctrl+,")
    gui.frames(3)
    return gui


def test_the_scale_of_the_command_line_holds_until_another_is_chosen(make_gui):
    gui = make_gui(session=Session(settings=Settings(ui_scale=1.25)))
    assert gui.host.ui.scale == 1.25
    gui.host.ui.asked_scale = 1.5
    gui.frames()
    assert gui.host.ui.scale == 1.5
    gui.session.settings.ui_scale = 2.0
    gui.frames()
    assert gui.host.ui.scale == 2.0


def test_the_theme_changes_at_once_and_stays(make_gui):
    gui = opened(make_gui)
    gui.click("preferences.theme")
    gui.click("preferences.theme.light")
    gui.frames(3)
    assert COLOURS == LIGHT
    gui.session.keeper.save()
    gui.key("escape")
    gui.frames(2)
    assert not gui.session.view.preferences
    again = make_gui()
    assert (again.session.settings.theme, COLOURS) == ("light", LIGHT)
    again.session.settings.theme = "dark"
    again.frames(2)
    assert COLOURS == DARK


def test_every_setting_can_be_changed_and_reset(make_gui):
    gui = opened(make_gui)
    for page, rows in PAGES.items():
        gui.click(f"preferences.{page}")
        for row in rows:
            name = f"preferences.{row.name}"
            before = getattr(gui.session.settings, row.name)
            gui.click(name)
            if row.options:
                other = next(value for value, _ in row.options if value != before)
                gui.click(f"{name}.{other}")
            gui.frames(3)
            assert getattr(gui.session.settings, row.name) != before, row.name
            gui.click(f"{name}.reset")
            gui.frames(3)
            assert getattr(gui.session.settings, row.name) == getattr(Settings(), row.name)
    assert gui.session.log.lines == ()


def test_every_row_is_a_setting():
    names = {field.name for field in dataclasses.fields(Settings)}
    assert {row.name for rows in PAGES.values() for row in rows} <= names


@pytest.mark.parametrize("day", [days.FIRST], indirect=True)
def test_files_and_keys(make_gui, tmp_path):
    gui = opened(make_gui)
    gui.session.settings.recents = [str(tmp_path / "a.json")]
    gui.click("preferences.Files")
    gui.click("preferences.forget_recent")
    assert gui.session.settings.recents == []
    gui.click("preferences.Keys")
    gui.click("preferences.change_keys")
    gui.frames(3)
    assert gui.session.view.keys and not gui.session.view.preferences


def test_no_table_and_no_default_keeps_a_colour_of_one_theme():
    """Those of marks on the arena's paper, which is white in both themes, may."""
    root = Path(editor.__file__).parent
    kept = []
    for path in sorted(root.rglob("*.py")):
        if path.name == "marks.py":
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        tables = [node for node in tree.body if isinstance(node, ast.Assign | ast.AnnAssign)]
        functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
        defaults = [d for f in functions for d in (*f.args.defaults, *f.args.kw_defaults) if d]
        kept += [
            f"{path.name}:{node.lineno}"
            for node in (*tables, *defaults)
            if "COLOURS." in ast.unparse(node)
        ]
    assert kept == []
