"""Writes the table of an evaluation to a file."""

from collections.abc import Callable
from pathlib import Path

from editor.actions.evaluation.comparison import about_comparison
from editor.actions.files.unsaved import listed
from editor.base.prompts import FileQuestion
from editor.session import Session
from kinetix.agents.stored_comparison import check_replaced
from kinetix.errors import CommandError
from kinetix.files.atomic import write_atomically
from kinetix.paths import working_dir


def ask_save(session: Session) -> None:
    """Ask where the table shall go.

    `.csv`; `.jsonl` with the lines of `kinetix eval`; `.html` or `.json` as of `kinetix compare`.
    """

    def answer(path: Path | None) -> None:
        if path is not None:
            save_table(session, path)

    session.ask(
        FileQuestion(
            purpose="save",
            title="Save the table (.csv, .jsonl, .html or .json)",
            folder=working_dir(),
            name="evaluation.csv",
            suffixes=(".csv", ".jsonl", ".html", ".json"),
            answer=answer,
            about=about_comparison,
        )
    )


def save_table(session: Session, path: Path) -> None:
    """Write the table in the form that the file's ending asks for.

    Raises:
        CommandError: The path has another ending, or the table is a comparison and no agent has
            played all levels.
        KinetixError: The file cannot be written, or is a `.json` that is no comparison.
    """
    evaluation = session.viewer.evaluation
    texts: dict[str, Callable[[], str]] = {
        ".csv": evaluation.csv_text,
        ".jsonl": evaluation.json_lines,
        ".html": lambda: evaluation.comparison_text(".html"),
        ".json": lambda: evaluation.comparison_text(".json"),
    }
    suffix = path.suffix.lower()
    if suffix not in texts:
        raise CommandError(f"{path.name}: expected a name that ends in {', '.join(texts)}")
    missing: list[str] = []
    if suffix in (".html", ".json"):
        missing = _unfinished(session)
        check_replaced(path)
    write_atomically(path, texts[suffix]().encode())
    if missing:
        session.toast(
            f"Wrote {path}, without agents that have not played every level: {listed(missing)}",
            "warning",
        )
    else:
        session.toast(f"Wrote {path}", "success")


def _unfinished(session: Session) -> list[str]:
    """Return the agents that a comparison has no place for: some levels of theirs are missing.

    Raises:
        CommandError: Nothing would be left.
    """
    evaluation = session.viewer.evaluation
    done = [contender.provenance for contender in evaluation.contenders()]
    plan = evaluation.plan
    if plan is not None and done:
        every = enumerate(plan.agents)
        return [agent.name for k, agent in every if plan.provenance(k) not in done]
    if evaluation.running:
        raise CommandError("Wait until an agent has played all levels.")
    raise CommandError("No agent has played all levels: .csv or .jsonl keeps what is done.")
