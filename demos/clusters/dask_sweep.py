"""Friction over voltage by workers of dask, on this machine or on a cluster.

    environment/run python3 demos/clusters/dask_sweep.py [FOLDER] [SCHEDULER]

FOLDER keeps each point and is shared by all workers. SCHEDULER is the address of a scheduler, such as that of
dask-jobqueue's SLURMCluster; without it two workers are started here. A point whose worker is lost is tried twice more
by dask, and after that by the same command. With MPI, executor=mpi4py.futures.MPIPoolExecutor() does the same under
mpirun -n N python3 -m mpi4py.futures.
"""

import sys
from pathlib import Path

import fingerpad as fp

SMALL = Path(__file__).parents[1] / "scenes" / "small_finger.toml"


def main(out: str = "results/dask", scheduler: str | None = None) -> None:
    try:
        from dask.distributed import Client
    except ImportError:
        sys.exit("dask is not installed; environment/add distributed, or give jobs=2 in place of executor")
    with Client(scheduler) if scheduler else Client(n_workers=2, threads_per_worker=1) as client:
        found = fp.sweep(fp.Scene.load(SMALL), out, executor=client.get_executor(retries=2), voltage=[0, 50, 100])
    print(found)


if __name__ == "__main__":
    main(*sys.argv[1:])
