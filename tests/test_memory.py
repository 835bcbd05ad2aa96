"""Available memory, on Linux and on other systems."""

import os

from kinetix.memory import available_memory


def test_linux_says_what_programs_may_take(tmp_path):
    told = tmp_path / "meminfo"
    told.write_text("MemTotal: 24000 kB\nMemFree: 1000 kB\nMemAvailable: 9000 kB\n")
    assert available_memory(told) == 9000 * 1024


def test_elsewhere_it_is_all_memory(tmp_path):
    everything = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    assert available_memory(tmp_path / "nothing") == everything
    assert available_memory() <= everything
