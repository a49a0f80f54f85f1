"""The hazards of the robot, each with its cause, its control, what verifies that, and what is left.

In the manner of ISO 14971 (hazard, cause, risk control, verification, residual risk) and of the risk control measures
of IEC 62304, from the data of the matrix: a row of the matrix that belongs to no hazard is an error, and so is a hazard
that nothing verifies (`test/test_hazards.py`). The residual is a travel of the tip, by computation
(`sher3_faults.budget`) and, where there is a report of the matrix, as measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Any, NamedTuple

import numpy as np
from sher3_faults.budget import GUARDED, TravelBudget

from sher3_safety.rows.processes import WALL
from sher3_safety.rows.row import Row
from sher3_safety.rows.stepped import ROWS

RUNAWAY = "runaway"
"""In place of a fault of the budget: an axis as fast as its drive lets it be."""
FALSE_FORCE = "false force"
"""In place of a fault of the budget: a hand that has left a sensor that stays where it was, where that is noticed."""
_DRIVERS = "sher3_ws/src/sher3_drivers/test"


class Hazard(NamedTuple):
    """One hazard.

    Attributes:
        name: what happens to the tip.
        cause: why it may.
        control: what keeps it short.
        components: patterns of the components of the matrix that break for it.
        tests: files of tests, under the project.
        faults: faults of the travel budget that bound it; the longest travel counts.
        gap: what software alone cannot hold; empty where nothing is known.
    """

    name: str
    cause: str
    control: str
    components: tuple[str, ...]
    tests: tuple[str, ...]
    faults: tuple[str, ...]
    gap: str = ""


HAZARDS = (
    Hazard(
        "moves on though the foot has left",
        "pedal silent, unplugged, stuck, chattering; contact or travel stuck",
        "two antivalent contacts, whole state told, age of 20 ms, limits of a foot; release then press",
        ("pedal", "pedal.*"),
        (f"{_DRIVERS}/test_plausible_pedal.py",),
        ("pedal released", "pedal silent or dead"),
        "a lever that hangs: the hand alone decides, a press ends after 120 s; one that bounces as a foot may, 3 to 6 "
        "times a second, is believed: a hand of 1 N that stays leads the tip on by up to 0.8 mm in 3 s",
    ),
    Hazard(
        "moves without a hand, or against it",
        "force sensor silent, frozen, saturated, not finite, faster than a hand, alive without one, of another sign, "
        "with a bias, a drift, a torque of its own",
        "a zero that is earned before enabling; age, range, repetition and jumps judged in the same tick; the drives' "
        "efforts as a second witness of force and torque; travel without a hand bounded; speed cap",
        ("force_sensor",),
        (f"{_DRIVERS}/test_force_sensor.py", "sher3_ws/src/sher3_control/test/test_hand.py",
         "sher3_ws/src/sher3_control/test/test_zero.py"),
        ("force sensor silent, dead", "force sensor frozen", "force not finite, out of range",
         "force to and fro every other tick", FALSE_FORCE),
        "beside a true hand a false force of 0.2 N and less, or below 12 % of the hand, that was there when the axes "
        "last turned round: 0.2 mm/s more, since the drives know a level no better: 20 g on the tool, and what "
        "friction in the screws holds, look the same; a gain that grows by 10 % a second under 0.6 N: 0.24 mm further "
        "along the hand, by 5 % 0.27 mm, told by its size; a sensor turned by 10 degrees as a hand comes "
        "at once: 67 um sideways on 1.5 mm (`python bench/slow_forces.py`); without a hand "
        "0.2 to 0.9 N are noticed so late that the travel near tissue is beyond the budget of 25 um, since a leg's "
        "force has a noise of 0.17 N and a light hand takes time: 102 um where 0.4 N leave just after enabling "
        "(`python bench/just_enabled.py`)",
    ),
    Hazard(
        "an axis moves by itself",
        "drive executes another velocity, creeps, runs at its own limit; echo false or missing",
        "sum of the commands sent against both encoders without leak, all together; echo; cap in the drive",
        ("*.power", "*.demand", "*.echo", "*.motor", "*.statusword"),
        (f"{_DRIVERS}/test_position.py", f"{_DRIVERS}/test_speed_limits.py"),
        ("axis leaves its commands", RUNAWAY),
        "a drive that creeps and reports the force that would explain it: a leg 85 um near tissue, the tilt 75 um at "
        "its limit (`python bench/attacks.py`), until the watch of the hand, which hears the force sensor, takes its "
        "power; one that neither hears nor is heard: 91 and 659 um (`sher3 safety budget`); one that turns its motor "
        "without being enabled: only safe torque off stops it",
    ),
    Hazard(
        "goes elsewhere, since a position is wrong",
        "encoder frozen, drifting, scaled, noisy; coupling slips",
        "two encoders and the demand, two against one; tracker where there is one",
        ("*.load_encoder", "*.motor_encoder", "*.encoders"),
        (f"{_DRIVERS}/test_watches.py",),
        ("encoder wrong, coupling slips", "encoder frozen"),
        "both encoders wrong alike by less than the force explains; both that drift as fast as the axis goes by "
        "itself, with a false echo: 0.7 mm in 0.3 s near tissue, and on; axes that creep behind encoders that drift, "
        "each within its own limit: 36 um near tissue (`sher3 safety search`); a slip behind the load encoder without "
        "a tracker; a drive whose commands and both positions have one wrong scale or sign, as by a description that "
        "is wrong alike: on 0.4 mm 9 um with 1.02, 47 with 1.1, 948 with the other sign (`python bench/attacks.py`), "
        "since its effort in that motion, 0.2 N for 30 ms, tells mass and sense of what it moves to 25 % along z and "
        "to 40 to 90 % sideways (a standard deviation, noise 0.17 N a tick): too little for a watch that is to let "
        "ten thousand starts pass; each axis is commanded alone and measured before use",
    ),
    Hazard(
        "goes elsewhere, since cables are exchanged",
        "plugs of two axes exchanged, poles reversed, at motor, encoders or both",
        "each axis against its commands from enabling on; the hand, felt twice, where a whole axis has another name",
        ("wires", "wires.*"),
        ("sher3_ws/src/sher3_control/test/test_hand.py", f"{_DRIVERS}/test_position.py"),
        ("axis leaves its commands",),
        "two legs exchanged whole are not told while the hand pushes along z, where they do the same",
    ),
    Hazard(
        "acts on reports that are old, garbled or of another axis",
        "CAN frames lost, late, twice, exchanged; two drives with one node id",
        "counter of SYNC and CRC with the node id behind every report; such a report is not believed",
        ("*.up",),
        (f"{_DRIVERS}/test_protection.py",),
        ("joint positions silent", "drive silent"),
        "drives without end-to-end protection: reports one tick old in even motion, 1 um near tissue and 10 um free",
    ),
    Hazard(
        "the drives do not hear, or hear something else",
        "CAN cut, bus off, commands garbled, another host",
        "CRC of commands, event time of the RPDO, host's heartbeat; foreign frames trip",
        ("bus", "delta_?", "*.down"),
        (f"{_DRIVERS}/test_protection.py", f"{_DRIVERS}/test_other_host.py"),
        ("CAN bus off or cut", "drive reports a fault or restarts"),
        "drives without end-to-end protection: one garbled command that enables runs the drive for 2 ms at its limit",
    ),
    Hazard(
        "the computer stops, hangs or is too late",
        "process killed, held, started twice; processor taken away",
        "each stage times out by itself: law, driver, drives; no heartbeat without a loop; one robot in a domain",
        ("process.*", "cpu"),
        ("tests/test_stop_and_hold.py",),
        ("motor driver or computer dead", "motor driver held up", "supervisor dead", "kinematics node dead",
         "admittance node dead", "user's commands silent"),
        "a drive whose processor hangs with its power stage on: emergency stop circuit",
    ),
    Hazard(
        "time is wrong",
        "clock jumps, stands, or goes backwards",
        "stamps against the monotonic clock at every stage",
        ("clock", "clock.*"),
        (),
        ("clock jumped",),
    ),
    Hazard(
        "loses its torque",
        "safe torque off, supply lost, drive in local mode",
        "POWER_OFF with its reason; no recovery while it lasts; bits of the statusword",
        ("safe_torque_off",),
        (f"{_DRIVERS}/test_closed_drives.py",),
        ("drive reports a fault or restarts",),
        "the residual is that of the software's answer alone; how far an axis without torque coasts, and sinks under "
        "its load, is to be measured at the robot",
    ),
    Hazard(
        "goes elsewhere, since the robot is another one than the software believes",
        "drive exchanged, configured by somebody else; robot file wrong",
        "name plates (`sher3 up --drives`), every object that shapes motion read back; impossible numbers refused",
        (),
        (
            f"{_DRIVERS}/test_closed_drives.py",
            f"{_DRIVERS}/test_name_plates.py",
            "tests/test_file_doors.py",
            "tests/test_fuzz_files.py",
        ),
        (),
        "a robot file that is plausible and wrong: travel and direction are not bounded by anything here",
    ),
    Hazard(
        "is faster than the tissue allows",
        "nobody said that tissue is near; a cap that is not kept",
        "regimes, of which a faster one begins at rest alone; cap in law, gate and drive",
        (),
        ("sher3_ws/src/sher3_control/test/test_speed_cap.py", "tests/test_regime_in_drives.py"),
        (),
        "no sensor tells where the tissue is: in the regime free every residual is the one on the right",
    ),
    Hazard(
        "presses on tissue",
        "a hand that pushes; a drive that holds against it",
        "v = gain force of the hand, cap of the regime; largest torque of the drives written and read back",
        (),
        (f"{_DRIVERS}/test_closed_drives.py", "sher3_ws/src/sher3_control/test/test_admittance.py"),
        (),
        "the sensor is at the handle: a force between tip and tissue is not measured, and nothing limits it",
    ),
    Hazard(
        "follows somebody else's commands",
        "a second process, program or host that publishes what moves the robot",
        "loopback alone; one publisher of each stream and command; no other host on CAN; policy file of the middleware",
        (),
        ("tests/test_security.py", "tests/test_privacy.py", "sher3_ws/src/sher3_control/test/test_control_nodes.py"),
        (),
        "whoever runs programs on the robot's computer as its user may do anything",
    ),
    Hazard(
        "moves when a fault is cleared",
        "recovery, enabling, late or lost frames",
        "one recovery a fault, disabled first; release then press; fault reset held until the drive has left FAULT",
        ("*.resets",),
        ("tests/test_product_machine.py", "sher3_ws/src/sher3_control/test/test_supervisor_histories.py"),
        ("pedal released",),
    ),
)  # fmt: skip


def rows_of(hazard: Hazard) -> list[Row]:
    """Return the rows of the matrix, in stepped and in wall time, that belong to a hazard."""
    return [row for row in (*ROWS, *WALL) if _concerns(hazard, row.component) or _concerns(hazard, row.loses)]


def _concerns(hazard: Hazard, component: str) -> bool:
    return any(fnmatchcase(component, name) for name in hazard.components)


def _bounds(hazard: Hazard, budget: TravelBudget) -> Iterator[tuple[str, float]]:
    """Yield (regime, travel [m]) of the faults that bound a hazard."""
    for row in budget.rows:
        if row.fault in hazard.faults:
            yield row.regime, row.travel
    if FALSE_FORCE in hazard.faults:
        for guarded in GUARDED:
            yield guarded.value, max(f.travel for f in budget.false_forces(guarded) if np.isfinite(f.travel))
    if RUNAWAY in hazard.faults:
        for regime, ways in budget.runaway.items():
            yield regime, max(ways.values())


def residual(hazard: Hazard, budget: TravelBudget) -> dict[str, float]:
    """Return the longest computed travel of the tip [m] by regime; nothing where no motion follows."""
    found: dict[str, float] = {}
    for regime, travel in _bounds(hazard, budget):
        found[regime] = max(found.get(regime, 0.0), travel)
    return found


def measured(hazard: Hazard, cells: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Return the longest measured travel [m] by state, of cells of a report of the matrix that had to stop."""
    found: dict[str, float] = {}
    for cell in cells:
        if _concerns(hazard, cell["component"]) and cell["effect"] == "stops" and cell["outcome"] is not None:
            found[cell["state"]] = max(found.get(cell["state"], 0.0), cell["outcome"]["travel"] or 0.0)
    return found


def hazard_table(budget: TravelBudget, cells: Sequence[Mapping[str, Any]] = ()) -> list[dict[str, Any]]:
    """Return the hazards as plain data, with their residuals in um."""
    table = []
    for hazard in HAZARDS:
        lines = rows_of(hazard)
        table.append({
            "hazard": hazard.name if hazard.name.startswith(("the ", "time", "an ")) else f"the tip {hazard.name}",
            "cause": hazard.cause,
            "control": hazard.control,
            "rows": len(lines),
            "tests": list(hazard.tests),
            "residual": {regime: 1e6 * travel for regime, travel in residual(hazard, budget).items()},
            "measured": {state: 1e6 * travel for state, travel in measured(hazard, cells).items()},
            "gap": hazard.gap,
        })  # fmt: skip
    return table
