"""The one call: a model and what was recorded go in, the answer comes out; nothing is written."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike
from sher3_machines.errors import MachineError

from sher3_public.answer import Answer
from sher3_public.arrays.stating import Gains, Inertias, Stated
from sher3_public.cases import Case, case_of_arrays, case_of_description, case_of_tables
from sher3_public.errors import InputError
from sher3_public.records import arrays_of, columns_of, is_several, is_table, tables_at

UNUSED = "is not used"
"""Words of a guess by which a signal plays no part."""
Runs = ArrayLike | Sequence[ArrayLike] | None


def diagnose(
    model: object,
    time: Any = None,
    control: Runs = None,
    position: Runs = None,
    effort: Runs = None,
    *,
    load: Runs = None,
    joints: Sequence[str] = (),
    gain: float | str | Mapping[str, float | str] = 1.0,
    resolution: float | None = None,
    simulated: bool | None = None,
    units: Mapping[str, str] | None = None,
    controls: Sequence[str] = (),
    servo: Gains | Mapping[str, Gains] | None = None,
    delay: float | Mapping[str, float] = 0.0,
    inertias: Inertias = "nominal",
    rate: float | None = None,
    tags: Mapping[str, Sequence[object]] | Sequence[Mapping[str, object]] | None = None,
    without: Collection[str] = (),
) -> Answer:
    """Say where a robot leaves its model, which effects explain it, and how far the gap shrinks; or abstain.

    Arrays are taken in SI units, where `units` says nothing else: s, rad or m, N m or N. Several
    runs are lists of arrays, or a list of tables.

    Args:
        model: path or text of MJCF or URDF, `MjModel`, `MjSpec`; a description (mapping, path of YAML, or object) of
            any kind of machine; None: axes by themselves, with a table.
        time: stamps (n,), or a table with named columns: a mapping of arrays, or a frame of pandas or Polars; or the
            path of a log in any format that is imported, each of its runs a table.
        control: what the actuators were told, (n, m): one column for each actuator of the model, or each joint.
        position: (n, k), of the joints in the order of the model.
        effort: (n, k), forces at the joints; without it those of the model's motors and servos follow from `control`.
        load: (n, k), second encoders behind the gears; NaN where a joint has none.
        joints: names of the columns of `position`, where the guess is wrong; those of a table have names.
        gain: N m (N) per unit of the effort, for all joints or by name; `unknown`: told by the model's inertias.
        resolution: one count of the encoders, rad or m; default what the readings say.
        simulated: whether the effort is a simulator's own, computed at the beginning of its steps; default guessed.
        units: unit of an array by its name, such as `{"time": "ms", "position": "deg", "control": "deg"}`.
        controls: joint, or actuator of the model, of each column of `control`, where the guess is wrong.
        servo: stiffness and damping of the servo that follows `control`, N m/rad and N m/(rad/s) (N/m and N/(m/s)), in
            place of the model's: one pair for all joints, or by name. It gives a URDF its drives.
        delay: s after its stamp at which a control acts, beyond the model's: one number, or by name of the joint.
        inertias: of the links and rotors of an arm: `nominal`, those of the model are compared with the robot;
            `identified`, they are found from efforts that were recorded, and stand in `corrected()`.
        rate: samples per second, Hz, of tables without stamps.
        tags: what differs between runs: tag -> value for each run, or a mapping for each run. The first run is the
            reference.
        without: ids of effects that are left out of the library.

    Returns:
        The answer; `guessed` says what was taken for what.

    Raises:
        InputError: arrays, model or keywords do not fit each other.
        MachineError: the model or the record cannot be used; the sentence says why and what to do.
        UnknownEffect: an id in `without` is no effect.
    """
    joints, controls = ([x] if isinstance(x, str) else x for x in (joints, controls))
    stated = Stated(tuple(joints), gain, resolution, simulated, units or {}, tuple(controls), servo, delay, inertias)
    case = _case(model, time, (control, position, effort, load), stated, rate, tags)
    try:
        return Answer.of(case, tuple(without))
    except MachineError as error:
        why = [guess for guess in case.guesses if UNUSED in guess]
        error.remedy = "; ".join([*([error.remedy] if error.remedy else []), *why])
        raise


def _case(
    model: object, time: Any, arrays: tuple[Runs, Runs, Runs, Runs], stated: Stated, rate: float | None, tags: Any
) -> Case:
    time = tables_at(time)
    tables = time if is_several(time) and is_table(time[0]) else [time] if is_table(time) else []
    if not tables:
        if model is None:
            raise InputError("arrays need a model", remedy="give the model, or a table whose columns have names")
        control, position, effort, load = arrays
        return case_of_arrays(model, arrays_of(time, control, position, effort, load), stated, tags)
    if any(x is not None for x in arrays):
        raise InputError("a table and arrays", remedy="give either a table or time, control, position, effort")
    columns = [columns_of(table) for table in tables]
    if not is_description(model):
        return case_of_tables(model, columns, rate, stated, tags)
    if stated != Stated():
        remedy = "write it into the description"
        raise InputError("gain, units and the like are stated twice", value="a description", remedy=remedy)
    return case_of_description(model, columns, tags)


def is_description(model: object) -> bool:
    """Return whether a model is a description of a machine: a mapping, an object of it, or a YAML file."""
    named = (isinstance(model, str) and "<" not in model) or hasattr(model, "__fspath__")
    return (
        isinstance(model, Mapping)
        or hasattr(model, "named_files")
        or (named and str(model).endswith((".yaml", ".yml")))
    )
