"""The base of every error of the project: what is wrong, which value, against which limit, and what to do about it."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any, TypeVar

E = TypeVar("E", bound="Sher3Error")


class Sher3Error(ValueError):
    """An error that carries its numbers.

    A subclass may set further attributes in `__init__`. Errors survive pickling, so they can cross processes.

    Attributes:
        what: what is wrong, one clause without a full stop.
        value: the value that is wrong, or None; its unit is in `what`, or the value is text with its unit.
        limit: the limit that the value violates, or None.
        remedy: what the caller can do about it, or None.
    """

    def __init__(self, what: str, *, value: object = None, limit: object = None, remedy: str | None = None) -> None:
        super().__init__(what)
        self.what = what
        self.value = value
        self.limit = limit
        self.remedy = remedy

    @classmethod
    def unknown(cls: type[E], what: str, name: object, known: Iterable[str], **details: Any) -> E:
        """Return the error of a name that is none of those known; the remedy is the nearest of them, if one is near.

        Args:
            what: what is wrong.
            name: that was given.
            known: names that there are.
            details: whatever else the type takes.
        """
        names = [str(x) for x in known]
        near = get_close_matches(str(name), names, 1)
        remedy = f"did you mean {near[0]}?" if near else "name one of them"
        return cls(what, value=name, limit=", ".join(names), remedy=remedy, **details)

    def __str__(self) -> str:
        parts = [self.what]
        if self.value is not None:
            parts.append(f"value {_text(self.value)}")
        if self.limit is not None:
            parts.append(f"limit {_text(self.limit)}")
        if self.remedy is not None:
            parts.append(self.remedy)
        return "; ".join(parts)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (type(self), self.args, self.__dict__.copy())

    def to_dict(self) -> dict[str, object]:
        """Return the error as plain data for `--json` outputs: its type and every attribute."""
        return {"error": type(self).__name__, **self.__dict__}


class FileError(Sher3Error):
    """A file cannot be read or written.

    Attributes:
        path: of the file.
        reason: what is wrong, without the path.
    """

    def __init__(self, what: str, *, path: object, **details: Any) -> None:
        super().__init__(f"{path}: {what}", **details)
        self.path = str(path)
        self.reason = what


def _rebuild(cls: type[Sher3Error], args: tuple[Any, ...], state: dict[str, Any]) -> Sher3Error:
    error = cls.__new__(cls, *args)
    error.args = args
    error.__dict__.update(state)
    return error


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
