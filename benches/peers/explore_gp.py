"""Contacts until S and R are right, by a Gaussian process that touches where its height is least certain.

    f(x, y) ~ GP(0, c^2 (1 + x x' + y y') + s^2 exp(-(x - x')^2 / 2 a^2 - (y - y')^2 / 2 b^2))

The process is tinygp's on JAX: covariance, marginal likelihood, posterior mean and variance. Every contact gives three
observations, its height and both slopes, with the covariance that an error of the normal has there; `Observed` is the kernel
of tinygp's tutorial on derivative observations, for two coordinates. The noise sds are given; s, a, b maximise the marginal
likelihood before every round (SciPy's L-BFGS with JAX's gradient, from two starts). The next touches are the candidates of
the largest posterior variance of the height, one after the other. S and R are means over 8 x 8 points of the patch, from the
posterior mean's first and second derivatives.

    cargo bench --bench explore -- export OBJECTS NOISES FIRST > touched.csv
    python benches/peers/explore_gp.py touched.csv [PROCESSES]
    python benches/peers/explore_gp_check.py touched.csv        # the process beside a closed form
"""

import os
import sys
from multiprocessing import get_context

# one core a process, which is what the README's time is of
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false")

import jax
import jax.numpy as jnp
import numpy as np
from scipy.optimize import minimize
from tinygp import GaussianProcess, kernels, noise, transforms

jax.config.update("jax_enable_x64", True)

BUDGET, PER_ROUND, HALF = 60, 3, 4.0
SIGMA_Z, SIGMA_N = 0.02, 0.03
RIGHT = (0.01, 0.02)
KINDS = ["sphere", "cylinder", "saddle", "torus", "bump", "superquadric"]
FIRST = [0, 10, 20, 210, 220, 230, 420, 430, 440]  # 3 x 3 of 21 x 21
WIDE = 10.0  # c: next to no prior on height and tilt
START = np.log([np.exp(2.0), 10.0, 10.0])  # s^2, a, b where the first round starts; later ones start at the last's end, too
BOUNDS = [(-8, 12), (0.0, 5.0), (0.0, 5.0)]  # of their logarithms
ROOM = 15  # contacts are filled up to a multiple of it: four shapes are compiled, not twenty
HEIGHT, SLOPES = np.array([1.0, 0, 0]), np.eye(3)[1:]


class Observed(kernels.Kernel):
    """Covariance of u0 f + u1 f_x + u2 f_y at one place with the like at another; all zero is no observation."""

    surface: kernels.Kernel

    def evaluate(self, one, other):
        (p, u), (q, v) = one, other

        def left(q):
            value, slope = jax.jvp(lambda p: self.surface.evaluate(p, q), (p,), (u[1:],))
            return u[0] * value + slope

        value, slope = jax.jvp(left, (q,), (v[1:],))
        return v[0] * value + slope


def process(log, contacts):
    at, what, covariance, _ = contacts
    s2, lengths = jnp.exp(log[0]), jnp.exp(log[1:])
    plane = WIDE**2 * (kernels.Constant(1.0) + kernels.DotProduct())
    surface = plane + transforms.Linear(1 / lengths, kernels.ExpSquared()) * s2
    return GaussianProcess(Observed(surface), (at, what), noise=noise.Dense(covariance))


def posterior(log, contacts, places):
    """The process given the contacts, its heights at the places."""
    heights = (places, jnp.tile(HEIGHT, (len(places), 1)))
    return process(log, contacts).condition(contacts[3], heights, diag=jnp.zeros(())).gp


def cost(log, contacts):
    # a weak prior on the lengths keeps the search inside what 8 by 8 can tell
    prior = 0.5 * jnp.sum(((log[1:] - jnp.log(10.0)) / 1.5) ** 2)
    return prior - process(log, contacts).log_probability(contacts[3])


@jax.jit
def variance(log, contacts, places):
    return posterior(log, contacts, places).variance


@jax.jit
def bends(log, contacts, places):
    """First and second derivatives of the posterior mean."""
    mean = posterior(log, contacts, places).mean_function
    height = lambda p: mean((p, jnp.asarray(HEIGHT)))
    return jax.vmap(jax.grad(height))(places), jax.vmap(jax.hessian(height))(places)


cost_and_slope = jax.jit(jax.value_and_grad(cost))


def contacts_of(touched, expected=np.empty((0, 2))):
    """Places, what is observed there, its noise and its values, of touches made and of touches to come.

    The variance does not ask for values, so touches to come have none; their noise is that of an upright normal.
    """
    n, m = len(touched), len(touched) + len(expected)
    room = -(-m // ROOM) * ROOM
    normal = touched[:, 3:] / np.linalg.norm(touched[:, 3:], axis=1, keepdims=True)
    p, q = np.zeros(room), np.zeros(room)
    p[:n], q[:n] = -normal[:, 0] / normal[:, 2], -normal[:, 1] / normal[:, 2]
    z, at, there = np.zeros(room), np.zeros((room, 2)), np.arange(room) < m
    z[:n], at[:m] = touched[:, 2], np.vstack([touched[:, :2], expected])
    w2 = 1 + p * p + q * q
    # an error of x and y moves the height by the slope
    covariance = np.diag(np.concatenate([np.where(there, SIGMA_Z**2 * w2, 1.0), np.ones(2 * room)]))
    for k in range(m):
        # J'J of d normal / d slope, inverted
        j = np.array([[1 + q[k] ** 2, -p[k] * q[k]], [-p[k] * q[k], 1 + p[k] ** 2]]) / w2[k] ** 2
        rows = [room + k, 2 * room + k]
        covariance[np.ix_(rows, rows)] = SIGMA_N**2 * np.linalg.inv(j)
    what = np.repeat(np.vstack([HEIGHT, SLOPES]), room, axis=0) * np.tile(there, 3)[:, None]
    return np.tile(at, (3, 1)), what, covariance, np.concatenate([z, p, q])


def learn(contacts, starts):
    def finite(log):
        value, slope = cost_and_slope(log, contacts)
        # where the factorisation breaks down the line search turns back
        return (float(value), np.asarray(slope)) if np.isfinite(value) else (1e10, np.zeros(3))

    # the likelihood has more than one maximum, and the last round's may no longer be the highest
    found = [minimize(finite, start, jac=True, method="L-BFGS-B", bounds=BOUNDS) for start in starts]
    return min(found, key=lambda end: end.fun).x


def shape(log, contacts):
    axis = np.linspace(-HALF, HALF, 8)
    slopes, second = bends(log, contacts, np.array([(x, y) for x in axis for y in axis]))
    (p, q), (r, t, u) = np.asarray(slopes).T, np.asarray(second)[:, [0, 0, 1], [0, 1, 1]].T
    w2 = 1 + p * p + q * q
    gauss = (r * u - t * t) / w2**2
    mean = ((1 + q * q) * r - 2 * p * q * t + (1 + p * p) * u) / (2 * w2**1.5)
    gap = np.sqrt(np.maximum(mean * mean - gauss, 0))
    s = -2 / np.pi * np.arctan2(mean, gap)
    return s.mean(), np.sqrt(np.maximum(2 * mean * mean - gauss, 0)).mean()


def following(log, touched, done, n):
    """Places of the largest variance of the height; a chosen one counts as touched (height and slopes)."""
    chosen = []
    for _ in range(n):
        contacts = contacts_of(touched[done], touched[chosen, :2])
        left = np.array(variance(log, contacts, touched[:, :2]))
        left[done + chosen] = -1
        chosen.append(int(np.argmax(left)))
    return chosen


def until(run):
    (seed, _, s, r), touched = run
    done, log, before = list(FIRST), START, None
    while True:
        contacts = contacts_of(touched[done])
        log = learn(contacts, [log, START])
        found = shape(log, contacts)
        right = abs(found[0] - s) <= RIGHT[0] and abs(found[1] / r - 1) <= RIGHT[1]
        if right and before is not None:
            return seed, before
        before = len(done) if right else None
        n = min(PER_ROUND, BUDGET - len(done))
        if n == 0:
            return seed, 10**9
        done += following(log, touched, done, n)


def read(path):
    lines = open(path).read().splitlines()
    for k in range(0, len(lines), 442):
        seed, noise_seed, s, r = lines[k].split(",")
        touched = np.array([[float(v) for v in line.split(",")] for line in lines[k + 1 : k + 442]])
        yield (int(seed), int(noise_seed), float(s), float(r)), touched


def quantile(counts, q):
    at = max(int(np.ceil(q * len(counts))), 1) - 1
    value = sorted(counts)[at]
    return f"> {BUDGET}" if value > BUDGET else str(value)


def main():
    processes = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    # JAX has threads of its own, which a forked process would lack
    with get_context("spawn").Pool(processes) as pool:
        found = list(pool.imap_unordered(until, read(sys.argv[1])))
    counts = [c for _, c in found]
    never = 100 * np.mean([c > BUDGET for c in counts])
    kinds = ", ".join(f"{kind} {quantile([c for o, c in found if o % 6 == k], 0.5)}" for k, kind in enumerate(KINDS))
    print(f"{'strategy':<22} {'median':>7} {'90 %':>8} {'never, %':>10}   medians by kind")
    print(f"{'Gaussian process':<22} {quantile(counts, 0.5):>7} {quantile(counts, 0.9):>8} {never:>10.1f}   {kinds}")


if __name__ == "__main__":
    main()
