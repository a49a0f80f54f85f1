"""The error of an invalid robot file: every problem with its path, value, limit and remedy."""

from __future__ import annotations

import difflib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from sher3_common.errors import Sher3Error

_BOUNDS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


@dataclass(frozen=True)
class Problem:
    """One problem of a robot file; `path` is the key's place, as in `actuators[3].limits.upper`."""

    path: str
    what: str
    value: Any
    limit: str | None
    remedy: str

    def __str__(self) -> str:
        limit = "" if self.limit is None else f"; limit {self.limit}"
        value = "" if self.value is None else f"; value {self.value!r}"
        return f"{self.path}: {self.what}{value}{limit}; {self.remedy}"


class InvalidRobot(Sher3Error):
    """A robot file or a change to it is invalid; `problems` lists all that is wrong, the first in value and limit."""

    def __init__(self, problems: list[Problem], source: Path | str) -> None:
        first = problems[0]
        super().__init__(
            f"{source}: {first.path}: {first.what}", value=first.value, limit=first.limit, remedy=first.remedy
        )
        self.problems = problems

    def __str__(self) -> str:
        return "\n".join([super().__str__(), *(f"also {problem}" for problem in self.problems[1:])])

    def to_dict(self) -> dict[str, object]:
        """Return the error as plain data, its problems as mappings."""
        return {**super().to_dict(), "problems": [asdict(problem) for problem in self.problems]}

    @classmethod
    def unknown_path(cls, path: str) -> InvalidRobot:
        """Return the error for a parameter path that does not exist."""
        remedy = "name a value as the file does, as in delta.link_length"
        return cls([Problem(path, "unknown path", None, None, remedy)], "<replace>")

    @classmethod
    def from_validation(cls, error: ValidationError, model: type[BaseModel], source: Path | str) -> InvalidRobot:
        """Translate pydantic's error list into problems."""
        return cls([_problem(details, model) for details in error.errors(include_url=False)], source)


def _problem(details: Any, model: type[BaseModel]) -> Problem:
    path = _path(details["loc"])
    context = details.get("ctx", {})
    kind = details["type"]
    if kind == "geometry":
        return Problem(path, context["what"], context["value"], str(context["limit"]), context["remedy"])
    if kind == "missing":
        return Problem(path, "missing key", None, None, "add it; every key is required")
    if kind == "extra_forbidden":
        return Problem(path, "unknown key", details["input"], None, _did_you_mean(details["loc"], model))
    bounds = [f"{sign} {context[key]:.6g}" for key, sign in _BOUNDS.items() if key in context]
    if bounds:
        return Problem(path, "out of range", details["input"], bounds[0], "correct it; units are m, rad, s, kg, N, N m")
    what = details["msg"][0].lower() + details["msg"][1:]
    return Problem(path, what, _short(details["input"]), str(context.get("expected", "")) or None, "correct the value")


def _path(location: tuple[int | str, ...]) -> str:
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location)
    return text.lstrip(".") or "robot"


def _short(value: Any) -> Any:
    text = repr(value)
    return value if len(text) <= 60 else text[:57] + "..."


def _did_you_mean(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """Suggest the nearest key of the part in which an unknown key stands."""
    part: Any = model
    for step in location[:-1]:
        part = part.model_fields[step].annotation if isinstance(step, str) else part.__args__[step]
    known = [field.alias or name for name, field in part.model_fields.items()]
    near = difflib.get_close_matches(str(location[-1]), known, n=1)
    return f"did you mean {near[0]!r}?" if near else "remove it; known keys: " + ", ".join(known)
