"""Keys by name: pygame's lower-case names, as action chords, settings and replays write them."""

from typing import Final

from imgui_bundle import imgui

from editor.base.language import tr

_NAMES: Final = {
    "tab": "tab",
    "left": "left_arrow",
    "right": "right_arrow",
    "up": "up_arrow",
    "down": "down_arrow",
    "page up": "page_up",
    "page down": "page_down",
    "home": "home",
    "end": "end",
    "insert": "insert",
    "delete": "delete",
    "backspace": "backspace",
    "space": "space",
    "return": "enter",
    "escape": "escape",
    "'": "apostrophe",
    ",": "comma",
    "-": "minus",
    ".": "period",
    "/": "slash",
    ";": "semicolon",
    "=": "equal",
    "[": "left_bracket",
    "\\": "backslash",
    "]": "right_bracket",
    "`": "grave_accent",
    "caps lock": "caps_lock",
    "scroll lock": "scroll_lock",
    "numlock": "num_lock",
    "print screen": "print_screen",
    "break": "pause",
    "pause": "pause",
    "left shift": "left_shift",
    "left ctrl": "left_ctrl",
    "left alt": "left_alt",
    "left meta": "left_super",
    "right shift": "right_shift",
    "right ctrl": "right_ctrl",
    "right alt": "right_alt",
    "right meta": "right_super",
    "menu": "menu",
    "[.]": "keypad_decimal",
    "[/]": "keypad_divide",
    "[*]": "keypad_multiply",
    "[-]": "keypad_subtract",
    "[+]": "keypad_add",
    "enter": "keypad_enter",
    "equals": "keypad_equal",
}


def _table() -> dict[str, imgui.Key]:
    names = dict(_NAMES)
    names |= {letter: letter for letter in "abcdefghijklmnopqrstuvwxyz"}
    names |= {str(digit): f"_{digit}" for digit in range(10)}
    names |= {f"[{digit}]": f"keypad{digit}" for digit in range(10)}
    names |= {f"f{number}": f"f{number}" for number in range(1, 16)}
    return {name: getattr(imgui.Key, theirs) for name, theirs in names.items()}


IMGUI: Final[dict[str, imgui.Key]] = _table()
"""Dear ImGui's key of each name."""

MODIFIERS: Final[dict[str, imgui.Key]] = {
    f"{side} {name}": modifier
    for side in ("left", "right")
    for name, modifier in (
        ("ctrl", imgui.Key.mod_ctrl),
        ("shift", imgui.Key.mod_shift),
        ("alt", imgui.Key.mod_alt),
        ("meta", imgui.Key.mod_super),
    )
}
"""Modifier of each modifier key. On macOS Dear ImGui itself swaps Cmd and Ctrl."""

_LABELS: Final = {
    "left": "\u2190",
    "right": "\u2192",
    "up": "\u2191",
    "down": "\u2193",
    "page up": "PgUp",
    "page down": "PgDn",
    "escape": "Esc",
    "delete": "Del",
    "return": "Enter",
}


def label(chord: str) -> str:
    """Return a chord for people: `"ctrl+shift+z"` becomes `"Ctrl+Shift+Z"`."""
    head, _, tail = chord.rpartition("+")
    if chord.endswith("+") or not tail:
        head, tail = chord[:-1].rstrip("+"), "+"
    parts = [part.capitalize() for part in head.split("+") if part]
    parts.append(_LABELS.get(tail, tail.upper() if len(tail) == 1 else tail.title()))
    return "+".join(tr(part) for part in parts)
