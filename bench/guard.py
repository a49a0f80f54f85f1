"""How often `sher3 gap check` fails a healthy arm, and how often it misses friction: drawn arms of MuJoCo.

Each arm gives a baseline and, with other motions and noise, a healthy log and one with more dry friction at a joint;
the rubbing arm gives a baseline as well, with which another log of it is compared.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import sher3.gap as gap
from sher3_public.guard.baseline import entry_of
from sher3_public.guard.worse import Worse, worse

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))

from drawn_arms import drawn_xml, logged

FIRST = 400
"""First seed: none of the tests'."""


def rubbing(xml: str, rng: np.random.Generator) -> tuple[str, str]:
    """Return the arm with more dry friction at a drawn joint: 0.4 to 1.6 N m, half as much at each next."""
    robot = ElementTree.fromstring(xml)
    joints = list(robot.iter("joint"))
    place = int(rng.integers(len(joints)))
    more = rng.uniform(0.4, 1.6) * 0.5**place
    joints[place].set("frictionloss", str(float(joints[place].get("frictionloss", "0")) + more))
    return ElementTree.tostring(robot, encoding="unicode"), str(joints[place].get("name"))


def said(xml: str, nominal: str, seed: int):
    log = logged(xml, seed)
    return entry_of(gap.diagnose(nominal, log.time, log.ctrl, log.qpos).diagnosis)


def main() -> None:
    """Print one line for each arm, and the two shares."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    count = parser.parse_args().seeds
    false, worn, found = 0, 0, 0
    for seed in range(FIRST, FIRST + count):
        rng = np.random.default_rng(seed)
        xml = drawn_xml(rng)
        faulty, joint = rubbing(xml, rng)
        healthy, also = (said(xml, xml, seed + k) for k in (0, 1000))
        rubs, still = (said(faulty, xml, seed + k) for k in (2000, 3000))
        passes, fails, same = worse(healthy, also), worse(healthy, rubs), worse(rubs, still)
        false, worn = false + bool(passes), worn + bool(same)
        found += any(w.rule == "new cause" and w.actuator == joint for w in fails)
        shown = ("healthy", passes), (f"{joint} rubs", fails), ("and still does", same)
        print(f"{seed}: {'; '.join(f'{name}: {_rules(x)}' for name, x in shown)}", flush=True)
    print(f"fail although nothing is worse: {false} of {count} healthy, {worn} of {count} that rub as before")
    print(f"friction that is found at its joint: {found} of {count}")


def _rules(found: Sequence[Worse]) -> str:
    return ", ".join(f"{w.rule} {w.actuator}" for w in found) or "passes"


if __name__ == "__main__":
    main()
