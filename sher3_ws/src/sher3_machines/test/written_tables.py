"""A table that is written and drafted: what the tests of drafts begin with."""

import numpy as np
from sher3_machines.drafting.draft import draft

TIME = np.arange(0.0, 4.0, 0.002)


def written(tmp_path, header, *columns):
    text = {"delimiter": ",", "header": header, "comments": "", "encoding": "utf-8"}
    np.savetxt(tmp_path / "a.csv", np.column_stack(columns), **text)
    return draft(tmp_path / "a.csv")
