"""Errors of the package; the extension module raises them."""

from __future__ import annotations


class Error(RuntimeError):
    """Something cannot be done; the text says what, where and what to do about it."""


class RackFileError(Error):
    """A rack file, or a table with its keys, has a mistake.

    Attributes:
        file: the file as it was named; empty for a table.
        line: in it, counted from 1; 0: nowhere.
    """

    def __init__(self, text: str, file: str = "", line: int = 0) -> None:
        super().__init__(text)
        self.file = file
        self.line = line


class MasterError(Error):
    """What a master got to hear.

    Attributes:
        code: which kind, e.g. "timeout", "sdo-aborted", "state-refused", "drive-fault".
        detail: the abort code of an SDO, the AL status code of a refused state, the error code 603Fh of a
            drive in Fault; else 0.
    """

    def __init__(self, text: str, code: str = "protocol", detail: int = 0) -> None:
        super().__init__(text)
        self.code = code
        self.detail = detail


class ObjectRefused(Error):
    """The object dictionary refuses to have an object read or written.

    Attributes:
        abort_code: that an SDO would be answered with (CiA 301, 7.2.4.3.17).
    """

    def __init__(self, text: str, abort_code: int = 0x08000000) -> None:
        super().__init__(text)
        self.abort_code = abort_code


class TimeLimitReached(Error):
    """The rack's limit of simulated time is over."""
