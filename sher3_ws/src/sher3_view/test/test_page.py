"""The page of a film: what is in it, that it needs no network, and that a browser draws it."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from invoking import invoke
from sher3_bags import Run, stream, write_run
from sher3_description import load_robot
from sher3_effects import plants, save_effects
from sher3_kinematics import RobotKinematics
from sher3_sim import simulate
from sher3_view import ViewError, film_of, write_page
from sher3_view.cli import app
from sher3_view.ghost import ghost_of
from sher3_view.page import page

START = 1_000_000_000
STAMP = START + np.arange(0, 2_000_000_001, 2_000_000)
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--enable-logging=stderr",
    "--virtual-time-budget=3000",
    "--window-size=1000,900",
]


def made(shift=0.0):
    """A run of two seconds: delta 1 rises by 2 mm/s, one newton along x after one second, enabled after half a one."""
    seconds = (STAMP - START) * 1e-9
    q = np.zeros((len(STAMP), 5))
    q[:, 0] = 0.002 * seconds + shift
    rotation, position = RobotKinematics(load_robot()).transform_tip_to_base_batch(q)
    assert rotation[0] == pytest.approx(np.eye(3)), "so that force in {f} is force in {b}"
    force = np.where(seconds[:, None] >= 1.0, [1.0, 0.0, 0.0], 0.0)
    pressed = (seconds >= 1.0).astype(float)[:, None]
    quaternion = np.tile([0.0, 0.0, 0.0, 1.0], (len(STAMP), 1))
    texts = [json.dumps({"state": "DISABLED", "reason": "start"}), json.dumps({"state": "ENABLED", "reason": "enable"})]
    settings = json.dumps({"regime": "free", "rcm": None, "settings": {"free_speed": 0.005, "near_speed": 0.0005}})
    return Run(
        {
            "measured_js": stream("measured_js", STAMP, position=q),
            "measured_cp": stream("measured_cp", STAMP, position=position, orientation=quaternion),
            "force/measured_cf": stream("force/measured_cf", STAMP, force=force, torque=0 * force),
            "pedal/measured": stream("pedal/measured", STAMP, axes=pressed, buttons=np.zeros((len(STAMP), 1))),
            "supervisor/status": stream("supervisor/status", [START, START + 500_000_000], data=texts),
            "motion/settings": stream("motion/settings", [START], data=[settings]),
        }
    )


def data_of(text):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S).group(1))


def test_the_film_by_hand():
    film = film_of(made())
    assert len(film.seconds) == 61, "two seconds at 30 frames a second, both ends included"
    assert film.position[-1] == pytest.approx([0.004, 0, 0, 0, 0])
    assert film.force[15] == pytest.approx([0, 0, 0]) and film.force[45] == pytest.approx([1, 0, 0])
    assert film.cap == pytest.approx(np.full(61, 0.005))
    assert film.pedal[15] == 0.0 and film.pedal[45] == 1.0
    assert [tuple(span) for span in film.states] == [(0.0, 0.5, "DISABLED", "start"), (0.5, 2.0, "ENABLED", "enable")]
    moved = np.linalg.norm(film.tip[-1] - film.tip[0])
    assert film.speed[30] == pytest.approx(moved / 2.0, rel=0.05), "the tip moves nearly evenly over so short a travel"


def test_the_points_come_back_to_a_few_micrometres():
    film = film_of(made())
    data = data_of(page(film))
    numbers = np.frombuffer(base64.b64decode(data["points"]), dtype="<i2").reshape(film.points.shape)
    there = np.isfinite(film.points)
    assert ((numbers == data["absent"]) == ~there).all()
    back = np.array(data["origin"]) + data["step"] * numbers
    assert np.abs(back - film.points)[there].max() < 5e-6
    assert np.abs(np.array(data["tip"]) - film.tip).max() < 1e-7


def test_the_page_needs_no_network():
    text = page(film_of(made()))
    assert not re.search(
        r"https?:|//[\w-]+\.\w|\bsrc=|\bhref=|@import|url\(|\bfetch\(|XMLHttp|WebSocket|import\(", text
    )


def test_a_name_cannot_leave_its_place():
    run = made()
    run.path = Path("<u>@DATA@<!--")
    text = page(film_of(run))
    assert "<u>" not in text and "<!--" not in text
    assert data_of(text)["name"] == "<u>@DATA@<!--"


def test_a_long_run_stays_small(tmp_path):
    """Ten minutes get 1200 frames, and the page stays below 3 MB with a ghost beside it."""
    stamp = START + np.arange(0, 600_000_000_001, 20_000_000)
    q = np.zeros((len(stamp), 5))
    q[:, 0] = 0.01 * np.sin(np.arange(len(stamp)) * 0.01)
    run = Run({"measured_js": stream("measured_js", stamp, position=q)})
    film = film_of(run)
    assert len(film.seconds) == 1200
    written = write_page(film, tmp_path / "long.html", [ghost_of(film, run, 2.0)])
    assert written.stat().st_size < 3e6


def test_the_ghost_is_exaggerated_by_the_factor():
    """Delta 1 is 1 mm higher: at factor 4 the ghost's slider is drawn 4 mm higher."""
    film = film_of(made())
    ghost = ghost_of(film, made(shift=0.001), 4.0)
    assert ghost.points[0, 0] - film.points[0, 0] == pytest.approx([0, 0, 0.004])
    (told,) = data_of(page(film, [ghost]))["ghosts"]
    moved = RobotKinematics(load_robot()).transform_tip_to_base([0.001, 0, 0, 0, 0])[:3, 3]
    rest = RobotKinematics(load_robot()).transform_tip_to_base([0.0] * 5)[:3, 3]
    assert told["exaggeration"] == 4.0
    assert told["distance"][0] == pytest.approx(np.linalg.norm(moved - rest), rel=1e-6), "told as it is"
    with pytest.raises(ViewError, match="limit at least 1"):
        ghost_of(film, made(), 0.5)


def test_nothing_to_show_is_an_error(tmp_path):
    with pytest.raises(ViewError, match="measured_js"):
        film_of(Run({}))
    with pytest.raises(ViewError, match="cannot be written"):
        write_page(film_of(made()), tmp_path / "no" / "page.html")


def test_the_command_writes_the_page(tmp_path):
    write_run(tmp_path / "trial", made())
    result = invoke(app, ["view", str(tmp_path / "trial"), "--json"])
    facts = json.loads(result.stdout)
    assert facts["page"] == str(tmp_path / "trial.html") and facts["frames"] == 61
    assert (tmp_path / "trial.html").stat().st_size == facts["bytes"]


def test_ghosts_are_taken_between_samples():
    """Of the same motion sampled every 6 ms, whose samples are beside the frames, no gap is drawn."""
    run, other = made(), made()
    rows = np.unique(np.append(np.arange(0, len(STAMP), 3), len(STAMP) - 1))
    q = run["measured_js"].position[rows]
    other.streams["measured_js"] = stream("measured_js", STAMP[rows], position=q)
    assert ghost_of(film_of(run), other).distance == pytest.approx(np.zeros(61), abs=1e-9)


def test_the_simulator_is_a_ghost_that_shows_the_gap(tmp_path):
    """A robot with backlash, and the simulator without and with it: the second is nearer."""
    robot = load_robot()
    seconds = np.arange(0, 1000) * 0.002
    goal = np.zeros((1000, 5))
    goal[:, 0] = 0.002 * np.sin(2 * np.pi * seconds)
    backlash = plants()["backlash"]("delta_1", width=4e-5)
    write_run(tmp_path / "robot", simulate(robot, goal, np.zeros((1000, 6)), [backlash], seed=1))
    save_effects(tmp_path / "found.yaml", [backlash])
    arguments = ["view", str(tmp_path / "robot"), "--simulated", "nominal", "--exaggerate", "20"]
    result = invoke(app, [*arguments, "--simulated", str(tmp_path / "found.yaml")])
    assert result.exit_code == 0, result.output
    nominal, found = data_of((tmp_path / "robot.html").read_text())["ghosts"]
    assert (nominal["name"], found["name"]) == ("nominal simulator", "simulator with found.yaml")
    assert np.mean(found["distance"]) < 0.3 * np.mean(nominal["distance"]) and np.max(nominal["distance"]) < 1e-4


def test_analyze_writes_figures_picture_and_page(tmp_path):
    bag = write_run(tmp_path / "trial", made())
    arguments = ["analyze", str(bag), "--picture", str(tmp_path / "a.png"), "--html", str(tmp_path / "a.html")]
    text = invoke(app, arguments)
    assert text.exit_code == 0 and "times are median/99 %/max" in text.output
    assert (tmp_path / "a.png").is_file()
    written = (tmp_path / "a.html").read_text()
    assert "<th>latency [ms]</th>" in written and "data:image/png;base64" in written
    assert not re.search(r"https?:|\bhref=|@import|url\(|\bfetch\(", written)
    assert json.loads(invoke(app, ["analyze", str(bag), "--json"]).output)["dropped"] == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [(["missing"], "sher3: missing: no such file"), (["{bag}", "--picture", "{bag}.xyz"], "cannot be drawn")],
)
def test_analyze_fails_in_one_sentence(arguments, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bag = write_run(tmp_path / "trial", made())
    result = invoke(app, ["analyze", *(word.format(bag=bag) for word in arguments)])
    assert result.exit_code == 2 and said in result.output


@pytest.mark.flaky(reruns=2)  # a browser on two cores that others use too may not draw in its time
@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the page was not opened in a browser")
def test_a_browser_draws_the_page(tmp_path):
    """The browser runs the script to its end without an error, and the arrow's orange and the rails' blue are seen."""
    target = write_page(film_of(made()), tmp_path / "trial.html")
    picture = tmp_path / "page.png"
    command = [CHROMIUM, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}"]
    result = subprocess.run(
        [*command, f"--screenshot={picture}", f"{target.as_uri()}#t=1.5"], capture_output=True, text=True, timeout=200
    )
    assert "CONSOLE" not in result.stderr, [line for line in result.stderr.splitlines() if "CONSOLE" in line]
    from matplotlib.image import imread

    pixels = imread(picture)[:, :, :3]
    stage = pixels[60:560, 20:660].reshape(-1, 3)
    orange = (stage[:, 0] > 0.7) & (stage[:, 1] < 0.5) & (stage[:, 2] < 0.3)
    blue = (stage[:, 2] > 0.5) & (stage[:, 0] < 0.3)
    assert orange.sum() > 200 and blue.sum() > 200
    dump = subprocess.run(
        [*command, "--dump-dom", f"{target.as_uri()}#t=1.5"], capture_output=True, text=True, timeout=200
    )
    assert "ENABLED" in dump.stdout and "1.00 N" in dump.stdout and "1.5 / 2.0 s" in dump.stdout
