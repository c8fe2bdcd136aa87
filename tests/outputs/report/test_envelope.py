"""A thinned curve keeps what matters of the whole one."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.outputs.report.envelope import MOST_STRETCHES, Envelope


@given(st.lists(st.tuples(st.floats(0, 1e6), st.floats(0, 1)), min_size=1, max_size=60), st.data())
def test_highest_value_and_flags_survive(
    rows: list[tuple[float, float]], data: st.DataObject
) -> None:
    """However long and in whatever blocks: the highest value, and whether a flag was up."""
    flags = np.array(data.draw(st.lists(st.booleans(), min_size=len(rows), max_size=len(rows))))
    times, values = np.array(rows).T
    cut = data.draw(st.integers(1, len(rows)))

    envelope = Envelope("log", n_flags=1)
    for part in (slice(0, cut), slice(cut, None)):
        if times[part].size:
            envelope.add(times[part], values[part], flags[part, None])
    starts, highest, raised = envelope.curve()

    assert highest.max() == values.max()
    assert raised.any() == flags.any()
    assert starts.size <= MOST_STRETCHES
    assert np.all(np.diff(starts) > 0)


def test_hours_take_no_more_than_a_screen() -> None:
    """A hundred hours at 10 Hz are 4,096 stretches at most, and values stay where they were."""
    envelope = Envelope("log", n_flags=0)
    for hour in range(100):
        times = hour * 3600 + np.arange(0, 3600, 0.1)
        envelope.add(times, (times == 3600 * 42).astype(float), np.zeros((times.size, 0), bool))

    starts, highest, _ = envelope.curve()

    assert starts.size <= MOST_STRETCHES
    at = starts[highest.argmax()]
    assert at <= 42 * 3600 < at + envelope.width_s
