"""The watches of encoders and positions as plain sums of one axis: what their compiled form has to give, to the bit."""

from __future__ import annotations

from sher3_common.reasons import Reason
from sher3_drivers.watches.axis import AxisLimits
from sher3_drivers.watches.trips import Trip


class PlainAxis:
    """Two encoders and a demand."""

    def __init__(self, scale, settings):
        self.name, self.unit, self.limits = scale.name, scale.unit, AxisLimits.of(scale, settings)

    def begin(self, motor, load):
        self.motor = self.motor_mark = self.low = self.high = motor
        self.load = self.load_mark = load
        self.start = self.slow = motor - load
        self.error = self.load_error = self.peak = self.gap = 0.0
        self.gap_ticks = self.drift_ticks = self.stray_ticks = 0
        self.drift_limit, self.error_limit = self.limits.drift, self.limits.astray

    def check(self, motor, load, advance, speed):
        limits, keep = self.limits, 1.0 - self.limits.forget_astray
        motor_step, load_step = motor - self.motor, load - self.load
        self.motor, self.load = motor, load
        if motor_step:
            self.load_mark = load
        if load_step:
            self.motor_mark = motor
        self.error = keep * self.error + advance - motor_step
        self.load_error = keep * self.load_error + advance - load_step
        self.peak = max(abs(speed), keep * self.peak)
        self.error_limit = limits.astray + limits.lag * self.peak
        self.stray_ticks = self.stray_ticks + 1 if abs(self.error) > self.error_limit else 0
        gap = motor - load
        self.gap = gap - self.slow
        self.slow += limits.forget_apart * self.gap
        far = min(2, int(abs(self.gap) / limits.apart))
        self.gap_ticks = self.gap_ticks + far if far else 0
        self.low, self.high = min(self.low, motor), max(self.high, motor)
        self.drift_limit = limits.drift + limits.drift_share * (self.high - self.low)
        self.drift_ticks = self.drift_ticks + 1 if abs(gap - self.start) > self.drift_limit else 0
        one_moved = (motor_step == 0.0) != (load_step == 0.0)
        far = abs(gap - self.start) > limits.apart_total
        if one_moved or far or self.gap_ticks or self.drift_ticks or self.stray_ticks:
            return self.frozen() or self.apart(gap - self.start) or self.astray()
        return None

    def frozen(self):
        for frozen, moved in (("load", self.motor - self.motor_mark), ("motor", self.load - self.load_mark)):
            if abs(moved) > self.limits.apart:
                text = f"{self.name}: {frozen} encoder stands still while the other one moved {moved:.3g} {self.unit}"
                return Trip(Reason.ENCODER_FROZEN, text, abs(moved), self.limits.apart, self.unit)
        return None

    def apart(self, total):
        limits = self.limits
        if max(self.gap_ticks, self.drift_ticks) < limits.apart_ticks and abs(total) <= limits.apart_total:
            return None
        suspect = "load side" if abs(self.error) <= abs(self.load_error) else "motor encoder"
        far = total, min(self.drift_limit, limits.apart_total)
        value, limit = (self.gap, limits.apart) if self.gap_ticks else far
        text = f"{self.name}: encoders {value:.3g} {self.unit} apart (limit {limit:.3g}); the {suspect} left the demand"
        return Trip(Reason.ENCODERS_DISAGREE, text, abs(value), limit, self.unit)

    def astray(self):
        if self.stray_ticks < self.limits.astray_ticks:
            return None
        text = f"{self.name}: {self.error:.3g} {self.unit} off its demand (limit {self.error_limit:.3g})"
        return Trip(Reason.FOLLOWING_ERROR, text, abs(self.error), self.error_limit, self.unit)


class PlainPlace:
    """The sum of an axis' commands."""

    def __init__(self, scale, settings):
        turns = scale.revolute
        self.scale, self.settings = scale, settings
        self.plain = settings.position_angle if turns else settings.position_distance
        self.elastic = settings.elastic_angle if turns else settings.elastic_distance
        self.keep = 1.0 - min(1.0, settings.period / settings.following_memory)

    def begin(self, motor, load, effort):
        self.motor, self.load, self.path, self.peak = motor, load, 0.0, 0.0
        self.base = self.force = effort / self.scale.hold
        self.left = self.explained = self.by_motor = 0.0
        self.limit = self.plain

    def advance(self, motor, load, effort, command, since):
        self.path += command * since
        self.by_motor, by_load = self.path + self.motor - motor, self.path + self.load - load
        self.left = by_load if abs(by_load) < abs(self.by_motor) else self.by_motor
        self.force += min(1.0, since / self.scale.settling) * (effort / self.scale.hold - self.force)
        self.explained = max(-self.elastic, min(self.elastic, self.force - self.base))
        self.peak = max(abs(command), self.keep * self.peak)
        settings = self.settings
        self.limit = self.plain + settings.position_lag * self.peak + settings.position_force * abs(self.explained)

    @property
    def share(self):
        return abs(self.left - self.explained) / self.limit

    @property
    def moved(self):
        return min(self.by_motor, self.by_motor - self.explained, key=abs)
