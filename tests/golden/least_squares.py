"""min |b - E c| by column-pivoted Householder QR, in the precision of `arithmetic`.

    E D = Q R P',  D = diag(1 / |E_j|)        rank = rows of R whose diagonal is above 10^(-digits/2) of the first
    condition = sqrt(|G|_1 |G^-1|_1),  G = R'R        the 1-norm condition of the column-equilibrated normal matrix
"""
from operator import mul

import mpmath

import arithmetic as ar


def dot(a, b):
    return sum(map(mul, a, b), ar.exact(0))


class Solution:
    """Coefficients, a basis of the null space (empty at full rank), rank, residual, conditioning."""

    def __init__(self, coefficients, null_space, rank, residual, condition, column_norms, matrix_norm):
        self.coefficients = coefficients
        self.null_space = null_space
        self.rank = rank
        self.residual = residual
        self.condition = condition
        self.column_norms = column_norms
        self.matrix_norm = matrix_norm


def solve(rows, rhs):
    """rows: list of lists (equations x unknowns) of working-precision numbers; rhs: list."""
    unknowns = len(rows[0])
    columns = [[row[j] for row in rows] for j in range(unknowns)]
    norms = [ar.sqrt(dot(c, c)) for c in columns]
    scale = [n if n != 0 else ar.exact(1) for n in norms]
    columns = [[v / s for v in c] for c, s in zip(columns, scale)]
    b = list(rhs)
    order = list(range(unknowns))
    triangle, rank = triangulate(columns, b, order)
    c = [ar.exact(0)] * unknowns
    basic = back_substitute(triangle, rank, b)
    for k in range(rank):
        c[order[k]] = basic[k] / scale[order[k]]
    null_space = []
    for free in range(rank, unknowns):
        minus = back_substitute(triangle, rank, [triangle[free][k] for k in range(rank)])
        direction = [ar.exact(0)] * unknowns
        direction[order[free]] = 1 / scale[order[free]]
        for k in range(rank):
            direction[order[k]] = -minus[k] / scale[order[k]]
        null_space.append(direction)
    residual = [v - dot(row, c) for row, v in zip(rows, rhs)]
    condition = condition_of(triangle, rank)
    return Solution(c, null_space, rank, residual, condition, scale, ar.sqrt(ar.exact(rank)))


def triangulate(columns, b, order):
    """Householder with column pivoting, in place.  Returns the columns of R (by position) and the rank."""
    unknowns, equations = len(columns), len(b)
    threshold = ar.decimal("1e-%d" % (mpmath.mp.dps // 2))
    first = None
    for k in range(min(unknowns, equations)):
        tails = [dot(c[k:], c[k:]) for c in columns[k:]]
        best = max(range(len(tails)), key=tails.__getitem__) + k
        columns[k], columns[best] = columns[best], columns[k]
        order[k], order[best] = order[best], order[k]
        pivot = columns[k]
        norm = ar.sqrt(tails[best - k])
        first = norm if first is None else first
        if norm <= threshold * first:
            return columns, k
        alpha = -norm if pivot[k] > 0 else norm
        v = pivot[k:]
        v[0] = v[0] - alpha
        beta = 2 / dot(v, v)
        for target in columns[k + 1 :] + [b]:
            tail = target[k:]
            s = beta * dot(v, tail)
            if s != 0:
                target[k:] = [t - s * w for t, w in zip(tail, v)]
        pivot[k] = alpha
    return columns, min(unknowns, equations)


def back_substitute(triangle, rank, b):
    x = [ar.exact(0)] * rank
    for k in reversed(range(rank)):
        x[k] = (b[k] - sum((triangle[j][k] * x[j] for j in range(k + 1, rank)), ar.exact(0))) / triangle[k][k]
    return x


def condition_of(triangle, rank):
    """Exact 1-norm condition of R'R, and its square root."""
    if rank == 0:
        return ar.exact(1)
    inverse = [back_substitute(triangle, rank, [ar.exact(int(i == k)) for i in range(rank)]) for k in range(rank)]
    upper = [[triangle[j][i] if i <= j else ar.exact(0) for i in range(rank)] for j in range(rank)]
    gram = max(sum((abs(dot(upper[i], upper[j])) for i in range(rank)), ar.exact(0)) for j in range(rank))
    rows = [[inverse[k][i] for k in range(rank)] for i in range(rank)]
    gram_inverse = max(sum((abs(dot(rows[i], rows[j])) for i in range(rank)), ar.exact(0)) for j in range(rank))
    return ar.sqrt(gram * gram_inverse)
