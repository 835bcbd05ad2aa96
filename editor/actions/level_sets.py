"""Actions of the set that is put together in the gallery: fill it, and write it."""

import os
from pathlib import Path

from editor.actions import gallery as browsing
from editor.base.prompts import FileQuestion
from editor.gallery import filing
from editor.gallery.card import Card
from editor.gallery.export import SetPlan, export_set, refused
from editor.session import Session
from kinetix.errors import CommandError, LevelError
from kinetix.level.sets import load_set
from kinetix.paths import user_levels_dir
from kinetix.wording import plural


def add_to_set(session: Session) -> None:
    """Put the chosen levels into the set."""
    put_in_set(session, [card.path for card in browsing.chosen_cards(session)])


def put_in_set(session: Session, paths: list[str]) -> None:
    """Put levels into the set, each with weight 1 unless it is there already."""
    for path in paths:
        session.gallery.tray.setdefault(path, 1.0)


def drop_from_set(session: Session, path: str) -> None:
    """Take a level out of the set."""
    session.gallery.tray.pop(path, None)


def load_into_set(session: Session, path: Path) -> None:
    """Take the levels and weights of a set that there is; those inside a file stay there.

    Raises:
        LevelError: The set is bad.
    """
    loaded = load_set(path.resolve())
    files = {str(each.path): each.weight for each in loaded.levels if each.path is not None}
    if not files:
        raise CommandError(f"{path.name} carries its levels itself: there are no files to choose.")
    session.gallery.tray = files
    session.toast(f"{plural(len(files), 'level')} of {path.name}")


def ask_export(session: Session) -> None:
    """Show the questions about a set: of the set's levels, or else of the chosen ones."""
    gallery = session.gallery
    if not gallery.open:
        browsing.toggle(session)
    if not gallery.tray:
        put_in_set(session, [card.path for card in gallery.chosen(session.library)])
    if not gallery.tray:
        session.complain("Choose the levels of the set first: Ctrl+A takes all that are shown.")
        return
    gallery.plan = gallery.plan or SetPlan()


def refused_in_set(session: Session) -> list[Card]:
    """The levels of the set that cannot go in."""
    by_path = {card.path: card for card in session.library.cards}
    return refused(by_path[path] for path in session.gallery.tray if path in by_path)


def leave_out_refused(session: Session) -> None:
    """Take the levels that cannot go in out of the set."""
    for card in refused_in_set(session):
        session.gallery.tray.pop(card.path, None)


def export_now(session: Session) -> None:
    """Ask where, and write the set."""
    gallery = session.gallery
    plan = gallery.plan
    if plan is None:
        return
    folder = plan.form == "folder"
    bad = refused_in_set(session)
    if bad:
        raise CommandError(f"{bad[0].name} has an error: mend it, or leave it out.")

    def answer(path: Path | None) -> None:
        if path is None:
            return
        target = path.with_name(path.name.removesuffix(".json")) if folder else path
        try:
            made = export_set({Path(p): w for p, w in gallery.tray.items()}, plan, target)
        except LevelError as error:
            session.toast(str(error), "error")
            return
        gallery.plan = None
        doubles = len(gallery.tray) - len(made.levels)
        train = sum(each.split == "train" for each in made.levels)
        more = f", {doubles} left out because they equal others" if doubles else ""
        session.toast(
            f"Saved {target}: {train} to train on, {len(made.levels) - train} to evaluate on{more}",
            "success",
        )
        browsing.look(session)

    session.ask(
        FileQuestion(
            purpose="save",
            title="Export level set as a folder" if folder else "Export level set",
            folder=_set_folder(session),
            name=f"{filing.stem_of(plan.name)}{'' if folder else '.json'}",
            suffixes=("",) if folder else (".json",),
            answer=answer,
        )
    )


def _set_folder(session: Session) -> Path:
    """Return the proposed folder of a set: beside the first level unless that one is bundled."""
    first = next((Path(path) for path in session.gallery.tray), None)
    if first is not None and not filing.bundled(first):
        return first.parent
    own = user_levels_dir()
    return own if os.path.isdir(own) else Path.home()
