#!/usr/bin/env python3
"""Screened Poisson as MeshLab has it, and distances to it and to our crust.

    compare_pymeshlab.py FOLDER NAME [NAME ...]

For each case FOLDER holds, little-endian and without headers,

    NAME.samples.f64          the samples, three numbers each
    NAME.truth.f64            many points of the true surface
    NAME.edges.f64            points of its sharp edges, possibly none
    NAME.crust.vertices.f64   our mesh,
    NAME.crust.triangles.u32  three indices each

This program estimates normals from the samples alone, runs screened Poisson
with its defaults, leaves NAME.poisson.vertices.f64 and
NAME.poisson.triangles.u32 and prints one JSON object: for each case and each
of `crust` and `poisson` the mean and largest distance from the samples, from
the truth and from the edges to the mesh, and the number of crossing triangles.
`tests/pymeshlab.rs` makes the cases and judges the numbers.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pymeshlab as ml


def main() -> None:
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    print(json.dumps({name: compare(folder, name) for name in sys.argv[2:]}))


def compare(folder: Path, name: str) -> dict:
    read = lambda part, kind: np.fromfile(folder / f"{name}.{part}", kind).reshape(-1, 3)
    clouds = {key: read(f"{key}.f64", "<f8") for key in ("samples", "truth", "edges")}
    crust = read("crust.vertices.f64", "<f8"), read("crust.triangles.u32", "<u4")
    peer = poisson(clouds["samples"])
    peer[0].astype("<f8").tofile(folder / f"{name}.poisson.vertices.f64")
    peer[1].astype("<u4").tofile(folder / f"{name}.poisson.triangles.u32")
    return {key: measure(mesh, clouds) for key, mesh in (("crust", crust), ("poisson", peer))}


def poisson(samples: np.ndarray):
    """Vertices and triangles of the surface through the samples' neighbourhood."""
    meshes = ml.MeshSet()
    meshes.add_mesh(ml.Mesh(samples))
    meshes.compute_normal_for_point_clouds(k=12)
    meshes.generate_surface_reconstruction_screened_poisson()
    mesh = meshes.current_mesh()
    vertices, triangles = mesh.vertex_matrix(), mesh.face_matrix()
    if len(triangles) == 0:
        sys.exit("screened Poisson gave no triangles")
    # The estimated normals agree among themselves; which way is chance.
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    if np.einsum("ij,ij", p, np.cross(q, r)) < 0:
        triangles = triangles[:, ::-1]
    return np.ascontiguousarray(vertices), np.ascontiguousarray(triangles)


def measure(mesh, clouds: dict) -> dict:
    vertices, triangles = mesh
    meshes = ml.MeshSet()
    meshes.add_mesh(ml.Mesh(vertices, triangles.astype(np.int32)))
    meshes.compute_selection_by_self_intersections_per_face()
    found = {"crossing": meshes.current_mesh().selected_face_number()}
    for key, points in clouds.items():
        if len(points) == 0:
            continue
        meshes.add_mesh(ml.Mesh(points))
        distance = meshes.get_hausdorff_distance(
            sampledmesh=meshes.current_mesh_id(), targetmesh=0, samplevert=True,
            sampleedge=False, sampleface=False, samplenum=len(points),
            maxdist=ml.PercentageValue(100),
        )
        if distance["n_samples"] < len(points):
            sys.exit(f"only {distance['n_samples']} of {len(points)} points were measured")
        found[key] = {"mean": distance["mean"], "max": distance["max"]}
    return found


if __name__ == "__main__":
    main()
