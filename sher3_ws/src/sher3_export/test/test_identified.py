"""Inertias that a diagnosis identified are written into a model beside the causes."""

import numpy as np
import pytest
import yaml
from linked_models import MODELS, tree_of
from sher3_diagnosis.verdict import Identified, Parameter
from sher3_export import export
from sher3_export.ranges import Ranges
from sher3_export.xml_file import parse_xml
from verdicts import cause, verdict

FOUND = [
    Identified(actuator="fore", constants={"link_mass": Parameter(value=0.3, unit="kg")}),
    Identified(actuator="elbow", constants={"inertia": Parameter(value=0.02, unit="kg*m^2")}),
]


def found_beside(friction):
    return verdict(friction).model_copy(update={"identified": FOUND})


@pytest.mark.parametrize(("to", "written"), [("mjcf", 3), ("urdf", 2), ("yaml", 3)])
def test_identified_inertias_are_written_beside_the_causes(to, written):
    """A URDF has no field for a rotor, and says so."""
    given, root = MODELS.get(to, ("", ""))
    model = parse_xml(given, root) if given else None
    done = export(found_beside(cause("coulomb_friction", "elbow", force=0.5, unit="N*m")), to, model)
    assert [x.effect for x in done.applied].count("identified") == written - 1
    assert len(done.not_expressed) == 3 - written
    if to == "yaml":
        assert yaml.safe_load(done.text)["joints"]["elbow"]["inertia"][0]["from"] == "identified"
    else:
        before, after = (tree_of(x).inertial[10] for x in (given, done.text))
        assert after - before == pytest.approx(0.3, rel=0.2)


def test_an_identified_inertia_with_an_interval_is_drawn_from_it_and_listed_among_the_ranges():
    rotor = Parameter(value=0.02, unit="kg*m^2", low=0.01, high=0.03)
    told = Identified(actuator="elbow", constants={"inertia": rotor})
    ranges = Ranges([[]], identified=[FOUND[0], told])
    rng = np.random.default_rng(0)
    draws = [{x.actuator: x.constants for x in ranges.draw_inertias(rng)} for _ in range(400)]
    assert {x["fore"]["link_mass"].value for x in draws} == {0.3}
    assert np.mean([0.01 <= x["elbow"]["inertia"].value <= 0.03 for x in draws]) == pytest.approx(0.95, abs=0.03)
    listed = yaml.safe_load(ranges.text())["identified"]
    assert listed[1]["place"] == "elbow" and listed[1]["inertia"]["range"] == pytest.approx([0.0116, 0.0284], abs=1e-4)
