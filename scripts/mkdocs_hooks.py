"""Brings documents that live beside the code into the site; mends links that cross the border."""

import posixpath
import re
from pathlib import Path
from typing import Final

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT: Final = Path(__file__).resolve().parents[1]
GUESTS: Final = {
    "README.md": "project/README.md",
    "ARCHITECTURE.md": "project/ARCHITECTURE.md",
    "CONTRIBUTING.md": "project/CONTRIBUTING.md",
    "CHANGELOG.md": "project/CHANGELOG.md",
    "kinetix/engine/README.md": "project/engine.md",
    "kinetix/level/README.md": "project/level.md",
    "checkpoints/README.md": "project/agents.md",
}
"""Documents outside docs/, and where the site shows them."""

_LINK: Final = re.compile(r"(?P<text>!?\[[^\]]*\])\((?!\w+:|#)(?P<path>[^)#\s]+)(?P<rest>[^)]*)\)")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the guests."""
    for source, shown in GUESTS.items():
        files.append(File.generated(config, shown, content=(ROOT / source).read_text("utf-8")))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Point links at where the site has what they mean; drop those to plain files of code."""
    del config
    homes = {shown: source for source, shown in GUESTS.items()}
    shown = page.file.src_uri
    folder = posixpath.dirname(homes.get(shown, f"docs/{shown}"))

    def mended(match: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(folder, match["path"]))
        place = GUESTS.get(target, target.removeprefix("docs/"))
        if files.get_file_from_path(place) is None:
            # Code is not part of the site; what is nowhere at all shall fail the build.
            return match["text"][1:-1] if (ROOT / target).exists() else match[0]
        where = posixpath.relpath(place, posixpath.dirname(shown) or ".")
        return f"{match['text']}({where}{match['rest']})"

    return re.sub(_LINK, mended, markdown)
