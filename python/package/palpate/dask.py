"""Studies, batches and adaptive fits on a Dask cluster.

    replicates 0 .. n  =  ranges  ->  parts, one a task  ->  merge: the bits of one process
    parts of contacts  ->  runs in the order of the cells  ->  tiles, asked round by round: the bits of one memory

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
from ._columns import Columns, columns
from ._errors import StudyError
from ._fit import Fit
from ._line import source
from ._many import FitMany, fit_many as _fit_many
from ._study import Progress, Study, arguments, merge

if TYPE_CHECKING:
    import numpy.typing as npt
    from distributed import Client

# Dask's own functions are not typed
Untyped = Any

__all__ = ["fit_adaptive", "fit_many", "part", "ranges", "study"]

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


def fit_adaptive(
    parts: Any,
    client: Client | None = None,
    *,
    tiles: int | None = None,
    retries: int = 3,
    unit: str | None = None,
    **options: Any,
) -> Fit:
    """`palpate.fit(..., adaptive=True)` of contacts that lie in parts, more of them than one memory holds: the same bits.

    parts: a Dask DataFrame with columns x, y, z [nx, ny, nz | zx, zy] [wz, wx, wy]; a Dask array (N, 3) or (N, 6); or a list of
    what `palpate.fit` takes alone, an array, a table, a path, each as it is, as Delayed or as Future. All have the same columns.
    Contacts are numbered through the parts in their order. tiles: runs of cells of the base grid (at most 64) that workers hold and
    answer for, by default two for every thread of the cluster; the answer does not depend on them, nor on how the contacts are
    cut into parts. Contacts stay with the workers, sorted; what passes is as large as the cells are many. A worker that is lost
    is replaced by doing its tasks again from the parts. options: degree, domain, sigma, grid, inset, level, bare. client: a distributed.Client,
    or the current one; without either everything is done here, a part at a time. The fit knows no contacts: it has no residuals.

    Raises what `palpate.fit` raises.

    >>> import numpy as np
    >>> x, y = np.random.default_rng(3).uniform(-1, 1, (2, 4000))
    >>> cloud = np.stack([x, y, 0.1 * (x * x + y * y)], axis=1)
    >>> fit_adaptive([cloud[:1000], cloud[1000:]], tiles=4).shape.class_name
    'cup'
    """
    words = {"adaptive": True, **options}
    unit = None if unit is None else _native.unit_name(unit)
    workers = _Workers(client, retries)
    given = [workers.hold(part) for part in _parts(parts)]
    bounds = workers.results([workers.do(_bounds, part) for part in given])
    fit = _native.TiledFit(bounds, words)
    edges = _edges([count for count, _ in bounds])
    runs = [workers.do(_run, part, fit.ground, first, edges[-1]) for part, first in zip(given, edges)]
    about = workers.results([workers.do(_about, run) for run in runs])
    counts = np.sum([by_root for by_root, _ in about], axis=0)
    spans = _tiles(counts, tiles or 2 * workers.threads)
    own = [workers.do(_merged, [workers.do(_of_roots, run, span) for run in runs]) for span in spans]
    sizes = [int(counts[a:b].sum()) for a, b in spans]
    held = []
    for tile, span in enumerate(spans):
        sides, before = _native.tile_sides(sizes, tile)
        beside = [[workers.do(_native.run_slice, own[other], cut) for other, cut in side] for side in sides]
        held.append(workers.do(_tile, fit.ground, span, own[tile], beside, (before, edges[-1])))
    extents = workers.results([workers.do(_extent, tile) for tile in held])

    def ask(questions: list[bytes]) -> list[Any]:
        return workers.results([workers.do(_answer, tile, question) for tile, question in zip(held, questions)])

    shown = [place for _, places in about for place in places]
    return Fit(fit.fit(extents, shown, ask), "contacts", unit)


class _Workers:
    """Tasks on a cluster, or done here at once where there is none."""

    def __init__(self, client: Any, retries: int) -> None:
        import distributed

        if client is None:
            try:
                client = distributed.get_client()
            except ValueError:
                pass
        self.client: Untyped = client
        self.retries = retries
        self.threads = 1 if client is None else max(1, sum(client.nthreads().values()))

    def hold(self, part: Any) -> Any:
        import dask as module

        dask: Untyped = module
        if self.client is None:
            return part
        return self.client.compute(part) if dask.is_dask_collection(part) else part

    def do(self, task: Any, *arguments: Any) -> Any:
        if self.client is not None:
            return self.client.submit(task, *arguments, pure=False, retries=self.retries)
        import dask as module

        dask: Untyped = module
        return task(*(dask.compute(argument)[0] for argument in arguments))

    def results(self, tasks: list[Any]) -> list[Any]:
        return tasks if self.client is None else list(self.client.gather(tasks))


def _parts(parts: Any) -> list[Any]:
    """The parts one by one; those of an array hold whole rows."""
    if hasattr(parts, "to_delayed"):
        if hasattr(parts, "rechunk"):
            parts = parts.rechunk({1: -1})
        return list(np.ravel(parts.to_delayed()))
    if isinstance(parts, (str, bytes)) or not hasattr(parts, "__iter__"):
        raise TypeError("parts: a Dask DataFrame or array, or a list of arrays, tables or paths wanted")
    found = list(parts)
    if not found:
        raise ValueError("parts: at least one wanted")
    return found


def _columns(part: Any) -> tuple[Any, ...]:
    return tuple(columns("fit_adaptive", Columns(part, None, None)))[:6]


def _bounds(part: Any) -> Any:
    return _native.part_bounds(_columns(part))


def _run(part: Any, ground: bytes, first: int, total: int) -> Any:
    return _native.part_run(_columns(part), ground, first, total)


def _about(run: Any) -> Any:
    return run[1:]


def _of_roots(run: Any, span: tuple[int, int]) -> bytes:
    return _native.run_of_roots(run[0], span)


def _merged(pieces: list[bytes]) -> bytes:
    return _native.merged_runs(pieces)


def _tile(ground: bytes, span: tuple[int, int], own: bytes, beside: Any, before_and_total: tuple[int, int]) -> Any:
    return _native.contact_tile(ground, span, own, beside, before_and_total)


def _extent(tile: Any) -> bytes:
    extent: bytes = tile[1]
    return extent


def _answer(tile: Any, question: bytes) -> Any:
    return _native.tile_answer(tile[0], question)


def _tiles(counts: npt.ArrayLike, tiles: int) -> list[tuple[int, int]]:
    """Runs of base cells with about equally many contacts.

    >>> _tiles([5, 0, 5, 5, 5], 2), _tiles([9, 0, 0], 3)
    ([(0, 3), (3, 5)], [(0, 1), (1, 2), (2, 3)])
    """
    ends = np.cumsum(counts)
    tiles = max(1, min(tiles, len(ends)))
    cuts = [int(np.searchsorted(ends, ends[-1] * k / tiles)) + 1 for k in range(1, tiles)]
    edges = [0, *cuts, len(ends)]
    for k in range(1, tiles):
        # each has one cell at least, and leaves as many as there are tiles behind it
        edges[k] = min(max(edges[k], edges[k - 1] + 1), len(ends) - (tiles - k))
    return list(zip(edges, edges[1:]))


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
