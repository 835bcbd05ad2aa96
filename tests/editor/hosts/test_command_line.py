"""The options of the app: what cannot be meant is one sentence, before a window opens."""

import pytest

from editor.__main__ import Options, _check
from kinetix.errors import KinetixError


@pytest.mark.parametrize("scale", ["nan", "inf", "-inf", "0", "-1", "0.7", "3.1", "100"])
def test_a_scale_that_nothing_can_be_read_at_is_refused(scale):
    with pytest.raises(KinetixError, match=rf"^--scale {scale}: expected 0\.75 to 3, such as"):
        _check(Options(scale=float(scale)))


@pytest.mark.parametrize("scale", [None, 0.75, 1.0, 3.0])
def test_the_scales_that_the_help_names_are_taken(scale):
    _check(Options(scale=scale))
