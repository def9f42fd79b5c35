"""A short chaos: what ``make chaos`` does for long."""

import socket

from tests.chaos import Chaos, lost


def test_nothing_is_lost_in_a_short_chaos(tmp_path):
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    chaos = Chaos(tmp_path / "data", port, seed=3)
    try:
        told = chaos.run(20)
    finally:
        chaos.stop()
    told["processes left"] = chaos.left
    assert not lost(told), told
    assert told["harm"] >= 20 and told["accepted"] >= 10, told
