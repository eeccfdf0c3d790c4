"""What the scripts share: places, runs with time and memory, the judge, tables."""

import contextlib
import csv
import importlib.util
import io
import json
import os
import struct
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def shared() -> Path:
    """The folder of scans and checks that lies beside a checkout."""
    place = Path(os.environ.get("POWERCRUST_SHARED", ROOT.parent / "shared"))
    if not (place / "scans").is_dir():
        sys.exit(f"{place} holds no scans: set POWERCRUST_SHARED")
    return place


def add_binary_option(parser) -> None:
    parser.add_argument(
        "--binary",
        type=Path,
        default=ROOT / "target" / "release" / "powercrust",
        help="the program to run (default: the release build)",
    )


def require_binary(path: Path) -> Path:
    if not path.is_file():
        sys.exit(f"{path} is not there: cargo build --release")
    return path.resolve()


@dataclass
class Run:
    """One finished process."""

    code: int  # negative: ended by that signal
    seconds: float
    cpu_seconds: float
    peak_mb: float
    output: str
    errors: str
    timed_out: bool


def run(command: list, limit_s: float = 600, cpus: int = 0) -> Run:
    """Runs a command with wall time, processor time and peak memory of that process alone,
    on so many processors (0: all)."""
    reading, writing = os.pipe()
    launcher = [sys.executable, "-I", "-S", ROOT / "scripts" / "launch.py", writing, limit_s, cpus]
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        done = subprocess.run(
            [str(word) for word in launcher + command], stdin=subprocess.DEVNULL, stdout=out,
            stderr=err, pass_fds=[writing],
        )
        os.close(writing)
        with open(reading) as pipe:
            report = pipe.read().split()
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read().decode("utf-8", "replace"))
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]} could not be run: {texts[1].strip()[-200:]}")
    status, seconds, cpu_seconds, kilobytes, expired = map(float, report)
    return Run(
        os.waitstatus_to_exitcode(int(status)), seconds, cpu_seconds, kilobytes / 1024,
        *texts, bool(expired),
    )


def reconstruct(binary: Path, cloud: Path, mesh: Path, *options, limit_s: float = 600):
    """Points to mesh with our program: the run, and its statistics or None."""
    stats = mesh.with_suffix(".json")
    stats.unlink(missing_ok=True)
    mesh.unlink(missing_ok=True)
    done = run([binary, cloud, "-o", mesh, "--stats", stats, *options], limit_s)
    found = json.loads(stats.read_text()) if stats.is_file() else None
    return done, found


def stage_seconds(stats: dict) -> dict:
    """Seconds by stage, in order."""
    return dict(stats["stats"]["seconds"])


def judge_module():
    """check_mesh.py as a module: it shares no code with this project."""
    if "check_mesh" not in sys.modules:
        place = shared() / "checks" / "check_mesh.py"
        spec = importlib.util.spec_from_file_location("check_mesh", place)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        sys.modules["check_mesh"] = module
    return sys.modules["check_mesh"]


def judge(mesh: Path, *options) -> dict:
    """The verdict of shared/checks/check_mesh.py; `failures` lists what is wrong.

    In this process, for to start another and load MeshLab takes it longer than
    to look at a small mesh.
    """
    module, said, words = judge_module(), io.StringIO(), sys.argv
    sys.argv = ["check_mesh.py", str(mesh), *map(str, options)]
    try:
        with contextlib.redirect_stdout(said):
            module.main()
    except SystemExit:
        pass
    except Exception as error:  # whatever it is, it is no verdict
        return {"failures": [f"the judge failed: {error!r}"]}
    finally:
        sys.argv = words
    try:
        return json.loads(said.getvalue())
    except json.JSONDecodeError:
        return {"failures": ["the judge failed: it said nothing"]}


def require_modules(*names: str) -> None:
    """Ends the program when the Python in use lacks a module."""
    lacking = [name for name in names if importlib.util.find_spec(name) is None]
    if lacking:
        sys.exit(f"{sys.executable} lacks {', '.join(lacking)}: pip install {' '.join(lacking)}")


def truths() -> dict:
    """TRUTH.csv by file name."""
    with open(shared() / "scans" / "TRUTH.csv", newline="") as rows:
        return {row["file"]: row for row in csv.DictReader(rows)}


def read_points(path: Path):
    """The finite points of a cloud, read without any code of the project."""
    import numpy as np

    if path.suffix == ".ply":
        from plyfile import PlyData

        vertices = PlyData.read(str(path))["vertex"]
        points = np.column_stack([np.asarray(vertices[k], np.float64) for k in "xyz"])
    elif path.suffix == ".las":
        points = las_points(path.read_bytes())
    elif path.suffix == ".pcd":
        points = pcd_points(path.read_bytes())
    else:
        rows = []
        for line in path.read_text(errors="replace").splitlines():
            words = line.split()
            if words and words[0] in ("p", "v"):
                words = words[1:]
            try:
                row = [float(word) for word in words[:3]]
            except ValueError:
                continue
            if len(row) == 3:
                rows.append(row)
        points = np.array(rows, np.float64).reshape(-1, 3)
    return points[np.isfinite(points).all(axis=1)]


def las_points(data: bytes):
    """The points of an uncompressed LAS file."""
    import numpy as np

    start, = struct.unpack_from("<I", data, 96)
    length, count = struct.unpack_from("<HI", data, 105)
    numbers = np.frombuffer(data, np.uint8, count * length, start).reshape(count, length)
    whole = numbers[:, :12].copy().view("<i4")
    scale, offset = np.frombuffer(data, "<f8", 6, 131).reshape(2, 3)
    return whole * scale + offset


def pcd_points(data: bytes):
    """The points of a compressed PCD file whose fields are x y z in 32 bits."""
    import numpy as np

    head, _, body = data.partition(b"DATA binary_compressed\n")
    if b"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F" not in head:
        raise ValueError("not a PCD file of the kind this knows")
    packed, size = struct.unpack_from("<II", body)
    body, out, at = body[8:8 + packed], bytearray(), 0
    while at < len(body):
        control, at = body[at], at + 1
        if control < 32:
            out += body[at:at + control + 1]
            at += control + 1
            continue
        length = control >> 5
        if length == 7:
            length, at = length + body[at], at + 1
        start = len(out) - ((control & 31) << 8 | body[at]) - 1
        at += 1
        for k in range(start, start + length + 2):
            out.append(out[k])
    assert len(out) == size
    return np.frombuffer(bytes(out), "<f4").reshape(3, -1).T.astype(np.float64)


CLOUD_FORMATS = (".ply", ".xyz", ".pts", ".pwn", ".txt", ".csv", ".npy", ".obj", ".off", ".stl", ".pcd",
                 ".las")


def clouds(names, most: int) -> list:
    """The shared clouds whose names hold one of `names`, all if there are none;
    with what TRUTH.csv says of each. Those of more points are told and left."""
    folder, known = shared() / "scans" / "clouds", truths()
    found = sorted(p for p in folder.iterdir() if p.suffix in CLOUD_FORMATS)
    if names:
        found = [p for p in found if any(name in p.name for name in names)]
    kept = []
    for path in found:
        truth = known[f"clouds/{path.name}"]
        if int(truth["points"]) > most:
            print(f"(skipped {path.name}: {truth['points']} points, --most says {most})",
                  file=sys.stderr)
        else:
            kept.append((path, truth))
    return kept


class Table:
    """A markdown table, printed row by row while the work goes on."""

    def __init__(self, *heads: str):
        print("| " + " | ".join(heads) + " |")
        print("|" + " --- |" * len(heads), flush=True)

    def row(self, *cells) -> None:
        texts = (str(cell).replace("|", "\\|").replace("\n", " ") for cell in cells)
        print("| " + " | ".join(texts) + " |", flush=True)
