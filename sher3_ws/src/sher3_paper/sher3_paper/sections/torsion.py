"""The torsion table against the deflection model."""

from __future__ import annotations

import numpy as np

from sher3_paper.comparison import Comparison, Section, Table, computed, within
from sher3_paper.search.optimise import PAPER_LAW
from sher3_paper.tables import printed, torsion_table
from sher3_paper.torsion import GEOMETRIES, compare_with_table

COMMAND = "sher3 paper --only torsion"


def torsion() -> Section:
    """Return the part on the 23 torsional compliances and the sprung one."""
    table = torsion_table()
    models = {geometry: compare_with_table(table, PAPER_LAW, geometry) for geometry in GEOMETRIES}
    fixed = {geometry: compare_with_table(table, PAPER_LAW, geometry, 1.0) for geometry in GEOMETRIES}
    lines: list[Comparison] = []
    for name, model in models.items():
        note = "the torque at which the secant fits best"
        lines.append(computed(f"effective torque, {name}", "N m", model.torque, COMMAND, note))
        rms, largest = 100 * model.relative_rms, 100 * model.largest
        lines.append(within(f"relative rms, {name}", "%", 15.0, rms, COMMAND, f"at {model.torque:.2f} N m, band 15"))
        lines.append(within(f"largest relative error, {name}", "%", 27.0, largest, COMMAND, "band 27"))
        at_one = 100 * fixed[name].relative_rms
        lines.append(computed(f"relative rms at 1 N m, {name}", "%", at_one, COMMAND))
    sprung = printed()["torsion_table"]["sprung"]
    plain = float(np.degrees(table.compliance[(table.platform_radius < 0.03) & (table.leg_width == 0.03)][-1]))
    lines.append(computed("springs, compliance with over without", "1", sprung[3] / plain, COMMAND, "0.13 / 0.27"))
    rows = [
        [
            f"{np.degrees(table.label[k]):.3g}",
            f"{table.platform_radius[k] * 1e3:.1f}",
            f"{table.leg_width[k] * 1e3:.0f}",
            f"{np.degrees(table.compliance[k]):.2f}",
            *(
                f"{np.degrees(table.compliance[k]) * (1 + m.error[k]):.2f} ({100 * m.error[k]:+.1f} %)"
                for m in models.values()
            ),
        ]
        for k in range(len(table.label))
    ]
    columns = ["psi [deg]", "r_p [mm]", "w [mm]", "printed", *(f"model, {name}" for name in models)]
    text = (
        "Torsional compliance of the tested geometries at the centre, link law as printed, one torque for all "
        "entries. The paper states neither the torque nor the kind of average; with a power law all averages differ "
        "by a factor alone, so the torque is fitted and stated."
    )
    figures = [("torsion", {"table": table, "models": models})]
    return Section("torsion", "Torsional compliance", text, lines, [Table("deg/(N m)", columns, rows)], figures)
