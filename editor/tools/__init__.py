"""The tools by id; adding one is a file and its name here."""

from typing import Final

from editor.tools.base import Tool
from editor.tools.circle import CircleTool
from editor.tools.joint import JointTool, WeldTool
from editor.tools.rectangle import RectangleTool
from editor.tools.select.idle import SelectTool
from editor.tools.thruster import ThrusterTool
from editor.tools.triangle import TriangleTool

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
