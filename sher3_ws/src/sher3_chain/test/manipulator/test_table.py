"""The table of an arm: a row for each joint, a column for each kind of constant, words that a mechanic uses."""

from causes_at import caused
from lifts import friction, machine, motion, needed, run_of
from sher3_chain.manipulator.library import joint_pages
from sher3_chain.manipulator.reporter import HEADS, table_of
from sher3_diagnosis import diagnose
from sher3_diagnosis.report.page import render
from sher3_effects import pages


def test_each_constant_stands_in_its_column_with_interval_and_rivals():
    causes = [
        caused("coulomb_friction", "friction", "A1", "force", 373.0, "N*m", ["stribeck_friction"]),
        caused("viscous_friction", "friction", "A1", "extra", 1.9, "N*m/(rad/s)"),
        caused("sensor_delay", "timing", "A1", "load_delay", 0.00309, "s"),
        caused("transmission_compliance", "compliance", "A2", "compliance", 1.3e-7, "rad/(N*m)"),
        caused("backlash", "lost_motion", "A2", "width", 0.002, "rad"),
    ]
    table = table_of(causes, joint_pages(), ["A1", "A2", "A3"], ["A1", "A2"])
    rows = {row[0]: dict(zip(table.heads[1:], row[1:], strict=True)) for row in table.rows}
    assert rows["A1"]["Coulomb"] == "Coulomb friction 373 N·m (336 N·m … 410 N·m) or stribeck friction"
    assert rows["A1"]["delay"].startswith("Sensor delay 3.09 ms") and rows["A1"]["viscous"].startswith("Viscous")
    assert rows["A2"]["spring"].startswith("Transmission compliance") and rows["A2"]["play"].startswith("Backlash 2 m")
    assert rows["A2"]["Coulomb"] == "–" and set(rows["A3"].values()) == {"not judged"}
    assert [x.split(":")[0] for x in table.lines()] == ["A1", "A2"] and len(table.heads) == len(HEADS) + 1


def test_a_servo_that_acts_late_or_weakly_stands_under_delay_and_gain():
    late = caused("command_delay", "timing", "A1", "reference_delay", 0.008, "s")
    weak = caused("controller_gain", "scale", "A1", "position_relative", -0.2, "1")
    table = table_of([late, weak], [*joint_pages(), *pages("law")], ["A1"], ["A1"])
    (row,) = (dict(zip(table.heads[1:], x[1:], strict=True)) for x in table.rows)
    assert row["delay"].startswith("Command delay 8 ms") and row["gain"].startswith("Controller gain")


def test_a_link_with_a_payload_has_a_row_of_its_own():
    table = table_of([caused("payload_mass", "inertia", "hand", "mass", 1.2, "kg")], joint_pages(), ["A1"], ["A1"])
    assert [row[0] for row in table.rows] == ["A1", "hand"] and "1.2 kg" in table.rows[1][1]


def test_the_page_of_an_arm_shows_its_table(tmp_path):
    q, v, a = motion(8.0)
    page = render(
        diagnose(machine(tmp_path / "lift.urdf"), [run_of(q, needed(q, v, a) + friction(v, (8.0, 0.5)))]), "lift"
    )
    assert "Joint by joint" in page and "<th>Coulomb</th>" in page


def test_a_loss_under_load_shows_its_dry_part_and_its_share():
    lossy = caused("gear_loss", "friction", "A1", "share", 0.06, "1")
    dry = caused("gear_loss", "friction", "A1", "usual", 0.145, "N*m")
    both = lossy.model_copy(update={"parameters": {**lossy.parameters, **dry.parameters}})
    row = table_of([both], joint_pages(), ["A1"], ["A1"]).rows[0]
    assert row[3].startswith("Gear loss share 6 % (") and "usual 145 mN·m (" in row[3]
