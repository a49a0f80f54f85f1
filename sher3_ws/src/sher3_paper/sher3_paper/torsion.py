"""Torsional compliance of the test geometries, and the identification of the link law from it, as in the paper.

At the centre a moment tau about z loads every link with F = tau / (3 w s), s = R / L, and a rotation theta about z
stretches it by dL = w s theta / 2 (eqs. (6) and (11) of the paper); exact for the symmetric stage at the centre.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from sher3_kinematics.link_law import LinkLaw

from sher3_paper.errors import BadData
from sher3_paper.tables import TorsionTable, require_rows

Floats = NDArray[np.float64]
Geometry = Literal["hole rows", "literal"]
GEOMETRIES: tuple[Geometry, ...] = ("hole rows", "literal")

LINK_LENGTH = 0.086
"""Link length [m] of the tested stage, which is the design before the optimisation."""
ROW_PITCH = 0.010
"""Distance [m] between the hole rows of the test discs: the leg offsets R are multiples of it."""


class Interval(NamedTuple):
    """An estimate with its 95 % confidence interval."""

    value: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.value:.3g} [{self.low:.3g}, {self.high:.3g}]"


def leg_slope(table: TorsionTable, geometry: Geometry = "hole rows") -> Floats:
    """Return s = R / L (n,) of the tested geometries.

    `hole rows`: R = 10, 20, 30, 40 mm for the four printed angles in rising order; `literal`: s = sin(psi).
    """
    if geometry == "literal":
        return np.sin(table.label)
    labels = np.unique(table.label)
    row = np.searchsorted(labels, table.label).astype(np.float64) + 1.0
    return ROW_PITCH / LINK_LENGTH * row


def link_force(torque: Floats | float, leg_width: Floats, slope: Floats) -> Floats:
    """Return the axial force [N] of each link under a moment [N m] about z at the centre."""
    return np.asarray(torque) / (3.0 * leg_width * slope)


def link_deflection(rotation: Floats, leg_width: Floats, slope: Floats) -> Floats:
    """Return the elongation [m] of each link for a rotation [rad] about z at the centre."""
    return 0.5 * leg_width * slope * rotation


def modelled_compliance(torque: float, leg_width: Floats, slope: Floats, law: LinkLaw) -> Floats:
    """Return the secant torsional compliance [rad/(N m)] at a moment [N m] about z, at the centre."""
    force = link_force(torque, leg_width, slope)
    return 2.0 * law.deflection(force) / (leg_width * slope * torque)


def effective_torque(table: TorsionTable, slope: Floats, law: LinkLaw) -> float:
    """Return the one moment [N m] at which the law fits the table best in the logarithm.

    A pure power law gives T_c proportional to tau^(b - 1), so the mean log ratio fixes tau in closed form.
    """
    ratio = np.log(modelled_compliance(1.0, table.leg_width, slope, law) / table.compliance).mean()
    return float(np.exp(-ratio / (law.b - 1.0)))


class PowerFit(NamedTuple):
    """A power law dL = a F^b fitted to link points.

    Attributes:
        a: [m/N^b], with its interval.
        b: exponent, with its interval.
        r_squared: of the deflections [m], not their logarithms.
        rms: of the deflection error [m].
        residual_df: points less parameters.
    """

    a: Interval
    b: Interval
    r_squared: float
    rms: float
    residual_df: int


def fit_power_law(force: Floats, deflection: Floats) -> PowerFit:
    """Fit dL = a F^b to link forces [N] and deflections [m] of one sign, least squares in the logarithm.

    Raises:
        BadData: fewer than three points, a value that is not positive, or all forces equal.
    """
    f, d = np.ravel(force), np.ravel(deflection)
    require_rows(len(f), 3, "link force and deflection")
    if not ((f > 0) & (d > 0)).all():
        worst = float(min(f.min(), d.min()))
        raise BadData("forces and deflections", value=worst, limit="> 0", remedy="pass magnitudes, without zeros")
    line = _line(np.log(f), np.log(d))
    b, a = line.slope, Interval(*(float(np.exp(value)) for value in line.intercept))
    error = d - a.value * f**b.value
    spread = float(((d - d.mean()) ** 2).sum())
    return PowerFit(a, b, 1.0 - float((error**2).sum()) / spread, float(np.sqrt((error**2).mean())), len(f) - 2)


class _Line(NamedTuple):
    slope: Interval
    intercept: Interval


def _line(x: Floats, y: Floats) -> _Line:
    if np.ptp(x) < 1e-9:
        raise BadData("forces", value=float(np.ptp(x)), limit="spread > 0", remedy="measure at several forces")
    fit = stats.linregress(x, y)
    t = stats.t.ppf(0.975, max(len(x) - 2, 1))
    slope = Interval(fit.slope, fit.slope - t * fit.stderr, fit.slope + t * fit.stderr)
    half = t * fit.intercept_stderr
    return _Line(slope, Interval(fit.intercept, fit.intercept - half, fit.intercept + half))


@dataclass(frozen=True)
class TableModel:
    """The torsion model against the printed table.

    Attributes:
        geometry: reading of the tested geometries.
        torque: moment [N m] the model is evaluated at.
        error: model / measurement - 1 (n,).
    """

    geometry: Geometry
    torque: float
    error: Floats

    @property
    def relative_rms(self) -> float:
        """Root mean square of the relative error."""
        return float(np.sqrt((self.error**2).mean()))

    @property
    def largest(self) -> float:
        """Largest magnitude of the relative error."""
        return float(np.abs(self.error).max())


def compare_with_table(
    table: TorsionTable, law: LinkLaw, geometry: Geometry, torque: float | None = None
) -> TableModel:
    """Return the model's errors against the table at one torque [N m], by default the best fitting one."""
    slope = leg_slope(table, geometry)
    moment = effective_torque(table, slope, law) if torque is None else torque
    model = modelled_compliance(moment, table.leg_width, slope, law)
    return TableModel(geometry, moment, model / table.compliance - 1.0)


def identify_from_table(table: TorsionTable, torque: float, geometry: Geometry) -> PowerFit:
    """Identify the link law from the table, every entry taken as a secant at the same moment [N m]."""
    slope = leg_slope(table, geometry)
    force = link_force(np.full(len(slope), torque), table.leg_width, slope)
    return fit_power_law(force, link_deflection(table.compliance * torque, table.leg_width, slope))


class Exponents(NamedTuple):
    """T_c ~ w^width s^slope r_p^radius with intervals, and the relative rms of what remains."""

    width: Interval
    slope: Interval
    radius: Interval
    relative_rms: float


def empirical_exponents(table: TorsionTable, geometry: Geometry) -> Exponents:
    """Fit a power of each geometric parameter to the table; the model's own are -(1 + b), -(1 + b) and 0."""
    columns = (table.leg_width, leg_slope(table, geometry), table.platform_radius)
    design = np.column_stack([np.ones(len(table.label)), *(np.log(column) for column in columns)])
    target = np.log(table.compliance)
    solution = np.linalg.lstsq(design, target, rcond=None)[0]
    error = target - design @ solution
    freedom = len(target) - design.shape[1]
    covariance = np.linalg.inv(design.T @ design) * float(error @ error) / freedom
    half = stats.t.ppf(0.975, freedom) * np.sqrt(np.diag(covariance))
    intervals = [Interval(v, v - h, v + h) for v, h in zip(solution.tolist(), half.tolist(), strict=True)]
    rms = float(np.sqrt((np.expm1(-error) ** 2).mean()))
    return Exponents(intervals[1], intervals[2], intervals[3], rms)


def leave_one_out(table: TorsionTable, torque: float, geometry: Geometry) -> Floats:
    """Return the relative error (n,) at each entry of the law identified without it."""
    slope = leg_slope(table, geometry)
    errors = np.empty(len(slope))
    for k in range(len(slope)):
        kept = np.arange(len(slope)) != k
        part = TorsionTable(*(column[kept] for column in table))
        force = link_force(np.full(kept.sum(), torque), part.leg_width, slope[kept])
        fit = fit_power_law(force, link_deflection(part.compliance * torque, part.leg_width, slope[kept]))
        law = LinkLaw(fit.a.value, fit.b.value, force_floor=0.0)
        one = modelled_compliance(torque, table.leg_width[k : k + 1], slope[k : k + 1], law)
        errors[k] = one[0] / table.compliance[k] - 1.0
    return errors
