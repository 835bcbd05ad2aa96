"""From the history of a level buffer into the editor: open a level and let the agent play it."""

from editor.actions.watching.agents import load_agent, play_agent
from editor.documents.document import Document
from editor.session import Session
from kinetix.level.model import Level


def play_level(session: Session, level: Level) -> None:
    """Open a level of the buffer in a tab and let the run's newest agent play it.

    Args:
        session: The app.
        level: As it came in.
    """
    run = session.viewer.run.path
    session.open_tab(Document(level))
    if run and session.viewer.slots["a"].path != run:
        load_agent(session, run, "a")
    play_agent(session)


def show(session: Session) -> None:
    """Show the panel with the history of the watched run's level buffer."""
    session.view.front = "curriculum"
