//! The Delaunay and the regular triangulation of sites on small integers.

use crate::common::random::Random;
use crate::exact::{self, Cell, Whole};
use crate::sites::{self, framed, HALF};
use powercrust::predicates::{conflict, conflict_weighted, Counts, Site};
use powercrust::tetra::{
    self, triangulate, Complex, Conflict, InPower, InSphere, Triangulation, FACETS,
};
use powercrust::{Context, Stage};
use std::collections::BTreeSet;

fn delaunay(all: &[Site]) -> Triangulation {
    build(&InSphere(all))
}

fn regular(all: &[Site]) -> Triangulation {
    build(&InPower(all))
}

fn build<C: Conflict>(test: &C) -> Triangulation {
    let count = test.sites().len() as u32 - 8;
    triangulate(test, count, Stage::Delaunay, &Context::default()).unwrap()
}

/// The cells by coordinates, whatever their ids.
fn cells(all: &[Site], complex: &Complex) -> Vec<Cell> {
    let mut cells: Vec<Cell> = complex
        .cells
        .iter()
        .map(|cell| {
            let mut cell = cell.map(|v| exact::whole(&all[v as usize]));
            cell.sort_unstable();
            cell
        })
        .collect();
    cells.sort_unstable();
    cells
}

fn corners(all: &[Site], cell: &[u32; 4]) -> [Whole; 4] {
    cell.map(|v| exact::whole(&all[v as usize]))
}

/// Vertices - edges + facets - cells.
fn euler(complex: &Complex) -> i64 {
    let (mut vertices, mut edges, mut facets) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
    for cell in &complex.cells {
        let mut v = *cell;
        v.sort_unstable();
        vertices.extend(v);
        for i in 0..4 {
            for j in i + 1..4 {
                edges.insert([v[i], v[j]]);
            }
            let facet: Vec<u32> = (0..4).filter(|&k| k != i).map(|k| v[k]).collect();
            facets.insert(facet);
        }
    }
    let sizes = [vertices.len(), edges.len(), facets.len(), complex.len()];
    let [v, e, f, c] = sizes.map(|n| n as i64);
    v - e + f - c
}

/// What every triangulation must satisfy, by the checker and by hand.
#[track_caller]
fn assert_sound<C: Conflict>(name: &str, test: &C, made: &Triangulation) {
    let all = test.sites();
    assert_eq!(
        tetra::check(&made.complex, &made.hidden, test),
        [],
        "{name}"
    );
    let volumes = made.complex.cells.iter().map(|cell| {
        let volume = exact::six_volumes(corners(all, cell));
        assert!(volume > 0, "{name}: {cell:?} has {volume}");
        volume
    });
    let side = 2 * HALF as i128;
    assert_eq!(volumes.sum::<i128>(), 6 * side.pow(3), "{name}: volume");
    assert_eq!(euler(&made.complex), 1, "{name}: Euler");
}

#[test]
fn small_sets_have_the_cells_of_the_definition() {
    for (name, sites) in sites::small() {
        let all = framed(&sites);
        let made = delaunay(&all);
        assert_sound(&name, &InSphere(&all), &made);
        assert!(cells(&all, &made.complex) == exact::cells(&all), "{name}");
        assert!(made.hidden.is_empty(), "{name}");
    }
}

#[test]
fn small_sets_of_balls_have_the_cells_of_the_definition() {
    let mut random = Random::new(3);
    let mut hidden = 0;
    for (name, mut sites) in sites::small() {
        for site in &mut sites {
            site[3] = random.below(40) as f64;
        }
        hidden += assert_regular(&name, &sites);
    }
    assert!(hidden > 10, "weights hid only {hidden} balls");
}

#[test]
fn balls_through_common_samples_have_the_cells_of_the_definition() {
    let mut random = Random::new(4);
    for k in 0..20 {
        let reach = 3 + 4 * k;
        let balls = sites::polar(9, reach, &mut random);
        assert_regular(&format!("polar, reach {reach}"), &balls);
    }
}

/// Compares with the definition; returns the number of hidden balls.
#[track_caller]
fn assert_regular(name: &str, sites: &[Site]) -> usize {
    let all = framed(sites);
    let made = regular(&all);
    assert_sound(name, &InPower(&all), &made);
    let expected = exact::cells(&all);
    assert!(cells(&all, &made.complex) == expected, "{name}");
    let with_cells: BTreeSet<Whole> = expected.iter().flatten().copied().collect();
    let without = |v: &u32| !with_cells.contains(&exact::whole(&all[*v as usize]));
    let expected: Vec<u32> = (0..all.len() as u32).filter(without).collect();
    assert_eq!(made.hidden, expected, "{name}: hidden");
    expected.len()
}

/// No site conflicts with any cell: by the predicate, and where the
/// determinant is not zero by plain integers.
#[test]
fn larger_sets_are_sound_and_empty_of_conflicts() {
    let mut random = Random::new(5);
    for (name, sites) in sites::large() {
        let all = framed(&sites);
        let made = delaunay(&all);
        assert_sound(&name, &InSphere(&all), &made);
        assert_eq!(made.complex.cell_at_vertex(all.len()).len(), all.len());
        let mut counts = Counts::default();
        for cell in &made.complex.cells {
            let v = cell.map(|v| &all[v as usize]);
            let [a, b, c, d] = corners(&all, cell);
            for (p, site) in (0u32..).zip(&all) {
                if cell.contains(&p) {
                    continue;
                }
                assert!(!conflict(v, site, &mut counts), "{name}: {cell:?}, {p}");
                // The slow determinant on a share of the pairs.
                if random.below(16) == 0 {
                    let five = [a, b, c, d, exact::whole(site)];
                    assert!(!exact::conflicts(five), "{name}: {cell:?}, {p}");
                }
            }
        }
    }
}

#[test]
fn larger_sets_of_balls_are_sound_and_empty_of_conflicts() {
    let mut random = Random::new(6);
    let mut families = sites::large();
    families.push(("polar".into(), sites::polar(200, 40, &mut random)));
    for (name, mut sites) in families {
        if name != "polar" {
            let largest = if name == "random" { 40_000 } else { 12 };
            for site in &mut sites {
                site[3] = random.below(largest) as f64;
            }
        }
        let all = framed(&sites);
        let made = regular(&all);
        assert_sound(&name, &InPower(&all), &made);
        let mut counts = Counts::default();
        for cell in &made.complex.cells {
            let v = cell.map(|v| &all[v as usize]);
            for (p, site) in (0u32..).zip(&all) {
                let conflicts = !cell.contains(&p) && conflict_weighted(v, site, &mut counts);
                assert!(!conflicts, "{name}: {cell:?}, {p}");
            }
        }
    }
}

#[test]
fn the_order_of_insertion_does_not_matter() {
    let mut random = Random::new(7);
    for (name, mut sites) in sites::large() {
        let reference = framed(&sites);
        let points = cells(&reference, &delaunay(&reference).complex);
        for site in &mut sites {
            site[3] = random.below(9) as f64;
        }
        let reference = framed(&sites);
        let made = regular(&reference);
        let (balls, hidden) = (
            cells(&reference, &made.complex),
            sites_of(&reference, &made.hidden),
        );
        // `framed` keeps the first of equal centres: shuffle what it kept.
        let mut kept = reference[..reference.len() - 8].to_vec();
        for _ in 0..4 {
            random.shuffle(&mut kept);
            let all = framed(&kept);
            let made = regular(&all);
            assert!(cells(&all, &made.complex) == balls, "{name}");
            assert_eq!(sites_of(&all, &made.hidden), hidden, "{name}");
            let flat: Vec<Site> = kept.iter().map(|s| [s[0], s[1], s[2], 0.0]).collect();
            let all = framed(&flat);
            assert!(cells(&all, &delaunay(&all).complex) == points, "{name}");
        }
    }
}

/// Larger sets than the definition can judge, with a curve through them, for
/// several threads to share: random, on a grid, on a sphere, on two lines that are
/// not shared well, and balls of which many are hidden.
fn shared() -> Vec<(&'static str, Vec<Site>)> {
    let mut random = Random::new(9);
    let ball = |mut s: Site, random: &mut Random| {
        s[3] = random.below(6_000) as f64;
        s
    };
    let cloud = sites::random(60_000, 900, &mut random);
    let balls = cloud.iter().map(|&s| ball(s, &mut random)).collect();
    let mut families = vec![
        ("random", cloud),
        ("grid", sites::grid(34)),
        ("sphere", sites::sphere(801 * 801)),
        ("lines", sites::skew_lines(300)),
        ("balls", balls),
    ];
    for (_, sites) in &mut families {
        sites.sort_by(|a, b| a.partial_cmp(b).unwrap());
        sites.dedup_by(|a, b| a[..3] == b[..3]);
        sites.sort_by_key(|s| tetra::order::key(s, HALF));
    }
    families
}

#[test]
fn the_number_of_threads_does_not_matter() {
    for (name, sites) in shared() {
        let mut all = sites.clone();
        all.extend(framed(&[]));
        let mut one: Option<Triangulation> = None;
        for threads in [1, 2, 3, 8] {
            let made = crate::common::threads(threads).install(|| match name {
                "balls" => regular(&all),
                _ => delaunay(&all),
            });
            match &one {
                None => {
                    if name == "balls" {
                        assert!(made.hidden.len() > 1_000, "{}", made.hidden.len());
                        assert_eq!(
                            tetra::check(&made.complex, &made.hidden, &InPower(&all)),
                            []
                        );
                    } else {
                        assert_eq!(tetra::check(&made.complex, &[], &InSphere(&all)), []);
                    }
                    one = Some(made);
                }
                Some(one) => {
                    assert!(made.complex.cells == one.complex.cells, "{name}, {threads}");
                    assert!(
                        made.complex.neighbours == one.complex.neighbours,
                        "{name}, {threads}"
                    );
                    assert_eq!(made.hidden, one.hidden, "{name}, {threads}");
                }
            }
        }
    }
}

/// Cells are numbered by what they are.
#[test]
fn cells_and_corners_ascend() {
    let all = framed(&sites::random(300, 500, &mut Random::new(10)));
    let cells = delaunay(&all).complex.cells;
    let mut sorted: Vec<[u32; 4]> = cells.clone();
    for (cell, ascending) in cells.iter().zip(&mut sorted) {
        ascending.sort_unstable();
        assert_eq!(cell[..2], ascending[..2]);
    }
    assert!(sorted.is_sorted());
}

fn sites_of(all: &[Site], ids: &[u32]) -> BTreeSet<Whole> {
    ids.iter()
        .map(|&v| exact::whole(&all[v as usize]))
        .collect()
}

/// One suite, two implementations: equal weights change nothing. The frame
/// takes part: its weights are equal too.
#[test]
fn equal_weights_give_the_delaunay_triangulation_cell_for_cell() {
    for (name, sites) in sites::large() {
        let plain = framed(&sites);
        let mut heavy = plain.clone();
        for site in &mut heavy {
            site[3] = 777.0;
        }
        let (a, b) = (delaunay(&plain), regular(&heavy));
        assert_eq!(a.complex.cells, b.complex.cells, "{name}");
        assert_eq!(a.complex.neighbours, b.complex.neighbours, "{name}");
        assert!(b.hidden.is_empty(), "{name}");
    }
}

/// Each clause of the checker can fail.
#[test]
fn the_checker_finds_what_is_broken() {
    use tetra::Finding;
    let all = framed(&sites::random(30, 50, &mut Random::new(8)));
    let test = InSphere(&all);
    let good = delaunay(&all);
    let findings = |break_it: &dyn Fn(&mut Complex)| {
        let mut complex = good.complex.clone();
        break_it(&mut complex);
        tetra::check(&complex, &good.hidden, &test)
    };
    assert_eq!(findings(&|_| {}), []);
    let inner = (0..good.complex.len())
        .find(|&c| !good.complex.neighbours[c].contains(&tetra::NONE))
        .unwrap();
    let cell = inner as u32;
    let found = findings(&|c| c.cells[inner].swap(0, 1));
    // The facets behind corners 0 and 1 now have other corners.
    assert!(matches!(found[0], Finding::Unmatched { .. }), "{found:?}");
    let found = findings(&|c| {
        c.cells[inner].swap(0, 1);
        c.neighbours[inner].swap(0, 1);
        for i in 0..2 {
            let (d, j) = tetra::unpack(c.neighbours[inner][i]);
            c.neighbours[d as usize][j] = tetra::pack(cell, i);
        }
    });
    assert_eq!(found, [Finding::NotPositive { cell }]);
    let found = findings(&|c| c.cells[inner][0] = 99);
    assert_eq!(found[0], Finding::NoSuchSite { cell, site: 99 });
    let found = findings(&|c| {
        let (d, j) = tetra::unpack(c.neighbours[inner][2]);
        c.neighbours[inner][2] = tetra::NONE;
        c.neighbours[d as usize][j] = tetra::NONE;
    });
    assert!(
        found.contains(&Finding::Open { cell, facet: 2 }),
        "{found:?}"
    );
    assert_eq!(
        tetra::check(&good.complex, &[3], &test),
        [Finding::NotHidden { site: 3 }]
    );

    // The Delaunay triangulation of other sites: conflicts; of fewer: lost.
    let mut moved = all.clone();
    for site in &mut moved[..30] {
        site[3] = (site[0] * site[0]).abs();
    }
    let found = tetra::check(&good.complex, &[], &InPower(&moved));
    assert!(
        found
            .iter()
            .any(|f| matches!(f, Finding::Conflicting { .. })),
        "{found:?}"
    );
    let mut more = all[..30].to_vec();
    more.push([1.0, 2.0, 3.0, 0.0]);
    let fewer = framed(&more);
    let without: Vec<Site> = [&fewer[..30], &fewer[31..]].concat();
    let mut complex = delaunay(&without).complex;
    for v in complex.cells.iter_mut().flatten() {
        *v += (*v >= 30) as u32;
    }
    let found = tetra::check(&complex, &[], &InSphere(&fewer));
    assert_eq!(found, [Finding::Lost { site: 30 }]);
    let found = tetra::check(&complex, &[30], &InSphere(&fewer));
    assert!(
        matches!(found[..], [Finding::WronglyHidden { site: 30, .. }]),
        "{found:?}"
    );
}

#[test]
fn facets_of_a_cell_look_one_way() {
    for (i, [a, b, c]) in FACETS.into_iter().enumerate() {
        let order = [i, a, b, c];
        let inversions = (0..4)
            .flat_map(|x| (x + 1..4).map(move |y| (x, y)))
            .filter(|&(x, y)| order[x] > order[y])
            .count();
        assert_eq!(inversions % 2, 0, "facet {i}");
    }
}
