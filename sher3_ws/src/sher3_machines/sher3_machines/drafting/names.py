"""What the name of a column says: which signal it is, of which axis, in which unit.

People name columns in many ways (`actual_q_2`, `Soll [mm]`, `/joint_states/elbow/position`, `present_current`), but of
few words: one for the quantity, one for who asks or measures, a unit, and what is left is the axis.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from sher3_machines.intake.columns import IN_HEADER
from sher3_machines.intake.fields import TIME_UNITS, VELOCITIES
from sher3_machines.intake.runs import NUMBERING
from sher3_machines.intake.spelling import PARTING, bare
from sher3_machines.intake.units import UNITS, spelled


def vocabulary(text: str) -> frozenset[str]:
    """Return the words of a text."""
    return frozenset(text.split())


POSITION = vocabulary(
    "position positions pos posn q qpos theta phi psi angle angles ang encoder enc lage weg winkel qm x z dist "
    "distance displacement displ stroke gap hub verschiebung schrittzähler steps schritte thetam posición posicion "
    "posição posicao posizione ángulo angulo saída saida salida"
)
COUNTING = vocabulary("encoder enc")
"""Words for a place that, where it is whole all along, is in counts."""
VELOCITY = vocabulary(
    "velocity velocities vel velo speed spd qd dq omega qdot qvel gyro drehzahl geschwindigkeit rate dot thetadot xdot "
    "velocidad velocidade vitesse velocità"
)
EFFORT = vocabulary(
    "effort efforts torque torques tau taus tao force iq trq moment drehmoment strom kraft amps qfrc f tq"
)
CURRENT = vocabulary("current currents curr cur i corriente courant corrente")
"""A current is an effort, but the current position is the measured one."""
TWOFOLD = {"tq": ("reference", "position"), **dict.fromkeys(CURRENT, ("position", "reference"))}
"""Words for an effort that some write for a place -> which, and beside what: the target of `q`, `Current X` beside
`Target X`.
"""
COMMAND = vocabulary(
    "control ctrl u input eingang voltage volt voltaje spannung pwm duty vir valve ventil esforço esforco"
)
CONTROLLERS, OUTPUTS = vocabulary("pid pi controller regler"), vocabulary("output out")
"""Words for a controller and for what comes out of it, which is what drives."""
ASKED = vocabulary(
    "ref reference set setpoint sp desired des target tar tgt goal soll demand commanded cmd command action qg d "
    "planned cmptd computed rsol referência referencia consigna envoyé envoyée envoyee"
)
MEASURED = vocabulary(
    "actual act measured meas present est estimate estimated ist rist feedback fb response antwort respuesta resposta "
    "réel réelle reel reelle mesuré mesurée medido medida misurato"
)
HELD = vocabulary("load")
"""Words for a second place that are a place only beside the first: alone they are forces, of cells in counts."""
SECOND = vocabulary(
    "load output link ql thetal second secondary se scale abtrieb maßstab massstab glasmaßstab glasmassstab tracker "
    "laser interferometer vicon mocap optitrack qualisys gt truth groundtruth"
)
IGNORED = vocabulary(
    "acceleration acc accel qdd ddq qddot ddot thetaddot xddot error err erro bus supply battery versorgung power "
    "leistung energy tcp pose cartesian ee eef execution main frequency freq frequenz accelerometer "
    "momentum deviation ratio batt vbat vbus vcc vdd air wind airspeed windspeed ff feedforward"
)
"""What is no signal of an axis: derivatives, momenta, supplies, frequencies, the air, what a controller adds unasked,
and what the hand of an arm does.
"""
TEMPERATURE = vocabulary("temperature temperatures temp temps temperatur")
APPLIED = vocabulary("hung applied external disturbance weight brake bremsmoment last")
"""A force from outside that is known, where the column has the unit of one."""
READING = vocabulary("value val wert")
"""What a channel calls its readings."""
DERIVED = vocabulary("filt filtered filter smooth smoothed gefiltert kalman ekf")
"""What was made of a reading: taken where the reading itself was not recorded."""
MODELLED = vocabulary("gravity friction damping coriolis centrifugal model modelled predicted simulated")
"""Terms of a model that a controller logs beside its readings: taken where no reading was recorded."""
PLAIN = vocabulary(
    "motor mot actuator state states joint value wert data real raw message msg sensor averaged average mean mittel "
    "abs absolute absolut inc incremental inkremental"
)
PLAIN |= DERIVED | MODELLED
"""Words that tell one axis from another only where nothing else does."""
PARTS = vocabulary("joint joints axis axes servo j gelenk achse junta articulación articulacion")
"""Words for a part of a machine whose place is meant where nothing says what was read: `joint1`, `J2`."""
TURNING = vocabulary("az azimuth el elevation pan tilt yaw pitch roll")
"""Names of axes that, with a unit of an angle, are a position."""
TIME = vocabulary(
    "t time stamp timestamp timestamps timestep zeit tiempo temps tempo date datetime utc received elapsed clock"
)
COUNTERS = vocabulary("sample samples index idx frame step n nr row")
PLACELESS = ("A", "mA", "N", "kN", "mN", "gf", "kgf", "lbf", "N*m", "mN*m", "V", "mV")
"""Units that no place has, whatever its name: `q-axis [A]` is a current."""
FORCES = ("%", *PLACELESS[:-2])
"""Units of an effort."""
SHARES = ("%", "1")
"""Units of what a drive is told, where its name speaks of no place."""
PLACES = ("m", "cm", "mm", "um", "rad", "mrad", "deg", "arcmin", "arcsec", "rev", "count")
"""Units of a position."""
CLEAR = vocabulary(
    "deg degree degrees rad radians rev revs rpm mm ms msec millis milliseconds us usec micros microseconds "
    "sec secs seconds"
)
"""Words that are nothing but a unit: a name by themselves, `ms,deg,rpm`, or at its end, `speedRpm`."""
OF_SPEEDS = vocabulary("rpm erpm rps dps")
"""Units that no other word is spelt like, wherever they stand: `motorRPM_1`, `rpm_value`."""
DRIVING = vocabulary("motor mot qm thetam antrieb drive schrittzähler steps schritte")
"""Words for the position on the side of the drive, of an axis with two positions; the other one is the load's."""
WORDS = POSITION | VELOCITY | EFFORT | CURRENT | COMMAND | ASKED | MEASURED | IGNORED
TELLING = WORDS | SECOND | TEMPERATURE | APPLIED | TURNING | TIME | COUNTERS
"""Words by which a column tells something by itself."""
NAMELESS = "c"
"""Word of the columns of a table without a header: c0, c1, ..."""
SLIDING = vocabulary("position pos posn x y z dist distance displacement displ stroke gap hub weg verschiebung")
"""Words beside which an `m` at the end is a metre: `cart_position_m`; `q_m` is an angle of a motor."""
LENGTHS = vocabulary("dist distance displacement displ stroke hub weg verschiebung")
"""Words for a place that is a length, whatever its axis is called."""
PER_SECOND = re.compile(r"(?P<name>.+)_(?P<unit>deg|rad|m|mm)(_|p|_per_)s")
"""A velocity whose name ends in its unit: `gyro_deg_s`, `omega_rad_per_s`."""
CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z][a-z]+$)")
"""Where the last word of a name begins with a capital: `wheelSpeedRpm`."""
ENTRY = re.compile(r"[A-Za-z]{0,5}[ _]?\d{1,2}|[xyz]")
"""What brackets hold that is no unit but an entry: `POSITIONS (J1)`, `FORCE (x)`."""
DIRECTIONS = vocabulary("x z")
"""Words for a place that name an axis, beside one for who asks or measures."""
SHORT = vocabulary("x z i u n d q t f")
"""Words of one letter: beside a longer word for the quantity they are the name of the axis."""
FORCEFUL = EFFORT | CURRENT | COMMAND | APPLIED
"""Words beside which a single letter at the end is a unit: `force_N`, `iq_A`, `u_V`; `enc_A` is the encoder of A."""
COUNTED = POSITION | VELOCITY | TIME | COUNTERS | PARTS | NUMBERING
"""Words beside which an `N` at the end is a number or a direction: no side is called N, and beside others it is newton.
"""
ACCELERATION = re.compile(r"(?i)a_[xyz]")
"""An acceleration along an axis, of an inertial sensor."""
NUMBERED = re.compile(r"\w*\d+: *(?=[A-Za-z])")
"""What numbers a column before its name: `obs_13: joint_pos`."""
SIDES = re.compile(r"(?i)(?<![a-z])(q|theta)_(?=[ml](?![a-z0-9]))")
"""A place of the motor or of the link, as textbooks of elastic joints write them: `q_m`, `theta_l`."""
PULSES = vocabulary("pwm pulse pulses pulsewidth width servo")
"""Words beside which a unit of time is that of the pulses that a hobby servo is told: `servo_us`."""
WEIGHED = vocabulary("weight weights mass masses load force gewicht gewichte masse kraft last")
"""Words beside which a `g` at the end is a gram."""
SIDE = re.compile(r"[lr](?=\w{4})")
"""The side, joined to a quantity: `Rspeed`."""
SHORTEST = 3
"""Letters of a word that is joined to another one: `Sollposition`, `Motorspannung`, `jointangle`."""
ASKED_SPEED = "asked speed"
"""Signal of a speed that is asked for: the reference of an axis of which speeds alone were recorded."""


@dataclass(frozen=True)
class Named:
    """What a column's name says.

    Attributes:
        signal: of an axis, as the description names it, or `velocity`; None: no signal of an axis.
        axis: what is left of the name; empty where nothing is.
        unit: as descriptions have it; None where the name has none.
    """

    signal: str | None
    axis: str
    unit: str | None


def parse(column: str) -> Named:
    """Return what the name of a column says, with the tables it lies in."""
    *tables, last = PARTING.split(column)
    last = NUMBERED.sub("", last)
    known, unit = bare_and_unit(last)
    words = words_of(known)
    unit = unit or next((spelled(w) for w in words if w in OF_SPEEDS), None)
    words = [w for w in words if w not in OF_SPEEDS]
    if ACCELERATION.fullmatch(known):
        return Named(None, "", unit)
    if tables and words and set(words) <= READING:  # a channel of a control system: its table has the name
        words = words_of(tables.pop())
    if tables and unit is None and not set(words) & TELLING:  # a file for each signal: its columns are the joints
        parted = parse(tables[-1])
        axis = "_".join(w for w in words if w not in PLAIN and w != NAMELESS)
        return Named(parted.signal, axis or parted.axis, parted.unit)
    if unit == "nm" and set(words) & (EFFORT | CURRENT):
        unit = "N*m"
    table = words_of(tables[-1]) if tables else []
    long = [w for w in words if w not in SHORT and w in WORDS - MEASURED - ASKED]
    used = [w for w in words if w in WORDS and not (long and w in SHORT and w != "d")]
    rest = [w for w in words if w not in used and w not in SECOND | PLAIN | CONTROLLERS | OUTPUTS]
    rest = rest or [w for w in used if w in DIRECTIONS and (len(used) > 1 or set(words) & SECOND)]
    if unit in FORCES and set(words) & APPLIED:
        return Named("applied", "_".join(w for w in rest if w not in APPLIED), unit)
    if unit in FORCES and set(words) & SECOND and not set(words) & POSITION:
        return Named("effort", "_".join(rest), unit)  # a load in percent is a force
    if unit in TIME_UNITS and set(words) & PULSES and not set(words) & TIME:
        return Named("reference", "_".join(w for w in rest if w not in PULSES), unit)
    if unit == "degC" or set(words) & TEMPERATURE:
        return Named("temperature", "_".join(w for w in rest if w not in TEMPERATURE), unit or "degC")
    told = set(used) | (set(words) & (SECOND | CONTROLLERS | OUTPUTS))
    signal = _signal(told, {w for w in table if w in (ASKED | COMMAND) - SHORT})
    if signal in ("position", "load") and unit in PLACELESS:
        signal = "effort" if unit in FORCES else None  # a bridge in mV, no place
    if signal == "position" and unit in VELOCITIES:
        signal = "velocity"
    if signal == "reference" and unit in VELOCITIES:
        signal = ASKED_SPEED
    if signal == "reference" and (unit in PLACELESS or (unit in SHARES and not set(words) & POSITION)):
        signal = "command"
    rest = rest or [w for w in table if w not in WORDS and w not in PLAIN and w not in SECOND] or table
    if signal is None and not set(words) & IGNORED:
        plain = unit == "count" or (unit in PLACES and set(words) <= PLAIN | TURNING)
        signal = "position" if plain else "effort" if unit in FORCES and not set(words) & WORDS else None
        signal = "velocity" if unit in VELOCITIES and not set(words) & WORDS else signal
    return Named(signal, "_".join(rest), unit)


def _signal(words: set[str], above: set[str]) -> str | None:
    """Return the signal that some words speak for; `above`: words of the table that say who asks."""
    asked = bool(words & ASKED or above)
    place = bool(words & POSITION)
    if words & IGNORED:
        return None
    if words & CONTROLLERS and words & OUTPUTS:
        return "command"
    if words & VELOCITY:
        return ASKED_SPEED if asked else "velocity"
    if words & EFFORT or (words & CURRENT and not place):
        return "command" if asked else "effort"
    if words & COMMAND:
        return None if words & MEASURED else "command"
    if asked:
        return "reference"
    if words & SECOND:
        return "load"
    return "position" if place or words & MEASURED else None


def words_of(text: str) -> list[str]:
    """Return the words of a name in small letters: parted by signs, by capitals and by digits.

    A word behind the capitals of a make is one too: `EPOSPosition`.
    """
    text = SIDES.sub(r"\1", text.replace("set_point", "sp").replace("Set Point", "sp"))
    parted = re.sub(
        r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z]{2})(?=[A-Z][a-z]{2})|(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])", " ", text
    )
    words = [w for w in re.split(r"[^0-9A-Za-zÀ-ÿ]+", parted.lower()) if w]
    return [part for w in words for part in _joined(w)]


def _joined(word: str) -> list[str]:
    """Return the words of two that are joined, what is asked or moves and its quantity; any other word by itself."""
    known = WORDS | PLAIN
    if word in known | TELLING:
        return [word]
    cuts = [*range(SHORTEST, len(word) - SHORTEST + 1)]
    cut = next((i for i in cuts if {word[:i], word[i:]} <= known), 1 if SIDE.match(word) and word[1:] in known else 0)
    return [word[:cut], word[cut:]] if cut else [word]


def bare_and_unit(name: str) -> tuple[str, str | None]:
    """Return a column's name without its unit, and the unit: in brackets, or the last word of the name."""
    match = IN_HEADER.fullmatch(name)
    if match:
        inside = match["unit"].strip()
        if spelled(inside) in UNITS and not inside.isdigit():
            return match["name"], spelled(inside)
        return (f"{match['name']} {inside}" if ENTRY.fullmatch(inside) else match["name"]), None
    if match := PER_SECOND.fullmatch(name):
        return match["name"], f"{match['unit']}/s"
    first, last = ([*CAPITAL.split(name), ""] if CAPITAL.search(name) else ["", name])[:2]
    if last.lower() in CLEAR:
        return first, spelled(last.lower())
    head, mark, last = name.rpartition("_" if "_" in name else " ")
    if mark == " " and (last not in UNITS or len(last) == 1):
        return name, None
    said, words = spelled(last), set(words_of(head))
    letter = len(last) == 1 and last.isupper() and bool(words & FORCEFUL)
    letter = letter or (last == "N" and not words & COUNTED)
    letter = letter or (last == "V" and bool(words & POSITION)) or (last == "g" and bool(words & WEIGHED))
    letter = letter or (last == "m" and bool(words & SLIDING)) or (last == "s" and bool(words & TIME))
    stated = head.endswith("_in") or letter or (len(last) > 1 and not last.isdigit())
    known = head and said in UNITS and stated
    return (head.removesuffix("_in"), said) if known else (name, None)


def tells_time(column: str) -> bool:
    """Return whether a column's name says that it is a time."""
    known, unit = bare_and_unit(bare(column))
    return bool(set(words_of(known)) & TIME) or (unit in TIME_UNITS and not set(words_of(known)) & PULSES)


def counts_samples(column: str) -> bool:
    """Return whether a column's name says that it numbers the samples."""
    known, _ = bare_and_unit(bare(column))
    return bool(set(words_of(known)) & COUNTERS)
