"""Clamped B-splines by the Cox-de Boor recursion: S(x, y) = sum_ij c_ij N_i(x) M_j(y), c flattened with j fastest.

At a knot the right limit, at the last knot the left one.  Derivatives by N' = p (N_i,p-1 / (t_i+p - t_i) - ...), 0/0 = 0.
"""
import arithmetic as ar


def uniform_knots(low, high, degree, segments):
    """Doubles: numpy's linspace, `low + i * step` with the last one `high` itself, ends repeated degree times more."""
    step = (high - low) / segments
    inner = [low + i * step for i in range(segments)] + [high]
    return [low] * degree + inner + [high] * degree


def ratio(numerator, denominator):
    return numerator / denominator if denominator != 0 else ar.exact(0)


def basis(knots, degree, x):
    """Values, first and second derivatives of all basis functions at x (lists of length len(knots) - degree - 1)."""
    t = [ar.exact(k) for k in knots]
    x = ar.exact(x) if isinstance(x, float) else x
    count = len(t) - degree - 1
    span = degree
    while span < count - 1 and x >= t[span + 1]:
        span += 1
    while t[span] == t[span + 1]:
        span -= 1
    tables = [[ar.exact(int(i == span)) for i in range(len(t) - 1)]]
    for p in range(1, degree + 1):
        last = tables[-1]
        tables.append(
            [
                ratio((x - t[i]) * last[i], t[i + p] - t[i]) + ratio((t[i + p + 1] - x) * last[i + 1], t[i + p + 1] - t[i + 1])
                for i in range(len(t) - 1 - p)
            ]
        )
    return tables[degree], derivative(tables, t, degree, 1), derivative(tables, t, degree, 2)


def derivative(tables, t, degree, times):
    if times == 0:
        return tables[degree]
    if degree == 0:
        return [ar.exact(0)] * len(tables[0])
    lower = derivative(tables, t, degree - 1, times - 1)
    return [
        degree * (ratio(lower[i], t[i + degree] - t[i]) - ratio(lower[i + 1], t[i + degree + 1] - t[i + 1]))
        for i in range(len(lower) - 1)
    ]


def row(nx, my):
    """Row of the face-splitting product for one point."""
    return [a * b if a != 0 and b != 0 else ar.exact(0) for a in nx for b in my]


def gram(knots, degree, order):
    """integral N_i^(order) N_j^(order), exact: Gauss-Legendre with degree + 1 nodes on each knot cell."""
    count = len(knots) - degree - 1
    total = [[ar.exact(0)] * count for _ in range(count)]
    for low, high in zip(knots, knots[1:]):
        if low == high:
            continue
        a, b = ar.exact(low), ar.exact(high)
        for node, weight in legendre(degree + 1):
            values = basis(knots, degree, (a + b) / 2 + (b - a) / 2 * node)[order]
            for i in range(count):
                for j in range(count):
                    if values[i] != 0 and values[j] != 0:
                        total[i][j] += (b - a) / 2 * weight * values[i] * values[j]
    return total


def legendre(n):
    """Nodes and weights on [-1, 1] by Newton's iteration on the Legendre recursion."""
    import math

    pairs = []
    for k in range(n):
        x = ar.exact(math.cos(math.pi * (k + 0.75) / (n + 0.5)))
        for _ in range(12):
            p0, p1 = ar.exact(1), x
            for m in range(2, n + 1):
                p0, p1 = p1, ((2 * m - 1) * x * p1 - (m - 1) * p0) / m
            slope = n * (x * p1 - p0) / (x * x - 1)
            x = x - p1 / slope
        pairs.append((x, 2 / ((1 - x * x) * slope * slope)))
    return pairs


def roughness(knots, degree):
    """Matrix of integral (S_xx^2 + 2 S_xy^2 + S_yy^2) over the domain, in the order of `row`."""
    x = [gram(knots[0], degree[0], d) for d in range(3)]
    y = [gram(knots[1], degree[1], d) for d in range(3)]
    n, m = len(x[0]), len(y[0])
    return [
        [x[2][i][k] * y[0][j][l] + 2 * x[1][i][k] * y[1][j][l] + x[0][i][k] * y[2][j][l] for k in range(n) for l in range(m)]
        for i in range(n)
        for j in range(m)
    ]
