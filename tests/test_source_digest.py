"""The digest of the package's sources."""

import os
import time

from kinetix.source_digest import digest, digest_of


def test_equal_sources_have_equal_digits(tmp_path) -> None:
    began = time.time() + 60
    (tmp_path / "a.py").write_text("x = 1\n")
    first = digest_of(tmp_path, began)
    assert first == digest_of(tmp_path, began)
    (tmp_path / "a.py").write_text("x = 2\n")
    assert first != digest_of(tmp_path, began)
    assert digest() == digest()


def test_sources_that_were_changed_meanwhile_have_no_digits(tmp_path) -> None:
    """A developer edits a file while the app runs: the next start must not find what it kept."""
    (tmp_path / "a.py").write_text("x = 1\n")
    os.utime(tmp_path / "a.py", (100.0, 100.0))
    assert digest_of(tmp_path, 200.0)
    assert digest_of(tmp_path, 50.0) is None
