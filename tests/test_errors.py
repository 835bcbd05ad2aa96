"""Sentences for people are one bounded, printable line whatever a file says."""

import pytest

from kinetix.errors import KinetixError, plain


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("naïve 灯 🚀", "naïve 灯 🚀"),
        ("\x1b[2J", "\\u001b[2J"),
        ("a\nb", "a\\nb"),
        ("\u202egnp.exe", "\\u202egnp.exe"),
        ("\udcff", "\\udcff"),
        ("\U000433b7", "\\U000433b7"),
    ],
)
def test_what_cannot_be_printed_is_escaped(text, said):
    assert str(KinetixError(text)) == said
    assert said.isprintable()


def test_a_long_text_loses_its_middle():
    assert plain("a" * 5000 + "end", 100).endswith("aend")
    assert len(plain("a" * 5000)) == 1000
