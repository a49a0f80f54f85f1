"""The base of every error of the project: what went wrong, in which value, against which limit, and what to do."""

from __future__ import annotations

from typing import Any


class Sher3Error(ValueError):
    """An error that carries its numbers.

    Subclasses set further attributes in `__init__`; instances survive pickling, so that they cross processes.

    Attributes:
        what: what is wrong, one clause without a full stop.
        value: the offending value, with its unit in `what` or as text.
        limit: the limit it violates, or None.
        remedy: what the caller can do about it, or None.
    """

    def __init__(self, what: str, *, value: object = None, limit: object = None, remedy: str | None = None) -> None:
        super().__init__(what)
        self.what = what
        self.value = value
        self.limit = limit
        self.remedy = remedy

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
    """A file cannot be read or written; carries `path`, and `reason`, what is wrong without the path."""

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
