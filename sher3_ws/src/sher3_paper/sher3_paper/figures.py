"""The figures of the report, drawn with Matplotlib and returned as PNG."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from sher3_kinematics.link_law import LinkLaw

from sher3_paper.grasp import GraspModel
from sher3_paper.search.constraints import Constraints
from sher3_paper.search.design import CHOSEN
from sher3_paper.search.optimise import Search
from sher3_paper.simulated import TwistLoop
from sher3_paper.tables import DeflectionTable, TorsionTable
from sher3_paper.torsion import TableModel, leg_slope, link_deflection, link_force

matplotlib.use("Agg")


def draw(name: str, arguments: dict[str, Any]) -> bytes:
    """Return the PNG of the figure with this name."""
    buffer = io.BytesIO()
    FIGURES[name](**arguments).savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()


def torsion(table: TorsionTable, models: dict[str, TableModel]) -> Figure:
    """Return measured against modelled torsional compliance."""
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.subplots()
    measured = np.degrees(table.compliance)
    for (name, model), marker in zip(models.items(), "os", strict=True):
        label = f"{name}, {model.torque:.2f} N m"
        axes.plot(measured, measured * (1 + model.error), marker, label=label, mfc="none")
    ends = np.array([0.2, 5.0])
    axes.plot(ends, ends, "k-", lw=0.8)
    axes.fill_between(ends, ends / 1.27, ends * 1.27, color="0.9", label="27 %", zorder=0)
    axes.set(xscale="log", yscale="log", xlabel="printed T_c [deg/(N m)]", ylabel="modelled T_c [deg/(N m)]")
    axes.set_xticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
    axes.set_yticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
    axes.minorticks_off()
    axes.legend()
    return figure


def link_law(table: TorsionTable, loops: list[TwistLoop], law: LinkLaw) -> Figure:
    """Return link force against deflection: from the table, from the plant, and the printed law."""
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.subplots()
    for loop in loops:
        width, slope = np.array(loop.design.leg_width), np.array(loop.design.leg_offset() / loop.design.link_length)
        force, stretch = link_force(loop.torque, width, slope), link_deflection(loop.rotation, width, slope)
        axes.plot(force, stretch * 1e6, ".", ms=3, color="C0")
    slope = leg_slope(table)
    force = link_force(np.full(len(slope), 0.96), table.leg_width, slope)
    axes.plot(
        force, link_deflection(0.96 * table.compliance, table.leg_width, slope) * 1e6, "s", mfc="none", color="C1"
    )
    f = np.linspace(-120, 120, 400)
    axes.plot(f, law.deflection(f) * 1e6, "k-", lw=1)
    axes.set(xlabel="link force [N]", ylabel="link deflection [um]")
    axes.legend(axes.lines[-3:], ["plant, six geometries", "table at 0.96 N m", "3.7 F^0.71"])
    return figure


def trends(found: Search) -> Figure:
    """Return GCI and T_c against psi for the least and largest w and every L, as in the paper's figure."""
    figure = Figure(figsize=(8.4, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    psi, lengths = np.unique(found.inclination), np.unique(found.link_length)
    for width, style in ((0.025, "--"), (0.040, "-")):
        for number, length in enumerate(lengths[::3]):
            rows = np.isclose(found.leg_width, width) & np.isclose(found.link_length, length)
            colour = matplotlib.colormaps["viridis"](number / 5)
            label = f"w {width * 1e3:.0f}, L {length * 1e3:.0f} mm"
            left.plot(np.degrees(psi), found.index[rows], style, color=colour, label=label)
            right.plot(np.degrees(psi), np.degrees(found.compliance[rows]), style, color=colour)
    k = found.find(CHOSEN)
    left.plot(27, found.index[k], "r*", ms=12)
    right.plot(27, np.degrees(found.compliance[k]), "r*", ms=12)
    left.set(xlabel="psi [deg]", ylabel="GCI")
    right.set(xlabel="psi [deg]", ylabel="mean T_c at 1 N m [deg/(N m)]")
    left.legend(fontsize=6)
    return figure


def pareto(found: Search, sets: dict[str, Constraints]) -> Figure:
    """Return all designs in the plane of the objectives, with the Pareto fronts of the constraint sets."""
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.subplots()
    compliance = np.degrees(found.compliance)
    axes.plot(compliance, found.index, ".", color="0.8", ms=4, label="all that reach")
    for (name, constraints), marker in zip(sets.items(), "os^", strict=True):
        front = found.pareto(constraints.met(found.values))
        axes.plot(compliance[front], found.index[front], marker + "-", ms=4, lw=0.8, label=f"front, {name}")
    k = found.find(CHOSEN)
    axes.plot(compliance[k], found.index[k], "r*", ms=13, label="chosen by the paper")
    axes.set(xlabel="mean T_c at 1 N m [deg/(N m)]", ylabel="GCI", xscale="log")
    axes.set_xticks([0.1, 0.2, 0.3, 0.5], ["0.1", "0.2", "0.3", "0.5"])
    axes.minorticks_off()
    axes.legend(fontsize=8)
    return figure


def grasp(table: DeflectionTable, model: GraspModel) -> Figure:
    """Return printed and modelled compliance per position, with the part of the delta links."""
    figure = Figure(figsize=(8.4, 3.4), layout="constrained")
    place = np.arange(len(table.positions))
    labels = [f"({x * 1e3:.0f}, {y * 1e3:.0f})" for x, y in table.positions]
    for axis, (axes, name) in enumerate(zip(figure.subplots(1, 3), "xyz", strict=True)):
        axes.bar(place - 0.2, table.compliance[:, axis] * 1e6, 0.4, label="printed", color="0.7")
        axes.bar(place + 0.2, model.model[:, axis] * 1e6, 0.4, label="model", color="C0")
        axes.bar(place + 0.2, model.delta_only[:, axis] * 1e6, 0.4, label="of it delta links", color="C1")
        axes.set_xticks(place, labels, fontsize=7)
        axes.set_title(f"C_{name} [um/N]")
    figure.axes[0].legend(fontsize=7)
    return figure


FIGURES: dict[str, Callable[..., Figure]] = {
    "torsion": torsion,
    "link_law": link_law,
    "trends": trends,
    "pareto": pareto,
    "grasp": grasp,
}
"""Every figure by the name under which sections ask for it."""
