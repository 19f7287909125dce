"""The program ``kinecal`` of this package: ``python -m kinecal calibrate ...``."""

import os
import sys

from .errors import KinecalError
from .program import program


def main() -> None:
    """Becomes the program."""
    try:
        os.execv(program(), ["kinecal", *sys.argv[1:]])
    except KinecalError as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
