"""Every page on simulated runs: its signature is finite, and a fit finds what its form in the plant did."""

import numpy as np
import pytest
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.polish import polished
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.fit.fitting import make_term
from sher3_effects import library
from sher3_gap.evidence import gather
from sher3_gap.excitation import excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.stages.units import PLACES
from sher3_sim import RunScatter
from simulated import ROBOT, runs_of, signals


@pytest.fixture(scope="module")
def evidence():
    return gather(signals(runs_of(("reversals", "loads"), repeats=1)), ROBOT)


@pytest.mark.parametrize("effect", library().values(), ids=library())
def test_signatures_are_finite_on_their_channels(effect, evidence):
    site = PLACES[effect.places[0]][0]
    shapes = effect.shapes(evidence.views, site) if effect.channels(site) else []
    for shape in shapes[:2]:
        term = make_term(evidence.data, effect, site, shape)
        for part in (*term.columns, *term.fixed):
            for channel, values in part.items():
                assert np.isfinite(values).all(), (effect.id, channel)
        coefficients = np.ones(term.width) * 0.1
        for name, value in effect.parameters(shape, coefficients).items():
            assert np.isfinite(value)
            assert effect.unit(name, site, False)


QUIET = RunScatter(zero=0.0, disturbance=0.0, viscous=0.0)
RECOVERED = [
    ("coulomb_friction", "delta_1", {"force": 0.8}),
    ("viscous_friction", "tilt", {"extra": 40.0}),
    ("viscous_friction", "roll", {"extra": 0.05}),
    ("cogging", "delta_2", {"amplitude": 0.6, "periods_per_rev": 6.0}),
    ("torque_constant", "delta_3", {"relative": 0.08}),
    ("lead_error", "roll", {"relative": 1e-3}),
    ("backlash", "tilt", {"width": 4e-5}),
    ("backlash", "roll", {"width": 1e-3}),
    ("transmission_ripple", "delta_1", {"amplitude": 1e-5, "periods_per_rev": 2.0}),
    ("tool_offset", "tip", {"x": 1e-4}),
    ("link_length_error", "delta_2", {"length": 1e-4}),
    ("base_tilt", "tip", {"x": 1e-3}),
    ("force_bias", "force_sensor", {"fx": 0.2}),
    ("force_crosstalk", "force_sensor", {"xz": 0.05}),
    ("drive_lag", "delta_1", {"time_constant": 6e-3}),
    ("drive_lag", "tilt", {"time_constant": 10.5e-3}),  # so late that the loop swings up to the drive's limit
    ("encoder_eccentricity", "delta_3", {"amplitude": 1e-5}),
    ("joint_clearance", "tilt", {"clearance": 4e-5}),
    ("link_compliance", "tip", {"fraction": 0.8, "own_weight": 1.0}),
]


@pytest.mark.parametrize(("effect", "site", "truth"), RECOVERED, ids=[f"{e}-{s}" for e, s, _ in RECOVERED])
def test_a_fit_finds_what_the_form_in_the_plant_did(effect, site, truth):
    """Simulated, seen in its channel, fitted, carried back to the simulator: within five percent of the truth."""
    page = library()[effect]
    runs = rehearse(
        ROBOT, [(excite(x, ROBOT), 0) for x in ("sweep", "loads")], [page.plant(site, **truth)], seed=1, scatter=QUIET
    )
    evidence = gather(signals(runs), ROBOT)
    found = Candidates(evidence, [page]).best(page, site)
    assert found is not None
    assert set(page.channels(site)) & found.terms[0].channels
    found = polished(evidence, Attribution(found, ((),), (1.0,))).fit
    (part,) = page.to_simulator(site, page.parameters(found.terms[0].shape, found.of(0)), ROBOT)
    for name, value in truth.items():
        assert part.parameters[name] == pytest.approx(value, rel=0.05), part


def polished_on_steps(effect, site, **truth):
    """The page's fit to two step runs of a robot with the effect, its shape polished."""
    page = library()[effect]
    wanted = [(excite("steps", ROBOT), repeat) for repeat in range(2)]
    evidence = gather(signals(rehearse(ROBOT, wanted, [page.plant(site, **truth)], seed=1, scatter=QUIET)), ROBOT)
    found = Candidates(evidence, [page]).best(page, site)
    assert found is not None
    after = polished(evidence, Attribution(found, ((),), (1.0,))).fit
    return page.parameters(after.terms[0].shape, after.of(0))


def test_a_vibration_in_one_direction_is_one_mode_and_polished():
    """Frequency within 1 % and damping within 5 %: the grid of the search alone is 2 % and 20 % away."""
    truth = {"frequency": 13.0, "damping": 0.05, "x": 0.8, "y": 0.0, "z": 0.6, "single": 1.0}
    found = polished_on_steps("structural_vibration", "tip", **truth)
    assert found["single"] == 1.0
    assert found["frequency"] == pytest.approx(13.0, rel=0.01)
    assert found["damping"] == pytest.approx(0.05, rel=0.05)
    assert (found["x"], found["y"], found["z"]) == pytest.approx((0.8, 0.0, 0.6), abs=0.02)


@pytest.mark.parametrize("limit", [5.0, 3.5])
def test_a_force_limit_is_found_whether_it_shows_between_ticks_or_at_them(limit):
    """A demand that steps lifts the force at once; below 5 N it has left the limit again when it is reported."""
    assert polished_on_steps("force_saturation", "tilt", limit=limit)["limit"] == pytest.approx(limit, rel=0.08)


def test_a_load_that_swings_on_its_transmission_is_told_by_mass_spring_and_frequency():
    """Three tenths of the roll's mass on 278 N m/rad swing at 34.25 Hz against the motor, which feels the spring.

    Forces are held over a tick in the simulator, which the law takes for 0.02 more of damping.
    """
    truth = {"compliance": 3.6e-3, "load_share": 0.3, "frequency": 34.25}
    found = polished_on_steps("transmission_compliance", "roll", **truth, damping=0.05)
    for name, value in truth.items():
        assert found[name] == pytest.approx(value, rel=0.05), found
    assert found["damping"] == pytest.approx(0.05, abs=0.03)


def test_a_cable_beside_the_origin_of_the_sensor_turns_it_as_well(evidence):
    """Its torques are columns of their own; stiffness and drag are those of the forces alone."""
    page, shape = library()["cable_drag"], {"stroke": 0.25, "lever": 1.0}
    assert page.bends(evidence.views, "force_sensor", {"stroke": 0.25}) == [shape]
    columns = page.signature(evidence.views[0], "force_sensor", shape).columns
    (values,) = columns.values()
    assert values.shape[1:] == (6, 24) and np.abs(values).max(axis=0).any(axis=1).all()
    coefficients = np.zeros((4, 6))  # by roll, by tilt, and dragged by either; forces, then torques
    coefficients[0, 1], coefficients[3, 2], coefficients[:, 3:] = 0.05, -0.01, 9.0
    assert page.parameters(shape, coefficients.ravel()) == {"stiffness": 0.05, "force": 0.01}


def test_balls_of_every_leg_are_one_error_of_the_platform():
    """No leg alone explains a platform that was bored wrong: each leg's x and y are told within 3 µm."""
    page = library()["platform_geometry_error"]
    moved = {"delta_1": (3e-5, -1e-5), "delta_2": (-2e-5, 2e-5), "delta_3": (1e-5, 3e-5)}
    effects = [page.plant(leg, x=x, y=y) for leg, (x, y) in moved.items()]
    runs = rehearse(ROBOT, [(excite(x, ROBOT), 0) for x in ("sweep", "postures")], effects, seed=1, scatter=QUIET)
    evidence = gather(signals(runs), ROBOT)
    fits = [Candidates(evidence, [page]).best(page, site) for site in ("tip", *moved)]
    assert min(fits, key=lambda f: f.total) is fits[0]
    told = page.to_simulator("tip", page.parameters(fits[0].terms[0].shape, fits[0].of(0)), ROBOT)
    assert {p.actuator: (p.parameters["x"], p.parameters["y"]) for p in told} == {
        leg: pytest.approx(x_y, abs=3e-6) for leg, x_y in moved.items()
    }
