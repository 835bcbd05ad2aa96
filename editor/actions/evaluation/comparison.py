"""Stored comparisons, opened again in the table."""

from pathlib import Path

from editor.actions.evaluation.evaluating import if_free
from editor.actions.files import file
from editor.agents.evaluation import Plan, bare_summary
from editor.base.prompts import FileQuestion
from editor.session import Session
from editor.worker.requests import AgentSummary, EvaluatedLevel
from kinetix.agents.results import Provenance
from kinetix.agents.stored_comparison import StoredComparison, read_comparison
from kinetix.errors import CommandError, KinetixError, LevelError
from kinetix.level.codec import level_hash, load_level
from kinetix.level.model import Level
from kinetix.paths import working_dir
from kinetix.wording import plural


def ask_comparison(session: Session) -> None:
    """Ask which stored comparison to show."""

    def answer(path: Path | None) -> None:
        if path is not None:
            open_comparison(session, path)

    session.ask(
        FileQuestion(
            purpose="open",
            title="Open a comparison (.json)",
            folder=working_dir(),
            suffixes=(".json",),
            answer=answer,
            about=about_comparison,
        )
    )


def about_comparison(path: Path) -> str:
    """Return what a stored comparison holds, or why it is not one; empty for other files."""
    if path.suffix.lower() != ".json":
        return ""
    try:
        stored = read_comparison(path)
    except KinetixError:
        return "This is no comparison."
    return "\n".join((_count(stored), "", *(one.label for one in stored.contenders)))


def open_comparison(session: Session, path: Path) -> bool:
    """Show a stored comparison in the table; asks first while an evaluation is under way.

    Returns:
        Whether it could be read; if not, a window shows why.
    """
    try:
        stored = read_comparison(path)
    except KinetixError as error:
        file.tell(session, "This cannot be opened", str(error))
        return False
    first = stored.contenders[0].provenance
    plan = Plan(
        agents=tuple(_agent(session, one.provenance) for one in stored.contenders),
        levels=tuple(
            EvaluatedLevel(name=name, source=_level(session, name, sha256))
            for name, sha256 in stored.hashes.items()
        ),
        hashes=tuple(stored.hashes.values()),
        attempts=first.attempts,
        seed=first.seed,
        deterministic=first.deterministic,
        sources=tuple(one.provenance for one in stored.contenders),
    )

    def show() -> None:
        session.gallery.open = False
        session.viewer.evaluation.restore(plan, stored.contenders)
        session.view.front = "evaluate"
        session.toast(f"{path.name}: {_count(stored)}", "success")

    if_free(session, show)
    return True


def _count(stored: StoredComparison) -> str:
    policies = plural(len(stored.contenders), "policy", "policies")
    return f"{policies} on {plural(len(stored.hashes), 'level')}."


def _agent(session: Session, provenance: Provenance) -> AgentSummary:
    found = known_by(session, provenance.digest, provenance.card_digest)
    return found or bare_summary(provenance.agent, provenance)


def known_by(session: Session, digest: str, card_digest: str) -> AgentSummary | None:
    """Return a loaded agent with these parameters and, where it is known, this card; or None."""
    for one in (*session.viewer.agents, *session.viewer.contenders):
        if digest and one.digest == digest and card_digest in ("", one.card_digest):
            return one
    return None


def _level(session: Session, name: str, sha256: str) -> str | Level:
    """Return the level that a stored name means: a file with that content, else the name alone."""
    if session.document.hash == sha256:
        return session.document.level
    try:
        if level_hash(load_level(name)) == sha256:
            return name
    except LevelError:
        pass
    card = next((one for one in session.library.cards if one.sha256 == sha256), None)
    return str(card.file) if card is not None else name


def present(session: Session, summary: AgentSummary) -> AgentSummary:
    """Return an agent that can play: itself, or the loaded one with the same parameters.

    Raises:
        CommandError: The agent is of a stored comparison, and none with its parameters is loaded.
    """
    if summary.ref.path:
        return summary
    found = known_by(session, summary.digest, summary.card_digest)
    if found is None:
        raise CommandError(
            f"{summary.name} is not loaded: choose the agent whose parameters begin with "
            f"{summary.digest[:12]} as agent A or B first."
        )
    return found
