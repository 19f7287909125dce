"""What is wrong with the input."""

from __future__ import annotations

import re

_PLACE = re.compile(r"(?P<file>[^:\n]+?)(?::(?P<line>\d+))?: ")
_NAME = re.compile(r"'([^'\n]+)'")


class KinecalError(ValueError):
    """Input that cannot be used; the message says what to do.

    One message may have several errors, one a line: see :attr:`errors`.
    """

    @property
    def errors(self) -> list[str]:
        """Each error: "file:line: what is wrong"."""
        return str(self).splitlines()

    @property
    def file(self) -> str | None:
        """File or array of the first error; None if it is of no file."""
        place = _PLACE.match(str(self))
        return place["file"] if place else None

    @property
    def line(self) -> int | None:
        """Line of the first error, from 1; of arrays, the row."""
        place = _PLACE.match(str(self))
        return int(place["line"]) if place and place["line"] else None

    @property
    def name(self) -> str | None:
        """What the first error names: a joint, a frame, a parameter."""
        name = _NAME.search(str(self))
        return name[1] if name else None
