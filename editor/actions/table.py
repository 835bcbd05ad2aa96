"""The one table of user actions (editor.md 3.13): menus, toolbar, keys, palette, help, replays."""

from typing import Final

from editor.actions import edit, export, file, gallery, level, physics, play, view
from editor.actions.agent_table import AGENTS
from editor.actions.base import Action, Context, editing, playing, selecting
from editor.playback import SPEEDS, Mode
from editor.session import Session

EDIT, PLAY = Context.EDIT, Context.PLAY


def _can_undo(session: Session) -> bool:
    under_way = session.driver.active or session.document.history.undo_label is not None
    return session.editing and under_way


def _can_redo(session: Session) -> bool:
    return session.editing and session.document.history.redo_label is not None


def _has_file(session: Session) -> bool:
    return session.document.path is not None


FILE: Final = (
    Action(id="file.new", label="New", menu="File", keys=("ctrl+n",), run=file.new),
    Action(id="file.open", label="Open…", menu="File", keys=("ctrl+o",), run=file.ask_open),
    Action(id="file.save", label="Save", menu="File", keys=("ctrl+s",), run=file.save),
    Action(
        id="file.save_as",
        label="Save As…",
        menu="File",
        keys=("ctrl+shift+s",),
        run=file.save_as,
    ),
    Action(
        id="file.close_tab", label="Close Tab", menu="File", keys=("ctrl+w",), run=file.close_tab
    ),
    Action(
        id="file.export",
        label="Export…",
        menu="File",
        context=Context.LEVEL,
        keys=("ctrl+e",),
        tooltip="Picture, film or trace.",
        run=export.ask_export,
    ),
    Action(
        id="file.screenshot",
        label="Save Screenshot",
        menu="File",
        keys=("ctrl+p",),
        tooltip="A picture of the whole window.",
        run=export.screenshot,
    ),
    Action(
        id="file.record",
        label="Record Film",
        menu="File",
        context=Context.LEVEL,
        keys=("ctrl+shift+r",),
        tooltip="Start and stop recording what is played as a GIF.",
        checked=lambda session: session.recording is not None,
        run=export.record,
    ),
    Action(id="file.quit", label="Quit", menu="File", keys=("ctrl+q",), run=file.quit_app),
)

EDITS: Final = (
    Action(
        id="edit.undo",
        label="Undo",
        menu="Edit",
        keys=("ctrl+z",),
        context=EDIT,
        enabled=_can_undo,
        run=edit.undo,
    ),
    Action(
        id="edit.redo",
        label="Redo",
        menu="Edit",
        keys=("ctrl+shift+z", "ctrl+y"),
        context=EDIT,
        enabled=_can_redo,
        run=edit.redo,
    ),
    Action(
        id="edit.cut",
        label="Cut",
        menu="Edit",
        keys=("ctrl+x",),
        context=EDIT,
        enabled=selecting,
        run=edit.cut,
    ),
    Action(
        id="edit.copy",
        label="Copy",
        menu="Edit",
        keys=("ctrl+c",),
        context=EDIT,
        tooltip="Shapes with their joints and thrusters.",
        enabled=selecting,
        run=edit.copy,
    ),
    Action(
        id="edit.paste",
        label="Paste",
        menu="Edit",
        keys=("ctrl+v",),
        context=EDIT,
        tooltip="At the pointer.",
        enabled=editing,
        run=edit.paste,
    ),
    Action(
        id="edit.paste_properties",
        label="Paste Properties",
        menu="Edit",
        keys=("ctrl+shift+v",),
        context=EDIT,
        tooltip="Role, density, surface, motor, limits: everything but place and shape.",
        enabled=selecting,
        run=edit.paste_properties,
    ),
    Action(
        id="edit.duplicate",
        label="Duplicate",
        menu="Edit",
        keys=("ctrl+d",),
        context=EDIT,
        enabled=selecting,
        run=edit.duplicate,
    ),
    Action(
        id="edit.select_all",
        label="Select All",
        menu="Edit",
        keys=("ctrl+a",),
        context=EDIT,
        enabled=editing,
        run=edit.select_all,
    ),
    Action(
        id="edit.delete",
        label="Delete",
        menu="Edit",
        keys=("delete", "backspace"),
        context=EDIT,
        tooltip="With the joints and thrusters that hang on it.",
        enabled=selecting,
        run=edit.delete,
    ),
    Action(
        id="edit.cancel",
        label="Cancel",
        menu="Edit",
        keys=("escape",),
        context=EDIT,
        tooltip="Leave what is under way; again: back to Select.",
        enabled=editing,
        run=edit.cancel,
    ),
)

ARRANGE: Final = (
    Action(
        id="edit.lock",
        label="Lock",
        menu="Arrange",
        keys=("ctrl+l",),
        context=EDIT,
        tooltip="Locked things are neither picked nor dragged.",
        enabled=selecting,
        run=edit.toggle_lock,
    ),
    Action(
        id="edit.hide",
        label="Hide",
        menu="Arrange",
        keys=("ctrl+h",),
        context=EDIT,
        tooltip="With nothing selected: show everything again.",
        enabled=editing,
        run=edit.toggle_hide,
    ),
    Action(
        id="edit.mirror_horizontal",
        label="Mirror Left–Right",
        menu="Arrange",
        keys=("ctrl+shift+h",),
        context=EDIT,
        enabled=selecting,
        run=edit.mirror("x"),
    ),
    Action(
        id="edit.mirror_vertical",
        label="Mirror Up–Down",
        menu="Arrange",
        keys=("ctrl+shift+u",),
        context=EDIT,
        enabled=selecting,
        run=edit.mirror("y"),
    ),
    *(
        Action(
            id=f"edit.align_{name}",
            label=label,
            menu="Arrange",
            context=EDIT,
            enabled=selecting,
            run=edit.align(label, axis, place),
        )
        for name, label, axis, place in (
            ("left", "Align Left", 0, lambda box: box[0]),
            ("centre_x", "Align Centres Across", 0, lambda box: (box[0] + box[2]) / 2),
            ("right", "Align Right", 0, lambda box: box[2]),
            ("top", "Align Top", 1, lambda box: box[3]),
            ("centre_y", "Align Centres Up", 1, lambda box: (box[1] + box[3]) / 2),
            ("bottom", "Align Bottom", 1, lambda box: box[1]),
        )
    ),
    *(
        Action(
            id=f"edit.distribute_{name}",
            label=label,
            menu="Arrange",
            context=EDIT,
            tooltip="Equal gaps between three or more shapes.",
            enabled=selecting,
            run=edit.distribute(label, axis),
        )
        for name, label, axis in (
            ("x", "Distribute Across", 0),
            ("y", "Distribute Up", 1),
        )
    ),
    Action(
        id="edit.forward",
        label="Bring Forward",
        menu="Arrange",
        context=EDIT,
        enabled=selecting,
        run=edit.reorder(1),
    ),
    Action(
        id="edit.back",
        label="Send Back",
        menu="Arrange",
        context=EDIT,
        enabled=selecting,
        run=edit.reorder(-1),
    ),
    *(
        Action(
            id=f"transform.nudge_{name}",
            label=f"Nudge {name.capitalize()}",
            menu="Arrange",
            keys=(name,),
            variants=(f"shift+{name}", f"alt+{name}"),
            context=EDIT,
            tooltip="0.05 m; Shift: ten times as far, Alt: a tenth.",
            enabled=selecting,
            run=edit.nudge(x, y),
        )
        for name, x, y in (("left", -1, 0), ("right", 1, 0), ("up", 0, 1), ("down", 0, -1))
    ),
    *(
        Action(
            id=f"transform.{name}",
            label=label,
            menu="Arrange",
            keys=(key,),
            variants=variants,
            context=EDIT,
            tooltip=tooltip,
            enabled=selecting,
            run=edit.turn(degrees),
        )
        for name, label, key, variants, tooltip, degrees in (
            ("rotate_ccw", "Rotate Left 15°", "q", ("shift+q",), "Shift: 1°.", 15.0),
            ("rotate_cw", "Rotate Right 15°", "e", ("shift+e",), "Shift: 1°.", -15.0),
            ("rotate_ccw_45", "Rotate Left 45°", "[", (), "", 45.0),
            ("rotate_cw_45", "Rotate Right 45°", "]", (), "", -45.0),
        )
    ),
)

TOOL_ACTIONS: Final = tuple(
    Action(
        id=f"tool.{tool}",
        label=label,
        menu="Tools",
        keys=(key,),
        context=EDIT,
        tooltip=tooltip,
        enabled=editing,
        checked=view.is_tool(tool),
        run=view.choose(tool),
    )
    for tool, label, key, tooltip in (
        ("select", "Select", "v", "Select, move, turn and resize."),
        ("rectangle", "Rectangle", "r", "Press the key twice to draw several."),
        ("circle", "Circle", "c", "Press the key twice to draw several."),
        ("triangle", "Triangle", "t", "Three clicks."),
        ("joint", "Joint", "j", "A hinge with a motor, where two shapes overlap."),
        ("weld", "Weld", "w", "Makes two overlapping shapes one."),
        ("thruster", "Thruster", "h", "Pushes a shape; drag where to."),
    )
)

SWITCHES: Final = tuple(
    Action(
        id=action_id,
        label=label,
        menu=menu,
        tooltip=tooltip,
        checked=view.is_set(setting),
        run=view.switch_setting(setting),
    )
    for action_id, label, menu, tooltip, setting in (
        ("tool.keep", "Keep Tool", "Tools", "Draw several things in a row.", "keep_tool"),
        (
            "tool.from_centre",
            "Draw from the Centre",
            "Tools",
            "What Alt does while a rectangle is drawn.",
            "from_centre",
        ),
        (
            "transform.move_jointed",
            "Move Jointed Shapes Together",
            "Arrange",
            "Alt while dragging moves one shape alone.",
            "move_jointed",
        ),
        (
            "run.restart_automatically",
            "Restart Automatically",
            "Run",
            "Start anew a second after the end.",
            "restart_automatically",
        ),
    )
)
"""What is otherwise done by holding a key, or not at all, as switches."""

VIEW: Final = (
    Action(
        id="snap.smart",
        label="Snap to Shapes",
        menu="View",
        keys=("shift+s",),
        context=EDIT,
        tooltip="Hold Ctrl while dragging to invert.",
        checked=view.is_set("snap_smart"),
        run=view.switch_setting("snap_smart"),
    ),
    Action(
        id="snap.grid",
        label="Snap to Grid",
        menu="View",
        keys=("shift+g",),
        context=EDIT,
        tooltip="Hold Ctrl while dragging to invert.",
        checked=view.is_set("snap_grid"),
        run=view.switch_setting("snap_grid"),
    ),
    Action(
        id="view.grid",
        label="Show Grid",
        menu="View",
        context=Context.LEVEL,
        keys=("g",),
        checked=view.is_set("grid_visible"),
        run=view.switch_setting("grid_visible"),
    ),
    Action(
        id="view.minimap",
        label="Show Map",
        menu="View",
        context=Context.LEVEL,
        tooltip="The whole arena, small, in the corner; a click moves the view there.",
        checked=view.is_set("minimap"),
        run=view.switch_setting("minimap"),
    ),
    Action(
        id="view.frame_selection",
        label="Frame Selection",
        menu="View",
        context=Context.LEVEL,
        keys=("f",),
        run=view.frame_selection,
    ),
    Action(
        id="view.fit",
        label="Fit Arena",
        menu="View",
        keys=("home",),
        context=Context.LEVEL,
        run=view.fit,
    ),
    Action(
        id="view.actual_size",
        label="Actual Size",
        menu="View",
        context=Context.LEVEL,
        keys=("ctrl+0",),
        tooltip="100 pixels a metre.",
        run=view.actual_size,
    ),
    Action(
        id="view.toggle_ui",
        label="Show Panels",
        menu="View",
        keys=("tab",),
        checked=view.is_on("interface"),
        run=view.switch("interface"),
    ),
    Action(
        id="view.fullscreen",
        label="Full Screen",
        menu="View",
        keys=("f11",),
        checked=view.is_on("fullscreen"),
        run=view.switch("fullscreen"),
    ),
    Action(
        id="view.debug_draw",
        label="Debug Drawing",
        menu="View",
        context=Context.LEVEL,
        keys=("f3",),
        checked=view.is_on("debug_draw"),
        run=view.switch("debug_draw"),
    ),
    Action(
        id="view.plots",
        label="Plots",
        menu="View",
        context=Context.LEVEL,
        keys=("f4",),
        checked=view.is_on("plots"),
        run=view.switch("plots"),
    ),
    *(
        Action(
            id=f"view.layout_{name}",
            label=f"Layout: {name.capitalize()}",
            menu="View",
            context=Context.LEVEL,
            tooltip=tooltip,
            run=view.lay_out(name),
        )
        for name, tooltip in (
            ("edit", "Outliner, level and inspector around the canvas."),
            ("play", "Timeline and plots under a wider canvas."),
            ("evaluate", "A high table of results."),
        )
    ),
    Action(
        id="view.keep_layout",
        label="Keep This Layout…",
        menu="View",
        context=Context.LEVEL,
        tooltip="Where the panels are now, under a name.",
        run=view.keep_layout,
    ),
    Action(
        id="view.next_tab",
        label="Next Tab",
        menu="View",
        keys=("ctrl+tab",),
        enabled=lambda session: len(session.tabs) > 1,
        run=view.switch_tab(1),
    ),
    Action(
        id="view.previous_tab",
        label="Previous Tab",
        menu="View",
        keys=("ctrl+shift+tab",),
        enabled=lambda session: len(session.tabs) > 1,
        run=view.switch_tab(-1),
    ),
)

RUN: Final = (
    Action(
        id="run.play_human",
        label="Play",
        menu="Run",
        keys=("space", "f5"),
        context=EDIT,
        tooltip="Arrows, W/S, A/D turn motors, 1 and 2 fire thrusters.",
        enabled=editing,
        run=play.play,
    ),
    Action(
        id="run.pause",
        label="Pause",
        menu="Run",
        keys=("space",),
        context=PLAY,
        enabled=playing,
        checked=lambda session: session.mode is Mode.PAUSED,
        run=play.pause,
    ),
    Action(
        id="run.step",
        label="Step",
        menu="Run",
        keys=(".",),
        context=PLAY,
        tooltip="One environment step: two engine steps, 1/30 s.",
        enabled=playing,
        run=play.step,
    ),
    Action(
        id="run.step_back",
        label="Step Back",
        menu="Run",
        keys=(",",),
        context=PLAY,
        enabled=playing,
        run=play.step_back,
    ),
    Action(
        id="run.slower",
        label="Slower",
        menu="Run",
        keys=("-",),
        context=PLAY,
        enabled=lambda session: session.playback.speed > SPEEDS[0],
        run=play.slower,
    ),
    Action(
        id="run.faster",
        label="Faster",
        menu="Run",
        keys=("=",),
        context=PLAY,
        enabled=lambda session: session.playback.speed < SPEEDS[-1],
        run=play.faster,
    ),
    Action(
        id="run.reset",
        label="Reset",
        menu="Run",
        keys=("backspace",),
        context=PLAY,
        enabled=playing,
        run=play.reset,
    ),
    Action(
        id="run.stop",
        label="Stop",
        menu="Run",
        keys=("escape",),
        context=PLAY,
        tooltip="Back to editing; the level is as it was.",
        enabled=playing,
        run=play.stop,
    ),
    Action(
        id="run.compare_physics",
        label="Compare Physics…",
        menu="Run",
        context=Context.LEVEL,
        tooltip="The same level and the same keys under two presets or solvers, side by side.",
        checked=physics.comparing,
        run=physics.ask_other,
    ),
    Action(
        id="run.edit_from_here",
        label="Edit from Here",
        menu="Run",
        context=PLAY,
        tooltip="A new level that starts with everything where it is now.",
        enabled=play.has_state,
        run=play.edit_from_here,
    ),
)

LEVEL: Final = (
    Action(
        id="level.random",
        label="Random Level",
        menu="Level",
        keys=("ctrl+r",),
        context=EDIT,
        tooltip="Of the present size; every one has its seed.",
        enabled=editing,
        run=level.random_level,
    ),
    Action(
        id="level.mutate",
        label="Mutate",
        menu="Level",
        keys=("ctrl+m",),
        context=EDIT,
        tooltip="One random change.",
        enabled=editing,
        run=level.mutate(None),
    ),
    Action(
        id="level.mutate_menu",
        label="Mutate…",
        menu="Level",
        keys=("ctrl+shift+m",),
        context=EDIT,
        tooltip="Choose the kind of change.",
        enabled=editing,
        run=level.mutate_menu,
    ),
    Action(
        id="level.permute",
        label="Permute Order",
        menu="Level",
        context=EDIT,
        tooltip="Another order of the slots, as training sees it.",
        enabled=editing,
        run=level.permute,
    ),
    Action(
        id="level.previous",
        label="Previous Level",
        menu="Level",
        context=Context.LEVEL,
        keys=("page up",),
        tooltip="Of the same folder.",
        enabled=_has_file,
        run=level.neighbour(-1),
    ),
    Action(
        id="level.next",
        label="Next Level",
        menu="Level",
        context=Context.LEVEL,
        keys=("page down",),
        tooltip="Of the same folder.",
        enabled=_has_file,
        run=level.neighbour(1),
    ),
    Action(
        id="level.gallery",
        label="Gallery",
        menu="Level",
        keys=("ctrl+g",),
        tooltip="All levels as pictures: search, open, sort out, put sets together.",
        checked=gallery.is_open,
        run=gallery.toggle,
    ),
    Action(
        id="level.export_set",
        label="Export Level Set…",
        menu="Level",
        tooltip="Chosen levels with weights and a split, for training and evaluation.",
        run=gallery.ask_export,
    ),
)

GALLERY: Final = (
    Action(
        id="gallery.open",
        label="Open",
        menu="Gallery",
        keys=("return",),
        context=Context.GALLERY,
        tooltip="Or a double click.",
        enabled=gallery.choosing,
        run=gallery.open_chosen,
    ),
    Action(
        id="gallery.rename",
        label="Rename…",
        menu="Gallery",
        keys=("f2",),
        context=Context.GALLERY,
        enabled=gallery.choosing,
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

APP: Final = (
    Action(
        id="app.palette",
        label="Command Palette",
        menu="Help",
        keys=("ctrl+shift+p",),
        checked=view.is_on("palette"),
        run=view.switch("palette"),
    ),
    Action(
        id="app.keys",
        label="Change Keys…",
        menu="Help",
        tooltip="Other keys for commands, motors and thrusters.",
        checked=view.is_on("keys"),
        run=view.switch("keys"),
    ),
    Action(
        id="app.help",
        label="Keys and Help",
        menu="Help",
        keys=("f1",),
        checked=view.is_on("help"),
        run=view.switch("help"),
    ),
)

ACTIONS: Final[tuple[Action, ...]] = (
    *FILE,
    *EDITS,
    *ARRANGE,
    *TOOL_ACTIONS,
    *SWITCHES,
    *VIEW,
    *RUN,
    *AGENTS,
    *LEVEL,
    *GALLERY,
    *APP,
)
"""All actions, in the order of the menus."""

BY_ID: Final[dict[str, Action]] = {action.id: action for action in ACTIONS}
