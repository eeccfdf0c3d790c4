"""Whether triangles cross, in rational arithmetic: slow, plain and right.

No code of the project is used, and no floating point decides anything.
"""

from fractions import Fraction


def crossings(vertices, triangles, suspects, most: int = 20) -> list:
    """Pairs of triangles, one of them among `suspects`, that meet in more than
    the vertices and the edge they share; at most `most` of them."""
    import numpy as np

    low = vertices[triangles].min(axis=1)
    high = vertices[triangles].max(axis=1)
    found, places = [], {}

    def place(v):
        if v not in places:
            places[v] = tuple(Fraction(float(x)) for x in vertices[v])
        return places[v]

    for s in map(int, suspects):
        near = np.nonzero((low <= high[s]).all(axis=1) & (low[s] <= high).all(axis=1))[0]
        for t in map(int, near):
            if t == s or (t in suspects and t < s):
                continue
            if meet([int(v) for v in triangles[s]], [int(v) for v in triangles[t]], place):
                found.append((s, t))
                if len(found) == most:
                    return found
    return found


def meet(a: list, b: list, place) -> bool:
    """Whether two triangles, by vertices, meet in more than what they share."""
    common = [v for v in a if v in b]
    one, two = [[place(v) for v in t] for t in (a, b)]
    if len(common) == 3:
        return True
    if len(common) == 2:
        p, q = (place(v) for v in common)
        r, s = (place(next(v for v in t if v not in common)) for t in (a, b))
        if orient(p, q, r, s) != 0:
            return False
        # In one plane: fine on different sides of the edge.
        n = cross(minus(q, p), minus(r, p))
        return dot(n, cross(minus(q, p), minus(s, p))) > 0
    if len(common) == 1:
        # What leaves the common vertex comes out through the opposite edge.
        sides = [[place(v) for v in t if v not in common] for t in (a, b)]
        return pierces(*sides[0], two) or pierces(*sides[1], one)
    edges = [(t[k], t[k - 1], other) for t, other in ((one, two), (two, one)) for k in range(3)]
    return any(pierces(p, q, other) for p, q, other in edges)


def pierces(p, q, t) -> bool:
    """Whether a closed segment and a closed triangle of positive area meet."""
    at_p, at_q = orient(*t, p), orient(*t, q)
    if at_p * at_q > 0:
        return False
    if at_p == 0 and at_q == 0:
        return meets_in_plane(p, q, t)
    signs = {sign(orient(p, q, t[k], t[(k + 1) % 3])) for k in range(3)}
    return not (1 in signs and -1 in signs)


def meets_in_plane(p, q, t) -> bool:
    n = cross(minus(t[1], t[0]), minus(t[2], t[0]))
    drop = max(range(3), key=lambda k: abs(n[k]))
    p, q, *t = (tuple(x for k, x in enumerate(r) if k != drop) for r in (p, q, *t))

    def turn(a, b, c):
        return sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    def within(x):
        turns = {turn(t[k], t[(k + 1) % 3], x) for k in range(3)}
        return not (1 in turns and -1 in turns)

    def crosses(a, b):
        return turn(p, q, a) * turn(p, q, b) <= 0 and turn(a, b, p) * turn(a, b, q) <= 0

    if within(p) or within(q):
        return True
    # Both ends outside: through the inside means across an edge's two sides.
    return any(crosses(t[k], t[(k + 1) % 3]) and not apart(p, q, t[k], t[(k + 1) % 3])
               for k in range(3))


def apart(p, q, a, b) -> bool:
    """Whether the boxes of two segments in a plane have nothing in common."""
    return any(max(p[k], q[k]) < min(a[k], b[k]) or max(a[k], b[k]) < min(p[k], q[k])
               for k in range(2))


def minus(p, q):
    return tuple(x - y for x, y in zip(p, q))


def cross(u, v):
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def dot(u, v):
    return sum(x * y for x, y in zip(u, v))


def orient(a, b, c, d):
    return dot(cross(minus(b, a), minus(c, a)), minus(d, a))


def sign(x) -> int:
    return (x > 0) - (x < 0)
