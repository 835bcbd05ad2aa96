"""`kinetix convert` loses nothing."""

import os

import pytest

from kinetix.cli import main
from kinetix.level.codec import load_document, load_level, save_level


@pytest.mark.parametrize("link", [False, True])
def test_a_level_is_not_replaced_by_what_another_format_can_say_of_it(link, tmp_path, capsys):
    level = target = tmp_path / "a.json"
    save_level(load_level("s/first_flight"), level)
    before = level.read_bytes()
    if link:
        target = tmp_path / "b.json"
        os.symlink(level, target)
    assert main(["convert", str(level), str(target)]) == 1
    assert "this is the file that is read" in capsys.readouterr().err
    assert level.read_bytes() == before


def test_a_level_can_be_written_anew_in_its_own_format(tmp_path):
    level = tmp_path / "a.json"
    save_level(load_level("s/first_flight"), level)
    before = level.read_bytes()
    assert main(["convert", str(level), str(level), "--format", "kinetix-level"]) == 0
    assert level.read_bytes() == before


def test_there_and_back(tmp_path):
    there, back = tmp_path / "there.json", tmp_path / "back.json"
    assert main(["convert", "s/first_flight", str(there)]) == 0
    assert load_document(there).format == "kinetix-env"
    assert main(["convert", str(there), str(back)]) == 0
    assert len(load_level(back).bodies) == len(load_level("s/first_flight").bodies)


def test_what_another_file_held_stays_beside_it(tmp_path, capsys):
    mine = tmp_path / "mine.json"
    save_level(load_level("s/wheelie"), mine)
    before = mine.read_bytes()
    assert main(["convert", "s/first_flight", str(mine)]) == 0
    assert (tmp_path / "mine.json.bak").read_bytes() == before
    assert "mine.json.bak: what mine.json held before" in capsys.readouterr().err


def test_a_second_conversion_keeps_the_first_backup(tmp_path):
    mine = tmp_path / "mine.json"
    save_level(load_level("s/wheelie"), mine)
    before = mine.read_bytes()
    assert main(["convert", "s/first_flight", str(mine)]) == 0
    between = mine.read_bytes()
    assert main(["convert", "s/goalkeeper", str(mine)]) == 0
    kept = {file.read_bytes() for file in tmp_path.glob("mine.json.bak*")}
    assert kept == {before, between}


def test_a_picture_is_not_written_as_a_level(tmp_path, capsys):
    picture = tmp_path / "level.png"
    assert main(["convert", "s/first_flight", str(picture)]) == 1
    assert "kinetix render" in capsys.readouterr().err
    assert not picture.exists()


def test_the_standard_output_is_no_level_file(capsys):
    assert main(["convert", "s/first_flight", "-"]) == 1
    assert "a level is written to a file" in capsys.readouterr().err
