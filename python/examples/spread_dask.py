"""Distributes divisions over the workers of a Dask cluster; cells and results are pickled.

The example uses a LocalCluster; on one machine ``furrow.sweep`` needs no cluster. Needs ``pip install distributed``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from distributed import Client, LocalCluster

import furrow


def divide(cell: furrow.Cell) -> furrow.Division:
    """The task of a worker, which has its own memo."""
    return cell.divide()


def spread(cells: Sequence[furrow.Cell], client: Client) -> list[furrow.Division]:
    """The division of every cell, in order."""
    # Several cells per task reduce the scheduler's overhead.
    found: list[furrow.Division] = client.gather(client.map(divide, cells, batch_size=25))
    return found


def main(count: int = 1000) -> None:
    """Divides cells of many sizes."""
    cells = [furrow.Cell(r0=float(r0), cue="germline") for r0 in np.linspace(1.8, 5.4, count)]
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster, Client(cluster) as client:
        divisions = spread(cells, client)
    alone = furrow.sweep(axes={"r0": [cell.r0 for cell in cells]}, cue="germline")
    chi = np.array([np.nan if division.chi is None else division.chi for division in divisions])
    same = np.array_equal(chi, alone["chi"], equal_nan=True)
    print(f"{count} divisions, the same to the last bit as furrow.sweep: {same}")


if __name__ == "__main__":
    main()
