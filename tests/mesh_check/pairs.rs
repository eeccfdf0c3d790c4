//! Pairs of triangles and distances, against oracles that share no idea with the checker: clipping in
//! rational numbers, and brute force.

use super::*;

/// Exact intersections of integer triangles by clipping in rational numbers:
/// shares no idea with the checker.
mod oracle {
    /// A point as `(x, y, z, w)` for `(x, y, z) / w`, `w > 0`, lowest terms.
    pub type Rational = [i128; 4];
    pub type Triangle = [[i128; 3]; 3];

    #[derive(Debug, PartialEq, Eq, Clone, Copy)]
    pub enum Contact {
        Disjoint,
        Shared,
        Touching,
        Crossing,
    }

    fn sub(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }

    fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    }

    pub fn normal(t: &Triangle) -> [i128; 3] {
        cross(sub(t[1], t[0]), sub(t[2], t[0]))
    }

    fn gcd(a: i128, b: i128) -> i128 {
        if b == 0 {
            a.abs()
        } else {
            gcd(b, a % b)
        }
    }

    fn lowest(p: Rational) -> Rational {
        let g = p.iter().fold(0, |g, &x| gcd(g, x)) * p[3].signum();
        p.map(|x| x / g)
    }

    /// `n . (p - o)` times `p`'s denominator.
    fn height(n: [i128; 3], o: [i128; 3], p: Rational) -> i128 {
        (0..3).map(|k| n[k] * (p[k] - o[k] * p[3])).sum()
    }

    /// The part of a convex polygon where `n . (p - o) >= 0`.
    fn clip(polygon: &[Rational], n: [i128; 3], o: [i128; 3]) -> Vec<Rational> {
        let mut kept = Vec::new();
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (hp, hq) = (height(n, o, p), height(n, o, q));
            if hp >= 0 {
                kept.push(p);
            }
            if hp.signum() * hq.signum() < 0 {
                // (hp / wp) and (hq / wq) weigh q and p.
                let (a, b) = (hq.abs(), hp.abs());
                kept.push(lowest(std::array::from_fn(|k| p[k] * a + q[k] * b)));
            }
        }
        kept.dedup();
        kept
    }

    /// Corners of the intersection of two triangles with an area.
    pub fn intersection(a: &Triangle, b: &Triangle) -> Vec<Rational> {
        let n = normal(b);
        let mut polygon: Vec<Rational> = a.iter().map(|p| [p[0], p[1], p[2], 1]).collect();
        polygon = clip(&polygon, n, b[0]);
        polygon = clip(&polygon, n.map(|x| -x), b[0]);
        for i in 0..3 {
            let side = sub(b[(i + 1) % 3], b[i]);
            polygon = clip(&polygon, cross(n, side), b[i]);
        }
        polygon.sort_unstable();
        polygon.dedup();
        polygon
    }

    /// Whether a point of a triangle's plane is in its relative interior.
    fn inside(p: Rational, t: &Triangle) -> bool {
        let n = normal(t);
        (0..3).all(|i| height(cross(n, sub(t[(i + 1) % 3], t[i])), t[i], p) > 0)
    }

    pub fn contact(a: &Triangle, b: &Triangle) -> Contact {
        let corners = intersection(a, b);
        if corners.is_empty() {
            return Contact::Disjoint;
        }
        // A point of the relative interior of the intersection.
        let middle = corners.iter().skip(1).fold(corners[0], |m, &p| {
            lowest(std::array::from_fn(|k| m[k] * p[3] + p[k] * m[3]).map2(m, p))
        });
        if inside(middle, a) && inside(middle, b) {
            return Contact::Crossing;
        }
        let mut common: Vec<Rational> = (a.iter())
            .filter(|p| b.contains(p))
            .map(|p| [p[0], p[1], p[2], 1])
            .collect();
        common.sort_unstable();
        match common == corners {
            true => Contact::Shared,
            false => Contact::Touching,
        }
    }

    /// The denominator of the middle of two points.
    trait Middle {
        fn map2(self, m: Rational, p: Rational) -> Rational;
    }

    impl Middle for Rational {
        fn map2(mut self, m: Rational, p: Rational) -> Rational {
            self[3] = 2 * m[3] * p[3];
            self
        }
    }
}

/// What the checker says about two triangles.
fn contact_by_check(a: &[[i32; 3]; 3], b: &[[i32; 3]; 3]) -> oracle::Contact {
    let points = [a.as_slice(), b.as_slice()].concat();
    let report = judge(&mesh(&points, &[&[0, 1, 2], &[3, 4, 5]]));
    let c = report.counts;
    match (c.crossing, c.touching, c.coincident) {
        (0, 0, 0) => oracle::Contact::Disjoint,
        (1, 0, 0) => oracle::Contact::Crossing,
        (0, 1, 0) => oracle::Contact::Touching,
        (0, 0, 1) => oracle::Contact::Shared,
        other => panic!("{other:?}"),
    }
}

/// The same with corners at equal positions made one vertex.
fn contact_when_shared(a: &[[i32; 3]; 3], b: &[[i32; 3]; 3]) -> Counts {
    let mut points = a.to_vec();
    let corners = b.map(|p| {
        points.iter().position(|q| *q == p).unwrap_or_else(|| {
            points.push(p);
            points.len() - 1
        }) as u32
    });
    judge(&mesh(&points, &[&[0, 1, 2], &corners])).counts
}

#[test]
fn pairs_of_triangles_agree_with_rational_clipping() {
    let mut random = Random(2718281828459045);
    let mut seen = [0u32; 4];
    let mut cases = 0;
    while cases < 40_000 {
        // Small cubes of integers give every degenerate position often; a
        // flat one gives coplanar pairs.
        let range = [2, 3, 4, 7][(random.next() % 4) as usize];
        let flat = random.next().is_multiple_of(4);
        let skew = random.next().is_multiple_of(2);
        let mut point = || -> [i32; 3] {
            let mut p: [i32; 3] = std::array::from_fn(|_| (random.next() % range) as i32);
            if flat {
                p[2] = if skew { 2 * p[0] - p[1] } else { 0 };
            }
            p
        };
        let a = [point(), point(), point()];
        let mut b = [point(), point(), point()];
        // Often make them share corners.
        for i in 0..2 {
            if random.next().is_multiple_of(4) {
                b[(random.next() % 3) as usize] = a[i];
            }
        }
        let wide = |t: [[i32; 3]; 3]| t.map(|p| p.map(i128::from));
        let (wa, wb) = (wide(a), wide(b));
        if oracle::normal(&wa) == [0; 3] || oracle::normal(&wb) == [0; 3] {
            continue;
        }
        cases += 1;
        let expected = oracle::contact(&wa, &wb);
        assert_eq!(oracle::contact(&wb, &wa), expected, "oracle: {a:?} {b:?}");
        assert_eq!(contact_by_check(&a, &b), expected, "{a:?} {b:?}");
        let c = contact_when_shared(&a, &b);
        let found = (c.crossing, c.touching, c.coincident);
        let wanted = match expected {
            oracle::Contact::Crossing => (1, 0, 0),
            oracle::Contact::Touching => (0, 1, 0),
            _ => (0, 0, 0),
        };
        assert_eq!(found, wanted, "shared: {a:?} {b:?}");
        seen[expected as usize] += 1;
    }
    assert!(seen.iter().all(|&n| n > 1000), "{seen:?}");
}

#[test]
fn the_tree_finds_the_pairs_that_brute_force_finds() {
    let mut random = Random(31415926535);
    for round in 0..60 {
        let count = 5 + round;
        let mut soup = PolygonMesh::default();
        let mut triangles = Vec::new();
        while triangles.len() < count {
            let t: oracle::Triangle =
                std::array::from_fn(|_| std::array::from_fn(|_| (random.next() % 12) as i128));
            if oracle::normal(&t) == [0; 3] {
                continue;
            }
            triangles.push(t);
            let first = soup.vertices.len() as u32;
            soup.vertices.extend(t.map(|p| p.map(|x| x as f64)));
            soup.push_face(&[first, first + 1, first + 2]);
        }
        let options = CheckOptions {
            max_findings: usize::MAX,
            ..CheckOptions::default()
        };
        let report = check(&soup, &options, &Context::default()).unwrap();
        let mut expected = [Vec::new(), Vec::new(), Vec::new()];
        for i in 0..count {
            for j in i + 1..count {
                let (a, b) = (i as u32, j as u32);
                match oracle::contact(&triangles[i], &triangles[j]) {
                    oracle::Contact::Disjoint => {}
                    oracle::Contact::Crossing => expected[0].push(Finding::Crossing { a, b }),
                    oracle::Contact::Touching => expected[1].push(Finding::Touching { a, b }),
                    oracle::Contact::Shared => expected[2].push(Finding::Coincident { a, b }),
                }
            }
        }
        let expected = expected.concat();
        let found: Vec<Finding> = (report.findings.into_iter())
            .filter(|f| {
                matches!(
                    f,
                    Finding::Crossing { .. }
                        | Finding::Touching { .. }
                        | Finding::Coincident { .. }
                )
            })
            .collect();
        assert_eq!(found, expected, "round {round}");
    }
}

#[test]
fn distances_agree_with_brute_force() {
    let sphere = wavy_sphere(24, 0.3);
    let surface = Surface::new(&sphere);
    let mut random = Random(161803398);
    let points: Vec<Point> = (0..500)
        .map(|_| std::array::from_fn(|_| (random.next() % 4000) as f64 / 1000.0 - 2.0))
        .collect();
    let found = surface.distances(&points, &Context::default()).unwrap();
    for (p, distance) in points.iter().zip(found) {
        assert_eq!(surface.distance(*p), distance);
        let nearest = (0..sphere.face_count())
            .map(|f| {
                let mut one = PolygonMesh::with_vertices(sphere.vertices.clone());
                one.push_face(sphere.face(f));
                dense_distance(*p, &one)
            })
            .fold(f64::INFINITY, f64::min);
        // The dense samples of each triangle come within a step of it.
        assert!(distance <= nearest + 1e-12 && nearest - distance < 0.02);
    }
    for p in &sphere.vertices {
        assert_eq!(surface.distance(*p), 0.0);
    }
}

/// The distance to a grid of points of the mesh's one triangle.
fn dense_distance(p: Point, one: &PolygonMesh) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| one.vertices[one.corners[k] as usize]);
    let steps = 12;
    let mut least = f64::INFINITY;
    for i in 0..=steps {
        for j in 0..=steps - i {
            let (u, v) = (
                f64::from(i) / f64::from(steps),
                f64::from(j) / f64::from(steps),
            );
            let q: Point = std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
            let d: f64 = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum();
            least = least.min(d.sqrt());
        }
    }
    least
}
