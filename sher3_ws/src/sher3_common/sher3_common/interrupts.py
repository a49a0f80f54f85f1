"""Ctrl-C as an exception that Python does not remember."""

from typing import NoReturn


class Interrupted(KeyboardInterrupt):
    """A `KeyboardInterrupt` of another type.

    Python remembers a plain one that meets code made of a string, as each dataclass is, and then ends `python -m` by
    the signal although the interrupt was answered with an exit code.
    """


def interrupt(*_: object) -> NoReturn:
    """Raise `Interrupted`: a handler of signals."""
    raise Interrupted
