"""Tags as people type them."""

import pytest

from editor.documents.tags import tags_of


@pytest.mark.parametrize(
    ("typed", "tags", "refused"),
    [
        ("wheels jump", ["wheels", "jump"], []),
        ("Wheels, jump;jump", ["wheels", "jump"], []),
        ("#Café  über_2-x", ["cafe", "uber_2-x"], []),
        ("", [], []),
        ("a/b ok 🙂", ["ok"], ["a/b", "🙂"]),
        ("x" * 41, [], ["x" * 41]),
    ],
)
def test_tags_are_made_of_what_people_type(typed, tags, refused):
    assert tags_of(typed) == (tags, refused)
