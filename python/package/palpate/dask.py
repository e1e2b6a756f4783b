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

from . import _native
from ._errors import StudyError
from ._line import source
from ._many import FitMany, fit_many as _fit_many
from ._study import Progress, Study, arguments, merge

if TYPE_CHECKING:
    from distributed import Client

# Dask's own functions are not typed
Untyped = Any

__all__ = ["fit_many", "part", "ranges", "study"]

# parts a thread: enough that a slow or lost worker leaves work for the others, few enough that a part outweighs its task
PARTS_A_THREAD = 4


def ranges(replicates: int, parts: int) -> list[tuple[int, int]]:
    """So many ranges of equal length, but for one replicate, that make 0 .. replicates.

    >>> ranges(10, 3)
    [(0, 3), (3, 6), (6, 10)]
    """
    parts = max(1, min(parts, replicates))
    edges = [replicates * k // parts for k in range(parts + 1)]
    return list(zip(edges, edges[1:]))


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

    client: a distributed.Client, or the current one. parts: tasks, by default four for every thread of the cluster.
    threads: threads of one task; workers that do several tasks at once want 1. options: seed, level, quantity, degree and
    the like, as in `palpate.study`. A tolerance, a budget and kept values belong to one process and are refused.
    Raises StudyError.
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
    if parts is None:
        parts = PARTS_A_THREAD * max(1, sum(cluster.nthreads().values()))
    spans = ranges(whole, parts)
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


def fit_many(x: Any, y: Any, z: Any, *, normals: Any = None, slopes: Any = None, **options: Any) -> FitMany:
    """`palpate.fit_many` over Dask arrays: every block of patches of z is one task.

    z (b, g) or (b, n, m), chunked along b alone; x, y and the rest as for `palpate.fit_many`, Dask arrays or not.
    The tasks run on the current client, or on threads where there is none.
    """
    import dask as module
    import dask.array as arrays

    dask: Untyped = module
    z = z.rechunk({axis: -1 for axis in range(1, z.ndim)})
    edges = [0]
    for size in z.chunks[0]:
        edges.append(edges[-1] + size)

    def piece(array: Any, a: int, b: int) -> Any:
        # only what has one entry a patch is cut
        if array is None or getattr(array, "ndim", 0) < 2:
            return array
        cut = array[a:b]
        return _blocks(dask, cut) if isinstance(cut, arrays.Array) else cut

    task = dask.delayed(_fit_many)
    blocks = [
        task(x=piece(x, a, b), y=piece(y, a, b), z=piece(z, a, b), normals=piece(normals, a, b),
             slopes=piece(slopes, a, b), **options)
        for a, b in zip(edges, edges[1:])
    ]  # fmt: skip
    return FitMany.join(list(dask.compute(*blocks)))


def _blocks(dask: Untyped, array: Untyped) -> Any:
    return dask.delayed(_joined)(array.to_delayed().tolist())


def _joined(blocks: Any) -> Any:
    """The blocks of an array, nested in lists, as one array."""
    import numpy

    return numpy.block(blocks) if isinstance(blocks, list) else blocks
