"""The written problem of one case in high precision: coefficients, fitted values, S and R on the shape grid.

    slope rows    wz (z - S), wx (zx - S_x), wy (zy - S_y)                                      weights times the contact's own
    tangent       wz = 1 / (half the domain's larger side), wx = wy = 10
    normal rows   (z - S) / Z,  (n - n^(S_x, S_y)) / sigma                   Gauss-Newton with step halving, to convergence
    unsupported   among the minimisers the one of least thin-plate roughness, where that is unique
"""
import arithmetic as ar
import least_squares
import shape
import splines

UNIT_ROUNDOFF = 2.0**-53


class Reference:
    """Solves on construction; `answer()` is the golden file's content."""

    def __init__(self, case):
        self.case = case
        self.steps = 0
        if case.rows is not None:
            self.prepare_dense()
            self.solution = least_squares.solve(self.rows, self.rhs)
            self.coefficients, self.unique = self.solution.coefficients, self.solution.rank == len(self.rows[0])
            self.gauge = "none"
            return
        self.prepare_spline()
        if case.objective[0] == "normals":
            self.gauss_newton()
        else:
            self.rows, self.rhs = self.slope_rows()
            self.solution = least_squares.solve(self.rows, self.rhs)
            self.coefficients = self.solution.coefficients
        self.settle_null_space()

    # -- preparation ------------------------------------------------------------------------------------------------

    def prepare_dense(self):
        self.rows = [[ar.exact(v) for v in row] for row in self.case.rows]
        self.rhs = [ar.exact(v) for v in self.case.rhs]

    def prepare_spline(self):
        case = self.case
        points = [(a, b) for a in case.x for b in case.y] if case.is_grid else list(zip(case.x, case.y))
        self.points = points
        xs, ys = [p[0] for p in points], [p[1] for p in points]
        self.domain = case.domain or [min(xs), max(xs), min(ys), max(ys)]
        if case.knots is not None:
            self.knots = case.knots
        else:
            d = self.domain
            self.knots = (
                splines.uniform_knots(d[0], d[1], case.degree[0], case.segments[0]),
                splines.uniform_knots(d[2], d[3], case.degree[1], case.segments[1]),
            )
        cache = [{}, {}]
        self.bases = [(self.basis(0, x, cache[0]), self.basis(1, y, cache[1])) for x, y in points]

    def basis(self, axis, value, cache):
        if value not in cache:
            cache[value] = splines.basis(self.knots[axis], self.case.degree[axis], value)
        return cache[value]

    def block_weights(self):
        """wz, wx, wy of the objective."""
        if self.case.objective[0] == "tangent":
            d = [ar.exact(v) for v in self.domain]
            return [2 / max(d[1] - d[0], d[3] - d[2]), ar.exact(10), ar.exact(10)]
        return [ar.exact(v) for v in self.case.objective[1:]]

    def contact_weight(self, block, r):
        column = self.case.weights[block]
        return ar.exact(1) if column is None else ar.exact(column[r])

    def slopes(self, r):
        """Measured slopes of contact r, or None."""
        if self.case.slopes is not None:
            return [ar.exact(c[r]) for c in self.case.slopes]
        if self.case.normals is not None:
            n = [ar.exact(c[r]) for c in self.case.normals]
            return [-n[0] / n[2], -n[1] / n[2]]
        return None

    def slope_rows(self, only_heights=False, weights=None):
        weights = weights or self.block_weights()
        rows, rhs = [], []
        for r, (bx, by) in enumerate(self.bases):
            slopes = None if only_heights else self.slopes(r)
            wanted = [(weights[0], 0, 0, ar.exact(self.case.z[r]))]
            if slopes is not None:
                wanted += [(weights[1], 1, 0, slopes[0]), (weights[2], 0, 1, slopes[1])]
            for block, (weight, dx, dy, value) in enumerate(wanted):
                w = weight * self.contact_weight(block, r)
                if w != 0:
                    rows.append([w * v for v in splines.row(bx[dx], by[dy])])
                    rhs.append(w * value)
        return rows, rhs

    # -- normal rows ------------------------------------------------------------------------------------------------

    def unit_normal(self, r):
        n = [ar.exact(c[r]) for c in self.case.normals]
        length = ar.sqrt(sum((v * v for v in n), ar.exact(0)))
        return [v / length for v in n]

    def normal_residuals(self, c, jacobian):
        """Weighted residuals b - model(c), and with `jacobian` the rows of d model / d c."""
        z_sigma, degrees = [ar.exact(v) for v in self.case.objective[1:]]
        sigma = degrees * ar.pi() / 180
        rows, rhs = [], []
        for r, (bx, by) in enumerate(self.bases):
            height, slope_x, slope_y = (splines.row(bx[a], by[b]) for a, b in ((0, 0), (1, 0), (0, 1)))
            zx, zy = least_squares.dot(slope_x, c), least_squares.dot(slope_y, c)
            length = ar.sqrt(1 + zx * zx + zy * zy)
            model = [-zx / length, -zy / length, 1 / length]
            rhs.append((ar.exact(self.case.z[r]) - least_squares.dot(height, c)) / z_sigma)
            rhs += [(n - m) / sigma for n, m in zip(self.unit_normal(r), model)]
            if jacobian:
                rows.append([v / z_sigma for v in height])
                cube = length * length * length
                by_zx = [-(1 + zy * zy) / cube, zx * zy / cube, -zx / cube]
                by_zy = [zx * zy / cube, -(1 + zx * zx) / cube, -zy / cube]
                for a, b in zip(by_zx, by_zy):
                    rows.append([(a * u + b * v) / sigma for u, v in zip(slope_x, slope_y)])
        return rows, rhs

    def gauss_newton(self):
        start = least_squares.solve(*self.slope_rows(only_heights=True, weights=[ar.exact(1)] * 3))
        c = start.coefficients
        if start.rank < len(c):
            c = least_squares.solve(*self.slope_rows(weights=[ar.exact(1)] * 3)).coefficients
        small = ar.decimal("1e-36")
        for self.steps in range(1, 2000):
            rows, rhs = self.normal_residuals(c, jacobian=True)
            solution = least_squares.solve(rows, rhs)
            step = solution.coefficients
            if max(map(abs, step)) <= small * max(map(abs, c)):
                break
            before, factor = least_squares.dot(rhs, rhs), ar.exact(1)
            while True:
                trial = [v + factor * s for v, s in zip(c, step)]
                after = self.normal_residuals(trial, jacobian=False)[1]
                if least_squares.dot(after, after) <= before or factor < ar.decimal("1e-30"):
                    break
                factor = factor / 2
            c = trial
        else:
            raise RuntimeError(self.case.name + ": Gauss-Newton did not converge")
        self.rows, self.rhs, self.solution, self.coefficients = rows, rhs, solution, c

    # -- what the data leave free -----------------------------------------------------------------------------------

    def settle_null_space(self):
        null_space = self.solution.null_space
        self.gauge, self.unique = "none", True
        if not null_space:
            return
        total = sum(map(abs, null_space[0]), ar.exact(0)) if len(null_space) == 1 else None
        if total is not None and all(abs(v - null_space[0][0]) < ar.decimal("1e-25") * total for v in null_space[0]):
            self.gauge = "constant"
            first = self.coefficients[0]
            self.coefficients = [v - first for v in self.coefficients]
            return
        rough = splines.roughness(self.knots, self.case.degree)
        images = [[least_squares.dot(row, z) for row in rough] for z in null_space]
        normal = [[least_squares.dot(a, z) for z in null_space] for a in images]
        rhs = [-least_squares.dot(a, self.coefficients) for a in images]
        best = least_squares.solve(normal, rhs)
        self.gauge = "least roughness"
        self.unique = best.rank == len(null_space)
        for t, z in zip(best.coefficients, null_space):
            self.coefficients = [c + t * v for c, v in zip(self.coefficients, z)]

    # -- answers ----------------------------------------------------------------------------------------------------

    def relative_loss(self):
        """kappa + kappa^2 |r| / (|E| |c|), equilibrated columns: relative change of c per relative change of the data."""
        s = self.solution
        kappa = s.condition
        residual = self.rhs if self.case.objective[0] == "normals" else s.residual
        size = ar.sqrt(sum(((v * d) ** 2 for v, d in zip(self.coefficients, s.column_norms)), ar.exact(0)))
        norm_r = ar.sqrt(least_squares.dot(residual, residual))
        if size == 0:
            return kappa, kappa
        return kappa, kappa + kappa * kappa * norm_r / (s.matrix_norm * size)

    def answer(self):
        s = self.solution
        kappa, loss = self.relative_loss()
        residual = self.rhs if self.case.objective[0] == "normals" else s.residual
        out = {
            "equations": len(self.rows),
            "unknowns": len(self.rows[0]),
            "rank": s.rank,
            "condition": float(kappa),
            "loss": float(loss),
            "weighted_residual": ar.text(ar.sqrt(least_squares.dot(residual, residual))),
        }
        if self.case.rows is not None:
            out["coefficients"] = [ar.text(v) for v in self.coefficients]
            return out
        out.update(gauge=self.gauge, steps=self.steps)
        out["coefficients"] = [ar.text(v) for v in self.coefficients] if self.unique else None
        out["fitted"] = self.fitted()
        if self.unique:
            out.update(self.maps(loss))
        return out

    def fitted(self):
        """S at the contacts: determined at any rank (up to the gauge)."""
        every = max(1, len(self.bases) // 100)
        heights = [least_squares.dot(splines.row(bx[0], by[0]), self.coefficients) for bx, by in self.bases[::every]]
        return {"every": every, "heights": [ar.text(h) for h in heights]}

    def maps(self, loss):
        case, d = self.case, self.domain
        ax = shape.grid_axis(d[0], d[1], case.inset, case.grid[0])
        ay = shape.grid_axis(d[2], d[3], case.inset, case.grid[1])
        bx = [splines.basis(self.knots[0], case.degree[0], v) for v in ax]
        by = [splines.basis(self.knots[1], case.degree[1], v) for v in ay]
        largest = max(abs(v * n) for v, n in zip(self.coefficients, self.solution.column_norms))
        shift = ar.exact(UNIT_ROUNDOFF) * loss * largest
        s_map, r_map, s_moves, r_moves = [], [], ar.exact(0), ar.exact(0)
        for px in bx:
            for py in by:
                rows = [splines.row(px[a], py[b]) for a, b in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))]
                d5 = [least_squares.dot(row, self.coefficients) for row in rows]
                s, r = (None, ar.exact(0)) if self.is_flat(d5) else shape.shape(*d5)
                s_map.append(s)
                r_map.append(r)
                if s is not None:
                    ds, dr = self.gradient(d5, s, r, rows)
                    s_moves, r_moves = max(s_moves, ds * shift), max(r_moves, dr * shift / r)
        return {
            "domain": d,
            "S": [None if v is None else ar.text(v) for v in s_map],
            "R": [ar.text(v) for v in r_map],
            "allowed": {"S": float(s_moves), "R": float(r_moves)},
        }

    def is_flat(self, d5):
        """Second derivatives that are rounding of this precision: exactly zero in the written problem."""
        d = [ar.exact(v) for v in self.domain]
        sides = (d[1] - d[0], d[3] - d[2])
        bend = max(abs(d5[2]) * sides[0] ** 2, abs(d5[3]) * sides[0] * sides[1], abs(d5[4]) * sides[1] ** 2)
        return bend <= ar.decimal("1e-40") * max(map(abs, self.coefficients))

    def gradient(self, d5, s, r, rows):
        """|dS/dc|, |dR/dc| in equilibrated coefficients, by differences (half the digits of the working precision)."""
        size = max(map(abs, d5))
        by_s, by_r = [], []
        for k in range(5):
            step = (size if size != 0 else ar.exact(1)) * ar.decimal("1e-25")
            moved = list(d5)
            moved[k] = moved[k] + step
            s1, r1 = shape.shape(*moved)
            by_s.append((s1 - s) / step)
            by_r.append((r1 - r) / step)
        norms = self.solution.column_norms
        total_s = total_r = ar.exact(0)
        for j in range(len(norms)):
            column = [row[j] for row in rows]
            total_s += (least_squares.dot(by_s, column) / norms[j]) ** 2
            total_r += (least_squares.dot(by_r, column) / norms[j]) ** 2
        return ar.sqrt(total_s), ar.sqrt(total_r)
