"""Errors of the bags: each names the file or topic, the numbers, the limit and what to do."""

from __future__ import annotations

from typing import Any

from sher3_common.errors import FileError, Sher3Error


class BagError(FileError):
    """A bag cannot be read or written as asked; base of the errors below."""


class ForeignBagError(BagError):
    """The file or folder is not a bag of this robot: other format, storage, encoding or namespace."""


class DamagedBagError(BagError):
    """A bag is cut or corrupt; carries `offset`, the first byte that could not be used."""

    def __init__(self, what: str, *, path: object, offset: int, **details: Any) -> None:
        details.setdefault("remedy", "run `sher3 recover` on it")
        super().__init__(f"{what} at byte {offset}", path=path, **details)
        self.offset = offset


class LimitError(BagError):
    """A size in a file exceeds what this reader accepts; carries value and limit in bytes or counts."""


class NothingRecorded(BagError):
    """A recording ended without a single message."""

    exit_code = 1


class MissingTopicError(Sher3Error, KeyError):
    """A run lacks a topic; carries `topic` and the topics it has."""

    def __init__(self, topic: str, present: tuple[str, ...]) -> None:
        listing = ", ".join(present) or "none"
        super().__init__(
            f"the run has no topic {topic!r}", value=listing, remedy="record it, or leave out what needs it"
        )
        self.topic = topic
        self.present = present

    def __str__(self) -> str:
        """Use the Sher3Error text: KeyError would print the repr of its argument."""
        return Sher3Error.__str__(self)


class TopicError(Sher3Error):
    """The content of one topic is wrong; carries `topic`, and `index`, the first offending message."""

    def __init__(self, what: str, *, topic: str, index: int | None = None, **details: Any) -> None:
        where = topic if index is None else f"{topic}, message {index}"
        super().__init__(f"{where}: {what}", **details)
        self.topic = topic
        self.index = index


class WrongTypeError(TopicError):
    """A topic has another message type than the contract, or the same type with another definition."""


class MalformedMessageError(TopicError):
    """A message does not decode, or its joints, frame or array lengths change within the run."""


class StampError(TopicError):
    """Header stamps repeat or go backwards."""


class NotFiniteError(TopicError):
    """A value is NaN or infinite."""


class CaseError(BagError):
    """A case folder contradicts itself or the contract."""
