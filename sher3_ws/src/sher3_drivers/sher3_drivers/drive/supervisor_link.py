"""What the supervisor says, turned into requests to the motor driver. Plain Python; the node feeds it."""

from __future__ import annotations

from sher3_common.operating_state import OperatingState, parse_heartbeat
from sher3_common.reasons import Action, Reason

from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_drivers.errors import CommandRefused
from sher3_drivers.watches.trips import Trip


class SupervisorLink:
    """Lets a driver follow the operating state.

    Attributes:
        driver: the driver.
        state: name of the operating state it follows now.
        action: how hard the supervisor asked to stop; `NONE` outside FAULT.
        refused: why the driver did not follow the newest change, None when it did.
    """

    def __init__(self, driver: MotorDriver) -> None:
        self.driver = driver
        self.state = OperatingState.DISABLED.value
        self.action = Action.NONE
        self.refused: str | None = None
        self._fault = False

    def hear(self, text: str) -> None:
        """Take a heartbeat of the supervisor, `STATE ACTION`; a damaged one counts as none."""
        heard = parse_heartbeat(text)
        if heard is None:
            return
        self.driver.hear_supervisor()
        state, action = heard
        self.obey(state.value, action)

    def obey(self, state: str, action: Action = Action.QUICK_STOP) -> None:
        """Follow an operating state: ask the driver once for every change.

        In FAULT a harder action than before is a change too. DISABLED after FAULT is the supervisor's one-shot
        recovery, which resets the drives; nothing else does. A state the driver does not know stops the robot.

        Args:
            state: name of the operating state.
            action: how hard to stop in FAULT.
        """
        fault = state == OperatingState.FAULT.value
        harder = fault and action > self.action
        if state == self.state and not harder:
            return
        self._fault = self._fault or fault
        self.state, self.action = state, action if fault else Action.NONE
        self.refused = None
        try:
            self._request(state, action)
        except CommandRefused as error:
            self.refused = str(error)

    def _request(self, state: str, action: Action) -> None:
        driver = self.driver
        if state in (OperatingState.ENABLED.value, OperatingState.PAUSED.value):
            self._enable(state)
        elif state != OperatingState.DISABLED.value:
            driver.stop_for(Trip(Reason.SUPERVISOR_FAULT, f"operating state {state}"), action)
        elif self._fault and driver.needs_reset:
            self._fault = False
            driver.reset()
        else:
            driver.disable()

    def _enable(self, state: str) -> None:
        """Enable the drives; a driver that refuses stops, since the robot must not be ENABLED without its drives."""
        try:
            self.driver.enable()
        except CommandRefused as error:
            self.driver.stop_for(Trip(Reason.DRIVE_FAULT, f"operating state {state}: {error}"))
            raise
