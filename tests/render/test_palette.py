"""The palettes: what compatibility fixes, and what people with any colour vision can tell apart."""

import subprocess
import sys

import pytest

from kinetix.render.palette import KINETIX, PALETTES, contrast, ink, luminance
from tests.render.colour_vision import ciede2000, lab, least_difference

ACCESSIBLE = [name for name in PALETTES if name not in {"kinetix", "mono"}]


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [  # published test data of Sharma, Wu & Dalal (2005), table 1
        ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
        ((50.0, -1.3802, -84.2814), (50.0, 0.0, -82.7485), 1.0000),
        ((50.0, 2.49, -0.001), (50.0, -2.49, 0.0009), 7.1792),
        ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
        ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
        ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
    ],
)
def test_ciede2000_reproduces_the_published_data(first, second, expected):
    assert ciede2000(first, second) == pytest.approx(expected, abs=1e-4)


def test_kinetix_has_the_published_colours():
    assert KINETIX.roles == ((160, 160, 160), (0, 204, 0), (0, 102, 204), (255, 102, 102))
    assert KINETIX.motor_bindings == ((255, 255, 0), (255, 0, 255), (0, 255, 255), (255, 153, 51))
    assert KINETIX.fill(0, fixed=True) == (80, 80, 80)
    assert KINETIX.fill(3, fixed=True) == (127, 51, 51)
    assert KINETIX.background == KINETIX.uncontrolled == (255, 255, 255)


def test_kinetix_alone_cannot_meet_the_rule():
    """Glyphs are on by default because green and red are close for deuteranopes."""
    green, red = KINETIX.roles[1], KINETIX.roles[3]
    difference = ciede2000(lab(green, "deuteranopia"), lab(red, "deuteranopia"))
    assert difference == pytest.approx(8.4, abs=0.05)


@pytest.mark.parametrize("name", ACCESSIBLE)
def test_roles_are_told_apart_by_every_eye(name):
    assert least_difference(PALETTES[name].roles) >= 15


@pytest.mark.parametrize("name", PALETTES)
def test_bodies_stand_out(name):
    palette = PALETTES[name]
    for role in range(4):
        for fixed in (False, True):
            fill = palette.fill(role, fixed)
            on_background = contrast(fill, palette.background)
            outlined = contrast(palette.outline, palette.background)
            assert max(on_background, outlined) >= 3, (role, fixed)
            if role and name in ACCESSIBLE:
                assert on_background >= 3, (role, fixed)
            assert contrast(ink(fill), fill) >= 4.5, (role, fixed)


def test_luminance_and_contrast_of_known_colours():
    assert luminance((255, 255, 255)) == pytest.approx(1)
    assert contrast((0, 0, 0), (255, 255, 255)) == pytest.approx(21)
    assert contrast((119, 119, 119), (255, 255, 255)) == pytest.approx(4.48, abs=0.01)


def test_mono_has_no_hue():
    mono = PALETTES["mono"]
    for colour in (*mono.roles, *mono.motor_bindings, *mono.thruster_bindings, mono.nozzle):
        assert len(set(colour)) == 1


def test_palette_and_style_do_not_load_jax():
    code = (
        "import sys, kinetix.render.palette, kinetix.render.style; sys.exit('jax' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
