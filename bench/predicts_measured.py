"""Bench: what causes named on some measured records are worth on others of the same machine.

The machine is diagnosed on the first records; its causes then foretell the force of those held out: the later half of
a double pendulum's swings and of the EMPS record, every second speed of three screw drives. Beside it stand two fits to
the same first records: every plain law of each joint at once, and the structure that is published.

    SHER3_SHARED=... nice python bench/predicts_measured.py

An error is the rms of what is left of the force, over that of the force less its nominal part, on the same samples.
Masses that a description calls unknown are those of the records they are held against, in all three.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from predicts import ROUNDS, Errors, rms
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, fit
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.quantify.closure import residual_after
from sher3_machines import described, import_case, open_case

REAL = Path(os.environ["SHER3_SHARED"]) / "real"
PLAIN = ("payload_mass", "viscous_friction", "coulomb_friction", "gravity_load", "spring_torque", "rotor_inertia")
"""Laws of a joint that the fit of all takes at once, as far as a machine has them."""

SCREW = """kind: axes
name: screw drive, speed and torque of the motor
time: {column: "time [ms]", unit: ms}
axes:
  - name: motor
    motion: rotary
    signals:
      position: {column: "Velocity actual value averaged [rpm]", unit: rpm}
      effort: {column: "Torque actual value averaged [%]", unit: "%", factor: 9.84e-5}
    command_law: {kind: force}
    mass: 2.186e-6
    range: [-1000, 1000]
    encoder_resolution: 1.3e-3
"""


class Case(NamedTuple):
    """A machine, its records, which of them are held out, and the structure that its source publishes."""

    name: str
    machine: Any
    first: Sequence[AxesRun]
    held_out: Sequence[AxesRun]
    published: Sequence[str]


def cases() -> list[Case]:
    """Return what is read of the shared folder."""
    friction, found = ("coulomb_friction", "viscous_friction"), []
    halved = ("dfki_double_pendulum", "A7.csv", ("gear_loss",)), ("emps", "DATA_EMPS.mat", (*friction, "gravity_load"))
    for name, file, published in halved:
        machine, (run,) = opened(name, [REAL / name / file])
        half = run.ticks // 2
        found.append(Case(name, machine, [part(run, slice(half))], [part(run, slice(half, None))], published))
    laws = (*friction, "stribeck_friction", "gravity_load"), friction[:1], (friction[0], "gravity_load")
    for number, published in enumerate(laws, 1):
        folder = REAL / f"rvim_screw_drives/experiments/driveNo{number}"
        files = sorted(folder.glob("steady_state/0.096kg/*.csv"), key=lambda f: float(f.stem.replace("n", "-")))
        machine, runs = opened(SCREW, files)
        found.append(Case(f"screw drive {number}", machine, runs[::2], runs[1::2], published))
    return found


def opened(description: str, files: Sequence[Path]) -> tuple[Any, Sequence[AxesRun]]:
    """Return a machine and its runs; the description is a name that is known, or the text of one."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(description)
        if "\n" in description:
            path = Path(folder) / "described.yaml"
            path.write_text(description, encoding="utf-8")
        import_case(files, described(path), Path(folder) / "case")
        return open_case(Path(folder) / "case")


def part(run: AxesRun, rows: slice) -> AxesRun:
    """Return some rows of a run."""
    return replace(run, signals={k: {n: x[rows] for n, x in s.items()} for k, s in run.signals.items()})


def predicted(case: Case) -> Errors:
    """Return the errors on the records held out."""
    first, held_out = (balance_of(case.machine, runs) for runs in (case.first, case.held_out))
    findings = diagnose(case.machine, case.first).findings
    causes = next(f.attribution.fit for f in findings if f.evidence.channels == first.channels)
    fits = causes, all_of(case, first, PLAIN), all_of(case, first, case.published)
    nothing = left_by(first.null(), held_out)
    return Errors(*(left_by(x, held_out) / nothing for x in fits))


def balance_of(machine: Any, runs: Sequence[AxesRun]) -> Evidence:
    """Return the evidence in the force balance."""
    return next(e for e in machine.gather(runs) if any(c.stage == "motor_mechanics" for c in e.channels))


def all_of(case: Case, evidence: Evidence, names: Sequence[str]) -> Fit:
    """Return the fit of all these laws at every joint, each with its best shape beside the others."""
    known = [e for e in case.machine.of(evidence).effects(evidence) if e.id in names]
    candidates, terms = Candidates(evidence, known), {}
    for effect, site in ROUNDS * [(e, s) for e in known for s in candidates.sites(e)]:
        others = [t for key, t in terms.items() if key != (effect.id, site)]
        best = candidates.best(effect, site, [*evidence.nuisance, *others])
        terms |= {(effect.id, site): best.terms[-1]} if best else {}
    return fit(evidence.data, [*evidence.nuisance, *terms.values()])


def left_by(found: Fit, evidence: Evidence) -> float:
    """Return what a fit leaves of the forces of other records, each over its floor."""
    moved = fit(evidence.data, again(evidence.data, found.terms))
    rows = np.mean(found.loro_coefficients, axis=0)
    held = replace(moved, loro_coefficients=np.broadcast_to(rows, (len(evidence.floors), len(rows))))
    channels = [c for c in evidence.channels if c.stage == "motor_mechanics"]
    return rms(*(x for c in channels for x in residual_after(evidence, held, c).values()))


def main() -> None:
    """Print a line for each machine."""
    for case in cases():
        e = predicted(case)
        print(f"{case.name}: causes {e.causes:.3f}  all plain laws {e.wrong:.3f}  published {e.true:.3f}", flush=True)


if __name__ == "__main__":
    main()
