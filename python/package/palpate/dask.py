"""Studies and batches on a Dask cluster.

    replicates 0 .. n  =  ranges  ->  parts, one a task  ->  merge: the bits of one process

A part is a function of its range alone. A task that is tried again, or done twice, gives the same bytes; a part that is
missing is noticed by `merge`. Workers need this package of the same version, and processors with the same instruction set.
"""

from __future__ import annotations

import tempfile
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._errors import StudyError
from ._line import source
from ._many import FitMany, fit_many as _fit_many
from ._study import Progress, Study, arguments, merge

if TYPE_CHECKING:
    import numpy.typing as npt
    from distributed import Client

# Dask's own functions are not typed
Untyped = Any

__all__ = ["fit_many", "part", "ranges", "study"]

# parts a thread: enough that a slow or lost worker leaves work for the others, few enough that a part outweighs its task
PARTS_A_THREAD = 4
# Most replicates of a part. A part that is lost is done again: minutes to an hour of one core at a million or a hundred
# thousand replicates a second. Fewer would make more files: 10^11 replicates are 373 parts of 4 to 7 MB.
MOST_IN_A_PART = 1 << 28


def ranges(replicates: int, parts: int) -> list[tuple[int, int]]:
    """So many ranges of equal length, but for one replicate, that make 0 .. replicates.

    >>> ranges(10, 3)
    [(0, 3), (3, 6), (6, 10)]
    """
    parts = max(1, min(parts, replicates))
    edges = [replicates * k // parts for k in range(parts + 1)]
    return list(zip(edges, edges[1:]))


def shared_out(replicates: int, threads: int) -> list[tuple[int, int]]:
    """The ranges that `study` makes of a study for so many threads.

    >>> len(shared_out(10**6, 8)), len(shared_out(10**11, 8))
    (32, 373)
    """
    return ranges(replicates, max(PARTS_A_THREAD * threads, -(-replicates // MOST_IN_A_PART)))


def part(line: list[str], text: str | None, span: tuple[int, int], threads: int | None = 1) -> bytes:
    """The bytes of one part: the task that a worker does. They depend on nothing but the arguments."""
    return _native.StudyPlan(line, text).run(span, threads, False, False, None).part


def study(
    scene: str | PathLike[str],
    replicates: int | None = None,
    client: Client | None = None,
    *,
    parts: int | None = None,
    threads: int | None = 1,
    retries: int = 3,
    progress: Progress | None = None,
    **options: Any,
) -> Study:
    """The study of `palpate.study`, its replicates shared out over the workers of a Dask cluster: the same bits.

    client: a distributed.Client, or the current one. parts: tasks, by default four for every thread of the cluster, and so
    many that none has more than 2^28 replicates; a lost worker loses what it did of its task. The parts, of some 5 MB,
    stand in a temporary folder of this process (TMPDIR) until all are there. threads: threads of one task; workers that
    do several tasks at once want 1. options: seed, level, quantity, degree and the like, as in `palpate.study`. A
    tolerance, a budget and kept values belong to one process and are refused. Raises StudyError.
    """
    import distributed

    dask: Untyped = distributed
    refused = [name for name in ("tolerance", "budget", "rule", "range", "keep_values") if options.get(name) is not None]
    if refused:
        raise StudyError(f"{', '.join(refused)}: not on a cluster, where replicates decides", "Option")
    cluster: Untyped = client or dask.get_client()
    name, text = source(scene)
    if text is None and Path(name).is_file():
        # workers need not see the file
        text = Path(name).read_text(encoding="utf-8")
    line = arguments(name, {"replicates": replicates, **options})
    whole = _native.StudyPlan(line, text).replicates
    cores = max(1, sum(cluster.nthreads().values()))
    spans = shared_out(whole, cores) if parts is None else ranges(whole, parts)
    futures = [cluster.submit(part, line, text, span, threads, pure=True, retries=retries) for span in spans]
    done = 0
    with tempfile.TemporaryDirectory(prefix="palpate-") as folder:
        files = {future.key: Path(folder) / f"part-{k}" for k, future in enumerate(futures)}
        lengths = {future.key: span[1] - span[0] for future, span in zip(futures, spans)}
        for future, content in dask.as_completed(futures, with_results=True):
            files[future.key].write_bytes(content)
            done += lengths[future.key]
            future.release()
            if progress is not None:
                progress(done, whole)
        return merge(list(files.values()))


def fit_many(
    x: Any,
    y: Any,
    z: Any,
    client: Client | None = None,
    *,
    normals: Any = None,
    slopes: Any = None,
    offsets: npt.ArrayLike | None = None,
    threads: int | None = 1,
    retries: int = 3,
    **options: Any,
) -> FitMany:
    """`palpate.fit_many` over Dask arrays: every block of z is one task, and no block is ever on this machine.

    z: a Dask array, (b, g) or (b, n, m) in blocks along b, which decide the tasks; blocks along the other axes are put
    together by the workers. Ragged: z (all contacts,) with offsets (b + 1,), whole numbers in memory; a patch is fitted with
    the block in which it begins. x, y, normals, slopes: as for `palpate.fit_many`, Dask arrays in whatever blocks, or not.

    client: a distributed.Client; otherwise the current one, or threads of this process where there is none. threads: of
    one task. The answer, some 90 bytes a patch, is the same as without Dask and comes in the order of the patches.
    Raises what `palpate.fit_many` raises; TypeError where z is no Dask array.

    >>> import dask.array, numpy as np
    >>> x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, 6), np.linspace(-1, 1, 6)))
    >>> z = dask.array.linspace(0.1, 0.2, 1000, chunks=300)[:, None] * (x * x + y * y)
    >>> fit_many(x, y, z, degree=2, weights="equal").class_name[::333]
    ['cup', 'cup', 'cup', 'cup']
    """
    import dask as module
    import dask.array as array_module

    dask: Untyped = module
    arrays: Untyped = array_module
    if not isinstance(z, arrays.Array):
        what = "z: a Dask array wanted, as dask.array.from_array(z, chunks=(10_000, -1)); palpate.fit_many takes others"
        raise TypeError(what)
    if "progress" in options:
        raise TypeError("progress: Dask tells it, by distributed.progress or dask.diagnostics.ProgressBar")
    if any(size != size for size in z.chunks[0]):
        raise ValueError("z has blocks of unknown size: z.compute_chunk_sizes() finds them")
    blocks = _edges(z.chunks[0])
    # places that all patches share, and the axes of images, have one dimension and are not cut
    cuts: list[tuple[int, int, Any]] = [(a, b, None) for a, b in zip(blocks, blocks[1:])]
    least = 2
    if offsets is not None:
        cuts, least = _ragged(offsets, blocks), 1
    z = z.rechunk({axis: -1 for axis in range(1, z.ndim)})

    def rows(array: Any, name: str, a: int, b: int) -> Any:
        if array is None:
            return None
        if not isinstance(array, (arrays.Array, np.ndarray)):
            array = np.asarray(array)
        if array.ndim < least:
            return array
        if len(array) != len(z):
            raise ValueError(f"{name} has {len(array)} rows and z {len(z)}: as many wanted")
        return array[a:b]

    given = {"x": x, "y": y, "z": z, "normals": normals, "slopes": slopes}
    task = dask.delayed(_fit_many)
    tasks = [
        task(**{name: rows(array, name, a, b) for name, array in given.items()}, offsets=own, threads=threads, **options)
        for a, b, own in cuts
    ]
    if client is None:
        return FitMany.join(list(dask.compute(*tasks, retries=retries)))
    cluster: Untyped = client
    return FitMany.join(list(cluster.gather(cluster.compute(tasks, retries=retries))))


def _edges(sizes: Any) -> list[int]:
    edges = [0]
    for size in sizes:
        edges.append(edges[-1] + int(size))
    return edges


def _ragged(offsets: npt.ArrayLike, blocks: list[int]) -> list[tuple[int, int, Any]]:
    """Rows a to b of the patches that begin in each block, and their own offsets.

    >>> [(a, b, own.tolist()) for a, b, own in _ragged([0, 3, 5, 9], [0, 4, 8, 9])]
    [(0, 5, [0, 3, 5]), (5, 9, [0, 4])]
    """
    ends = np.asarray(offsets)
    whole = ends.ndim == 1 and len(ends) > 0 and ends.dtype.kind in "iu"
    if not whole or ends[0] != 0 or ends[-1] != blocks[-1] or (ends[1:] < ends[:-1]).any():
        raise ValueError(f"offsets: whole numbers that begin at 0, do not decrease and end at {blocks[-1]}, the rows of z, wanted")
    ends = ends.astype(np.int64)
    first = np.searchsorted(ends[:-1], blocks)
    first[-1] = len(ends) - 1
    cuts = ((int(ends[k]), int(ends[last]), ends[k : last + 1] - ends[k]) for k, last in zip(first, first[1:]) if last > k)
    return list(cuts)
