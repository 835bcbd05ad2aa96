"""Arrays that are alive at once have places of their own."""

from hypothesis import given
from hypothesis import strategies as st

from kinetix.engine.native.allocation import Span, placed, prolonged

SPANS = st.lists(st.tuples(st.integers(1, 90), st.integers(0, 30), st.integers(0, 12)), max_size=30)


@given(SPANS)
def test_what_is_alive_at_once_does_not_overlap(drawn):
    spans = [Span(size, first, first + lasts) for size, first, lasts in drawn]
    total = placed(spans)
    for number, a in enumerate(spans):
        assert a.place % 4 == 0
        assert a.place + a.size <= total
        for b in spans[:number]:
            if a.first <= b.last and b.first <= a.last:
                assert a.place + a.size <= b.place or b.place + b.size <= a.place


@given(SPANS)
def test_no_more_is_taken_than_all_need_one_after_the_other(drawn):
    spans = [Span(size, 2 * k, 2 * k + 1) for k, (size, _, _) in enumerate(drawn)]
    assert placed(spans) <= max((x.size for x in spans), default=0) + 15


def test_what_a_loop_reads_of_before_lives_until_its_end():
    before, inside, after = Span(4, 1, 5), Span(4, 4, 5), Span(4, 9, 11)
    prolonged([before, inside, after], [(3, 8), (2, 7)])
    assert (before.last, inside.last, after.last) == (8, 5, 11)
