import itertools

import pytest

from editor.base.controls import DEFAULT_KEYS, Drive, action_of, key_caps

TABLE = {
    "left": (1, 0, 0, 0, 0, 0),
    "right": (2, 0, 0, 0, 0, 0),
    "up": (0, 1, 0, 0, 0, 0),
    "down": (0, 2, 0, 0, 0, 0),
    "w": (0, 0, 1, 0, 0, 0),
    "s": (0, 0, 2, 0, 0, 0),
    "a": (0, 0, 0, 1, 0, 0),
    "d": (0, 0, 0, 2, 0, 0),
    "1": (0, 0, 0, 0, 1, 0),
    "2": (0, 0, 0, 0, 0, 1),
}


@pytest.mark.parametrize("key", TABLE)
def test_each_key_drives_its_channel(key):
    assert action_of({key}) == TABLE[key]


def test_keys_of_different_channels_add_up():
    for first, second in itertools.combinations(TABLE, 2):
        if DEFAULT_KEYS[first].channel != DEFAULT_KEYS[second].channel:
            both = tuple(a + b for a, b in zip(TABLE[first], TABLE[second], strict=True))
            assert action_of({first, second}) == both


def test_opposite_keys_cancel():
    assert action_of({"left", "right", "1"}) == (0, 0, 0, 0, 1, 0)


def test_other_keys_do_nothing():
    assert action_of({"space", "x", "f5"}) == (0,) * 6


def test_rebound_keys_replace_the_default():
    keys = {"k": Drive(channel=5, value=1)}
    assert action_of({"k", "left"}, keys) == (0, 0, 0, 0, 0, 1)


def test_caps_name_the_forward_key_first():
    assert key_caps(0) == ("←", "→")
    assert key_caps(2) == ("W", "S")
    assert key_caps(4) == ("1",)
