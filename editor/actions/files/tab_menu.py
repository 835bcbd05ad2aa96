"""The menu of a right click on a tab."""

from editor.actions.files.file import close_tab
from editor.base.camera import Point
from editor.base.prompts import Choice, MenuQuestion
from editor.session import Session
from editor.session.tabs import Tab


def open_tab_menu(session: Session, tab: Tab, at: Point) -> None:
    """Ask what to do with a tab.

    Args:
        session: The app.
        tab: The tab.
        at: Where the menu opens [px].
    """
    path = tab.document.path
    choices = [Choice(id="close", label="Close")]
    if len(session.tabs) > 1:
        choices.append(Choice(id="others", label="Close the Others"))
    if path is not None:
        choices.append(Choice(id="path", label="Copy the Path", separated=True))

    def answer(choice: str | None) -> None:
        match choice:
            case "close":
                close_tab(session, tab)
            case "others":
                for other in [each for each in session.tabs if each is not tab]:
                    close_tab(session, other)
            case "path":
                session.clipboard.set(str(path))
                session.toast(f"Copied {path}", "success")
            case _:
                pass

    title = tab.document.title
    session.ask(MenuQuestion(title=title, choices=tuple(choices), at=at, answer=answer))
