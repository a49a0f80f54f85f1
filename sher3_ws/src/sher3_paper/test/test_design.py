"""The design search: known results in both readings, constraints, fronts, symmetry, parallel runs and bad input."""

import numpy as np
import pytest
from distributed import LocalCluster
from sher3_kinematics.deflection import DeltaDeflection
from sher3_paper.errors import BadData, InfeasibleDesign
from sher3_paper.search.constraints import AS_STATED, REACH_ONLY, RELAXED, Constraints, Workspace, quantities
from sher3_paper.search.design import BEFORE, CHOSEN, READINGS, Design, Reading, base_radius, platform_radius
from sher3_paper.search.optimise import PAPER_LAW, Search, best, fine_grid, grid, search, search_parallel


@pytest.fixture(scope="module")
def found() -> dict[Reading, Search]:
    return {reading: search(reading=reading) for reading in READINGS}


def test_radii_of_the_chosen_design() -> None:
    assert platform_radius(0.040) == pytest.approx(0.0328, abs=5e-5)
    assert base_radius(0.064, 0.040, np.radians(27)) == pytest.approx(0.0618, abs=1e-4)
    assert CHOSEN.leg_offset() == pytest.approx(0.03254, abs=1e-5)
    assert CHOSEN.leg_offset("midplane") == pytest.approx(0.064 * np.sin(np.radians(27)))
    assert platform_radius(BEFORE.leg_width) == pytest.approx(0.0250, abs=1e-4)


def test_printed_conditioning_index(found: dict[Reading, Search]) -> None:
    """GCI 0.356 +- 0.005, by the circumradius reading only."""
    circum, midplane = found["circumradius"], found["midplane"]
    assert circum.index[circum.find(CHOSEN)] == pytest.approx(0.356, abs=0.005)
    assert midplane.index[midplane.find(CHOSEN)] == pytest.approx(0.323, abs=0.002)


def test_torsional_compliance_of_the_chosen_design(found: dict[Reading, Search]) -> None:
    for reading, expected in (("circumradius", 0.1363), ("midplane", 0.1662)):
        result = found[reading]
        assert np.degrees(result.compliance[result.find(CHOSEN)]) == pytest.approx(expected, abs=2e-4)


def test_compiled_search_agrees_with_the_deflection_model(found: dict[Reading, Search]) -> None:
    """The kernel's two 3 x 3 systems against the full gamma matrix, and its index against numpy's singular values."""
    poses = Workspace().poses(432)
    centres = np.column_stack((poses, np.zeros(len(poses))))
    for reading, result in found.items():
        for k in (0, 17, 333, 480, 700):
            design = result.design(k)
            model = DeltaDeflection(design.robot(reading), PAPER_LAW)
            assert model.torsional_compliance(centres, 1.0).mean() == pytest.approx(result.compliance[k], rel=1e-9)
            links = model.link_vectors(centres)[:, ::2]
            rows = links / links[..., 2:]
            sigma = np.linalg.svd(rows, compute_uv=False)
            assert (sigma[:, 2] / sigma[:, 0]).mean() == pytest.approx(result.index[k], rel=1e-9)


def test_sector_stands_for_the_whole_disc() -> None:
    """The mean over 60 degrees is that over the disc: rotated and mirrored positions give the same mean."""
    space = Workspace()
    sector = space.poses(432)
    angle, radius = np.arctan2(sector[:, 1], sector[:, 0]), np.hypot(sector[:, 0], sector[:, 1])
    assert (angle > 0).all()
    assert (angle < np.pi / 3).all()
    assert len(sector) * 6 >= 432
    assert (radius**2).mean() == pytest.approx(space.radius**2 / 2, rel=1e-12)
    turned = np.concatenate([s * angle + t for s in (1, -1) for t in (0, 2 * np.pi / 3, 4 * np.pi / 3)])
    disc = np.column_stack(
        (np.tile(radius, 6) * np.cos(turned), np.tile(radius, 6) * np.sin(turned), np.zeros(len(turned)))
    )
    model = DeltaDeflection(CHOSEN.robot(), PAPER_LAW)
    mean = model.torsional_compliance(disc, 1.0).mean()
    k = search()
    assert mean == pytest.approx(k.compliance[k.find(CHOSEN)], rel=1e-9)


def test_more_positions_change_nothing(found: dict[Reading, Search]) -> None:
    fine = search(poses=20_000)
    k = fine.find(CHOSEN)
    assert fine.index[k] == pytest.approx(found["circumradius"].index[k], abs=2e-4)
    assert fine.compliance[k] == pytest.approx(found["circumradius"].compliance[k], rel=1e-3)


def test_chosen_design_violates_the_stated_constraints(found: dict[Reading, Search]) -> None:
    result = found["circumradius"]
    k = result.find(CHOSEN)
    met = {name: bool(flags[k]) for name, flags in AS_STATED.each(result.values).items()}
    assert met == {"reach": True, "clearance": False, "stroke": False, "swing": False}
    assert result.values.stroke[k] == pytest.approx(0.1016, abs=1e-4)
    assert np.degrees(result.values.swing[k]) == pytest.approx(39.2, abs=0.05)
    assert np.degrees(result.values.cone[k]) == pytest.approx(32.6, abs=0.05)


@pytest.mark.parametrize(
    ("reading", "clearance", "stroke", "swing", "everything"),
    [("circumradius", 544, 373, 553, 92), ("midplane", 544, 524, 636, 176)],
)
def test_feasible_counts(
    found: dict[Reading, Search], reading: Reading, clearance: int, stroke: int, swing: int, everything: int
) -> None:
    each = AS_STATED.each(found[reading].values)
    assert [int(each[name].sum()) for name in ("clearance", "stroke", "swing")] == [clearance, stroke, swing]
    assert int(AS_STATED.met(found[reading].values).sum()) == everything


def test_constrained_quantities_by_sampling() -> None:
    """Stroke, swing and cone against the kinematics at many positions of the cylinder."""
    space, design = Workspace(), Design(0.080, 0.030, np.radians(22.0))
    values = quantities([design.link_length], [design.leg_width], [design.inclination])
    angle = np.linspace(0, 2 * np.pi, 181)
    ring = space.radius * np.column_stack((np.cos(angle), np.sin(angle)))
    positions = np.concatenate([ring * r for r in np.linspace(0, 1, 11)])
    across = positions - [design.leg_offset(), 0.0]
    rise = np.sqrt(design.link_length**2 - (across**2).sum(axis=1))
    assert values.stroke[0] == pytest.approx(space.height + rise.max() - rise.min(), rel=1e-4)
    direction = np.column_stack((across, rise)) / design.link_length
    centre = np.array([-design.leg_offset(), 0.0, np.sqrt(design.link_length**2 - design.leg_offset() ** 2)])
    swing = np.arccos(np.clip(direction @ centre / design.link_length, -1, 1)).max()
    assert values.swing[0] == pytest.approx(swing, rel=1e-4)
    lean = np.linspace(0.3, 0.6, 601)
    axes = np.column_stack((-np.sin(lean), np.zeros(len(lean)), np.cos(lean)))
    cone = np.arccos(np.clip(axes @ direction.T, -1, 1)).max(axis=1).min()
    assert values.cone[0] == pytest.approx(cone, rel=1e-3)


def test_optima_under_the_stated_constraints(found: dict[Reading, Search]) -> None:
    result = found["circumradius"]
    chosen = best(result, AS_STATED)
    assert str(result.design(chosen["least T_c"])) == "L 78 mm, w 40 mm, psi 23 deg"
    assert str(result.design(chosen["largest GCI"])) == "L 90 mm, w 25 mm, psi 25 deg"
    other = found["midplane"]
    assert str(other.design(best(other, AS_STATED)["least T_c"])) == "L 78 mm, w 40 mm, psi 26 deg"


def test_chosen_design_is_on_no_front(found: dict[Reading, Search]) -> None:
    for result in found.values():
        k = result.find(CHOSEN)
        for constraints in (RELAXED, REACH_ONLY):
            assert k not in result.pareto(constraints.met(result.values))
        assert len(result.dominating(k, result.values.reaches)) > 10
        assert 90 < result.rank(k, result.values.reaches)[0] < 140


def test_front_is_exactly_the_undominated_designs(found: dict[Reading, Search]) -> None:
    result = found["circumradius"]
    among = AS_STATED.met(result.values)
    brute = [k for k in np.flatnonzero(among) if len(result.dominating(k, among)) == 0]
    assert sorted(result.pareto(among)) == brute


def test_parallel_search_is_the_same_search() -> None:
    parameters = fine_grid(600)
    assert len(parameters[0]) >= 600
    one = search(parameters, poses=30)
    many = search_parallel(parameters, poses=30, jobs=2, chunk=200)
    assert np.array_equal(one.index, many.index, equal_nan=True)
    assert np.array_equal(one.values.cone, many.values.cone, equal_nan=True)


def test_dask_search_is_the_same_search() -> None:
    parameters = fine_grid(400)
    with LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as cluster:
        found = search_parallel(parameters, poses=30, dask=cluster.scheduler_address, chunk=150)
    assert np.array_equal(found.compliance, search(parameters, poses=30).compliance, equal_nan=True)


def test_out_of_reach_is_marked() -> None:
    result = search((np.array([0.030]), np.array([0.025]), np.array([0.5])))
    assert np.isnan(result.index).all()
    assert not REACH_ONLY.met(result.values).any()
    with pytest.raises(InfeasibleDesign, match="no design"):
        best(result, Constraints())


def test_bad_designs_are_refused() -> None:
    for parameters in ((0.0, 0.04, 0.5), (0.06, -0.04, 0.5), (0.06, 0.04, 27.0)):
        with pytest.raises(InfeasibleDesign):
            Design(*parameters)
    with pytest.raises(InfeasibleDesign, match="not in the grid"):
        search().find(Design(0.0641, 0.04, 0.5))
    with pytest.raises(BadData):
        grid(np.array([]), np.array([0.04]), np.array([0.5]))
    with pytest.raises(BadData):
        fine_grid(0)
    with pytest.raises(BadData):
        search(poses=0)
    with pytest.raises(BadData):
        search(torque=-1.0)
