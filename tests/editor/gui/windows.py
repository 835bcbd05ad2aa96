"""Places of Dear ImGui's windows."""

from imgui_bundle import imgui


def rect(name):
    """Left, top, right and bottom of a window [px]."""
    window = imgui.internal.find_window_by_name(name)
    x, y = window.pos.x, window.pos.y
    return x, y, x + window.size.x, y + window.size.y


def apart(one, other):
    """Return whether two rectangles do not overlap."""
    return one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


def popup_open():
    """Return whether a menu or another popup is open."""
    return imgui.is_popup_open("", imgui.PopupFlags_.any_popup.value)
