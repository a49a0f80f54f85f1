"""Recorded inputs played to the control nodes, in stepped time or to processes; see `test_layouts`.

As a script: `python layout_player.py INPUTS OUTPUT DOMAIN admittance+kinematics`. It starts the processes, which a test
cannot do by itself: a process with threads of the middleware must not fork.
"""

from __future__ import annotations

import pickle
import sys
from functools import partial
from pathlib import Path

from rclpy.node import Node
from sher3_bringup.processes.fleet import Fleet
from sher3_bringup.processes.up import launch_nodes, prepare
from sher3_bringup.settings.run_settings import checked, parse_processes
from sher3_common.operating_state import OperatingState, heartbeat_text
from sher3_common.reasons import Action
from sher3_common.samples import TextSample
from sher3_runtime import NODE_OPTIONS, advertise, on_tick, subscribe

INPUTS = ("measured_js", "pedal/measured", "force/measured_cf")
OUTPUTS = ("servo_cv", "servo_jv")
REST = 40
"""Ticks at rest before the recording begins: processes do not hear their first samples in the same tick."""
RATE = 100.0


def settings_of(nodes="admittance,kinematics", domain=0):
    """Return patient settings, hurried where this user may: a sample that comes late is another input."""
    processes = parse_processes(nodes, mock=True, record=False)
    return checked(rate=RATE, processes=processes, patience="patient", domain=domain, realtime=-1)


class Player(Node):
    """Plays recorded inputs, one set each tick, as devices and supervisor would send them; keeps the commands.

    At rest it repeats the first sample with the pedal released and no force.
    """

    def __init__(self, inputs, output=None, **options):
        super().__init__("player", **{**NODE_OPTIONS, **options})
        self.inputs, self.output, self.first, self.commands = inputs, output, None, {}
        self.publish = {name: advertise(self, name) for name in INPUTS}
        self.say_state, self.beat = advertise(self, "operating_state"), advertise(self, "supervisor/heartbeat")
        for name in OUTPUTS:
            subscribe(self, name, partial(self.keep, name))
        on_tick(self, self.tick)

    def keep(self, name, sample):
        number = self.number(sample.stamp)
        if number >= REST:
            self.commands[name, number] = sample.twist if name == "servo_cv" else sample.velocity

    def number(self, stamp):
        return round((stamp - self.first) * 1e-9 * RATE)

    def tick(self, stamp):
        self.first = self.first or stamp
        at = self.number(stamp) - REST
        if at == -REST // 2:
            self.say_state(TextSample(OperatingState.ENABLED.value))
        if at >= -REST // 2:
            self.beat(TextSample(heartbeat_text(OperatingState.ENABLED, Action.NONE)))
        if at >= len(self.inputs):
            return
        joints, pedal, wrench = self.inputs[max(at, 0)]
        if at < 0:
            pedal, wrench = pedal._replace(axes=(0.0,)), wrench._replace(wrench=(0.0,) * 6)
        for name, sample in zip(INPUTS, (joints, pedal, wrench), strict=True):
            self.publish[name](sample._replace(stamp=stamp))

    def close(self):
        if self.output is not None:
            self.output.write_bytes(pickle.dumps(self.commands))


def main():
    """Start the processes, play, and write the commands."""
    source, output, domain, nodes = sys.argv[1:]
    inputs, settings = pickle.loads(Path(source).read_bytes()), settings_of(nodes, int(domain))
    looks = []
    realtime = prepare(settings)
    with Fleet() as fleet:
        launch_nodes(fleet, settings, realtime)
        fleet.launch("player", lambda: [Player(inputs, Path(output))], realtime)
        fleet.start()
        fleet.watch(lambda: looks.append(1) or len(looks) * 0.05 > (REST + len(inputs)) / RATE + 1.0)


if __name__ == "__main__":
    main()
