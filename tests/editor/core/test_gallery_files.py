"""Work on several files of the gallery at once, and on files that level sets name."""

from editor import actions
from tests.editor.core.helpers import texts
from tests.editor.core.test_gallery import choose, folder, names_of, session  # noqa: F401

# The fixtures `folder` and `session` are those of the gallery's tests.


def test_copies_are_made_of_all_that_can_be_read(session, folder):  # noqa: F811
    choose(session, "Hill cart", "broken", "Rocket")
    actions.run(session, "gallery.duplicate")
    assert {path.name for path in folder.rglob("*_copy*.json")} == {
        "hill_cart_copy.json",
        "rocket_copy.json",
    }
    assert "Made 2 copies" in texts(session)
    assert any("broken.json" in text for text in texts(session))
    assert {"Hill cart copy", "Rocket copy"} <= names_of(session)
    chosen = session.gallery.chosen(session.library, session.results)
    assert {card.name for card in chosen} == {"Hill cart copy", "Rocket copy"}
