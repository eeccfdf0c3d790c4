"""The goals of speed and memory, each with the runs that show whether it is met."""

import os
from dataclasses import dataclass
from statistics import median

from benchmark.cases import SPHERES, Case


@dataclass(frozen=True)
class Measure:
    """The sum of some parts of a contestant's run."""

    who: str
    threads: int
    case: Case
    parts: tuple

    def of(self, run: dict) -> float:
        return sum(run[part] for part in self.parts)


@dataclass(frozen=True)
class Goal:
    """What is measured, alone or as a ratio, and the bounds it should keep."""

    what: str
    measure: Measure
    over: Measure | None = None
    least: float | None = None
    most: float | None = None
    scale: float = 1.0
    unit: str = ""

    def measures(self):
        return [self.measure] + ([self.over] if self.over else [])

    def values(self, runs: dict) -> list:
        """One value a round; `runs` are lists of parts by contestant, threads and case."""
        lists = [[m.of(run) for run in runs[m.who, m.threads, m.case]] for m in self.measures()]
        return [self.scale * row[0] / (row[1] if self.over else 1) for row in zip(*lists)]

    def was_run(self, runs: dict) -> bool:
        return all(runs.get((m.who, m.threads, m.case)) for m in self.measures())

    def bounds(self) -> str:
        least = [f"at least {self.least:g}"] if self.least is not None else []
        most = [f"at most {self.most:g}"] if self.most is not None else []
        return ", ".join(least + most) + self.unit if least + most else ""

    def met(self, middle: float) -> bool:
        low = self.least is None or middle >= self.least
        return low and (self.most is None or middle <= self.most)


TRIANGULATIONS = ("delaunay", "power")
# What the authors' program takes for 100,000 samples on one core of such a machine.
AUTHORS_S = 35
# What is worth a line in a plot, as sums of parts.
LINES = {
    "powercrust": ("powercrust to mesh file", ("wall",)),
    "kernel": ("powercrust, triangulations", TRIANGULATIONS),
    "CGAL": ("CGAL, triangulations", TRIANGULATIONS),
    "MeshLib": ("MeshLib to mesh file", ("wall",)),
    "Poisson": ("screened Poisson to mesh file", ("wall",)),
}


def comparisons(case: Case, threads: list) -> list:
    """Ratios worth knowing of one input, whatever was run; without bounds."""
    found, one = [], threads[0]

    def add(what, who, n, parts, over, m, over_parts=None):
        found.append(Goal(f"{what}, {who} on {n} over {over} on {m}", Measure(who, n, case, parts),
                          Measure(over, m, case, over_parts or parts)))

    for n in threads:
        for part in TRIANGULATIONS:
            add(part, "kernel", n, (part,), "CGAL", 1)
        add("end to end without files over both triangulations", "powercrust", n, ("stages",),
            "CGAL", 1, TRIANGULATIONS)
        for peer in ("MeshLib", "Poisson"):
            for part in ("wall", "cpu"):
                add(f"{part}, process", "powercrust", n, (part,), peer, n)
        add("labels + crust over both triangulations", "powercrust", n, ("labels", "crust"),
            "powercrust", n, TRIANGULATIONS)
    for n in threads[1:]:
        for part in TRIANGULATIONS:
            add(part, "kernel", n, (part,), "kernel", one)
        add("end to end without files", "powercrust", n, ("stages",), "powercrust", one)
    return found


def goals(scale: float) -> list:
    """All goals, at a share of the sizes they are set for."""
    size = lambda count: max(1000, round(scale * count))
    million, cube = Case("ellipsoid", size(1_000_000)), Case("cube", size(1_000_000))
    scans, small = Case("scans", size(362_272)), Case("ellipsoid", size(100_000))
    torus = Case("torus", size(100_000))

    def against(what, part, case, most):
        ours, theirs = (Measure(who, 1, case, (part,)) for who in ("kernel", "CGAL"))
        return Goal(f"{what} over CGAL's, {case}, 1 thread", ours, theirs, most=most)

    found = [against("Delaunay", "delaunay", case, most)
             for case, most in ((million, 0.5), (cube, 0.5), (scans, 0.6))]
    found += [against("regular triangulation of all polar balls", "power", case, 0.15)
              for case in (million, cube, scans)]
    for case in (million, cube, scans):
        found += [Goal(f"{what}, {case}, {many} threads against 1",
                       *(Measure("kernel", n, case, (part,)) for n in (1, many)),
                       least=1.7 if many == 2 else None)
                  for what, part in (("Delaunay", "delaunay"), ("regular", "power"))
                  for many in (2, 4, 8, 16) if many == 2 or many <= (os.cpu_count() or 1)]
    for stage in ("samples", "poles", "labels", "crust"):
        share = Measure("powercrust", 2, million, (stage,))
        found.append(Goal(f"share of {stage}, {million}, 2 threads", share,
                          Measure("powercrust", 2, million, ("stages",)), most=0.15))
    for case, threads in ((million, 1), (million, 2), (torus, 1), (scans, 1)):
        ours = lambda *parts: Measure("powercrust", threads, case, parts)
        found.append(Goal(f"labels + crust over both triangulations, {case}, {threads} thread"
                          + "s" * (threads > 1),
                          ours("labels", "crust"), ours(*TRIANGULATIONS), most=0.4))
    whole = Measure("powercrust", 2, million, ("wall",))
    found += [
        Goal(f"end to end with files on 2 threads over CGAL's two triangulations on 1, {million}",
             whole, Measure("CGAL", 1, million, TRIANGULATIONS), most=0.2),
        Goal(f"end to end over pymeshlab's normals + screened Poisson, depth 10, {million}, "
             "2 threads", whole, Measure("Poisson", 2, million, ("wall",)), most=1),
    ]
    alone = Measure("powercrust", 1, small, ("cpu",))
    found += [
        Goal(f"end to end over MeshLib's triangulation, {small}, 1 thread, processor time", alone,
             Measure("MeshLib", 1, small, ("cpu",)), most=1),
        Goal(f"end to end, {small}, 1 thread, processor time", alone,
             most=AUTHORS_S / 30 * scale, unit=" s"),
    ]
    peak = ("peak MB",)
    whole = Measure("powercrust", 2, million, peak)
    found += [
        Goal(f"peak memory a sample, {million}, 2 threads", whole,
             scale=2**20 / 1000 / million.points, most=1.5, unit=" KB"),
        Goal(f"memory foretold by --dry-run over peak, {million}",
             Measure("powercrust", 2, million, ("foretold MB",)), whole, least=0.75, most=1.25),
        Goal(f"memory foretold by --dry-run over peak, {scans}",
             Measure("powercrust", 1, scans, ("foretold MB",)),
             Measure("powercrust", 1, scans, peak), least=0.75, most=1.25),
    ]
    side = round(60 * scale ** (1 / 3))
    sphere = max(SPHERES) if scale >= 0.5 else min(SPHERES)
    pairs = ((Case("grid", side**3), "cube"), (Case("cospherical", sphere), "ellipsoid"),
             (Case("rounded", size(100_000)), "ellipsoid"))
    for case, generic in pairs:
        other = Case(generic, case.points)
        found.append(Goal(f"Delaunay a point, {case} over {other}",
                          *(Measure("kernel", 1, c, ("delaunay us",)) for c in (case, other)),
                          most=1))
    return found


def report(all_goals: list, runs: dict, row) -> list:
    """Gives `row` the cells of each goal; returns those that were not met."""
    missed = []
    for goal in all_goals:
        if not goal.was_run(runs):
            row(goal.what, goal.bounds(), "not run", "")
            continue
        values = goal.values(runs)
        middle = median(values)
        if not goal.met(middle):
            missed.append(goal)
        verdict = "" if not goal.bounds() else "yes" if goal.met(middle) else "NO"
        row(goal.what, goal.bounds(),
            f"{middle:.3g}{goal.unit} ({min(values):.3g} to {max(values):.3g})", verdict)
    return missed
