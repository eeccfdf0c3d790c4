"""A plot of time over size, both in powers of ten, as SVG."""

import math
from html import escape
from statistics import median

WIDTH, HEIGHT = 940, 540
LEFT, RIGHT, TOP, BOTTOM = 70, 330, 60, 60
# Told apart by people who see fewer colours, too (Okabe and Ito).
COLOURS = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]


def slope(points: list) -> float:
    """The exponent: least squares through (size, median) in logarithms."""
    xs, ys = zip(*((math.log(n), math.log(median(times))) for n, times in points))
    x0, y0 = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((x - x0) * (y - y0) for x, y in zip(xs, ys)) / sum((x - x0) ** 2 for x in xs)


def draw(title: str, series: dict) -> str:
    """`series`: by name a list of (size, times), the times those of the rounds."""
    sizes = [n for points in series.values() for n, _ in points]
    times = [t for points in series.values() for _, many in points for t in many]
    x = Axis(min(sizes), max(sizes), LEFT, WIDTH - RIGHT)
    y = Axis(min(times), max(times), HEIGHT - BOTTOM, TOP)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           'font-family="sans-serif" font-size="13">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
           text(LEFT, 28, title, 'font-size="16" font-weight="bold"')]
    out += grid(x, y)
    # Names at the ends of the lines, drawn apart where they would overlap.
    ends = sorted(series, key=lambda name: y.at(median(series[name][-1][1])))
    place = -math.inf
    for name in ends:
        points, colour = series[name], COLOURS[list(series).index(name) % len(COLOURS)]
        path = " ".join(f"{x.at(n):.1f},{y.at(median(many)):.1f}" for n, many in points)
        out.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        for n, many in points:
            out.append(f'<line x1="{x.at(n):.1f}" x2="{x.at(n):.1f}" y1="{y.at(min(many)):.1f}" '
                       f'y2="{y.at(max(many)):.1f}" stroke="{colour}"/>')
            out.append(f'<circle cx="{x.at(n):.1f}" cy="{y.at(median(many)):.1f}" r="3.5" '
                       f'fill="{colour}"/>')
        place = max(place + 17, y.at(median(points[-1][1])) + 4)
        exponent = f", n^{slope(points):.2f}" if len(points) > 1 else ""
        out.append(text(x.at(points[-1][0]) + 10, place, name + exponent, f'fill="{colour}"'))
    return "\n".join(out + ["</svg>\n"])


class Axis:
    """Logarithmic, from one pixel to another."""

    def __init__(self, least: float, most: float, start: float, end: float):
        self.low, self.high = math.log10(least), math.log10(max(most, least * 1.01))
        self.start, self.end = start, end

    def at(self, value: float) -> float:
        share = (math.log10(value) - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self):
        """1, 2 and 5 times the powers of ten within the range."""
        for power in range(math.floor(self.low), math.ceil(self.high) + 1):
            for factor in (1, 2, 5):
                value = factor * 10.0**power
                if self.low - 1e-9 <= math.log10(value) <= self.high + 1e-9:
                    yield value


def grid(x: Axis, y: Axis) -> list:
    out = []
    for n in x.ticks():
        out.append(line(x.at(n), y.start, x.at(n), y.end))
        out.append(text(x.at(n), y.start + 20, f"{n:,.0f}", 'text-anchor="middle"'))
    for t in y.ticks():
        out.append(line(x.start, y.at(t), x.end, y.at(t)))
        out.append(text(x.start - 8, y.at(t) + 4, f"{t:g}", 'text-anchor="end"'))
    out.append(text((x.start + x.end) / 2, y.start + 44, "samples", 'text-anchor="middle"'))
    out.append(text(x.start - 8, y.end - 10, "s", 'text-anchor="end"'))
    return out


def line(x1, y1, x2, y2) -> str:
    return (f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" '
            'stroke="#dddddd"/>')


def text(x, y, words: str, style: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" {style}>{escape(words)}</text>'
