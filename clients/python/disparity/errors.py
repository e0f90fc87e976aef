# SPDX-License-Identifier: Apache-2.0
"""The clients raise these, and ValueError for arguments that are not allowed."""


class DisparityError(RuntimeError):
    """Has one line as its text: what, where, what to do."""


class Gone(DisparityError):
    """There is no daemon: it has stopped or died, or the connection has ended. Later reads look for it again."""


class Refused(DisparityError):
    """The daemon refuses a request, or answers in another version of the protocol. `closing`: it has closed the
    connection after this message."""

    def __init__(self, text: str, closing: bool = False) -> None:
        super().__init__(text)
        self.closing = closing
