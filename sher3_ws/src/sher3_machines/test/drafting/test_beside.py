"""Untitled logs of a driven axis: target and profile are no forces, and of several columns the drive is told."""

import numpy as np
import pytest
from sher3_common import parse_yaml
from sher3_machines.drafting.drafts import draft_of

NAMES = ("time", "target", "position", "velocity", "effort", "noise")


def log_of(seed, sweep):
    """Time, target, place, speed, current and noise (n, 6) of a drawn slide that is told steps or a sweep."""
    draw = np.random.default_rng(seed)
    step, gain, pole = 0.01, 10.0 ** draw.uniform(-2.0, 3.0), draw.uniform(8.0, 25.0)
    t = step * np.arange(2000)
    target = np.sin(2.0 * np.pi * (0.1 + 0.04 * t) * t) if sweep else np.sign(np.sin(2.0 * np.pi * t / 2.0))
    target = draw.uniform(2.0, 50.0) * target
    x, v, rows = target[0], 0.0, []
    for asked in target:
        rows.append((x, v))
        for _ in range(10):
            v += 0.1 * step * (pole**2 * (asked - x) - 1.4 * pole * v)
            x += 0.1 * step * v
    x, v = np.array(rows).T
    force = gain * (np.gradient(v, step) + draw.uniform(5.0, 20.0) * v + 0.2 * np.std(v) * np.sign(v))
    noise = draw.normal(size=len(t))
    return np.column_stack([t, target, np.round(x, 2), v, force * draw.choice([-1.0, 1.0]), noise])


@pytest.mark.parametrize("sweep", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_place_speed_and_drive_are_told_beside_a_target(tmp_path, seed, sweep):
    order = np.random.default_rng(seed).permutation(len(NAMES))
    np.savetxt(tmp_path / "a.txt", log_of(seed, sweep)[:, order], delimiter="\t")
    (axis,) = parse_yaml(draft_of(tmp_path / "a.txt").text)["axes"]
    found = {signal: NAMES[order[int(s["column"][1:])]] for signal, s in axis["signals"].items()}
    assert {k: found.get(k) for k in ("position", "velocity", "effort")} == {
        k: k for k in ("position", "velocity", "effort")
    }
    assert found.get("reference", "target") == "target"


@pytest.mark.parametrize("scale", [1.0, 1e-3, 57.3])
def test_speed_over_place_of_a_motor_that_gets_up_to_speed_is_no_circle(tmp_path, scale):
    """Any smooth curve is a short arc of a large circle; what a turned joint carries goes round."""
    t = np.arange(0.0, 10.0, 0.002)
    v = 140.0 + 70.0 * (1.0 - np.exp(-np.maximum(t - 5.0, 0.0)))
    np.savetxt(tmp_path / "a.csv", np.column_stack([t, scale * np.cumsum(v) * 0.002, scale * v]), delimiter=",")
    signals = parse_yaml(draft_of(tmp_path / "a.csv").text)["axes"][0]["signals"]
    assert signals["position"]["column"] == "c1" and signals["velocity"]["column"] == "c2"
