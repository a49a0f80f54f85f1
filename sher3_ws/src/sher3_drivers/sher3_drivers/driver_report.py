"""The driver's health as one diagnostic: level, a sentence, and the numbers."""

from __future__ import annotations

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
    if refused is not None:
        values.append(("refused", refused))
    level, message = _verdict(driver, refused)
    return level, message, tuple(values)


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
