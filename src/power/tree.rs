//! A tree over balls: which of them is nearest, by whatever measure.
//!
//! Every node splits its balls at the median along the longest side of their
//! box in four dimensions, the radius being the fourth: so the few huge outer
//! balls part from the many small ones early, and what a node says of its balls
//! is tight. The tree depends on the balls alone.

use crate::geom::{Ball, Point};

/// Balls in a leaf, at most.
const LEAF: usize = 4;

/// What is known of all balls below a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    min: Point,
    max: Point,
    /// The largest radius.
    pub radius: f64,
    least: f64,
}

impl Extent {
    fn of(balls: &[Ball], some: &[u32]) -> Extent {
        let mut all = Extent {
            min: [f64::INFINITY; 3],
            max: [f64::NEG_INFINITY; 3],
            radius: f64::NEG_INFINITY,
            least: f64::INFINITY,
        };
        for ball in some.iter().map(|&b| &balls[b as usize]) {
            for k in 0..3 {
                all.min[k] = all.min[k].min(ball.centre[k]);
                all.max[k] = all.max[k].max(ball.centre[k]);
            }
            all.radius = all.radius.max(ball.radius);
            all.least = all.least.min(ball.radius);
        }
        all
    }

    /// The squared distance from a point to the box of the centres.
    pub fn dist_sq(&self, p: Point) -> f64 {
        let mut sum = 0.0;
        for (k, &x) in p.iter().enumerate() {
            let d = (self.min[k] - x).max(x - self.max[k]).max(0.0);
            sum += d * d;
        }
        sum
    }

    /// The dimension in which the balls spread most.
    fn longest(&self) -> usize {
        let side = |k: usize| match k {
            3 => self.radius - self.least,
            k => self.max[k] - self.min[k],
        };
        (1..4).fold(0, |best, k| if side(k) > side(best) { k } else { best })
    }
}

#[derive(Clone, Copy, Debug)]
struct Node {
    extent: Extent,
    /// The right child; the left one is the next node. 0 for leaves.
    right: u32,
    /// Balls of a leaf, among those in order.
    first: u32,
    count: u32,
}

/// A tree over balls, which are known by their index.
#[derive(Clone, Debug)]
pub(crate) struct BallTree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl BallTree {
    pub fn new(balls: &[Ball]) -> BallTree {
        let mut tree = BallTree {
            nodes: Vec::new(),
            order: (0..balls.len() as u32).collect(),
        };
        if !balls.is_empty() {
            let mut order = std::mem::take(&mut tree.order);
            tree.build(balls, &mut order, 0);
            tree.order = order;
        }
        tree
    }

    fn build(&mut self, balls: &[Ball], order: &mut [u32], first: usize) {
        let extent = Extent::of(balls, order);
        let at = self.nodes.len();
        self.nodes.push(Node {
            extent,
            right: 0,
            first: first as u32,
            count: order.len() as u32,
        });
        if order.len() <= LEAF {
            return;
        }
        let axis = extent.longest();
        let key = |b: &u32| match axis {
            3 => balls[*b as usize].radius,
            k => balls[*b as usize].centre[k],
        };
        let middle = order.len() / 2;
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let (left, right) = order.split_at_mut(middle);
        self.build(balls, left, first);
        self.nodes[at].right = self.nodes.len() as u32;
        self.build(balls, right, first + middle);
    }

    /// Goes through the balls that may matter, the most promising ones first.
    /// `bound` is never more than the value of any ball below a node; `leaf`
    /// looks at a ball and tells the largest value that still matters.
    /// `stack` is memory that many calls may share.
    pub fn search(
        &self,
        stack: &mut Vec<(f64, u32)>,
        bound: impl Fn(&Extent) -> f64,
        mut leaf: impl FnMut(u32) -> f64,
    ) {
        stack.clear();
        if let Some(root) = self.nodes.first() {
            stack.push((bound(&root.extent), 0));
        }
        let mut most = f64::INFINITY;
        while let Some((least, n)) = stack.pop() {
            if least > most {
                continue;
            }
            let node = &self.nodes[n as usize];
            if node.right == 0 {
                let own = node.first as usize..(node.first + node.count) as usize;
                for &b in &self.order[own] {
                    most = leaf(b);
                }
                continue;
            }
            let child = |c: u32| (bound(&self.nodes[c as usize].extent), c);
            let (left, right) = (child(n + 1), child(node.right));
            if left.0 <= right.0 {
                stack.extend([right, left]);
            } else {
                stack.extend([left, right]);
            }
        }
    }

    /// The ball whose sphere is nearest to a point, counting negative inside,
    /// and how far it is; of equal ones the first. `balls` are those the tree
    /// was made of.
    pub fn nearest_sphere(
        &self,
        balls: &[Ball],
        p: Point,
        stack: &mut Vec<(f64, u32)>,
    ) -> Option<(f64, u32)> {
        let mut best: Option<(f64, u32)> = None;
        let bound = |e: &Extent| e.dist_sq(p).sqrt() * (1.0 - 1e-15) - e.radius;
        self.search(stack, bound, |b| {
            let ball = &balls[b as usize];
            let off = crate::geom::vec3::dist_sq(p, ball.centre).sqrt() - ball.radius;
            if best.is_none_or(|(least, c)| (off, b) < (least, c)) {
                best = Some((off, b));
            }
            best.map_or(f64::INFINITY, |(least, _)| least)
        });
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::vec3::dist_sq;

    #[test]
    fn the_nearest_sphere_is_that_of_a_search_through_all() {
        let mut state = 11u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let mut balls: Vec<Ball> = (0..400)
            .map(|_| Ball::new([next(), next(), next()], 0.1 * next()))
            .collect();
        balls.extend((0..20).map(|_| Ball::new([9.0 * next(), next(), next()], 5.0 * next())));
        balls.push(balls[7]);
        let tree = BallTree::new(&balls);
        let mut stack = Vec::new();
        for _ in 0..300 {
            let p = [2.0 * next(), next(), next()];
            let off = |b: &Ball| dist_sq(p, b.centre).sqrt() - b.radius;
            let all = (balls.iter().enumerate()).map(|(i, b)| (off(b), i as u32));
            let least = all.min_by(|a, b| a.partial_cmp(b).unwrap());
            assert_eq!(tree.nearest_sphere(&balls, p, &mut stack), least);
        }
        assert_eq!(
            BallTree::new(&[]).nearest_sphere(&[], [0.0; 3], &mut stack),
            None
        );
    }
}
