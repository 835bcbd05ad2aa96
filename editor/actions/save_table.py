"""Writes the table of an evaluation to a file."""

from collections.abc import Callable
from pathlib import Path

from editor.actions.comparison import about_comparison
from editor.base.prompts import FileQuestion
from editor.session import Session
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
        CommandError: It has another ending.
        LevelError: The file cannot be written.
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
    if suffix in (".html", ".json") and not evaluation.contenders():
        raise CommandError("Wait until an agent has played all levels.")
    write_atomically(path, texts[suffix]().encode())
    session.toast(f"Wrote {path}", "success")
