"""An effect of the user's own: one file in a folder anywhere, found, diagnosed, applied and reported."""

import numpy as np
import pytest
from invoking import invoke
from sher3_common import FileError
from sher3_diagnosis.report.page import render
from sher3_effects import add_library, library, load_effects, plants, save_effects, to_effects
from sher3_effects.registry import VARIABLE
from sher3_gap.sher import diagnose_runs
from sher3_gap_cli.app import app
from sher3_gap_cli.library.page import library_data, page_text
from simulated import ROBOT, runs_of, signals

PAGE = '''
"""Bent screw: once in two thirds of a revolution the screw rubs and pushes the load ahead."""

from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Signature, column
from sher3_effects.page import Page
from sher3_sim.effect import PlantEffect, parameter

TURNS = 1.5


class BentScrew(Page):
    """force A sin(1.5 turn) on the motor and B sin(1.5 turn) between motor and load."""

    id, family, stage = "bent_screw", "periodic", "transmission"
    inputs = ("position",)
    best = Best("sweep", "constant speeds over several revolutions separate periods")
    explanation = "A bent screw rubs and pushes the load ahead, three times in two revolutions."
    siblings = {"transmission_ripple": "a whole number of periods, and no force"}

    def channels(self, site):
        return (Channel("motor_mechanics", site), Channel("transmission", site))

    def signature(self, view, site, shape):
        turn = 2 * np.pi * view.run.smooth[:, view.row(site)] / view.lead(site)
        wave = view.run.to_grid(np.sin(TURNS * turn))
        none = np.zeros_like(wave)
        rubs, pushes = self.channels(site)
        return Signature({rubs: column(wave, none), pushes: column(none, wave)})

    def parameters(self, shape, coefficients):
        return {"force": float(coefficients[0]), "push": float(coefficients[1])}


@dataclass(frozen=True)
class BentScrewInPlant(PlantEffect, page=BentScrew):
    """The same in the plant, by its slots for cogging and ripple."""

    force: float = parameter("N", 0.5, -10.0, 10.0, "of the rubbing")
    push: float = parameter("m", 1e-5, -1e-3, 1e-3, "of the load ahead of the motor")

    def apply(self, p):
        p.axis["cogging_amplitude"][self.rows], p.axis["cogging_periods"][self.rows] = self.force, TURNS
        p.axis["ripple_amplitude"][self.rows], p.axis["ripple_periods"][self.rows] = self.push, TURNS
'''


@pytest.fixture
def own(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    (tmp_path / "bent_screw.py").write_text(PAGE)
    add_library([tmp_path], trust=True)
    return tmp_path


def test_a_page_in_a_folder_is_found_and_printed(own):
    assert "bent_screw" in library() and "bent_screw" in plants()
    (row,) = library_data("bent_screw")
    text = page_text(row)
    assert "A bent screw rubs" in text and "force [N" in text
    assert max(map(len, text.splitlines())) <= 80


def test_a_cause_of_the_users_own_is_diagnosed_applied_and_reported(own):
    truth = plants()["bent_screw"]("delta_2", force=1.2, push=1.5e-5)
    found = diagnose_runs(signals(runs_of(("sweep", "reversals"), [truth], repeats=2)), ROBOT)
    assert [(c.effect, c.actuator) for c in found.verdict.causes] == [("bent_screw", "delta_2")]
    values = {n: p.value for n, p in found.verdict.causes[0].parameters.items()}
    assert values == pytest.approx({"force": 1.2, "push": 1.5e-5}, rel=0.1)
    assert "A bent screw rubs" in render(found, "own")
    save_effects(own / "effects.yaml", to_effects(found.verdict.causes, ROBOT))
    (applied,) = load_effects(own / "effects.yaml")
    assert np.isclose(applied.force, values["force"]) and applied.actuator == "delta_2"


def test_without_its_folder_the_effect_is_unknown(own, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    assert "bent_screw" not in library()


def test_a_folder_that_is_not_there_and_a_file_that_is_no_page_are_refused(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    with pytest.raises(FileError, match="not there"):
        add_library([tmp_path / "absent"])
    (tmp_path / "wrong.py").write_text("1 / 0")
    with pytest.raises(FileError, match="not a page"):
        add_library([tmp_path / "wrong.py"], trust=True)
    assert len(library()) == 44


def test_python_that_nobody_trusts_is_not_run(tmp_path, monkeypatch):
    """Neither by a name in the option nor by a folder that holds it; an effects file cannot ask for it at all."""
    monkeypatch.setenv(VARIABLE, "")
    ran = tmp_path / "ran"
    (tmp_path / "page.py").write_text(f"open({str(ran)!r}, 'w')")
    (tmp_path / "effects.yaml").write_text("schema: sher3.effects/1\nlibrary: [page.py]\neffects: []\n")
    for named in (tmp_path / "page.py", tmp_path):
        with pytest.raises(FileError, match=r"page\.py: is Python.*--trust"):
            add_library([named])
        result = invoke(app, ["library", "--library", str(named)])
        assert result.exit_code == 2 and "--trust" in result.output
    with pytest.raises(FileError, match=r"page\.py: is Python"):
        load_effects(tmp_path / "effects.yaml")
    assert not ran.exists()
    assert invoke(app, ["library", "--library", str(tmp_path), "--trust"]).exit_code == 0 and ran.exists()
