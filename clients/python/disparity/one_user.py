# SPDX-License-Identifier: Apache-2.0
"""Tells a program that uses one object in two threads at once, or on both sides of a fork."""
from __future__ import annotations

import os
import threading


class OneUser:
    """Is held ("with") during each call of an object. what: its class, for the message. forks: whether both processes may
    use it after a fork."""

    def __init__(self, what: str, forks: bool = False) -> None:
        self._what = what
        self._in_use = threading.Lock()
        self._process = None if forks else os.getpid()

    def __enter__(self) -> None:
        if self._process not in (None, os.getpid()):
            raise ValueError(
                f"{self._what}: it was made before a fork, and two processes would read the same connection: make one after "
                "the fork, in the process that uses it"
            )
        if not self._in_use.acquire(blocking=False):
            raise ValueError(
                f"{self._what}: two threads use it at once: give each thread one of its own, or hold a threading.Lock "
                "during each call"
            )

    def __exit__(self, *_: object) -> None:
        self._in_use.release()
