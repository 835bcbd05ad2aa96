"""Actions of the gallery: open it, open, rename, duplicate and delete levels, assemble sets."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor.actions import agents, file, measure, outside
from editor.base.prompts import FileQuestion, TextQuestion
from editor.gallery import filing
from editor.gallery.card import Card
from editor.gallery.export import SetPlan, export_set, refused
from editor.play.mode import Mode
from editor.session import Session
from kinetix.errors import CommandError, LevelError
from kinetix.level.sets import load_set
from kinetix.paths import levels_dir, user_levels_dir
from kinetix.wording import plural

ATTEMPTS: Final = 20
"""Per level and agent, where nothing else was said."""
MAX_OPENED: Final = 12
"""Most levels that are opened at once: each is a tab."""


def folders(session: Session) -> list[Path]:
    """Return the folders of the gallery: the app's levels, the user's, and the folders added."""
    found = [levels_dir(), user_levels_dir(), *map(Path, session.settings.gallery_folders)]
    return list(dict.fromkeys(path for path in found if os.path.isdir(path)))


def unreachable(session: Session) -> list[Path]:
    """Return the folders that the user has added and that cannot be looked into now."""
    added = map(Path, session.settings.gallery_folders)
    return [path for path in dict.fromkeys(added) if not os.path.isdir(path)]


def look(session: Session) -> None:
    """Look through the folders again, in the background."""
    session.library.look(folders(session))


def toggle(session: Session) -> None:
    """Show the gallery, or go back to the level; what is open stays as it is."""
    gallery = session.gallery
    gallery.open = not gallery.open
    if not gallery.open:
        return
    session.driver.cancel()
    session.release_all()
    if session.mode is Mode.PLAYING:
        session.playback.pause()
    look(session)


def is_open(session: Session) -> bool:
    """Return whether the gallery is on the screen."""
    return session.gallery.open


def close(session: Session) -> None:
    """Back to the level; first the export's questions go."""
    if session.gallery.plan is not None:
        session.gallery.plan = None
    else:
        session.gallery.open = False


def choosing(session: Session) -> bool:
    """Return whether levels are chosen in the gallery."""
    return session.gallery.open and bool(session.gallery.chosen(session.library))


def _chosen(session: Session) -> list[Card]:
    chosen = session.gallery.chosen(session.library)
    if not chosen:
        raise CommandError("Choose a level first.")
    return chosen


def open_chosen(session: Session) -> None:
    """Open every chosen level in a tab."""
    chosen = _chosen(session)
    if len(chosen) > MAX_OPENED:
        raise CommandError(f"{len(chosen)} levels are too many tabs: choose up to {MAX_OPENED}.")
    opened = [file.open_path(session, card.file) for card in chosen]
    if any(opened):
        session.gallery.open = False


def play_agent(session: Session) -> None:
    """Open the chosen level and let agent A play it; without one, ask which."""
    first, *others = _chosen(session)
    if others:
        raise CommandError("Choose one level to be played.")
    if file.open_path(session, first.file):
        session.gallery.open = False
        agents.play_agent(session)


def evaluate(session: Session) -> None:
    """Measure the loaded agents on the chosen levels, as *Evaluate* does at first."""
    who = tuple(dict.fromkeys((*session.viewer.agents, *session.viewer.contenders)))
    if not who:
        agents.choose("a")(session)
        raise CommandError("Choose an agent first, then evaluate again.")
    measure.start_evaluation(
        session,
        who,
        tuple(card.path for card in _chosen(session)),
        attempts=ATTEMPTS,
        seed=0,
        physics="",
        deterministic=session.viewer.deterministic,
    )
    session.gallery.open = False
    session.view.front, session.view.levels_to_measure = "evaluate", "chosen"


def move(steps: Callable[[Session], int]) -> Callable[[Session], None]:
    """An action that goes on by some cards."""

    def run(session: Session) -> None:
        gallery = session.gallery
        gallery.move(gallery.shown(session.library, session.results), steps(session))

    return run


def select_all(session: Session) -> None:
    """Choose all that is shown."""
    gallery = session.gallery
    gallery.selection = tuple(card.path for card in gallery.shown(session.library, session.results))


def _guard_file(session: Session, path: Path) -> None:
    """Refuse what would take a file away from under unsaved changes, or from the app itself.

    Raises:
        CommandError: With the reason.
    """
    if filing.bundled(path):
        raise CommandError(f"{path.name} came with the app: duplicate it and change the copy.")
    index = session.tabs.locate(path)
    if index is not None and session.tabs[index].document.dirty:
        raise CommandError(f"{path.name} has unsaved changes: save or close it first.")


def rename(session: Session) -> None:
    """Ask for another name of the chosen level."""
    card = _chosen(session)[0]
    _guard_file(session, card.file)

    def answer(name: str | None) -> None:
        if name is None or name == card.name:
            return
        index = session.tabs.locate(card.file)
        target = filing.rename(card.file, name)
        session.old_names.move(card.file, target)
        if index is not None:
            document = session.tabs[index].document
            document.path = target
            outside.take(session, document)
        gallery = session.gallery
        gallery.selection, gallery.focus = (str(target),), str(target)
        if card.path in gallery.tray:
            gallery.tray[str(target)] = gallery.tray.pop(card.path)
        look(session)

    session.ask(TextQuestion(title="Rename level", text=card.name, accept="Rename", answer=answer))


def duplicate(session: Session) -> None:
    """Copy the chosen levels; copies of the app's own go to the user's folder."""
    made = [filing.duplicate(card.file) for card in _chosen(session)]
    session.gallery.selection = tuple(map(str, made))
    session.gallery.focus, session.gallery.scroll = str(made[0]), True
    session.toast(f"Made {made[0]}" if len(made) == 1 else f"Made {len(made)} copies", "success")
    look(session)


def delete(session: Session) -> None:
    """Move the chosen levels to the trash."""
    chosen = _chosen(session)
    for card in chosen:
        _guard_file(session, card.file)
    thrown = []
    try:
        for card in chosen:
            thrown.append(filing.throw_away(card.file))
    finally:
        if thrown:
            session.gallery.thrown.append(tuple(thrown))
        session.gallery.selection = ()
        for one in thrown:
            session.gallery.tray.pop(str(one.origin), None)
        look(session)
    name = chosen[0].name if len(chosen) == 1 else f"{len(chosen)} levels"
    session.toast(f"Moved {name} to the trash", action="gallery.restore")


def can_restore(session: Session) -> bool:
    """Return whether something was deleted that can come back."""
    return bool(session.gallery.thrown)


def restore(session: Session) -> None:
    """Bring back what was deleted last; what cannot come back now waits behind all others.

    Raises:
        LevelError: Something cannot.
    """
    deletions = session.gallery.thrown
    back, waiting, reason = [], [], None
    for one in deletions.pop():
        try:
            filing.bring_back(one)
            back.append(one)
        except LevelError as error:
            waiting.append(one)
            reason = reason or error
    if waiting:
        deletions.insert(0, tuple(waiting))
    session.gallery.selection = tuple(str(one.origin) for one in back)
    look(session)
    if reason is not None:
        others = f" (and {len(waiting) - 1} more)" if len(waiting) > 1 else ""
        raise LevelError(f"{reason}{others}")


def include_folder(session: Session, folder: Path) -> None:
    """Show a folder's levels in the gallery, from now on."""
    name = str(folder.resolve())
    if name not in session.settings.gallery_folders:
        session.settings.gallery_folders.append(name)
    session.gallery.folder = folder.resolve()
    look(session)


def add_folder(session: Session) -> None:
    """Choose a folder whose levels the gallery shows too."""

    def answer(path: Path | None) -> None:
        if path is not None:
            include_folder(session, path)

    session.ask(
        FileQuestion(
            purpose="folder",
            title="Add a folder to the gallery",
            folder=Path.home(),
            answer=answer,
        )
    )


def remove_folder(session: Session, folder: Path) -> None:
    """Show a folder's levels no more; the files stay."""
    session.settings.gallery_folders = [
        name for name in session.settings.gallery_folders if Path(name) != folder
    ]
    if session.gallery.folder == folder:
        session.gallery.folder = None
    look(session)


def add_to_set(session: Session) -> None:
    """Put the chosen levels into the set."""
    put_in_set(session, [card.path for card in _chosen(session)])


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
        toggle(session)
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
        look(session)

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
