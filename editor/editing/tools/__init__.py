"""The tools by id; adding one is a file and its name here."""

from typing import Final

from editor.editing.tools.base import Tool
from editor.editing.tools.circle import CircleTool
from editor.editing.tools.joint import JointTool, WeldTool
from editor.editing.tools.rectangle import RectangleTool
from editor.editing.tools.select.idle import SelectTool
from editor.editing.tools.thruster import ThrusterTool
from editor.editing.tools.triangle import TriangleTool

TOOLS: Final[dict[str, Tool]] = {
    tool.id: tool
    for tool in (
        SelectTool(),
        RectangleTool(),
        CircleTool(),
        TriangleTool(),
        JointTool(),
        WeldTool(),
        ThrusterTool(),
    )
}
