"""The driver's health as one diagnostic: level, a sentence, and the numbers."""

from __future__ import annotations

from sher3_description.reasons import Reason, reading

from .can_errors import BusCondition
from .motor_driver import MotorDriver

OK, WARNING, ERROR = 0, 1, 2


def driver_report(driver: MotorDriver, refused: str | None = None) -> tuple[int, str, tuple[tuple[str, str], ...]]:
    """Return (level, message, values) of a driver.

    Args:
        driver: the driver.
        refused: the newest refusal, if there was one.
    """
    values = [(name, str(count)) for name, count in driver.counters.items()]
    collector = driver.collector
    values += [("duplicate_tpdos", str(collector.duplicates)), ("misfit_tpdos", str(collector.misfits))]
    values += [("dropped", str(driver.dropped)), ("goal", driver.goal.value), ("later_stops", str(driver.stop.later))]
    for channel, condition in zip(driver.settings.channels, driver.bus_conditions, strict=True):
        values.append((f"{channel.link}", condition.name))
    for health in driver.health:
        state = health.state.name if health.state else "unknown"
        values.append((f"{health.name}.state", state))
        values.append((f"{health.name}.missing_tpdos", str(health.missing_total)))
        if health.active:
            values.append((f"{health.name}.emergency", str(health.active[-1])))
    values += _readings(driver)
    stop = driver.stop
    if stop.first is not None:
        values += [("reason", stop.code.name), ("action", stop.action.name)]
        values.append(reading(stop.code, "stop", stop.first.value, stop.first.limit, stop.first.unit))
    if refused is not None:
        values.append(("refused", refused))
    level, message = _verdict(driver, refused)
    return level, message, tuple(values)


def _readings(driver: MotorDriver) -> list[tuple[str, str]]:
    """Return what the detectors look at now, each with its limit."""
    settings, now = driver.settings, driver.clock()
    heard = driver.loop.heard_at
    silence = float("inf") if heard is None else (now - heard) * 1e-9
    found = [
        reading(Reason.SUPERVISOR_SILENT, "heartbeat", silence, settings.supervisor_limit, "s"),
        reading(Reason.CPU_STARVED, "longest hold-up", driver.loop.stall * 1e-9, settings.stall_limit, "s"),
        reading(Reason.COMMAND_STALE, "servo_jv", driver.command_age, settings.stop_age * settings.period, "s"),
    ]
    for health, axis in zip(driver.health, driver.motion.joints.axes, strict=True):
        silence = (now - (health.heard_at or now)) * 1e-9
        found.append(reading(Reason.DRIVE_SILENT, health.name, silence, settings.drive_heartbeat_limit, "s"))
        found += axis.readings()
    return found


def _verdict(driver: MotorDriver, refused: str | None) -> tuple[int, str]:
    if driver.stop.reason is not None:
        return ERROR, f"stopped: {driver.stop.reason}"
    worst = max(driver.bus_conditions)
    if worst > BusCondition.ACTIVE:
        return WARNING, f"CAN controller {worst.name}"
    if refused is not None:
        return WARNING, refused
    if driver.dropped or driver.counters["incomplete"] or driver.collector.duplicates or driver.collector.misfits:
        return WARNING, "frames were lost, came late, twice or misshapen"
    return OK, driver.goal.value
