"""`kinetix convert`."""

import json
from pathlib import Path

from kinetix.cli import main
from kinetix.level.codec import load_document, load_level

FIXTURES = Path(__file__).parents[1] / "level" / "fixtures"
CART = FIXTURES / "v1" / "cart_and_bell.json"
PEER = FIXTURES / "kinetix_env" / "gaps.json"


def test_from_ours_to_the_peer_names_what_is_lost(tmp_path, capsys):
    out = tmp_path / "cart.json"
    assert main(["convert", str(FIXTURES / "v1" / "everything.json"), str(out)]) == 0
    printed = capsys.readouterr()
    assert printed.out == f"{out}: kinetix-env\n"
    for field in ("automatic motors", "gravity", "max_timesteps", "name", "description", "tags"):
        assert field in printed.err
    assert load_document(out).format == "kinetix-env"


def test_from_the_peer_to_ours_and_back(tmp_path, capsys):
    ours, theirs = tmp_path / "gaps.json", tmp_path / "again" / "gaps.json"
    assert main(["convert", str(PEER), str(ours)]) == 0
    assert "not carried: gaps between slots" in capsys.readouterr().err
    assert main(["convert", str(ours), str(theirs)]) == 0
    assert capsys.readouterr().err == ""
    assert load_level(theirs) == load_level(ours)


def test_the_same_format_is_rewritten_byte_for_byte(tmp_path, capsys):
    for path, form in ((PEER, "kinetix-env"), (CART, "kinetix-level")):
        out = tmp_path / "out.json"
        assert main(["convert", str(path), str(out), "--format", form]) == 0
        assert out.read_bytes() == path.read_bytes()
    assert capsys.readouterr().err == ""


def test_errors_are_one_sentence_on_stderr(tmp_path, capsys):
    bad = tmp_path / "bad.json"
    tree = json.loads(CART.read_text())
    tree["bodies"][0]["role"] = "pink"
    bad.write_text(json.dumps(tree))
    assert main(["convert", str(bad), str(tmp_path / "out.json")]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(f"{bad}: $.bodies[0].role: expected")
    assert printed.err.count("\n") == 1
    assert not (tmp_path / "out.json").exists()
    assert main(["convert", str(CART), str(bad / "out.json")]) == 1
    assert capsys.readouterr().err == f"{bad}: File exists\n"
