"""Bodies and joints of a scene as a tree of links, for engines that know nothing else."""

import dataclasses

from protocol import Scene, UnsaidError, both_fixed


@dataclasses.dataclass(frozen=True, kw_only=True)
class Link:
    """A free body's place in the tree."""

    index: int
    """The body."""
    parent: int | None
    """The body it hangs at, and None for the world."""
    joint: Scene | None
    """Joint that it hangs by; None where it moves freely in the plane."""

    @property
    def sign(self) -> int:
        """True if its angle counts as the joint's does: as the joint's second body, 1."""
        return 1 if self.joint is None or self.joint["b"] == self.index else -1

    @property
    def origin(self) -> list[float]:
        """Origin of the link's frame, from the body's centre: at the pin."""
        if self.joint is None:
            return [0.0, 0.0]
        return self.joint["anchor_b" if self.sign > 0 else "anchor_a"]

    @property
    def holder(self) -> int:
        """The body at the joint's other end, which may be a fixed one."""
        assert self.joint is not None
        return self.joint["a" if self.sign > 0 else "b"]

    @property
    def pin(self) -> list[float]:
        """Place of the pin on that other body."""
        assert self.joint is not None
        return self.joint["anchor_a" if self.sign > 0 else "anchor_b"]


def tree_of(scene: Scene) -> list[Link]:
    """Parents before children, as bodies hang at fixed ones and at each other.

    Raises:
        UnsaidError: Joints close a loop.
    """
    fixed = [not body["mass"] for body in scene["bodies"]]
    waiting = [joint for joint in scene["joints"] if not both_fixed(scene, joint)]
    links: dict[int, Link] = {}
    _hang(links, waiting, fixed)
    for index, still in enumerate(fixed):
        if not still and index not in links:
            links[index] = Link(index=index, parent=None, joint=None)
            _hang(links, waiting, fixed)
    return list(links.values())


def _hang(links: dict[int, Link], waiting: list[Scene], fixed: list[bool]) -> None:
    """Hang what is joined to something that is there already, until nothing is left of it."""
    found = True
    while found:
        found = False
        for joint in list(waiting):
            ends = joint["a"], joint["b"]
            there = [end in links or fixed[end] for end in ends]
            if all(there):
                raise UnsaidError("joints that close a loop")
            if any(there):
                parent, index = ends if there[0] else ends[::-1]
                of = None if fixed[parent] else parent
                links[index] = Link(index=index, parent=of, joint=joint)
                waiting.remove(joint)
                found = True
