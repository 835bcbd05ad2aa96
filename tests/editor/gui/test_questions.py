"""Questions are on the screen whenever they are asked, and the keyboard answers them."""

import pytest

from editor.actions.files.datasets import about_dataset
from editor.base.prompts import Choice, FileQuestion, Question, TextQuestion
from editor.base.settings import Settings
from editor.session import Session
from editor.worker.jobs import Worker
from kinetix.level.codec import save_level
from kinetix.level.model import Level
from tests.editor.days import refuse


def a_session(**settings):
    return Session(settings=Settings(**settings), worker=Worker(perform=refuse))


def a_question(answers, title="Restore unsaved work?"):
    return Question(
        title=title,
        message="The app ended without saving it.",
        choices=(Choice(id="restore", label="Restore"), Choice(id="later", label="Later")),
        default="restore",
        cancel="later",
        answer=answers.append,
    )


def layout_of(make_gui):
    gui = make_gui(session=a_session())
    gui.frames(50)
    gui.host.ui.save_layout()
    return gui.session.settings.layout


@pytest.mark.parametrize("stored", [False, True], ids=["first start", "second start"])
@pytest.mark.parametrize(("key", "answer"), [("return", "restore"), ("escape", "later")])
def test_a_question_asked_before_the_first_frame_is_seen_and_answered(
    make_gui, stored, key, answer
):
    answers = []
    session = a_session(layout=layout_of(make_gui) if stored else "")
    session.ask(a_question(answers))
    gui = make_gui(session=session)
    for _ in range(20):
        gui.frames(2)
        assert gui.shows("question.restore")
    gui.key(key)
    assert answers == [answer]
    assert not session.prompts
    gui.frames(40)
    gui.key("c")
    assert session.tool.id == "circle"


@pytest.mark.parametrize("name", ["line.accept", "question.restore"])
def test_a_long_title_is_broken_into_lines(make_gui, name):
    def below(title):
        """Height at which the button stands: the more lines above it, the lower."""
        session = a_session()
        asks_text = name == "line.accept"
        text = TextQuestion(title=title, answer=lambda _: None)
        session.ask(text if asks_text else a_question([], title))
        gui = make_gui(session=session, size=(800, 600), scale=2.0)
        gui.frames(6)
        assert gui.probe(name).high[0] <= 800
        return gui.probe(name).low[1]

    long = "Name of a level that somebody has called by sixty letters and more than that"
    assert below(long) > below("Name")


def test_two_questions_are_asked_one_after_the_other(make_gui):
    answers = []
    session = a_session()
    session.ask(a_question(answers, "First"))
    session.ask(a_question(answers, "Second"))
    gui = make_gui(session=session)
    gui.frames(20)
    gui.click("question.later")
    gui.frames(4)
    gui.click("question.restore")
    assert answers == ["later", "restore"]


@pytest.mark.parametrize("layout", ["edit", "play", "evaluate"])
def test_panels_that_move_meanwhile_do_not_take_it_away(make_gui, layout):
    answers = []
    session = a_session()
    gui = make_gui(session=session)
    gui.frames(40)
    session.ask(a_question(answers))
    gui.frames(3)
    session.view.layout = layout
    session.view.front = "agents"
    gui.frames(40)
    gui.click("question.restore")
    assert answers == ["restore"]


def test_a_line_keeps_its_text_and_the_keyboard_when_a_panel_comes(make_gui):
    answers = []
    session = a_session()
    gui = make_gui(session=session)
    gui.frames(40)
    session.ask(TextQuestion(title="Name", text="", answer=answers.append))
    gui.frames(4)
    gui.text("Car")
    session.view.front = "agents"
    gui.frames(10)
    gui.key("end")
    gui.text("t")
    gui.key("return")
    assert answers == ["Cart"]


@pytest.fixture
def browsing(make_gui, tmp_path):
    """A window that asks for a file to open, and a level that is there."""
    path = tmp_path / "levels" / "mine.json"
    path.parent.mkdir()
    save_level(Level(name="Mine"), path)
    gui = make_gui(session=a_session())
    gui.frames(40)
    gui.key("ctrl+o")
    gui.frames(3)
    return gui, path


def test_a_path_can_be_typed_at_once(browsing):
    gui, path = browsing
    gui.text(str(path))
    gui.key("return")
    assert gui.session.document.path == path
    assert not gui.session.prompts


def test_a_folder_that_is_typed_is_entered_and_the_name_follows(browsing):
    gui, path = browsing
    gui.text(str(path.parent))
    gui.key("return")
    gui.frames(3)
    gui.text("mine.json")
    gui.key("return")
    assert gui.session.document.path == path


def test_a_name_that_is_not_there_can_be_corrected(browsing):
    gui, path = browsing
    gui.text(f"{path.parent}/my")
    gui.key("return")
    gui.frames(3)
    assert gui.session.prompts
    gui.key("end")
    gui.key("backspace")
    gui.text("ine.json")
    gui.key("return")
    assert gui.session.document.path == path


def test_return_in_the_empty_field_uses_the_folder_on_show(make_gui, tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    chosen = []
    gui = make_gui()
    gui.session.ask(
        FileQuestion(purpose="folder", title="Folder", folder=tmp_path, answer=chosen.append)
    )
    gui.frames(3)
    gui.text(str(inner))
    gui.key("return")
    gui.frames(3)
    assert not chosen
    gui.key("return")
    gui.frames(3)
    assert chosen == [inner]


@pytest.mark.parametrize("name", ["~nobody-of-this-name/x", "/", "..", "\u4f60"])
def test_odd_names_break_nothing(browsing, name):
    gui, _ = browsing
    gui.text(name)
    gui.key("return")
    gui.frames(3)
    assert gui.session.log.lines == ()
    assert gui.session.prompts


@pytest.mark.parametrize("way", ["return", "button"])
def test_a_folder_that_is_not_there_yet_may_be_named(make_gui, tmp_path, way):
    answers = []
    gui = make_gui()
    (tmp_path / "letters").mkdir()
    (tmp_path / "letters" / "letter.txt").write_text("x")
    question = FileQuestion(
        purpose="folder",
        title="Where to?",
        folder=tmp_path,
        suffixes=(),
        describe=about_dataset,
        wanted="a data set or an empty folder",
        fresh=True,
        answer=answers.append,
    )
    gui.session.ask(question)
    gui.frames(4)
    gui.click("browser.accept")
    assert answers == []
    gui.click("browser.name")
    gui.text("letters")
    gui.click("browser.accept")
    assert answers == []
    gui.click("browser.name")
    gui.key("end")
    gui.text("2")
    if way == "return":
        gui.key("return")
    else:
        gui.click("browser.accept")
    gui.frames(2)
    assert answers == [tmp_path / "letters2"]
