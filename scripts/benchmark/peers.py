"""One run of a peer with a Python interface: peers.py NAME POINTS.npy MESH.ply THREADS.

Prints a name and seconds for each step.
"""

import os
import sys
import time


def meshlib(points, mesh: str, _: int):
    from meshlib import mrmeshnumpy, mrmeshpy

    yield "import"
    cloud = mrmeshnumpy.pointCloudFromPoints(points)
    surface = mrmeshpy.triangulatePointCloud(cloud)
    if surface is None:
        sys.exit("no triangulation")
    yield "triangulate"
    mrmeshpy.saveMesh(surface, mesh)
    yield "write"


def poisson(points, mesh: str, threads: int):
    # Its threads wait for each other in a loop, for minutes where others want the processors.
    os.environ["OMP_WAIT_POLICY"] = "passive"
    import pymeshlab

    yield "import"
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(points))
    meshes.compute_normal_for_point_clouds()
    yield "normals"
    meshes.generate_surface_reconstruction_screened_poisson(depth=10, threads=threads)
    yield "poisson"
    meshes.save_current_mesh(mesh)
    yield "write"


def main() -> None:
    import numpy as np

    name, source, mesh, threads = sys.argv[1:]
    steps = {"MeshLib": meshlib, "Poisson": poisson}[name]
    start = time.perf_counter()
    for step in steps(np.load(source), mesh, int(threads)):
        now = time.perf_counter()
        print(step, f"{now - start:.4f}")
        start = now


if __name__ == "__main__":
    main()
