"""The command group `sher3 gap`."""

from __future__ import annotations

from collections.abc import Callable

import typer

from sher3_gap_cli.commands.apply import apply, compare
from sher3_gap_cli.commands.challenge import arms, calibrate, challenge
from sher3_gap_cli.commands.compare_simulators import compare_simulators
from sher3_gap_cli.commands.diagnose import diagnose
from sher3_gap_cli.commands.discover import discover
from sher3_gap_cli.commands.excite import excite
from sher3_gap_cli.commands.experiment import experiment
from sher3_gap_cli.commands.export import export
from sher3_gap_cli.commands.intake import IMPORT_EXAMPLE, case, describe, import_data
from sher3_gap_cli.commands.monitor import monitor
from sher3_gap_cli.guard.check import check
from sher3_gap_cli.library.command import library
from sher3_gap_cli.watch.command import watch

app = typer.Typer(no_args_is_help=True, help="Find and explain the gap between a robot and its simulation.")

EXAMPLES: dict[Callable[..., None], str] = {
    diagnose: "sher3 gap diagnose case_001 · sher3 gap diagnose cases/* --jobs 2 --out verdicts",
    discover: "sher3 gap discover case_002 · sher3 gap discover case_002 --save found.yaml --out gap/case_002",
    apply: "sher3 gap apply gap/case_001/verdict.json -o corrected.yaml --case case_001",
    compare: "sher3 gap compare case corrected",
    export: "sher3 gap export gap/case_emps/verdict.json --to mjcf --check case_emps --out emps.xml",
    experiment: "sher3 gap experiment gap/case_001/verdict.json case_001 -o tell_apart.yaml",
    library: "sher3 gap library · sher3 gap library friction · sher3 gap library backlash",
    excite: "sher3 gap excite · sher3 gap excite all -o case · sher3 gap excite sweep --simulate -o case",
    check: "sher3 gap check log.npz robot.xml --baseline verdict.json --junit gap.xml --markdown gap.md",
    monitor: "sher3 gap monitor --effects effects.yaml --json",
    watch: "sher3 gap watch --model robot.urdf --states /joint_states --best-effort",
    arms: "sher3 gap arms --seeds 0:1 --seconds 20",
    describe: "sher3 gap describe slide.csv --out slide.yaml",
    case: "sher3 gap case bags/a bags/b --out case",
    challenge: "sher3 gap challenge --seeds 0:40 --json",
    calibrate: "sher3 gap calibrate lumped=run/lumped tables=run/tables -o calibration.json --kept evidence",
}
"""Every command whose function bears its name, with an example."""
TRACES = "sher3 gap compare-simulators first.npz second.npz --model robot.xml"

for _command, _example in EXAMPLES.items():
    app.command(epilog=f"Example{'s' * (' · ' in _example)}: {_example}")(_command)
app.command("compare-simulators", epilog=f"Example: {TRACES}")(compare_simulators)
app.command("import", epilog=f"Example: {IMPORT_EXAMPLE}")(import_data)
