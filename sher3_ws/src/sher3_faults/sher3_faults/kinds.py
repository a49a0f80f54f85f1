"""The kinds of faults, each one small class that acts on a stream: items in, items out, told the time.

The names follow PX4's failure injection (off, stuck, garbage, wrong, slow, delayed, intermittent) with duplicated,
reordered, the slow ones (creep, drift, ramp, late, swap), the lively ones (held, chatter, contradicted), those of a
force (bias, turn), of an encoder (jitter) and of a cable (miswired) added. What an item is (a CAN frame, a force
record, a pedal state, one number) is told by `Items`, so that each kind exists once.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Mapping
from random import Random
from typing import Any, ClassVar, NamedTuple, Protocol

Parameters = Mapping[str, float]


class Items(Protocol):
    """What a kind of fault needs to know of the items of its stream."""

    def key(self, item: Any) -> Hashable:
        """Return the name of the source of an item: several sources share a stream, as CAN identifiers share a bus."""

    def garbage(self, item: Any, random: Random) -> Any:
        """Return an item of the same form with random content."""

    def wrong(self, item: Any, parameters: Parameters) -> Any:
        """Return a well-formed item with a false content."""

    def exchanged(self, item: Any) -> Any:
        """Return an item of one of two sources under the name of the other; where there is one source, the item."""

    def alive(self, item: Any, random: Random) -> Any:
        """Return the item with the noise of a living source, where it has any."""


class Bounds(NamedTuple):
    """Default and range of a parameter."""

    default: float
    low: float
    high: float


class Kind:
    """A fault of a stream; call it with the items that come at `now` [ns] to have those that go on."""

    bounds: ClassVar[Mapping[str, Bounds]] = {}

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        self.items, self.random = items, random
        self.parameters = {**{name: b.default for name, b in self.bounds.items()}, **parameters}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return the items that pass."""
        raise NotImplementedError


class Off(Kind):
    """No item passes."""

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return no item."""
        return []


class Stuck(Kind):
    """The first item of each source is repeated in place of all that follow."""

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._first: dict[Hashable, Any] = {}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return the first item of each source in place of its later ones."""
        return [self._first.setdefault(self.items.key(item), item) for item in items]


class Garbage(Kind):
    """Every item has random content."""

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return items of the same form with random content."""
        return [self.items.garbage(item, self.random) for item in items]


class Wrong(Kind):
    """Every item is well-formed and false; what `scale`, `offset` and `code` mean is the stream's."""

    bounds: ClassVar[Mapping[str, Bounds]] = {
        "scale": Bounds(1.0, -1e3, 1e3),
        "offset": Bounds(0.0, -1e3, 1e3),
        "code": Bounds(0.0, 0.0, 0xFFFF),
    }

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return well-formed items with false content."""
        return [self.items.wrong(item, self.parameters) for item in items]


class Slow(Kind):
    """Of each source only one item in `every` goes on."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"every": Bounds(4.0, 2.0, 1e4)}

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._count: dict[Hashable, int] = {}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return one item of `every` of each source."""
        passed = []
        for item in items:
            key = self.items.key(item)
            count = self._count[key] = self._count.get(key, 0) + 1
            if count % int(self.parameters["every"]) == 0:
                passed.append(item)
        return passed


class Delayed(Kind):
    """Every item comes `delay` s later."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"delay": Bounds(0.02, 0.0, 10.0)}

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._waiting: deque[tuple[int, Any]] = deque()

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Keep new items back and return those whose delay is over."""
        due = now + round(self.parameters["delay"] * 1e9)
        self._waiting.extend((due, item) for item in items)
        passed = []
        while self._waiting and self._waiting[0][0] <= now:
            passed.append(self._waiting.popleft()[1])
        return passed


class Intermittent(Kind):
    """A loss begins with `probability` at each item of a source and takes `burst` of them."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"probability": Bounds(0.5, 0.0, 1.0), "burst": Bounds(1.0, 1.0, 1e4)}

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._left: dict[Hashable, int] = {}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return the items outside the random losses."""
        return [item for item in items if not self._lost(self.items.key(item))]

    def _lost(self, key: Hashable) -> bool:
        left = self._left.get(key, 0)
        if left == 0 and self.random.random() < self.parameters["probability"]:
            left = int(self.parameters["burst"])
        self._left[key] = max(0, left - 1)
        return left > 0


class Duplicated(Kind):
    """Every item comes `copies` times more."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"copies": Bounds(1.0, 1.0, 100.0)}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return every item several times."""
        return [item for item in items for _ in range(1 + int(self.parameters["copies"]))]


class Reordered(Kind):
    """Of every two items of a source the second comes first; the other waits until it does."""

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._held: dict[Hashable, Any] = {}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return each pair of items in reverse order."""
        passed = []
        for item in items:
            key = self.items.key(item)
            if key in self._held:
                passed += [item, self._held.pop(key)]
            else:
                self._held[key] = item
        return passed


class _Slow(Kind):
    """Base of the kinds that falsify more and more, or steadily, by numbers of their own."""

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._begin: int | None = None

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Falsify by as much as the time since the first item says."""
        self._begin = now if self._begin is None else self._begin
        falsity = {"scale": 1.0, "offset": 0.0, "code": 0.0, **self.falsity(1e-9 * (now - self._begin))}
        return [self.items.wrong(item, falsity) for item in items]

    def falsity(self, time: float) -> Parameters:
        """Return scale and offset `time` s after the first item."""
        raise NotImplementedError


class Creep(_Slow):
    """A steady speed [m/s, rad/s] is added to what an axis was told."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"speed": Bounds(1e-4, -2.0, 2.0)}

    def falsity(self, time: float) -> Parameters:
        """Return the same offset at all times."""
        return {"offset": self.parameters["speed"]}


class Drift(_Slow):
    """A number goes off at `rate` per second."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"rate": Bounds(2e-5, -10.0, 10.0)}

    def falsity(self, time: float) -> Parameters:
        """Return an offset that grows."""
        return {"offset": self.parameters["rate"] * time}


class Ramp(_Slow):
    """The scale of a number grows by `rate` per second."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"rate": Bounds(0.1, -10.0, 10.0)}

    def falsity(self, time: float) -> Parameters:
        """Return a scale that grows."""
        return {"scale": 1.0 + self.parameters["rate"] * time}


class Late(Kind):
    """Each item comes in the place of the one that is `items` later; the first one stands in for those before it."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"items": Bounds(1.0, 1.0, 1e3)}

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._kept: dict[Hashable, deque[Any]] = {}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Repeat what came before."""
        return [self._before(item) for item in items]

    def _before(self, item: Any) -> Any:
        kept = self._kept.setdefault(self.items.key(item), deque())
        kept.append(item)
        return kept.popleft() if len(kept) > int(self.parameters["items"]) else kept[0]


class Swap(Kind):
    """What two sources say is exchanged: each bears the name of the other."""

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return the items with their sources exchanged."""
        return [self.items.exchanged(item) for item in items]


class Held(Kind):
    """Every item is the first one again, with noise: it looks alive and says nothing."""

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._first: dict[Hashable, Any] = {}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return the first item of each source in place of its later ones, alive."""
        return [self.items.alive(self._first.setdefault(self.items.key(item), item), self.random) for item in items]


class Chatter(Kind):
    """Of each source `items` items are false as in `Wrong`, as many true, and so on."""

    bounds: ClassVar[Mapping[str, Bounds]] = {
        "items": Bounds(5.0, 1.0, 1e3),
        "scale": Bounds(0.0, -1e3, 1e3),
        "offset": Bounds(0.0, -1e3, 1e3),
        "code": Bounds(0.0, 0.0, 0xFFFF),
    }

    def __init__(self, items: Items, parameters: Parameters, random: Random) -> None:
        super().__init__(items, parameters, random)
        self._count: dict[Hashable, int] = {}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return false and true items in turn."""
        return [self.items.wrong(item, self.parameters) if self._is_false(item) else item for item in items]

    def _is_false(self, item: Any) -> bool:
        key = self.items.key(item)
        count = self._count[key] = self._count.get(key, -1) + 1
        return count // int(self.parameters["items"]) % 2 == 0


class Bias(_Slow):
    """A force [N] along z and a torque [N m] about x that nobody exerts are added."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"force": Bounds(0.0, -100.0, 100.0), "torque": Bounds(0.0, -1.0, 1.0)}

    def falsity(self, time: float) -> Parameters:
        """Return the same force and torque at all times."""
        return self.parameters


class Turn(_Slow):
    """A sensor sits turned by `angle` [rad] about y: what it reads is in a frame that nobody knows."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"angle": Bounds(0.35, -3.2, 3.2)}

    def falsity(self, time: float) -> Parameters:
        """Return the same angle at all times."""
        return self.parameters


class Jitter(Chatter):
    """A number goes to and fro by `size` [m, rad], `items` of them on either side."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"size": Bounds(2e-6, 0.0, 1.0), "items": Bounds(4.0, 1.0, 1e3)}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return each item off by `size`, to one side and to the other."""
        size, falsity = self.parameters["size"], {"scale": 1.0, "code": 0.0}
        sides = [size if self._is_false(item) else -size for item in items]
        return [self.items.wrong(item, {**falsity, "offset": side}) for item, side in zip(items, sides, strict=True)]


class Miswired(Kind):
    """The plugs of the axes `one` and `other` (1 to 5) are exchanged; where both are the same, its poles are."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"one": Bounds(1.0, 1.0, 5.0), "other": Bounds(2.0, 1.0, 5.0)}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return rows of axes with two exchanged."""
        return [self.items.wrong(item, self.parameters) for item in items]


class Contradicted(Kind):
    """A second source of the same name says something else, just after each item, or (`first` 1) just before it."""

    bounds: ClassVar[Mapping[str, Bounds]] = {"first": Bounds(0.0, 0.0, 1.0)}

    def __call__(self, items: list[Any], now: int) -> list[Any]:
        """Return each item with one of random content beside it."""
        passed: list[Any] = []
        for item in items:
            pair = [item, self.items.garbage(item, self.random)]
            passed += reversed(pair) if self.parameters["first"] else pair
        return passed


KINDS: dict[str, Callable[[Items, Parameters, Random], Kind]] = {
    "off": Off,
    "stuck": Stuck,
    "garbage": Garbage,
    "wrong": Wrong,
    "slow": Slow,
    "delayed": Delayed,
    "intermittent": Intermittent,
    "duplicated": Duplicated,
    "reordered": Reordered,
    "creep": Creep,
    "drift": Drift,
    "ramp": Ramp,
    "late": Late,
    "swap": Swap,
    "held": Held,
    "chatter": Chatter,
    "contradicted": Contradicted,
    "bias": Bias,
    "turn": Turn,
    "jitter": Jitter,
    "miswired": Miswired,
}
"""Every kind by its name."""

OK, OFF = "ok", "off"
"""`ok` is no kind: it ends a fault."""


def bounds_of(kind: str) -> Mapping[str, Bounds]:
    """Return the parameters of a kind; `ok` has none."""
    return {} if kind == OK else KINDS[kind].bounds  # type: ignore[attr-defined]
