"""Names of commands as the parser of command lines takes them."""


class Program(str):
    """A name of several words, `kinetix train`, that hints keep whole.

    Of a program's name, tyro's hints at options of sub-commands keep what `partition` splits off
    first: `kinetix ppo --help`, which does not exist.
    """

    __slots__ = ()

    def partition(self, sep: str, /) -> tuple[str, str, str]:
        """Return the whole name as the first part."""
        return self, "", ""
