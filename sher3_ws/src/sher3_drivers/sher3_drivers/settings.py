"""Settings of the motor driver: which drive is on which channel, and every limit. They are validated once, here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from sher3_description import ACTUATORS

from sher3_drivers.bus.load import ChannelBudget, check_budget
from sher3_drivers.errors import DriverSettingsError

Seconds = Annotated[float, Field(gt=0.0, le=10.0, allow_inf_nan=False)]
Speed = Annotated[float, Field(gt=0.0, le=100.0, allow_inf_nan=False)]
Number = Annotated[int, Field(ge=0, le=2**32 - 1)]
Length = Annotated[float, Field(gt=0.0, le=0.01, allow_inf_nan=False)]
Angle = Annotated[float, Field(gt=0.0, le=0.2, allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ChannelSettings(_Part):
    """One CAN channel.

    Attributes:
        link: specification of its link (`bus.link.open_link`).
        drives: actuators whose drives are on it.
    """

    link: str
    drives: tuple[str, ...]


class NamePlate(_Part):
    """What stands on a drive (object 0x1018).

    Attributes:
        vendor, product, serial: vendor id, product code and serial number.
    """

    vendor: Number
    product: Number
    serial: Number


class DriveIdentity(NamePlate):
    """The name plate of a drive, as it must be found.

    Attributes:
        drive: actuator.
    """

    drive: str


class RegimeCaps(_Part):
    """Largest speeds of the five actuators in one speed regime, m/s and rad/s."""

    regime: str
    caps: tuple[Speed, Speed, Speed, Speed, Speed]


class MotorDriverSettings(_Part):
    """Everything the motor driver can be told.

    Attributes:
        channels: CAN channels; together they hold every actuator once.
        period: control period and SYNC period, s.
        protected: commands and reports carry a check (`canopen.protection`), which the drives must have.
        identities: name plates of drives that must be no other ones; those of drives not named are not looked at.
        regime: speed regime at the start.
        caps: speed caps of the actuators by regime, which the drives get too; without them the velocity limits hold.
        host_id: CANopen node id of this computer, for its heartbeat.
        host_heartbeat: period of the host's heartbeat, s. The control loop itself sends it, so that a loop that hangs
            falls silent.
        host_heartbeat_limit: silence after which a drive stops by itself, s: `stall_limit`, a heartbeat and a period.
            The travel budget bounds it: a leg that hears nobody goes on until then.
        drive_heartbeat: period of the drives' heartbeats, s.
        drive_heartbeat_limit: silence after which the host gives a drive up, s.
        feedback_limit: longest wait for the TPDOs of a tick, as a share of the period.
        missing_limit: consecutive ticks with a TPDO of every drive missing after which the driver stops the robot: free
            the tilt goes 212 um meanwhile at 9 mm/s. A computer that is held up sends no SYNC, so it misses none.
            Motion ends before: such ticks are not published, the controller falls
            silent, and `zero_age` acts.
        report_limit: reports of a drive in a row that fail their check, come twice in one tick and differ, or stay away
            while others are heard, after which the robot stops; none of them is believed.
        status_reports: statuswords in a row that say that an enabled drive does not follow; one may while it begins to.
        zero_age: age of the newest command after which zero velocity is sent, in periods.
        stop_age: age after which the drives are quick-stopped, in periods; wide, since zero is being sent by then.
        supervisor_limit: silence of the supervisor's heartbeat (every 10 ms) after which the driver stops, s.
        stall_limit: longest hold-up of the driver's loop while the drives are enabled, s.
        encoder_distance, encoder_angle: limit of the difference of motor and load encoder without its slow part, m and
            rad. On the nominal robot it is 1 um and 0.04 mrad.
        encoder_latency: time for which that limit may be exceeded, s; a tick beyond twice the limit counts twice.
        encoder_memory: time constant with which the slow part is followed, s.
        encoder_drift_distance, encoder_drift_angle: how far they may part since enabling, the slow part too, while the
            axis stays where it is, m and rad.
        encoder_drift_share: what the range of its positions since then adds to it: a lead error of 2 %.
        encoder_total_distance, encoder_total_angle: limit of the difference since the drives were enabled, its slow
            part included, m and rad; more is a stop at once.
        following_distance, following_angle: integrated demand minus motor motion, its slow part aside, at rest, m and
            rad. A load D pushes a PI drive off by D / ki, and the slow part takes 29 % of a sudden one: 8 N at the tip
            push a leg off by 50 um. The slider of the tilt bears 1.8 times the force at the tip and trips at a
            sudden 6 N; at the ends of its travel it bears 3.6 times that force and trips at 3 N.
        following_lag: what the demanded speed adds to that limit, s; the nominal drive lags 4 to 5 ms.
        following_latency: time for which that limit may be exceeded, s.
        following_memory: time constant with which its slow part is followed, s.
        obey_distance, obey_angle: travel an axis may make without being told to, by its echo of the demand, m and rad.
        obey_latency: time a command may take to show in the echo, s; the nominal drive shows it in the next tick.
        echo_reports: reports in a row that must repeat an older command, or that of another axis, to be called stale or
            swapped; one may when a command comes late.
        position_distance, position_angle: how far an axis may be from the sum of the commands sent since enabling, at
            rest, what its force explains aside, m and rad. Two counts of the motor encoder and of the torque make
            3 um and 0.1 mrad; the rest is for what no robot file tells.
        position_lag: what the commanded speed adds to it, s: one and a half periods between the host's clock and the
            drive's.
        position_force: what the force explains adds to it, as a share: how well a torque constant is known.
        elastic_distance, elastic_angle: the most that the force may explain, m and rad: 26 N at a leg.
        brake_time: time after which a stopped robot must rest, s: three times the longest ramp from full tip speed.
        rest_distance, rest_angle: how far an axis at rest may go, stopped or disabled, what its force explains aside, m
            and rad.
        transition_limit: longest time for one CiA 402 transition, s.
        sdo_limit: longest wait for an SDO response, s.
    """

    channels: tuple[ChannelSettings, ...]
    period: Annotated[float, Field(ge=0.0005, le=0.1)] = 0.002
    protected: bool = False
    identities: tuple[DriveIdentity, ...] = ()
    regime: str = "bench"
    caps: tuple[RegimeCaps, ...] = ()
    host_id: Annotated[int, Field(ge=1, le=127)] = 127
    host_heartbeat: Seconds = 0.005
    host_heartbeat_limit: Seconds = 0.027
    drive_heartbeat: Seconds = 0.050
    drive_heartbeat_limit: Seconds = 0.200
    feedback_limit: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.8
    missing_limit: Annotated[int, Field(ge=1, le=1000)] = 6
    report_limit: Annotated[int, Field(ge=1, le=1000)] = 3
    status_reports: Annotated[int, Field(ge=1, le=1000)] = 3
    zero_age: Annotated[int, Field(ge=1, le=1000)] = 4
    stop_age: Annotated[int, Field(ge=1, le=1000)] = 50
    supervisor_limit: Seconds = 0.030
    stall_limit: Seconds = 0.020
    encoder_distance: Length = 7e-6
    encoder_angle: Angle = 4e-4
    encoder_latency: Seconds = 0.010
    encoder_memory: Seconds = 0.3
    encoder_drift_distance: Length = 1e-5
    encoder_drift_angle: Angle = 4e-4
    encoder_drift_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.02
    encoder_total_distance: Length = 5e-4
    encoder_total_angle: Angle = 1e-2
    following_distance: Length = 6e-5
    following_angle: Angle = 3e-3
    following_lag: Seconds = 0.010
    following_latency: Seconds = 0.004
    following_memory: Seconds = 0.1
    obey_distance: Length = 1e-6
    obey_angle: Angle = 3.5e-5
    obey_latency: Seconds = 0.006
    echo_reports: Annotated[int, Field(ge=1, le=100_000)] = 4
    position_distance: Length = 7e-6
    position_angle: Angle = 4e-4
    position_lag: Seconds = 0.003
    position_force: Annotated[float, Field(ge=0.0, le=1.0)] = 0.1
    elastic_distance: Length = 2e-4
    elastic_angle: Angle = 1e-2
    brake_time: Seconds = 0.1
    rest_distance: Length = 7e-6
    rest_angle: Angle = 4e-4
    transition_limit: Seconds = 0.5
    sdo_limit: Seconds = 0.3

    @model_validator(mode="after")
    def _consistent(self) -> MotorDriverSettings:
        named = [drive for channel in self.channels for drive in channel.drives]
        if sorted(named) != sorted(ACTUATORS):
            raise ValueError(f"channels hold the drives {named}; every one of {list(ACTUATORS)} must be there once")
        plates = [identity.drive for identity in self.identities]
        if len(set(plates)) < len(plates) or not set(plates) <= set(ACTUATORS):
            raise ValueError(f"identities name the drives {plates}; each of {list(ACTUATORS)} may be there once")
        if self.host_id <= len(ACTUATORS):
            raise ValueError(f"host_id {self.host_id} is a drive's node id; limit > {len(ACTUATORS)}")
        for name in ("host_heartbeat", "drive_heartbeat"):
            period, limit = getattr(self, name), getattr(self, f"{name}_limit")
            if limit < 2.0 * period:
                raise ValueError(f"{name}_limit {limit:g} s trips on one lost heartbeat; limit >= {2.0 * period:g} s")
        if self.stop_age <= self.zero_age:
            raise ValueError(f"stop_age {self.stop_age} is not above zero_age {self.zero_age}")
        return self

    @classmethod
    def checked(cls, **values: object) -> MotorDriverSettings:
        """Return validated settings.

        Raises:
            DriverSettingsError: a value is out of range, unknown or inconsistent with another.
        """
        try:
            return cls.model_validate(values)
        except ValidationError as error:
            where = "; ".join(f"{'.'.join(map(str, e['loc'])) or 'settings'}: {e['msg']}" for e in error.errors())
            raise DriverSettingsError(f"motor driver settings: {where}", remedy="correct the settings") from error

    @property
    def heartbeats(self) -> float:
        """Heartbeats of host and drives on the fullest channel, 1/s."""
        return 1.0 / self.host_heartbeat + max(len(c.drives) for c in self.channels) / self.drive_heartbeat

    def budgets(self) -> list[ChannelBudget]:
        """Return the bus-load budget of every channel; raise BusLoadError when one is overloaded."""
        drives = [len(channel.drives) for channel in self.channels]
        return check_budget(drives, 1.0 / self.period, self.heartbeats, self.protected)


_MOCKS = ("local:", "virtual:")
"""Links that no real drive is on."""


def default_settings(
    period: float = 0.002,
    links: Sequence[str] | None = None,
    kind: str = "local",
    protected: bool | None = None,
) -> MotorDriverSettings:
    """Return the layout the bus-load budget asks for: two channels (3, 2); above 600 Hz five, or unprotected three.

    Args:
        period: control period, s.
        links: one link specification per channel; by default `<kind>:drives/0`, `<kind>:drives/1`, ...
        kind: kind of the default links.
        protected: commands and reports carry a check; by default where all drives are mocks, which can.
    """
    if protected is None:
        protected = all(name.startswith(_MOCKS) for name in links or [f"{kind}:"])
    layout: tuple[tuple[str, ...], ...] = (ACTUATORS[:3], ACTUATORS[3:])
    if period < 1.0 / 600.0:
        layout = tuple((name,) for name in ACTUATORS) if protected else (ACTUATORS[:2], ACTUATORS[2:4], ACTUATORS[4:])
    names = tuple(links) if links is not None else tuple(f"{kind}:drives/{i}" for i in range(len(layout)))
    if len(names) != len(layout):
        remedy = "name one link per channel or configure the channels"
        raise DriverSettingsError("number of links", value=len(names), limit=len(layout), remedy=remedy)
    channels = [{"link": name, "drives": drives} for name, drives in zip(names, layout, strict=True)]
    return MotorDriverSettings.checked(channels=channels, period=period, protected=protected)
