"""Rows of the File menu."""

from typing import Final

from editor.actions.base import Action, Context
from editor.actions.evaluation import comparison
from editor.actions.files import (
    address,
    export,
    external_change,
    file,
    quitting,
    recording,
    recover,
)

FILE: Final = (
    Action(id="file.new", label="New", menu="File", group="open", keys=("ctrl+n",), run=file.new),
    Action(
        id="file.open",
        label="Open…",
        menu="File",
        group="open",
        keys=("ctrl+o",),
        run=file.ask_open,
    ),
    Action(
        id="file.open_trace",
        label="Open Episode…",
        menu="File",
        group="open",
        tooltip="A trace (.npz) that was exported: look at it again, step by step.",
        run=export.ask_trace,
    ),
    Action(
        id="file.open_address",
        label="Open Address…",
        menu="File",
        group="open",
        tooltip="A level, an episode or a comparison on the web.",
        run=address.ask,
    ),
    Action(
        id="file.open_comparison",
        label="Open Comparison…",
        menu="File",
        group="open",
        tooltip="A .json of kinetix compare, or saved from the Evaluate panel: its table again.",
        run=comparison.ask_comparison,
    ),
    Action(
        id="file.save", label="Save", menu="File", group="save", keys=("ctrl+s",), run=file.save
    ),
    Action(
        id="file.save_as",
        label="Save As…",
        menu="File",
        group="save",
        keys=("ctrl+shift+s",),
        run=file.save_as,
    ),
    *(
        Action(
            id=f"file.{name}",
            label=label,
            menu="File",
            group="save",
            tooltip=tooltip,
            enabled=enabled,
            passing=True,
            refusal="No other program has changed the file, or it cannot be read now.",
            run=run,
        )
        for name, label, tooltip, enabled, run in (
            (
                "reload",
                "Reload",
                "What the file holds now, as one edit.",
                external_change.is_readable,
                external_change.reload,
            ),
            (
                "keep_mine",
                "Keep Mine",
                "Saving overwrites the other one.",
                external_change.is_changed,
                external_change.keep,
            ),
            (
                "differences",
                "Differences…",
                "What differs between the file and the level here.",
                external_change.is_readable,
                external_change.show_differences,
            ),
        )
    ),
    Action(
        id="file.export",
        label="Export…",
        menu="File",
        group="export",
        context=Context.LEVEL,
        keys=("ctrl+e",),
        tooltip="Picture, film, trace, or a level for kinetix-env.",
        run=export.ask_export,
    ),
    Action(
        id="file.stop_export",
        label="Stop the Export",
        menu="File",
        group="export",
        tooltip="Cancels exports that are being written or waiting.",
        enabled=lambda session: bool(export.writing(session)),
        passing=True,
        refusal="Nothing is being exported.",
        run=export.stop,
    ),
    Action(
        id="file.screenshot",
        label="Save Screenshot",
        menu="File",
        group="export",
        keys=("ctrl+p",),
        tooltip="A picture of the whole window.",
        run=export.screenshot,
    ),
    Action(
        id="file.record",
        label="Record Film",
        menu="File",
        group="export",
        context=Context.LEVEL,
        keys=("ctrl+shift+r",),
        tooltip="Start and stop recording what is played as a GIF.",
        checked=lambda session: session.films.recording is not None,
        run=recording.start_or_end,
    ),
    Action(
        id="file.undiscard",
        label="Bring Back Discarded Work",
        menu="File",
        group="close",
        tooltip="Brings unsaved work that was discarded at the start back from the trash.",
        enabled=recover.can_bring_back,
        passing=True,
        refusal="No unsaved work was discarded.",
        run=recover.bring_back,
    ),
    Action(
        id="file.close_tab",
        label="Close Tab",
        menu="File",
        group="close",
        keys=("ctrl+w",),
        run=file.close_tab,
    ),
    Action(
        id="file.quit",
        label="Quit",
        menu="File",
        group="close",
        keys=("ctrl+q",),
        run=quitting.quit_app,
    ),
)
