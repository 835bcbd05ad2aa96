"""List the problems of levels and level sets; exit status 1 when one of them is an error."""

import dataclasses
import json as json_module
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import tyro
from tyro.conf import Positional

from kinetix.bundled import named_levels, refuse_empty
from kinetix.cli.shared.one_core import OneCore
from kinetix.errors import LevelError, plain
from kinetix.failures import crash_sentence
from kinetix.level.codec import (
    LEVELSET_FORMAT,
    LoadedLevel,
    format_of,
    load_document,
    resolve_path,
)
from kinetix.level.json_text import parse_json, read_text
from kinetix.level.sets import is_set_file, issues_in_file, json_files, load_set
from kinetix.level.validate import Issue, has_errors, validate


@dataclasses.dataclass(frozen=True, kw_only=True)
class Validate(OneCore):
    """List the problems of levels and level sets."""

    files: Annotated[Positional[tuple[str, ...]], tyro.conf.arg(metavar="FILE …")]
    """Level files of either format, names of bundled levels, level sets, or folders of them."""
    json: bool = False
    """Print one JSON object a file on stdout, and nothing else there."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class FileReport:
    """Problems of one file."""

    file: str
    format: str | None
    """Format that the file says it has; None where it says none or is no JSON."""
    issues: tuple[Issue, ...]

    @property
    def ok(self) -> bool:
        """True if there is no error."""
        return not has_errors(self.issues)


def run(command: Validate) -> int:
    """Print the problems of each file.

    Returns:
        0 when no file has an error, 1 when one has, 2 when no file was named.
    """
    if not command.files:
        print("kinetix validate: expected at least one file", file=sys.stderr)
        return 2
    ok = True
    for file in named_files(command.files):
        report = file_report(file)
        ok = ok and report.ok
        print(_json_line(report) if command.json else _text(report), flush=True)
    return 0 if ok else 1


def named_files(files: tuple[str, ...]) -> Iterator[str]:
    """The files that the command line means.

    Folders stand for the JSON files below them; a folder without any stands for itself.
    """
    for file in files:
        refuse_empty(file, "a level file or a folder")
        folder = Path(file) if os.path.exists(file) else named_levels(file)
        if folder is not None and os.path.isdir(folder):
            yield from map(str, json_files(folder) or [folder])
        else:
            yield file


def file_report(file: str) -> FileReport:
    """The problems of one file, those of reading it included."""
    path = None
    try:
        if os.path.isdir(file):
            raise LevelError(f"{file}: expected level files in this folder, found none")
        path = resolve_path(file)
        if is_set_file(path):
            return FileReport(file=file, format=LEVELSET_FORMAT, issues=tuple(_set_issues(path)))
        loaded = load_document(path)
        issues = tuple(_level_issues(loaded))
    except LevelError as error:
        found = [
            dataclasses.replace(issue, message=issue.message.removeprefix(f"{file}: "))
            for issue in reading_issues(error)
        ]
        return FileReport(file=file, format=_told_format(path), issues=tuple(found))
    except Exception as error:  # a fault of ours in one file must not hide the others
        message = crash_sentence(error, "kinetix validate", [file])
        issue = Issue(code="E001", severity="error", path="$", message=message)
        return FileReport(file=file, format=None, issues=(issue,))
    return FileReport(file=file, format=loaded.format, issues=issues)


def _told_format(path: Path | None) -> str | None:
    """The format that a file says it has, though its content is bad."""
    try:
        return None if path is None else format_of(parse_json(read_text(path, "set"), str(path)))
    except LevelError:
        return None


def _level_issues(loaded: LoadedLevel) -> Iterator[Issue]:
    """Yield the problems of a file, each with its path in that file."""
    yield from issues_in_file(loaded.level, loaded.source)
    for mend in loaded.mends:
        message = f"Mended on reading: {mend.message}."
        yield Issue(code=mend.code, severity="warning", path=mend.path, message=message)


def _set_issues(path: Path) -> Iterator[Issue]:
    loaded = load_set(path)
    if not loaded.levels:
        message = "Expected levels in this set, found none."
        yield Issue(code="E001", severity="error", path="$.levels", message=message)
    for k, (entry, each) in enumerate(zip(loaded.manifest.levels, loaded.levels, strict=True)):
        if entry.path is None:
            for issue in validate(each.level):
                where = f"$.levels[{k}].level{issue.path[1:]}"
                message = f"{each.name}: {issue.message}"
                yield dataclasses.replace(issue, path=where, message=message)
        elif each.path is not None:
            issues = (
                validate(each.level) if each.native else _level_issues(load_document(each.path))
            )
            for issue in issues:
                message = f"{entry.path}: {issue.path}: {issue.message}"
                yield dataclasses.replace(issue, path=f"$.levels[{k}].path", message=message)


def reading_issues(error: LevelError) -> Iterator[Issue]:
    """Yield what is wrong with a file that cannot be read."""
    for fault in error.faults:
        yield Issue(code=fault.code, severity="error", path=fault.path, message=fault.message)
    if not error.faults:
        yield Issue(code="E001", severity="error", path="$", message=str(error))


def issue_tree(issue: Issue) -> dict[str, Any]:
    """Return an issue as commands print it in JSON."""
    return {
        "code": issue.code,
        "severity": issue.severity,
        "path": issue.path,
        "message": issue.message,
    }


def _json_line(report: FileReport) -> str:
    tree = {
        "file": report.file,
        "ok": report.ok,
        "format": report.format,
        "issues": [issue_tree(issue) for issue in report.issues],
    }
    return json_module.dumps(tree, ensure_ascii=False)


def _text(report: FileReport) -> str:
    if not report.issues:
        return f"{plain(report.file)}: no problems"
    return "\n".join(
        f"{plain(report.file)}: {issue.severity} {issue.code} {issue.path}: {plain(issue.message)}"
        for issue in report.issues
    )
