"""The driver's health as one diagnostic: level, a sentence, and the numbers."""

from __future__ import annotations

from sher3_common.reasons import Reason, reading

from sher3_drivers.bus.condition import BusCondition
from sher3_drivers.drive.motor_driver import MotorDriver

OK, WARNING, ERROR = 0, 1, 2
"""Levels of `diagnostic_msgs/DiagnosticStatus`."""

Values = list[tuple[str, str]]


def driver_report(driver: MotorDriver, refused: str | None = None) -> tuple[int, str, tuple[tuple[str, str], ...]]:
    """Return (level, message, values) of a driver; values are pairs of name and text.

    Args:
        driver: the driver.
        refused: the newest refusal, if there was one.
    """
    values = [*_counts(driver), *_conditions(driver), *_readings(driver), *_stop(driver)]
    if refused is not None:
        values.append(("refused", refused))
    level, message = _verdict(driver, refused)
    return level, message, tuple(values)


def _counts(driver: MotorDriver) -> Values:
    """Return what was lost, refused or misshapen so far, and where the drives are being taken."""
    collector = driver.wire.collector
    counts = {
        **driver.counters,
        "error_frames": driver.watches.bus.error_frames,
        "duplicate_tpdos": collector.duplicates,
        "misfit_tpdos": collector.misfits,
        "dropped": driver.wire.dropped,
        "goal": driver.goal.value,
        "later_stops": driver.stop.later,
    }
    return [(name, str(count)) for name, count in counts.items()]


def _conditions(driver: MotorDriver) -> Values:
    """Return the state of every channel and drive."""
    channels = zip(driver.settings.channels, driver.watches.bus.conditions, strict=True)
    values = [(channel.link, condition.name) for channel, condition in channels]
    for drive in driver.session.drives:
        values.append((f"{drive.name}.state", drive.state.name if drive.state else "unknown"))
        values.append((f"{drive.name}.missing_tpdos", str(drive.missing_total)))
        if drive.warns:
            values.append((f"{drive.name}.warning", "bit 7 of its statusword"))
        if absent := driver.absent.get(drive.name):
            values.append((f"{drive.name}.absent", " ".join(absent)))
        if drive.active:
            values.append((f"{drive.name}.emergency", str(drive.active[-1])))
    return values


def _readings(driver: MotorDriver) -> Values:
    """Return what the watches look at now, each with its limit."""
    settings, now, loop = driver.settings, driver.clock(), driver.watches.loop
    silence = float("inf") if loop.heard_at is None else (now - loop.heard_at) * 1e-9
    found = [
        reading(Reason.SUPERVISOR_SILENT, "heartbeat", silence, settings.supervisor_limit, "s"),
        reading(Reason.CPU_STARVED, "longest hold-up", loop.stall * 1e-9, settings.stall_limit, "s"),
        reading(Reason.COMMAND_STALE, "servo_jv", driver.command_age, settings.stop_age * settings.period, "s"),
    ]
    for drive, axis in zip(driver.session.drives, driver.watches.motion.joints.axes, strict=True):
        silence = (now - (drive.heard_at or now)) * 1e-9
        found.append(reading(Reason.DRIVE_SILENT, drive.name, silence, settings.drive_heartbeat_limit, "s"))
        found += axis.readings()
    return found


def _stop(driver: MotorDriver) -> Values:
    """Return why the robot was stopped; nothing when it was not."""
    stop = driver.stop
    if stop.first is None:
        return []
    first = reading(stop.code, "stop", stop.first.value, stop.first.limit, stop.first.unit)
    return [("reason", stop.code.name), ("action", stop.action.name), first]


def _verdict(driver: MotorDriver, refused: str | None) -> tuple[int, str]:
    """Return level and sentence of the gravest thing there is to say."""
    if driver.stop.reason is not None:
        return ERROR, f"stopped: {driver.stop.reason}"
    worst = max(driver.watches.bus.conditions)
    if worst > BusCondition.ACTIVE:
        return WARNING, f"CAN controller {worst.name}"
    if refused is not None:
        return WARNING, refused
    collector = driver.wire.collector
    if driver.wire.dropped or driver.counters["incomplete"] or collector.duplicates or collector.misfits:
        return WARNING, "frames were lost, came late, twice or misshapen"
    return OK, driver.goal.value
