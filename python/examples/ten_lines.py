"""Ten lines: noisy touches of a bar of radius 25 in, its shape with intervals out."""

import numpy as np

import palpate

random = np.random.default_rng(4)
x, y = random.uniform(-6, 6, (2, 60))
z = np.sqrt(25**2 - x**2) - 25 + 0.05 * random.standard_normal(60)
normals = np.column_stack([x / 25, 0 * x, 1 + z / 25]) + 0.05 * random.standard_normal((60, 3))
fit = palpate.fit(x, y, z, normals=normals)
print(fit)
print(f"radius {fit.shape.radius:.1f}, between {fit.shape.radius_interval[0]:.1f} and {fit.shape.radius_interval[1]:.1f}")
print("height in the middle and its slope along x:", fit.surface.ev(0.0, 0.0), fit.surface.ev(0.0, 0.0, dx=1))
