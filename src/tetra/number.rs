//! The order in which cells are handed over: it depends on the complex alone,
//! not on the history of insertions, and cells at one vertex lie together.
//!
//! The corners of a cell ascend, but for the last two where orientation asks
//! for it; cells ascend by their ascending corners. A counting sort by the
//! lowest corner leaves about six cells to sort at each vertex.

use rayon::prelude::*;

use super::complex::{pack, unpack, Complex, NONE};
use super::store::{Cell, Store};

/// Cells that one thread sorts or numbers without dividing.
const GRAIN: usize = 4096;

/// The cells of the store in canonical order.
pub(super) fn number(store: Store, vertices: usize) -> Complex {
    let Store { cells, free, .. } = store;
    for &slot in &free {
        cells[slot as usize].set_vertices([NONE; 4]);
    }
    drop(free);
    let (starts, mut keys) = by_lowest(&cells, vertices);
    let mut sorted = vec![[NONE; 4]; keys.len()];
    sort(&mut keys, &mut sorted, &starts, 0);
    drop(starts);
    let mut new_of = vec![NONE; cells.len()];
    for (new, key) in (0u32..).zip(&keys) {
        new_of[key.slot() as usize] = new;
    }
    let places: Vec<Places> = cells
        .par_iter()
        .with_min_len(GRAIN)
        .map(Places::of)
        .collect();
    // Reading all that lies scattered first lets the reads overlap.
    let scattered = |key: &Key| cells[key.slot() as usize].neighbours();
    let mut neighbours: Vec<[u32; 4]> =
        keys.par_iter().with_min_len(GRAIN).map(scattered).collect();
    let renumber = |(key, behind): (&Key, &mut [u32; 4])| {
        let own = places[key.slot() as usize];
        let old = *behind;
        for i in 0..4 {
            behind[own.of_corner(i)] = if old[i] == NONE {
                NONE
            } else {
                let (d, j) = unpack(old[i]);
                pack(new_of[d as usize], places[d as usize].of_corner(j))
            };
        }
    };
    keys.par_iter()
        .zip(&mut neighbours)
        .with_min_len(GRAIN)
        .for_each(renumber);
    Complex {
        cells: sorted,
        neighbours,
    }
}

/// What a cell is sorted by, after its lowest vertex: the other three,
/// ascending, and the slot, with the orientation in its top bit.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    others: [u32; 3],
    slot: u32,
}

impl Key {
    const ODD: u32 = 1 << 31;

    fn slot(self) -> u32 {
        self.slot & !Key::ODD
    }

    /// The corners in canonical order.
    fn corners(self, lowest: u32) -> [u32; 4] {
        let [a, b, c] = self.others;
        if self.slot & Key::ODD == 0 {
            [lowest, a, b, c]
        } else {
            [lowest, a, c, b]
        }
    }
}

/// The cells in use by their lowest vertex, as a compressed table.
fn by_lowest(cells: &[Cell], vertices: usize) -> (Vec<u32>, Vec<Key>) {
    let mut starts = vec![0u32; vertices + 2];
    let used = || {
        let all = cells.iter().map(Cell::vertices).enumerate();
        all.filter(|(_, v)| v[1] != NONE)
    };
    for (_, v) in used() {
        starts[v[0].min(v[1]).min(v[2].min(v[3])) as usize + 2] += 1;
    }
    for v in 0..vertices {
        starts[v + 2] += starts[v + 1];
    }
    // One place ahead: filling moves the start of each to its end.
    let mut keys = vec![Key::default(); starts[vertices + 1] as usize];
    for (slot, mut v) in used() {
        let odd = order(&mut v);
        let at = &mut starts[v[0] as usize + 1];
        keys[*at as usize] = Key {
            others: [v[1], v[2], v[3]],
            slot: slot as u32 | if odd { Key::ODD } else { 0 },
        };
        *at += 1;
    }
    starts.pop();
    (starts, keys)
}

/// Orders four numbers by five exchanges; returns whether an odd number of
/// them was made.
#[inline]
fn order(v: &mut [u32; 4]) -> bool {
    let mut odd = false;
    for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        let (low, high) = (v[i].min(v[j]), v[i].max(v[j]));
        odd ^= v[i] > v[j];
        (v[i], v[j]) = (low, high);
    }
    odd
}

/// Sorts the keys at each lowest vertex and writes down the cells. `starts`
/// is that of the vertices from `first` on, and of the one beyond.
fn sort(keys: &mut [Key], sorted: &mut [[u32; 4]], starts: &[u32], first: usize) {
    let vertices = starts.len() - 1;
    let base = starts[0];
    if keys.len() > GRAIN && vertices > 1 {
        let half = vertices / 2;
        let at = (starts[half] - base) as usize;
        let (low, high) = keys.split_at_mut(at);
        let (below, above) = sorted.split_at_mut(at);
        rayon::join(
            || sort(low, below, &starts[..=half], first),
            || sort(high, above, &starts[half..], first + half),
        );
        return;
    }
    for v in 0..vertices {
        let bucket = (starts[v] - base) as usize..(starts[v + 1] - base) as usize;
        keys[bucket.clone()].sort_unstable();
        for k in bucket {
            sorted[k] = keys[k].corners((first + v) as u32);
        }
    }
}

/// Where the corners of a cell go: the new place of corner `k` in bits `2k`
/// and `2k + 1`.
#[derive(Clone, Copy)]
struct Places(u8);

impl Places {
    #[inline]
    fn of(cell: &Cell) -> Places {
        let v = cell.vertices();
        let after = |i: usize, j: usize| (v[i] > v[j]) as u8;
        let (ab, ac, ad) = (after(0, 1), after(0, 2), after(0, 3));
        let (bc, bd, cd) = (after(1, 2), after(1, 3), after(2, 3));
        let (a, b) = (ab + ac + ad, 1 - ab + bc + bd);
        let (c, d) = (2 - ac - bc + cd, 3 - ad - bd - cd);
        let all = a | b << 2 | c << 4 | d << 6;
        // Swap 2 and 3 where the order is odd.
        let odd = (ab ^ ac ^ ad ^ bc ^ bd ^ cd) * 0b0101_0101;
        Places(all ^ (all >> 1 & odd))
    }

    #[inline]
    fn of_corner(self, k: usize) -> usize {
        (self.0 >> (2 * k) & 3) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_ascend_and_keep_their_orientation() {
        let even = [[0, 1, 2, 3], [1, 2, 0, 3], [3, 2, 1, 0], [2, 0, 1, 3]];
        for order in even {
            for (swap, expected) in [(false, [4, 5, 7, 9]), (true, [4, 5, 9, 7])] {
                let mut cell = order.map(|k: usize| [4, 5, 7, 9][k]);
                if swap {
                    cell.swap(1, 2);
                }
                // What lies behind is no matter here, but for the hull.
                let complex = Complex {
                    cells: vec![cell],
                    neighbours: vec![[NONE; 4]],
                };
                let store = Store::of(&complex, 1);
                let places = Places::of(&store.cells[0]);
                for k in 0..4 {
                    assert_eq!(expected[places.of_corner(k)], cell[k], "{cell:?}");
                }
                assert_eq!(number(store, 10).cells, [expected], "{cell:?}");
            }
        }
    }
}
