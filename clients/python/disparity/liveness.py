# SPDX-License-Identifier: Apache-2.0
"""Tells when a daemon that says nothing is asked whether it is there, and when it is not."""
from __future__ import annotations

_SECOND = 1_000_000_000

# The clocks are compared this often, by the same question, while frames come.
_CLOCK_INTERVAL = _SECOND
# A daemon that has said nothing for so long, and for some intervals, is asked whether it is there.
_LEAST_SILENCE, _SILENT_INTERVALS, _LONGEST_INTERVAL = _SECOND // 2, 3, 3600 * _SECOND
# It must answer within this time.
_ANSWER_TIME = _SECOND


class Liveness:
    """Is of one connection. All times are in ns, and the caller brings them; heard: when the last bytes were read.

    The C++ client does the same.
    """

    def __init__(self) -> None:
        self._asked = 0  # when the last Ping was sent

    def asks(self, now: int, heard: int, interval: int) -> bool:
        """Returns whether a Ping is to be sent now, and counts it as sent."""
        if self._asked > heard:
            return False  # it has been asked
        silence = _SILENT_INTERVALS * min(interval, _LONGEST_INTERVAL)
        silent = now - heard >= max(_LEAST_SILENCE, silence)
        if not silent and now - self._asked < _CLOCK_INTERVAL:
            return False
        self._asked = now
        return True

    def is_gone(self, now: int, heard: int) -> bool:
        """Returns whether a Ping has waited for its answer too long."""
        return self._asked > heard and now - self._asked > _ANSWER_TIME
