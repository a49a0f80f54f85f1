"""Does a cell of the matrix hold? What a fault must come to, held against what was measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sher3_common.operating_state import OperatingState

from sher3_safety.measurement.recording import STANDS, Outcome
from sher3_safety.rows.row import AT_END, DETECTION_LIMIT, STOP_LIMIT, Row, State

MOVES_AGAIN = 20e-6
"""Least way of the tip after release-then-press that counts as motion, m."""
UNMEASURED = "not measured"
"""How the miss of a cell begins in which the fault did not find the robot in the state it is meant for."""


@dataclass(frozen=True)
class Verdict:
    """A cell with its outcome and everything it misses."""

    row: Row
    state: State
    outcome: Outcome | None
    misses: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Whether nothing is missed."""
        return not self.misses

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        outcome = None if self.outcome is None else self.outcome.to_dict()
        cell = {"component": self.row.component, "fault": self.row.fault, "parameters": dict(self.row.parameters)}
        expected = {"state": self.state.name, "effect": self.row.expects, "budget": self.state.budget}
        return {"name": self.row.name, **cell, **expected, "outcome": outcome, "misses": list(self.misses)}


def judge(row: Row, state: State, outcome: Outcome | None, recovered: bool = True) -> Verdict:
    """Return the verdict on one cell; `recovered`: the operator tried to go on afterwards."""
    if outcome is None:
        return Verdict(row, state, None, ("not in the recording",))
    return Verdict(row, state, outcome, tuple(_misses(row, state, outcome, recovered)))


def _misses(row: Row, state: State, o: Outcome, recovered: bool) -> Iterator[str]:
    budget = state.budget if row.budget is None else row.budget
    # Where the pedal is released, that is the onset, and the fault may have been noticed before.
    operating = OperatingState.DISABLED if row.expects == "barred" else state.operating
    found_before = row.since and o.operating == OperatingState.FAULT
    if o.operating not in ("", operating) and not row.release and not found_before:
        yield f"was {o.operating} when the fault set in instead of {operating.value}"
    if o.speed < 0.8 * state.speed and not row.since:
        yield f"moved at {o.speed * 1e3:.2f} mm/s before the fault instead of {state.speed * 1e3:g}"
    if state.end and o.to_end > AT_END:
        yield f"{o.to_end * 100:.1f} % of its travel from its end before the fault (limit {AT_END * 100:g} %)"
    if row.expects == "goes on" and o.tripped:
        yield f"tripped: {o.reason}"
    if row.expects == "ends":
        yield from _of_an_end(row, o)
    elif row.expects == "said":
        yield from _of_a_report(row, o)
    elif row.expects == "barred":
        yield from _of_a_bar(row, o, budget)
    elif row.expects == "stops":
        yield from _of_a_stop(row, state, o, budget)
    elif o.excess > budget and row.expects != "residual":
        yield f"{o.excess * 1e6:.0f} um off its way (budget {budget * 1e6:.0f} um)"
    if row.expects == "either" and o.tripped and o.braking > budget:
        yield f"travelled {o.braking * 1e6:.0f} um after the report (budget {budget * 1e6:.0f} um)"
    if (row.expects == "stops" and not row.slow) or (row.expects in ("stops", "either") and o.tripped):
        if o.alone > STANDS * state.budget:
            yield f"moved {o.alone * 1e6:.1f} um before the pedal was released"
        if o.resumed < MOVES_AGAIN and recovered and not row.final:
            yield "did not move again after recovery, release and press"


def _of_a_stop(row: Row, state: State, o: Outcome, budget: float) -> Iterator[str]:
    if row.slow:
        if o.excess > budget:
            yield f"{o.excess * 1e6:.0f} um off its path (budget {budget * 1e6:.0f} um)"
        if not o.tripped and state.name not in row.quiet:
            yield "nobody noticed"
        elif o.tripped and row.reasons and o.reason not in row.reasons:
            yield f"reason {o.reason} instead of {' or '.join(row.reasons)}"
        return
    if o.travel > budget:
        yield f"travelled {o.travel * 1e6:.0f} um (budget {budget * 1e6:.0f} um)"
    rest, notice = STOP_LIMIT + state.later, DETECTION_LIMIT + state.later
    if o.stop is None or o.stop > rest:
        yield "did not stop" if o.stop is None else f"stood after {o.stop * 1e3:.0f} ms (limit {rest * 1e3:.0f})"
    if row.release or state.name in row.quiet:
        return
    if not o.tripped:
        yield "nobody noticed"
    elif row.reasons and o.reason not in row.reasons:
        yield f"reason {o.reason} instead of {' or '.join(row.reasons)}"
    if o.detection is not None and o.detection > notice and state.speed:
        yield f"noticed after {o.detection * 1e3:.0f} ms (limit {notice * 1e3:.0f})"


def _of_a_report(row: Row, o: Outcome) -> Iterator[str]:
    """Ask of what no software can stop that it is reported in time, for the right reason."""
    if o.detection is None or o.detection > DETECTION_LIMIT:
        yield "nobody noticed" if o.detection is None else f"noticed after {o.detection * 1e3:.0f} ms"
    elif row.reasons and o.reason not in row.reasons:
        yield f"reason {o.reason} instead of {' or '.join(row.reasons)}"


def _of_a_bar(row: Row, o: Outcome, budget: float) -> Iterator[str]:
    """Ask of a robot that cannot be enabled that it stays where it is."""
    if o.travel > budget:
        yield f"travelled {o.travel * 1e6:.0f} um (budget {budget * 1e6:.0f} um)"
    if o.tripped:
        yield f"tripped: {o.reason}"


def _of_an_end(row: Row, o: Outcome) -> Iterator[str]:
    if o.detection is None or o.detection > DETECTION_LIMIT:
        yield "nobody noticed" if o.detection is None else f"noticed after {o.detection * 1e3:.0f} ms"
    if o.faulted is None or o.faulted > STOP_LIMIT:
        yield "no FAULT" if o.faulted is None else f"FAULT after {o.faulted * 1e3:.0f} ms"
    elif row.reasons and o.fault_reason not in row.reasons:
        yield f"FAULT for {o.fault_reason} instead of {' or '.join(row.reasons)}"
