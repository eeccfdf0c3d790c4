"""Who takes part, and how each is run.

A contestant has a `name`, `surface` and `parallel` (whether it makes one, and can use threads), `prepare(scratch)`, which says
why it cannot run or returns None, and `run(files, threads)`, which returns numbers by part:
seconds of the stages it tells apart, and of the whole process `wall` and `cpu` seconds and
`peak MB`. Stages of the same name do the same work.
"""

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path

import harness
from benchmark import peers
from benchmark.cases import Files

LIMIT_S = 3600


def finish(command: list, cpus: int = 0) -> tuple:
    """A run that succeeded, and its process's numbers."""
    done = harness.run(command, LIMIT_S, cpus)
    if done.code != 0:
        raise RuntimeError(f"exit {done.code}: {done.errors.strip()[-200:]}")
    return done, {"wall": done.seconds, "cpu": done.cpu_seconds, "peak MB": done.peak_mb}


def parts(output: str) -> dict:
    """Lines of a name and seconds; others are passed over."""
    words = (line.split() for line in output.splitlines())
    return {pair[0]: float(pair[1]) for pair in words if len(pair) == 2}


class Powercrust:
    """Points to mesh by the command, files included."""

    name, surface, parallel = "powercrust", True, True

    def __init__(self, options):
        self.binary = options.binary

    def prepare(self, scratch: Path):
        self.binary = harness.require_binary(self.binary)
        self.mesh = scratch / "crust.ply"

    def run(self, files: Files, threads: int) -> dict:
        done, stats = harness.reconstruct(
            self.binary, files.npy, self.mesh, "--threads", threads, limit_s=LIMIT_S
        )
        if done.code != 0 or stats is None:
            raise RuntimeError(f"exit {done.code}: {done.errors.strip()[-200:]}")
        stages = harness.stage_seconds(stats)
        return {**stages, **dict(stats["stats"]["part_seconds"]), "stages": sum(stages.values()), "wall": done.seconds,
                "cpu": done.cpu_seconds, "peak MB": done.peak_mb,
                "foretold MB": self.foretold(files)}

    def foretold(self, files: Files) -> float:
        done = harness.run([self.binary, files.npy, "-o", self.mesh, "--dry-run", "--json"])
        return json.loads(done.output)["estimate"]["memory_bytes"] / 2**20


class Kernel:
    """Our two triangulations alone, of the samples and of all their polar balls."""

    name, surface, parallel = "kernel", False, True

    def __init__(self, options):
        self.program = options.binary.parent / "examples" / "triangulations"

    def prepare(self, _: Path):
        if not self.program.is_file():
            return f"{self.program} is not there: cargo build --release --examples"
        self.program = self.program.resolve()

    def run(self, files: Files, threads: int) -> dict:
        done, process = finish([self.program, files.raw, threads])
        found = parts(done.output)
        return {**found, "delaunay us": 1e6 * found["delaunay"] / files.points, **process}


class Cgal:
    """The same by CGAL, with its inexact circumcentres; one thread."""

    name, surface, parallel = "CGAL", False, False

    def __init__(self, _):
        pass

    def prepare(self, scratch: Path):
        if shutil.which("g++") is None or not Path("/usr/include/CGAL").is_dir():
            return "g++ or libcgal-dev is not installed"
        source = scratch / "cgal_dt_rt.cpp"
        shutil.copy(harness.shared() / "checks" / source.name, source)
        self.program = scratch / "cgal_dt_rt"
        built = subprocess.run(
            ["g++", "-O3", "-march=native", "-DNDEBUG", source, "-o", self.program,
             "-lgmp", "-lmpfr"], capture_output=True, text=True,
        )
        return None if built.returncode == 0 else f"does not build: {built.stderr[:300]}"

    def run(self, files: Files, _: int) -> dict:
        done, process = finish([self.program, files.raw])
        found = parts(done.output)
        found["power"] = found.pop("regular")  # our name for that stage
        return {**found, **process}


class Peer:
    """A library with a Python interface, in a process of its own from points to mesh file."""

    surface, parallel = True, True

    def __init__(self, _):
        pass

    def prepare(self, scratch: Path):
        self.mesh = scratch / f"{self.name}.ply"
        if importlib.util.find_spec(self.module) is None:
            return f"{sys.executable} lacks {self.module}"

    def run(self, files: Files, threads: int) -> dict:
        # Held to as many processors as it may use threads: not all of them can be told.
        command = [sys.executable, peers.__file__, self.name, files.npy, self.mesh, threads]
        done, process = finish(command, cpus=threads)
        return {**parts(done.output), **process}


class MeshLib(Peer):
    """MeshLib's triangulation of points: a surface, not always closed."""

    name, module = "MeshLib", "meshlib"


class Poisson(Peer):
    """Normals and screened Poisson at depth 10 by pymeshlab: smooths the samples."""

    name, module = "Poisson", "pymeshlab"


CONTESTANTS = [Powercrust, Kernel, Cgal, MeshLib, Poisson]
