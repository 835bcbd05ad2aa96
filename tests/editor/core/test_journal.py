"""The log neither grows without bound nor repeats itself."""

from editor.base.journal import CAPACITY, Journal
from kinetix.errors import KinetixError


def test_what_fails_in_every_frame_is_counted(session):
    for _ in range(1000):
        with session.guard():
            raise ZeroDivisionError("on purpose")
    message, details = session.log.lines
    assert "on purpose" in message and message.endswith("(×1000)")
    assert details.startswith("Traceback") and details.endswith("(×1000)")
    assert len(session.toasts) == 1


def test_two_that_alternate_are_counted_as_well():
    journal = Journal()
    assert [journal.add(text) for text in "abab"] == [True, True, False, False]
    assert journal.lines == ("a (×2)", "b (×2)")


def test_the_oldest_go_first():
    journal = Journal()
    for number in range(3 * CAPACITY):
        journal.add(str(number))
    assert len(journal.lines) == CAPACITY
    assert journal.lines[-1] == str(3 * CAPACITY - 1)


def test_what_came_again_is_news(session):
    with session.guard():
        raise KinetixError("It is gone.")
    mark = session.log.serial
    assert session.log.since(mark) == ()
    with session.guard():
        raise KinetixError("It is gone.")
    assert session.log.since(mark) == ("It is gone.",)
