"""The one evaluation at a time: another takes its place only after a question."""

from collections.abc import Callable

from editor.base.prompts import Choice, Question
from editor.session import Session


def if_free(session: Session, then: Callable[[], None]) -> None:
    """Do what replaces the evaluation; ask first if one is under way.

    Args:
        session: The app.
        then: What replaces it.
    """
    if not session.viewer.evaluation.running:
        then()
        return

    def answer(choice: str) -> None:
        if choice == "stop":
            then()

    session.ask(
        Question(
            title="Stop the evaluation?",
            message="An evaluation is under way. Its table would be lost; "
            "the gallery keeps the levels that were played to the end.",
            choices=(
                Choice(id="cancel", label="Let It Go On"),
                Choice(id="stop", label="Stop It"),
            ),
            default="cancel",
            cancel="cancel",
            answer=answer,
        )
    )
