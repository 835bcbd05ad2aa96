"""Measurements that `--bench` takes."""

import pytest

from editor.hosts.bench.drawing import drawing_rows

pytestmark = [pytest.mark.gl, pytest.mark.usefixtures("software_gl")]


def test_frames_are_measured_and_an_idle_app_is_left_again():
    rows = drawing_rows((640, 400))
    assert [row.code for row in rows] == ["PE1", "PE1", "PE4"]
    assert rows[-1].value.endswith("%")
