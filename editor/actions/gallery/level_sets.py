"""Actions of the set that is put together in the gallery: fill it, and write it."""

import os
from pathlib import Path
from typing import Final

from editor.actions.files import file
from editor.actions.gallery import gallery as browsing
from editor.base.prompts import Choice, FileQuestion, Question
from editor.documents.files import plain_reason
from editor.gallery import filing
from editor.gallery.export import SetPlan, export_set, plan_of, splits_alike, unpack
from editor.gallery.named_levels import set_name
from editor.session import Session
from editor.session.messages import Kind
from kinetix.errors import CommandError, KinetixError, LevelError
from kinetix.level.sets import LoadedSet, inline_losses, read_set
from kinetix.paths import user_levels_dir
from kinetix.wording import plural

MOST_AT_ONCE: Final = 20
"""Sets of so many levels are written while the window waits: that is no longer than a blink."""
MOST_TOLD: Final = 5
"""Levels of a set that cannot be opened, of which a question says why."""


def add_to_set(session: Session) -> None:
    """Put the chosen levels into the set."""
    put_in_set(session, [card.path for card in browsing.chosen_cards(session)])


def put_in_set(session: Session, paths: list[str]) -> None:
    """Put levels into the set, each with weight 1 unless it is there already."""
    for path in paths:
        session.gallery.tray.setdefault(path, 1.0)


def drop_from_set(session: Session, path: str) -> None:
    """Take a level out of the set; the message brings it back."""
    tray = session.gallery.tray
    card = session.library.card(path)
    name = Path(path).stem if card is None else card.name
    kept = {each: weight for each, weight in tray.items() if each != path}
    _replace(session, kept, f"{name} is no longer in the set")


def load_into_set(session: Session, path: Path) -> None:
    """Take the levels and weights of a set that there is.

    Asks where the set carries levels itself, and where some of them cannot be opened.

    Raises:
        LevelError: The set is bad, or none of its levels can be opened.
    """
    loaded, unreadable = read_set(path.resolve())
    if not unreadable:
        _take(session, path, loaded)
        return
    told = [
        f"{name}: {plain_reason(path.resolve().parent / name, error)}"
        for name, error in unreadable.items()
    ]
    if not loaded.levels:
        raise LevelError(f"{path}: none of its levels can be opened; {told[0]}")
    for sentence in told:
        session.log.add(sentence)
    _ask_for_others(session, path, loaded, told)


def open_set(session: Session, path: Path) -> bool:
    """Show the gallery with the levels of a set; returns False where a window shows why not."""
    try:
        load_into_set(session, path)
    except LevelError as error:
        file.tell(session, "This cannot be opened", str(error))
        return False
    if not session.gallery.open:
        browsing.toggle(session)
    return True


def _take(session: Session, path: Path, loaded: LoadedSet) -> None:
    """Make the levels of a set those of the tray; asks where they have no files."""
    # As the cards have them: a set names the levels beside it by way of `..`.
    files = {
        os.path.abspath(each.path): each.weight for each in loaded.levels if each.path is not None
    }
    if any(each.path is None for each in loaded.levels):
        _ask_to_unpack(session, path, loaded)
    else:
        _replace(session, files, f"{plural(len(files), 'level')} of {set_name(path)}")
        _propose(session, path, loaded)


def _propose(session: Session, path: Path, loaded: LoadedSet) -> None:
    """Let the next export begin with the form of the set that was taken."""
    plan = session.gallery.proposed = plan_of(loaded)
    if not splits_alike(loaded, plan):
        session.toast(
            f"{path.name} is split by hand, or its levels were changed: an export splits it anew.",
            "warning",
        )


def _ask_for_others(session: Session, path: Path, loaded: LoadedSet, told: list[str]) -> None:
    """Ask whether to take a set without the levels that cannot be opened."""

    def answer(choice: str) -> None:
        if choice == "others":
            _take(session, path, loaded)

    more = [f"and {len(told) - MOST_TOLD} more"] if len(told) > MOST_TOLD else []
    count = plural(len(told) + len(loaded.levels), "level")
    session.ask(
        Question(
            title=f"Take the other levels of {path.name}?",
            message="\n".join(
                [
                    f"{len(told)} of {count} cannot be opened:",
                    *(f"• {sentence}" for sentence in told[:MOST_TOLD]),
                    *more,
                ]
            ),
            choices=(
                Choice(id="others", label="Take the Others"),
                Choice(id="cancel", label="Cancel"),
            ),
            default="others",
            cancel="cancel",
            answer=answer,
        )
    )


def _ask_to_unpack(session: Session, path: Path, loaded: LoadedSet) -> None:
    carried = sum(each.path is None for each in loaded.levels)
    folder = (user_levels_dir() if filing.bundled(path) else path.parent) / set_name(path)

    def answer(choice: str) -> None:
        if choice != "unpack":
            return
        files = {str(file): weight for file, weight in unpack(loaded, folder).items()}
        _replace(session, files, f"{plural(len(files), 'level')} in {folder}", "success")
        _propose(session, path, loaded)
        browsing.look(session)

    session.ask(
        Question(
            title=f"Unpack {path.name}?",
            message=f"It carries its {plural(carried, 'level')} itself. As files in "
            f"{folder} they can be looked at, changed and put into the set.",
            choices=(
                Choice(id="unpack", label="Unpack"),
                Choice(id="cancel", label="Cancel"),
            ),
            default="unpack",
            cancel="cancel",
            answer=answer,
        )
    )


def _replace(session: Session, tray: dict[str, float], told: str, kind: Kind = "info") -> None:
    """Make other levels the set; the message's button brings back what the set had."""
    gallery = session.gallery
    undo = None
    if gallery.tray and gallery.tray != tray:
        gallery.tray_before, undo = gallery.tray, "gallery.set_back"
    gallery.tray, after = tray, dict(tray)
    # Once the set has been changed again, the button would take that away too.
    session.messages.toast(told, kind, action=undo, offered=lambda: gallery.tray == after)


def weigh(session: Session, before: dict[str, float]) -> None:
    """Note the set as it was before a weight was changed, so that it can be brought back."""
    if before != session.gallery.tray:
        session.gallery.tray_before = before


def empty_set(session: Session) -> None:
    """Take all levels out of the set."""
    count = len(session.gallery.tray)
    session.gallery.proposed = SetPlan()
    _replace(session, {}, f"Took {plural(count, 'level')} out of the set")


def can_bring_set_back(session: Session) -> bool:
    """Return whether another set was there before."""
    return session.gallery.tray_before is not None


def bring_set_back(session: Session) -> None:
    """Show the set that was there before; doing it again shows the present one."""
    gallery = session.gallery
    before = gallery.tray_before
    if before is not None:
        gallery.tray, gallery.tray_before = before, gallery.tray


def ask_export(session: Session) -> None:
    """Show the questions about a set: of the set's levels, or else of the chosen ones."""
    gallery = session.gallery
    if not gallery.open:
        browsing.toggle(session)
    if not gallery.tray:
        put_in_set(
            session, [card.path for card in gallery.chosen(session.library, session.results)]
        )
    if not gallery.tray:
        session.complain("Choose the levels of the set first: Ctrl+A takes all that are shown.")
        return
    gallery.plan = gallery.plan or gallery.proposed


def refused_in_set(session: Session) -> dict[str, str]:
    """Paths and names of the levels that cannot go in: with an error, unreadable, or gone."""
    found = {}
    for path in session.gallery.tray:
        card = session.library.card(path)
        if (card is not None and (card.errors or card.fault)) or not os.path.isfile(path):
            found[path] = Path(path).stem if card is None else card.name
    return found


def leave_out_refused(session: Session) -> None:
    """Take the levels that cannot go in out of the set."""
    refused = refused_in_set(session)
    kept = {path: weight for path, weight in session.gallery.tray.items() if path not in refused}
    _replace(session, kept, f"Took {plural(len(refused), 'level')} out of the set")


def export_now(session: Session) -> None:
    """Ask where, and write the set; many levels are written in the background."""
    gallery = session.gallery
    plan = gallery.plan
    if plan is None:
        return
    folder = plan.form == "folder"
    if not gallery.tray:
        raise CommandError("No level is in the set: put some into it first.")
    if gallery.exporting is not None:
        raise CommandError("Another set is being exported: wait until that is done.")
    bad = refused_in_set(session)
    if bad:
        name = next(iter(bad.values()))
        raise CommandError(f"{name} has an error or is gone: repair it, or leave it out.")

    def answer(path: Path | None) -> None:
        if path is not None:
            _write(session, path, plan)

    session.ask(
        FileQuestion(
            purpose="save",
            title="Export level set as a folder" if folder else "Export level set",
            folder=_set_folder(session),
            name=f"{filing.stem_of(plan.name)}{'' if folder else '.json'}",
            as_folder=folder,
            answer=answer,
        )
    )


def _write(session: Session, path: Path, plan: SetPlan) -> None:
    """Write the set; where that takes long, beside the window."""
    gallery = session.gallery
    levels = {Path(each): weight for each, weight in gallery.tray.items()}
    if len(levels) <= MOST_AT_ONCE:
        try:
            made = export_set(levels, plan, path)
        except LevelError as error:
            session.toast(str(error), "error")
            return
        gallery.plan = None
        _exported(session, path, levels, plan, made)
        return
    gallery.plan, gallery.exporting = None, path
    session.toast(f"Exporting {plural(len(levels), 'level')} to {path} …")

    def take(told: LoadedSet | KinetixError) -> None:
        gallery.exporting = None
        if isinstance(told, KinetixError):
            gallery.plan = gallery.plan or plan
            session.toast(str(told), "error")
        else:
            _exported(session, path, levels, plan, told)

    session.fetches.begin(lambda: export_set(levels, plan, path), take)


def _exported(
    session: Session, path: Path, levels: dict[Path, float], plan: SetPlan, made: LoadedSet
) -> None:
    """Report what was written of these levels and their weights."""
    session.gallery.proposed = plan
    doubles = len(levels) - len(made.levels)
    train = sum(each.split == "train" for each in made.levels)
    more = f", {doubles} left out because they equal others" if doubles else ""
    if doubles and len(set(levels.values())) > 1:
        more += ", the largest weight stays"
    session.toast(
        f"Saved {path}: {train} to train on, {len(made.levels) - train} to evaluate on{more}",
        "success",
    )
    _tell_losses(session, made, inline=plan.form == "file")
    browsing.look(session)


def _tell_losses(session: Session, made: LoadedSet, *, inline: bool) -> None:
    """List what the set does not carry of kinetix-env's files, as `kinetix levelset build` does."""
    told = inline_losses(made, inline=inline)
    if told:
        more = f" (and {len(told) - 1} more, see the log)" if len(told) > 1 else ""
        session.toast(f"{told[0]}{more}", "warning")
    for sentence in told[1:]:
        session.log.add(sentence)


def _set_folder(session: Session) -> Path:
    """Return the proposed folder of a set: beside the first level unless that one is bundled."""
    first = next((Path(path) for path in session.gallery.tray), None)
    if first is not None and not filing.bundled(first):
        return first.parent
    own = user_levels_dir()
    return own if os.path.isdir(own) else Path.home()
