"""The editor without a window."""

import tempfile
from pathlib import Path

from editor.documents import files
from editor.documents.commands.group import Move
from editor.documents.document import Document
from editor.editing import picking
from editor.editing.snapping import Rules, snap_shift, targets
from editor.hosts.bench.rows import Row, crowded_level, median_ms
from kinetix.level.validate import validate


def core_rows() -> list[Row]:
    """Measure the editor without a window: picking, undo, snapping, opening, checking."""
    level = crowded_level()
    body = level.bodies[0]
    # A drag works out what it may snap to once, when it starts.
    available = targets(level, (body.id,))
    rules = Rules(smart=True, grid=0.1, catch=0.08, release=0.12)

    def hit() -> None:
        picking.stack(level, (2.5, 2.5), 0.08)
        snap_shift((body,), (0.013, 0.011), rules, available)

    document = Document(level)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.json"
        saving = median_ms(lambda: files.save_document(document, path, "kinetix-level"), 20)

    def undo() -> None:
        document.commit(Move(ids=(1,), shift=(0.1, 0.0)))
        document.undo()

    return [
        Row(
            code="PE2",
            metric="hit test and snap, 50 entities",
            value=f"{median_ms(hit):.2f} ms",
            target="0.3 ms",
        ),
        Row(code="PE9", metric="save a level", value=f"{saving:.1f} ms", target="20 ms"),
        Row(code="PE9", metric="edit and undo", value=f"{median_ms(undo):.2f} ms", target="5 ms"),
        Row(
            code="PE11",
            metric="validate, 50 entities",
            value=f"{median_ms(lambda: validate(level)):.2f} ms",
            target="5 ms",
        ),
    ]
