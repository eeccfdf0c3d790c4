"""The inputs: points of known kinds, the same in every run."""

from dataclasses import dataclass
from pathlib import Path

import harness


@dataclass(frozen=True)
class Case:
    """An input and how many points it should have."""

    name: str
    points: int

    def __str__(self):
        return f"{self.name} {short(self.points)}"


@dataclass
class Files:
    """A case on disk: raw f64 triples and a NumPy array file."""

    case: Case
    points: int
    raw: Path
    npy: Path


def write(case: Case, scratch: Path) -> Files:
    import numpy as np

    points = np.ascontiguousarray(INPUTS[case.name](case.points), dtype="<f8")
    stem = str(case).replace(" ", "_")
    files = Files(case, len(points), scratch / f"{stem}.f64", scratch / f"{stem}.npy")
    points.tofile(files.raw)
    np.save(files.npy, points)
    return files


def ellipsoid(count: int):
    """Samples of the ellipsoid 1:2:3, uniform by area."""
    import numpy as np

    random, axes, kept = np.random.default_rng(1), np.array([1.0, 2.0, 3.0]), []
    while sum(map(len, kept)) < count:
        u = random.normal(size=(count, 3))
        u /= np.linalg.norm(u, axis=1)[:, None]
        # The map to the ellipsoid stretches areas in proportion to |u / axes|.
        kept.append(axes * u[random.random(count) < np.linalg.norm(u / axes, axis=1)])
    return np.concatenate(kept)[:count]


def torus(count: int):
    """Samples of a torus: where the medial axis is a curve (fact F6)."""
    import numpy as np

    random, major, minor = np.random.default_rng(2), 1.0, 0.4
    u, v, w = random.random((3, 3 * count))
    keep = w * (major + minor) < major + minor * np.cos(2 * np.pi * v)
    u, v = 2 * np.pi * u[keep][:count], 2 * np.pi * v[keep][:count]
    rho = major + minor * np.cos(v)
    return np.column_stack([rho * np.cos(u), rho * np.sin(u), minor * np.sin(v)])


def bunny(count: int):
    """The vertices of the Stanford bunny, at most 35k."""
    return thin(harness.shared() / "scans" / "meshes" / "bunny_closed.ply", count)


def scans(count: int):
    """The bunny as ten overlapping scans, at most 362k."""
    return thin(harness.shared() / "scans" / "clouds" / "bunny_10scans.ply", count)


def thin(path: Path, count: int):
    points = harness.read_points(path)
    return points[:: max(1, len(points) // count)]


def cube(count: int):
    """Uniform in a cube: no surface, all kernel."""
    import numpy as np

    return np.random.default_rng(3).random((count, 3))


def grid(count: int):
    """The largest cubic grid of integers with at most so many points."""
    import numpy as np

    side = int(count ** (1 / 3) + 1e-9)
    return np.stack(np.meshgrid(*3 * [np.arange(side)]), axis=-1).reshape(-1, 3)


# Squares of radii by the number of integer points on the sphere.
SPHERES = {18_432: 4_849_845, 92_160: 90_000_018}


def cospherical(count: int):
    """All integer points of a sphere, 18,432 or 92,160: every in-sphere test is zero."""
    import numpy as np

    square = SPHERES[max((size for size in SPHERES if size <= count), default=min(SPHERES))]
    half, found = int(square**0.5), []
    for x in range(-half, half + 1):
        rest = square - x * x
        y = np.arange(-int(rest**0.5), int(rest**0.5) + 1)
        z = np.rint(np.sqrt(rest - y * y)).astype(np.int64)
        hit = z * z == rest - y * y
        for side in (1, -1):
            found.append(np.column_stack([np.full(hit.sum(), x), y[hit], side * z[hit]]))
    return np.unique(np.concatenate(found), axis=0)


def rounded(count: int):
    """Random on a sphere, rounded to integers of at most 1000: close to cospherical."""
    import numpy as np

    u = np.random.default_rng(4).normal(size=(count, 3))
    return np.rint(1000 * u / np.linalg.norm(u, axis=1)[:, None])


INPUTS = {make.__name__: make for make in
          (ellipsoid, torus, bunny, scans, cube, grid, cospherical, rounded)}
# No solid is bounded by these: contestants that make surfaces are not asked.
SHAPELESS = {"cube", "grid"}


def short(count: int) -> str:
    for size, letter in ((1_000_000, "M"), (1000, "k")):
        if count >= size:
            return f"{count / size:.4g}{letter}"
    return str(count)


def number(text: str) -> int:
    """10k, 1M, 2500."""
    factor = {"k": 1000, "M": 1_000_000}.get(text[-1:], 1)
    return round(float(text[:-1] if factor > 1 else text) * factor)
