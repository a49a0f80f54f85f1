"""Writes LeRobot data sets to the published schema of versions 2.1 and 3."""

import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

V2_DATA = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
V3_DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


def _lists(x):
    return pa.array(list(np.asarray(x, np.float32)), pa.list_(pa.float32(), np.shape(x)[1]))


def write_data_set(folder, version, rate, joints, episodes, robot="so101_follower", flat=()):
    """Write episodes of (stamps (n,) or None, action (n, k), state (n, k)); stamps of None are frame over rate.

    Features in `flat` have a column for each joint in place of lists.
    """
    motors = [f"{joint}.pos" for joint in joints]
    old = version.startswith("v2")
    names = {"motors": motors} if old else motors
    wide = {"dtype": "float32", "shape": [len(joints)], "names": names}
    one = {"dtype": "int64", "shape": [1], "names": None}
    features = {"action": wide, "observation.state": wide, "timestamp": {**one, "dtype": "float32"}}
    features |= {name: one for name in ("frame_index", "episode_index", "index", "task_index")}
    for name in flat:
        features |= {f"{name}.{motor}": {**wide, "shape": [1], "names": None} for motor in motors}
        del features[name]
    info = {"codebase_version": version, "robot_type": robot, "fps": rate, "features": features}
    info |= {"total_episodes": len(episodes), "total_frames": sum(len(x[1]) for x in episodes), "total_tasks": 1}
    info |= {"chunks_size": 1000, "splits": {"train": f"0:{len(episodes)}"}, "data_path": V2_DATA if old else V3_DATA}
    (folder / "meta").mkdir(parents=True)
    (folder / "meta/info.json").write_text(json.dumps(info))
    chunk = folder / "data/chunk-000"
    chunk.mkdir(parents=True)
    tables, index = [], 0
    for number, (stamps, action, state) in enumerate(episodes):
        n = len(action)
        frames = np.arange(n)
        stamps = frames / rate if stamps is None else stamps
        tables.append(
            pa.table(
                {
                    "action": pa.array(list(np.asarray(action, np.float32)), pa.list_(pa.float32(), len(joints))),
                    "observation.state": pa.array(
                        list(np.asarray(state, np.float32)), pa.list_(pa.float32(), len(joints))
                    ),
                    "timestamp": pa.array(np.asarray(stamps, np.float32)),
                    "frame_index": frames,
                    "episode_index": np.full(n, number),
                    "index": index + frames,
                    "task_index": np.zeros(n, dtype=int),
                }
            )
        )
        index += n
        for name in flat:
            each = np.stack(tables[-1][name].to_pylist()).T
            columns = {f"{name}.{motor}": pa.array(x) for motor, x in zip(motors, each, strict=True)}
            kept = tables[-1].drop_columns([name])
            tables[-1] = pa.table({**{n: kept[n] for n in kept.column_names}, **columns})
    if old:
        for number, table in enumerate(tables):
            pq.write_table(table, chunk / f"episode_{number:06d}.parquet")
    else:
        pq.write_table(pa.concat_tables(tables), chunk / "file-000.parquet")
    return folder
