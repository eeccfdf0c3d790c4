//! A tree of boxes over triangles: which pairs come close, and which triangle
//! is nearest.
//!
//! Nodes lie in one array, parents before children, left child next to its
//! parent. Every node splits its triangles at the median along the longest
//! side of the box of their middles, so the depth is logarithmic whatever the
//! input, and nothing depends on the number of threads.

use crate::context::Cancelled;
use crate::geom::Point;
use rayon::prelude::*;

/// Triangles in a leaf, at most.
const LEAF: usize = 4;
/// Below this many triangles a subtree is built by one thread.
const GRAIN: usize = 8192;
/// The self-join is cut into about this many tasks.
const TASKS: usize = 2048;
/// Node pairs a task visits between two looks at cancellation.
const PAIRS_PER_TICK: u32 = 1 << 16;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cuboid {
    pub min: Point,
    pub max: Point,
}

impl Cuboid {
    /// A box that no other meets, for what is gone.
    pub const NOWHERE: Cuboid = Cuboid {
        min: [f64::INFINITY; 3],
        max: [f64::NEG_INFINITY; 3],
    };

    pub fn of(t: &[Point; 3]) -> Cuboid {
        Cuboid {
            min: std::array::from_fn(|k| t[0][k].min(t[1][k]).min(t[2][k])),
            max: std::array::from_fn(|k| t[0][k].max(t[1][k]).max(t[2][k])),
        }
    }

    fn join(&mut self, other: &Cuboid) {
        for k in 0..3 {
            self.min[k] = self.min[k].min(other.min[k]);
            self.max[k] = self.max[k].max(other.max[k]);
        }
    }

    /// The smallest box around both.
    pub fn joined(mut self, other: &Cuboid) -> Cuboid {
        self.join(other);
        self
    }

    /// Whether the closed boxes have a point in common.
    #[inline]
    pub fn meets(&self, other: &Cuboid) -> bool {
        (self.min[0] <= other.max[0])
            & (other.min[0] <= self.max[0])
            & (self.min[1] <= other.max[1])
            & (other.min[1] <= self.max[1])
            & (self.min[2] <= other.max[2])
            & (other.min[2] <= self.max[2])
    }

    /// Squared distance to a point, zero inside.
    #[inline]
    fn dist_sq(&self, p: Point) -> f64 {
        let mut sum = 0.0;
        for (k, &x) in p.iter().enumerate() {
            let d = (self.min[k] - x).max(x - self.max[k]).max(0.0);
            sum += d * d;
        }
        sum
    }
}

#[derive(Clone, Copy, Debug)]
struct Node {
    cuboid: Cuboid,
    /// Distance to the right child in the array; 0 for leaves.
    right: u32,
    /// First slot of the triangles below.
    first: u32,
    /// Number of triangles below.
    count: u32,
}

/// The tree. Triangles are known by their slot, the position in `order`.
pub(super) struct Bvh {
    nodes: Vec<Node>,
    /// The triangle in each slot.
    pub order: Vec<u32>,
    /// The box of the triangle in each slot.
    boxes: Vec<Cuboid>,
}

/// A triangle while the tree is built: the sum of its box's corners.
#[derive(Clone, Copy)]
struct Item {
    middle: Point,
    triangle: u32,
}

impl Bvh {
    /// A tree over triangles with these boxes (finite, at most 2^32 - 1).
    pub fn new(boxes: &[Cuboid]) -> Bvh {
        let mut items: Vec<Item> = boxes
            .par_iter()
            .enumerate()
            .map(|(i, b)| Item {
                middle: std::array::from_fn(|k| b.min[k] + b.max[k]),
                triangle: i as u32,
            })
            .collect();
        let mut nodes = Vec::new();
        if !items.is_empty() {
            nodes = build(&mut items, 0, boxes);
        }
        let order: Vec<u32> = items.iter().map(|i| i.triangle).collect();
        let boxes = order.iter().map(|&t| boxes[t as usize]).collect();
        Bvh {
            nodes,
            order,
            boxes,
        }
    }

    /// Calls `visit` once for each unordered pair of slots whose boxes meet.
    /// The work is cut into tasks, the same for any number of threads; each
    /// has its own `T`, and they come back in order. `tick` receives the
    /// tasks done and their number, now and then from any thread.
    pub fn self_join<T: Default + Send>(
        &self,
        visit: impl Fn(&mut T, u32, u32) + Sync,
        tick: impl Fn(u64, u64) -> Result<(), Cancelled> + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        let tasks = self.tasks();
        let total = tasks.len() as u64;
        let done = std::sync::atomic::AtomicU64::new(0);
        let count = || done.load(std::sync::atomic::Ordering::Relaxed);
        tasks
            .into_par_iter()
            .map(|task| {
                let mut result = T::default();
                let mut stack = vec![task];
                let mut pairs = 0u32;
                while let Some((a, b)) = stack.pop() {
                    pairs += 1;
                    if pairs == PAIRS_PER_TICK {
                        pairs = 0;
                        tick(count(), total)?;
                    }
                    if !self.split(a, b, &mut stack) {
                        self.leaves(a, b, |i, j| visit(&mut result, i, j));
                    }
                }
                let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
                tick(done, total)?;
                Ok(result)
            })
            .collect()
    }

    /// Pairs of nodes that together cover the join of the root with itself.
    fn tasks(&self) -> Vec<(u32, u32)> {
        let mut tasks = Vec::new();
        if !self.nodes.is_empty() {
            tasks.push((0, 0));
        }
        let mut grows = true;
        while grows && tasks.len() < TASKS {
            grows = false;
            let mut next = Vec::with_capacity(tasks.len() * 3);
            for (a, b) in tasks {
                match self.split(a, b, &mut next) {
                    true => grows = true,
                    false => next.push((a, b)),
                }
            }
            tasks = next;
        }
        tasks
    }

    /// Replaces a pair of nodes by pairs of their children whose boxes meet;
    /// false if both are leaves.
    fn split(&self, a: u32, b: u32, into: &mut Vec<(u32, u32)>) -> bool {
        let (na, nb) = (&self.nodes[a as usize], &self.nodes[b as usize]);
        let mut push = |x: u32, y: u32| {
            if self.nodes[x as usize]
                .cuboid
                .meets(&self.nodes[y as usize].cuboid)
            {
                into.push((x, y));
            }
        };
        if a == b {
            if na.right == 0 {
                return false;
            }
            let (left, right) = (a + 1, a + na.right);
            push(left, right);
            push(left, left);
            push(right, right);
        } else if na.right != 0 && (nb.right == 0 || na.count >= nb.count) {
            push(a + 1, b);
            push(a + na.right, b);
        } else if nb.right != 0 {
            push(a, b + 1);
            push(a, b + nb.right);
        } else {
            return false;
        }
        true
    }

    fn leaves(&self, a: u32, b: u32, mut visit: impl FnMut(u32, u32)) {
        let slots = |n: u32| {
            let node = &self.nodes[n as usize];
            node.first..node.first + node.count
        };
        for i in slots(a) {
            let after = if a == b { i + 1 } else { 0 };
            for j in slots(b).filter(|&j| j >= after) {
                if self.boxes[i as usize].meets(&self.boxes[j as usize]) {
                    visit(i, j);
                }
            }
        }
    }

    /// The smallest squared distance from `p` that `dist_sq` gives for any
    /// slot, given that it is never less than the distance to the slot's
    /// box; infinite for no triangles. `stack` is scratch memory.
    pub fn nearest_sq(
        &self,
        p: Point,
        stack: &mut Vec<(f64, u32)>,
        dist_sq: impl Fn(u32) -> f64,
    ) -> f64 {
        let mut best = f64::INFINITY;
        stack.clear();
        if let Some(root) = self.nodes.first() {
            stack.push((root.cuboid.dist_sq(p), 0));
        }
        while let Some((bound, n)) = stack.pop() {
            if bound >= best {
                continue;
            }
            let node = &self.nodes[n as usize];
            if node.right == 0 {
                for slot in node.first..node.first + node.count {
                    if self.boxes[slot as usize].dist_sq(p) < best {
                        best = best.min(dist_sq(slot));
                    }
                }
            } else {
                let [l, r] =
                    [n + 1, n + node.right].map(|c| (self.nodes[c as usize].cuboid.dist_sq(p), c));
                let (near, far) = if l.0 <= r.0 { (l, r) } else { (r, l) };
                stack.push(far);
                stack.push(near);
            }
        }
        best
    }

    /// Gives a slot another box; those of the nodes above follow.
    pub fn replace(&mut self, slot: u32, cuboid: Cuboid) {
        self.boxes[slot as usize] = cuboid;
        // Down to the leaf, then back up.
        let mut path = [0u32; 64];
        let mut depth = 0;
        let mut at = 0u32;
        while self.nodes[at as usize].right != 0 {
            path[depth] = at;
            depth += 1;
            let right = at + self.nodes[at as usize].right;
            at = if slot < self.nodes[right as usize].first {
                at + 1
            } else {
                right
            };
        }
        let leaf = &self.nodes[at as usize];
        let mut whole = Cuboid::NOWHERE;
        for s in leaf.first..leaf.first + leaf.count {
            whole.join(&self.boxes[s as usize]);
        }
        self.nodes[at as usize].cuboid = whole;
        for &up in path[..depth].iter().rev() {
            let mut whole = self.nodes[up as usize + 1].cuboid;
            let right = up + self.nodes[up as usize].right;
            whole.join(&self.nodes[right as usize].cuboid);
            self.nodes[up as usize].cuboid = whole;
        }
    }

    /// Calls `visit` with every slot whose box meets the given one.
    pub fn query(&self, cuboid: &Cuboid, mut visit: impl FnMut(u32)) {
        let mut stack = Vec::new();
        if !self.nodes.is_empty() {
            stack.push(0u32);
        }
        while let Some(n) = stack.pop() {
            let node = &self.nodes[n as usize];
            if !node.cuboid.meets(cuboid) {
                continue;
            }
            if node.right != 0 {
                stack.extend([n + node.right, n + 1]);
                continue;
            }
            for slot in node.first..node.first + node.count {
                if self.boxes[slot as usize].meets(cuboid) {
                    visit(slot);
                }
            }
        }
    }
}

/// The nodes over `items`, which it reorders; `first` is their first slot.
fn build(items: &mut [Item], first: u32, boxes: &[Cuboid]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(items.len() / 2 + 1);
    if items.len() < GRAIN {
        build_into(items, first, boxes, &mut nodes);
        return nodes;
    }
    let middle = halve(items);
    let (low, high) = items.split_at_mut(middle);
    let (left, right) = rayon::join(
        || build(low, first, boxes),
        || build(high, first + middle as u32, boxes),
    );
    let mut cuboid = left[0].cuboid;
    cuboid.join(&right[0].cuboid);
    nodes.push(Node {
        cuboid,
        right: 1 + left.len() as u32,
        first,
        count: items.len() as u32,
    });
    nodes.extend(left);
    nodes.extend(right);
    nodes
}

fn build_into(items: &mut [Item], first: u32, boxes: &[Cuboid], nodes: &mut Vec<Node>) {
    let at = nodes.len();
    nodes.push(Node {
        cuboid: Cuboid::NOWHERE,
        right: 0,
        first,
        count: items.len() as u32,
    });
    let mut cuboid = Cuboid::NOWHERE;
    if items.len() <= LEAF {
        for item in items.iter() {
            cuboid.join(&boxes[item.triangle as usize]);
        }
    } else {
        let middle = halve(items);
        let (low, high) = items.split_at_mut(middle);
        build_into(low, first, boxes, nodes);
        let right = nodes.len();
        build_into(high, first + middle as u32, boxes, nodes);
        nodes[at].right = (right - at) as u32;
        cuboid.join(&nodes[at + 1].cuboid);
        cuboid.join(&nodes[right].cuboid);
    }
    nodes[at].cuboid = cuboid;
}

/// Moves the lower half along the longest side to the front.
fn halve(items: &mut [Item]) -> usize {
    let mut extent = Cuboid::NOWHERE;
    for item in items.iter() {
        for (k, &x) in item.middle.iter().enumerate() {
            extent.min[k] = extent.min[k].min(x);
            extent.max[k] = extent.max[k].max(x);
        }
    }
    let side: Point = std::array::from_fn(|k| extent.max[k] - extent.min[k]);
    let axis = (1..3).fold(0, |best, k| if side[k] > side[best] { k } else { best });
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        let order = a.middle[axis].total_cmp(&b.middle[axis]);
        order.then(a.triangle.cmp(&b.triangle))
    });
    middle
}
