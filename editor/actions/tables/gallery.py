"""Rows of the Gallery menu."""

from typing import Final

from editor.actions import gallery
from editor.actions.base import Action, Context

GALLERY: Final = (
    Action(
        id="gallery.open",
        label="Open",
        menu="Gallery",
        keys=("return",),
        context=Context.GALLERY,
        tooltip="Or a double click.",
        enabled=gallery.choosing,
        refusal="Choose levels in the gallery first.",
        run=gallery.open_chosen,
    ),
    Action(
        id="gallery.rename",
        label="Rename…",
        menu="Gallery",
        keys=("f2",),
        context=Context.GALLERY,
        enabled=gallery.choosing,
        refusal="Choose levels in the gallery first.",
        run=gallery.rename,
    ),
    Action(
        id="gallery.duplicate",
        label="Duplicate",
        menu="Gallery",
        keys=("ctrl+d",),
        context=Context.GALLERY,
        tooltip="Copies of the app's own levels go to your folder.",
        enabled=gallery.choosing,
        refusal="Choose levels in the gallery first.",
        run=gallery.duplicate,
    ),
    Action(
        id="gallery.delete",
        label="Delete",
        menu="Gallery",
        keys=("delete",),
        context=Context.GALLERY,
        tooltip="To the trash.",
        enabled=gallery.choosing,
        refusal="Choose levels in the gallery first.",
        run=gallery.delete,
    ),
    Action(
        id="gallery.restore",
        label="Bring Back",
        menu="Gallery",
        keys=("ctrl+z",),
        context=Context.GALLERY,
        tooltip="What was deleted last.",
        enabled=gallery.can_restore,
        refusal="Nothing was moved to the trash.",
        run=gallery.restore,
    ),
    Action(
        id="gallery.select_all",
        label="Choose All",
        menu="Gallery",
        keys=("ctrl+a",),
        context=Context.GALLERY,
        run=gallery.select_all,
    ),
    Action(
        id="gallery.add_to_set",
        label="Add to the Set",
        menu="Gallery",
        keys=("ctrl+shift+a",),
        context=Context.GALLERY,
        enabled=gallery.choosing,
        refusal="Choose levels in the gallery first.",
        run=gallery.add_to_set,
    ),
    Action(
        id="gallery.close",
        label="Back to the Level",
        menu="Gallery",
        keys=("escape",),
        context=Context.GALLERY,
        run=gallery.close,
    ),
    Action(
        id="gallery.add_folder",
        label="Add a Folder…",
        menu="Gallery",
        context=Context.GALLERY,
        run=gallery.add_folder,
    ),
    *(
        Action(
            id=f"gallery.move_{name}",
            label=label,
            menu="Gallery",
            keys=keys,
            context=Context.GALLERY,
            run=gallery.move(steps),
        )
        for name, label, keys, steps in (
            ("left", "Card Before", ("left",), lambda s: -1),
            ("right", "Card After", ("right",), lambda s: 1),
            ("up", "Card Above", ("up",), lambda s: -s.gallery.columns),
            ("down", "Card Below", ("down",), lambda s: s.gallery.columns),
            ("page_up", "Page Up", ("page up",), lambda s: -s.gallery.columns * s.gallery.rows),
            (
                "page_down",
                "Page Down",
                ("page down",),
                lambda s: s.gallery.columns * s.gallery.rows,
            ),
            ("first", "First Card", ("home",), lambda s: -len(s.library.cards)),
            ("last", "Last Card", ("end",), lambda s: len(s.library.cards)),
        )
    ),
)
