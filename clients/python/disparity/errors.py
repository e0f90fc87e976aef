# SPDX-License-Identifier: Apache-2.0
"""What the clients raise, beside ValueError for arguments that cannot be right."""


class DisparityError(RuntimeError):
    """One line: what, where, what to do."""


class Gone(DisparityError):
    """The daemon has stopped or died, or the connection has ended: connect again."""
