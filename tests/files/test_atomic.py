"""Saving never leaves anything but the old or the new file."""

import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kinetix.errors import LevelError
from kinetix.files import atomic
from kinetix.level.codec import dumps, load_level, save_level
from kinetix.level.model import Body, Circle, Level

OLD = Level(name="old", bodies=(Body(id=1, shape=Circle(radius=0.3), position=(1, 1)),))
NEW = OLD.replace(name="new", description="n" * 3000)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "level.json"
    save_level(OLD, path)
    return path


def fail(*_, **__):
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize("step", ["open", "fdopen", "fsync", "replace", "chmod"])
def test_a_failure_at_any_step_leaves_the_old_file(file, monkeypatch, step):
    if step == "chmod":
        monkeypatch.setattr(Path, "chmod", fail)
    else:
        monkeypatch.setattr(atomic.os, step, fail)
    with pytest.raises(LevelError, match=r"level\.json: cannot be saved: No space left"):
        save_level(NEW, file)
    monkeypatch.undo()
    assert load_level(file) == OLD
    assert os.listdir(file.parent) == ["level.json"]


def test_a_failing_write_leaves_the_old_file(file, monkeypatch):
    real = os.fdopen

    def full(descriptor, mode):
        stream = real(descriptor, mode)
        stream.raw.close()  # the buffer has nowhere to go, as on a full disk
        return stream

    monkeypatch.setattr(atomic.os, "fdopen", full)
    with pytest.raises((LevelError, ValueError)):
        save_level(NEW, file)
    assert load_level(file) == OLD
    assert os.listdir(file.parent) == ["level.json"]


def test_a_folder_that_cannot_be_synced_does_not_hurt(file, monkeypatch):
    monkeypatch.setattr(atomic, "_sync_folder", fail)
    save_level(NEW, file)
    assert load_level(file) == NEW


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(LevelError, match=r"none/x\.json: cannot be saved: No such file"):
        save_level(NEW, tmp_path / "none" / "x.json")


def test_permissions_and_links_stay(file):
    file.chmod(0o640)
    link = file.with_name("link.json")
    link.symlink_to(file.name)
    save_level(NEW, link)
    assert link.is_symlink()
    assert load_level(file) == NEW
    assert stat.S_IMODE(file.stat().st_mode) == 0o640


# Forks a process for each line on stdin, which then saves for ever; says its id.
NURSERY = """
import os, sys
from kinetix.level.codec import load_level, save_level
path = sys.argv[1]
old = load_level(path)
new = old.replace(name="new", description="n" * 3000)
for _ in sys.stdin:
    child = os.fork()
    if child == 0:
        while True:
            save_level(new, path)
            save_level(old, path)
    print(child, flush=True)
    os.waitpid(child, 0)
    print("dead", flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="needs fork")
def test_a_kill_during_save_leaves_the_old_or_the_new_file(file):
    allowed = {dumps(OLD), dumps(NEW)}
    seen = set()
    start = time.perf_counter()
    save_level(OLD, file)
    one_save = max(time.perf_counter() - start, 0.001)
    with subprocess.Popen(
        [sys.executable, "-c", NURSERY, str(file)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        bufsize=1,
    ) as nursery:
        pace, k = 1.0, 0
        while k < 50 or (len(seen) < 2 and k < 80):
            nursery.stdin.write("go\n")
            child = int(nursery.stdout.readline())
            time.sleep(pace * one_save * (0.5 + 0.4 * (k % 17)))
            os.kill(child, signal.SIGKILL)
            assert nursery.stdout.readline() == "dead\n"
            assert file.read_text() in allowed
            seen.add(load_level(file).name)
            k += 1
            if k >= 50:  # on a busy machine the first save tells little of the others
                pace *= 2.0 if seen == {"old"} else 0.5
        nursery.stdin.close()
    assert seen == {"old", "new"}


@pytest.mark.parametrize("make", [os.mkfifo, Path.mkdir], ids=["a named pipe", "a folder"])
@pytest.mark.skipif(os.name != "posix", reason="needs named pipes")
def test_what_is_no_file_is_not_replaced(tmp_path, make):
    path = tmp_path / "special.json"
    make(path)
    mode = stat.S_IFMT(path.stat().st_mode)
    with pytest.raises(LevelError, match=r"special\.json: cannot be saved: it is a "):
        save_level(NEW, path)
    assert stat.S_IFMT(path.stat().st_mode) == mode
    assert os.listdir(tmp_path) == ["special.json"]


@pytest.mark.skipif(os.name != "posix", reason="needs devices")
def test_a_device_is_not_replaced(tmp_path):
    device = tmp_path / "null.json"
    device.symlink_to("/dev/null")
    with pytest.raises(LevelError, match="a device"):
        save_level(NEW, device)
    assert stat.S_ISCHR(device.stat().st_mode)


def test_no_temporary_file_of_another_run_is_in_the_way(file):
    # Process ids repeat in containers: names made of them collide with what a killed run left.
    stale = [f".{file.name}.{os.getpid()}.{k}.tmp" for k in range(3000)]
    for name in stale:
        file.with_name(name).touch()
    save_level(NEW, file)
    assert load_level(file) == NEW


def test_what_killed_runs_left_goes_when_it_is_old(file):
    old, young = (file.with_name(f".kinetix-{name}.tmp") for name in ("old", "young"))
    for left in (old, young):
        left.write_text("half a le")
    os.utime(old, (0, 0))
    atomic._SWEPT.discard(file.parent)  # as in a process that has not written here yet
    save_level(NEW, file)
    assert not old.exists() and young.exists()


def test_a_folder_is_looked_through_once(file, monkeypatch):
    looked = []
    monkeypatch.setattr(atomic, "_sweep", looked.append)
    monkeypatch.setattr(atomic, "_SWEPT", set())
    for _ in range(3):
        save_level(NEW, file)
    assert looked == [file.parent]


def test_a_name_may_be_as_long_as_the_system_allows(tmp_path):
    path = tmp_path / f"{'n' * 250}.json"
    save_level(NEW, path)
    assert load_level(path) == NEW


def test_backups_of_long_names_have_room_for_their_numbers(tmp_path):
    path = tmp_path / f"{'n' * 247}.json"
    for k in range(4):
        atomic.write_with_backup(path, str(k).encode(), keep_all=True)
    assert {file.read_bytes() for file in tmp_path.iterdir()} == {b"0", b"1", b"2", b"3"}


def test_a_folder_where_the_backup_belongs_is_named(file):
    atomic.backup_of(file).mkdir()
    said = r"level\.json: cannot be saved: its backup level\.json\.bak: it is a folder"
    with pytest.raises(LevelError, match=said):
        atomic.write_with_backup(file, b"new")
    assert load_level(file) == OLD


def test_an_older_backup_that_cannot_be_moved_is_told(file, monkeypatch):
    atomic.backup_of(file).write_bytes(b"older")
    monkeypatch.setattr(atomic.shutil, "move", fail)
    said = r"level\.json: cannot be saved: its backup level\.json\.bak: No space left"
    with pytest.raises(LevelError, match=said):
        atomic.write_with_backup(file, b"new", keep_all=True)
    assert load_level(file) == OLD
    assert atomic.backup_of(file).read_bytes() == b"older"


def test_an_older_backup_keeps_its_name_on_a_full_disk(file, monkeypatch):
    backup = atomic.backup_of(file)
    backup.write_bytes(b"older")
    for step in ("_write_new", "_sync"):
        with monkeypatch.context() as patched:
            patched.setattr(atomic, step, fail)
            with pytest.raises(LevelError, match="No space left"):
                atomic.write_with_backup(file, b"new", keep_all=True)
        assert backup.read_bytes() == b"older"
        assert sorted(os.listdir(file.parent)) == ["level.json", "level.json.bak"]


def test_a_backup_that_is_a_link_stays_one(file):
    before, backup = file.read_bytes(), atomic.backup_of(file)
    elsewhere = file.with_name("elsewhere")
    elsewhere.write_bytes(b"older")
    backup.symlink_to(elsewhere)
    atomic.write_with_backup(file, b"new", keep_all=True)
    assert backup.is_symlink() and elsewhere.read_bytes() == before
    assert file.with_name("level.json.bak2").read_bytes() == b"older"


@pytest.mark.parametrize("write", [atomic.write_atomically, atomic.write_with_backup])
def test_a_read_only_file_is_not_replaced(file, monkeypatch, write):
    # Root may write everything, whatever the mode of a file says.
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK or Path(path) != file)
    with pytest.raises(LevelError, match=r"level\.json: cannot be saved: the file is read-only"):
        write(file, b"new")
    assert load_level(file) == OLD
    assert os.listdir(file.parent) == [file.name]


def test_a_name_that_no_system_takes_is_told():
    with pytest.raises(LevelError, match=r"cannot be saved: .*embedded null"):
        atomic.write_atomically(Path("a\0b"), b"")


def test_a_block_that_fails_leaves_the_old_file(file):
    before = file.read_bytes()
    with pytest.raises(ZeroDivisionError), atomic.replacing(file) as temporary:
        temporary.write_bytes(b"half")
        raise ZeroDivisionError
    assert file.read_bytes() == before
    assert os.listdir(file.parent) == [file.name]


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="needs root")
def test_a_file_of_another_user_stays_that_users(file):
    os.chown(file, 12345, 12345)
    save_level(NEW, file)
    assert (file.stat().st_uid, file.stat().st_gid) == (12345, 12345)


@pytest.mark.skipif(not os.path.exists("/proc/self/fd"), reason="needs /proc")
@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"])
def test_where_a_programs_output_goes_is_no_file_to_replace(tmp_path, name):
    log = tmp_path / "log.txt"
    log.write_text("hello")
    program = (
        "import pathlib, sys\n"
        "from kinetix.files.atomic import write_with_backup\n"
        "write_with_backup(pathlib.Path(sys.argv[1]), b'level')\n"
    )
    with log.open("a") as output:
        done = subprocess.run(
            [sys.executable, "-c", program, name],
            stdout=output,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert "choose another name" in done.stderr
    assert log.read_text() == "hello"
    assert not Path("/dev/stdout.bak").exists()


def test_what_could_not_be_written_is_known_before(tmp_path):
    atomic.check_target(tmp_path / "new.json")
    atomic.check_target(tmp_path / "new" / "folders" / "new.json")
    assert not list(tmp_path.iterdir())
    (tmp_path / "file").touch()
    with pytest.raises(
        LevelError, match=r"cannot be saved: expected a folder, got the file .*/file$"
    ):
        atomic.check_target(tmp_path / "file" / "new.json")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(LevelError, match=r"cannot be saved: the link .*/link leads nowhere$"):
        atomic.check_target(tmp_path / "link" / "new.json")
    with pytest.raises(LevelError, match="it is a folder; choose another name"):
        atomic.check_target(Path("/"))
    with pytest.raises(LevelError, match="it is a folder; choose another name"):
        atomic.check_target(tmp_path)
