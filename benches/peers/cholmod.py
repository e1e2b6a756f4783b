"""CHOLMOD on the matrices that `cargo bench --bench hierarchical -- orders FOLDER` writes: numbers in the factor and seconds.

    pip install scikit-sparse scipy; cholmod.py FOLDER

Each order of elimination of CHOLMOD's own; the best of five factorisations, on as many threads as BLAS takes.
"""

import sys
import time
from pathlib import Path

import numpy as np
import scipy.sparse
from sksparse import cholmod


def main(folder: Path) -> None:
    print("| matrix | unknowns | order | numbers in the factor | plan s | factor s | solve ms |\n|---|---|---|---|---|---|---|")
    for path in sorted(folder.glob("*.txt"), key=lambda path: path.stat().st_size):
        with path.open() as lines:
            order, _ = map(int, lines.readline().split())
            rows, columns, values = np.loadtxt(lines, unpack=True)
        upper = scipy.sparse.csc_matrix((values, (rows.astype(int), columns.astype(int))), shape=(order, order))
        matrix = (upper + scipy.sparse.triu(upper, 1).T).tocsc()
        for method in ("amd", "metis", "nesdis"):
            begun = time.perf_counter()
            factor = cholmod.analyze(matrix, mode="supernodal", ordering_method=method)
            planned = time.perf_counter() - begun
            factored = solved = float("inf")
            for _ in range(5):
                begun = time.perf_counter()
                factor.cholesky_inplace(matrix)
                factored = min(factored, time.perf_counter() - begun)
                begun = time.perf_counter()
                factor(np.ones(order))
                solved = min(solved, time.perf_counter() - begun)
            entries = factor.L().nnz
            print(f"| {path.stem} | {order} | {method} | {entries} | {planned:.3f} | {factored:.3f} | {1e3 * solved:.1f} |")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
