"""Letters of all scripts: from the system's fonts, where it has some."""

import shutil

import pytest
from imgui_bundle import imgui

from editor.toolkit.appearance import FONTS
from editor.toolkit.fonts import FAMILIES, Fallbacks, folders, found
from tests.editor import days

pytestmark = pytest.mark.parametrize("day", [days.FIRST], indirect=True)
STAR = 0x2605
FAMILY = {"CJK": 0x6F22, "Korean": 0xD55C}


@pytest.fixture
def dejavu():
    """A font that most systems have, with many scripts and some emoji."""
    for path in found(folders()):
        if path.name == "DejaVuSans.ttf":
            return path
    pytest.skip("DejaVu Sans is not installed")


def load(gui, places):
    fallbacks = Fallbacks((FONTS.regular, FONTS.bold), places)
    gui.frames(5)
    while fallbacks.step():
        gui.frames(1)
    return fallbacks


def test_one_font_of_each_family_is_chosen(day, tmp_path):
    del day
    fonts = tmp_path / "fonts" / "truetype"
    names = [names[-1] for names in FAMILIES.values()]
    for name in (*names, FAMILIES["emoji"][0], "Other.ttf", "NotoColorEmoji.ttf"):
        (fonts / name).parent.mkdir(parents=True, exist_ok=True)
        (fonts / name).touch()
    chosen = [path.name for path in found((tmp_path / "none", tmp_path / "fonts"))]
    assert chosen == [*names[:-1], FAMILIES["emoji"][0]]


def test_a_font_for_two_families_is_added_once(day, tmp_path):
    del day
    (tmp_path / "NotoSansCJK-Regular.ttc").touch()
    assert len(found((tmp_path,))) == 1


def test_letters_come_from_the_systems_fonts(make_gui, dejavu, tmp_path):
    gui = make_gui()
    shutil.copy(dejavu, tmp_path)
    gui.host.ui._fallbacks = Fallbacks((), ())
    for font in (FONTS.regular, FONTS.bold):
        assert not font.is_glyph_in_font(STAR)
    fallbacks = load(gui, (tmp_path,))
    for font in (FONTS.regular, FONTS.bold):
        assert font.is_glyph_in_font(STAR)
        assert font.is_glyph_in_font(ord("😀"))
    assert [path.name for path in fallbacks.loaded] == ["DejaVuSans.ttf"]
    gui.session.toast("★ שלום 😀")
    gui.frames(5)
    assert imgui.calc_text_size("★").x > 0


def test_the_app_adds_them_by_itself(make_gui, dejavu):
    gui = make_gui()
    gui.frames(40)
    assert dejavu in gui.host.ui._fallbacks.loaded
    assert FONTS.regular.is_glyph_in_font(STAR)


def test_emoji_are_drawn_on_a_system_without_any(make_gui, monkeypatch):
    monkeypatch.setattr("editor.toolkit.fonts.folders", lambda: ())
    gui = make_gui()
    gui.frames(20)
    for sign in "🚀🏎🙂":
        assert FONTS.regular.is_glyph_in_font(ord(sign)), sign


def test_names_of_files_and_levels_in_other_scripts_are_shown(make_gui, tmp_path):
    from kinetix.level.codec import save_level
    from kinetix.level.model import Level

    path = tmp_path / "漢字-😀-한국어.json"
    save_level(Level(name="שלום 漢字 🏎"), path)
    gui = make_gui()
    gui.frames(40)
    gui.open(path)
    gui.frames(10)
    assert gui.session.document.path == path
    assert gui.session.log.lines == ()


def test_what_is_no_font_is_passed_over(make_gui, tmp_path):
    for names, content in zip(FAMILIES.values(), (b"", b"<html>", b"\0" * 40, b"PK"), strict=True):
        (tmp_path / names[0]).write_bytes(content)
    gui = make_gui()
    load(gui, (tmp_path,))
    gui.frames(3)
    assert gui.session.log.lines == ()


@pytest.mark.parametrize("family", ["CJK", "Korean"])
def test_east_asian_letters_where_the_system_has_them(make_gui, family):
    names = FAMILIES["Chinese and Japanese" if family == "CJK" else "Korean"]
    if not any(path.name in names for path in found(folders())):
        pytest.skip("no such font is installed")
    gui = make_gui()
    gui.frames(60)
    assert FONTS.regular.is_glyph_in_font(FAMILY[family])


def test_a_letter_has_its_size_whatever_the_toolkit_has_moved(make_gui):
    gui = make_gui()
    gui.frames(40)
    fonts = imgui.get_io().fonts

    def width(letter, size, font=FONTS.bold):
        return font.get_font_baked(size).get_char_advance(ord(letter)) / size

    width("n", 60.0)
    for _ in range(5):
        assert width("n", 26.0) == pytest.approx(width("n", 44.0), rel=0.1)
        gui.frames()
    picture, size = fonts.tex_data.unique_id, 100.0
    while fonts.tex_data.unique_id == picture and size < 200:
        # Until the picture of letters is full, and sizes that nobody needs go.
        width("W", size, FONTS.regular)
        size += 1
    width("o", 26.0)
    gui.frames()
    large = width("m", 44.0)
    assert large == pytest.approx(width("m", 26.0), rel=0.1)
