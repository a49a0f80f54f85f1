"""The part of the live page that only mocks have: hand and foot, effects, faults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from queue import Empty, SimpleQueue
from typing import Any

from sher3_faults.requests import FaultRequest, make_request

from sher3_view.live.hand import COMMANDS, MOST_FORCE, Hand

FAULTS = {
    "Force sensor silent, 0.5 s": {"component": "force_sensor", "fault": "off", "duration": 0.5},
    "Pedal silent, 0.5 s": {"component": "pedal", "fault": "off", "duration": 0.5},
    "Bus 0 delayed by 10 ms, 1 s": {
        "component": "bus0.up",
        "fault": "delayed",
        "duration": 1.0,
        "parameters": {"delay": 0.01},
    },
    "End all faults": {"component": "all", "fault": "ok"},
}
"""What can be broken from the page, and how it is asked for on `mock/fault`."""
FIRST = "backlash"
"""Effect that is offered first."""
Effect = tuple[str, str]
"""An effect and its place; it has its usual size."""


class MockPanel:
    """Folders that are seen only while there are mocks.

    Attributes:
        hand: hand and foot of the visitor.
        effects: what the mocks were asked to have.
    """

    def __init__(self, gui: Any, effects: Mapping[str, Sequence[str]]) -> None:
        """Add the folders to a graphical interface of viser; `effects` by name with their places."""
        self.hand = Hand()
        self.effects: list[Effect] = []
        self._gui, self._places = gui, effects
        self._faults: SimpleQueue[FaultRequest] = SimpleQueue()
        self._exchanges: SimpleQueue[list[Effect]] = SimpleQueue()
        self._folders = [self._add_hand(), self._add_effects(), self._add_faults()]

    def show(self, mocks: bool, exchange: bool) -> None:
        """Show the folders while there are mocks, that of the effects while a plant exchanges them."""
        for folder, wanted in zip(self._folders, (mocks, exchange, mocks), strict=True):
            if folder.visible != wanted:
                folder.visible = wanted

    def faults(self) -> list[FaultRequest]:
        """Return the faults that were asked for since the last call."""
        return _taken(self._faults)

    def exchanges(self) -> list[list[Effect]]:
        """Return the sets of effects that were asked for since the last call."""
        return _taken(self._exchanges)

    def _folder(self, title: str) -> Any:
        return self._gui.add_folder(title, expand_by_default=False, visible=False)

    def _add_hand(self) -> Any:
        folder = self._folder("Hand and foot on the mock")
        with folder:
            for command in COMMANDS:
                button = self._gui.add_button(command.capitalize())
                button.on_click(lambda _, command=command: self._ask(command=command))
            pedal = self._gui.add_checkbox("Pedal", initial_value=False)
            pedal.on_update(lambda _: self._ask(pedal=pedal.value))
            pushes = [
                self._gui.add_slider(f"Push {name} [N]", -MOST_FORCE, MOST_FORCE, step=0.1, initial_value=0.0)
                for name in "xyz"
            ]
            for push in pushes:
                push.on_update(lambda _: self._ask(force=tuple(p.value for p in pushes)))
        return folder

    def _ask(self, **wanted: Any) -> None:
        self.hand.touched = True
        for name, value in wanted.items():
            setattr(self.hand, name, value)

    def _add_effects(self) -> Any:
        folder, first = self._folder("Effects in the mock"), FIRST if FIRST in self._places else min(self._places)
        with folder:
            effect = self._gui.add_dropdown("Effect", sorted(self._places), initial_value=first)
            place = self._gui.add_dropdown("Place", tuple(self._places[first]))
            effect.on_update(lambda _: setattr(place, "options", tuple(self._places[effect.value])))
            put = self._gui.add_button("Put it in")
            put.on_click(lambda _: self._exchange([*self.effects, (effect.value, place.value)]))
            self._gui.add_button("Take all out").on_click(lambda _: self._exchange([]))
            self._inside = self._gui.add_markdown("")
        return folder

    def _exchange(self, effects: list[Effect]) -> None:
        self.effects = list(dict.fromkeys(effects))
        self._inside.content = "\n".join(f"- {name} on {place}" for name, place in self.effects)
        self._exchanges.put(self.effects)

    def _add_faults(self) -> Any:
        folder = self._folder("Break a mock")
        with folder:
            for label, request in FAULTS.items():
                button = self._gui.add_button(label)
                button.on_click(lambda _, request=request: self._faults.put(make_request(**request)))
        return folder


def _taken(queue: SimpleQueue[Any]) -> list[Any]:
    found = []
    while True:
        try:
            found.append(queue.get_nowait())
        except Empty:
            return found
