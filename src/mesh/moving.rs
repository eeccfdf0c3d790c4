//! A tree of boxes over triangles that change and disappear.
//!
//! The tree is built once; a triangle keeps its leaf, whose box and those
//! above follow it. That stays good as long as triangles change where they
//! are, which is what edge collapses do.

use super::bvh::{Bvh, Cuboid};
use crate::geom::Point;

pub(super) struct Moving {
    bvh: Bvh,
    /// The slot of each triangle.
    slot: Vec<u32>,
}

impl Moving {
    /// A tree over the boxes of triangles, which must be finite.
    pub fn new(boxes: &[Cuboid]) -> Moving {
        let bvh = Bvh::new(boxes);
        let mut slot = vec![0; boxes.len()];
        for (s, &t) in bvh.order.iter().enumerate() {
            slot[t as usize] = s as u32;
        }
        Moving { bvh, slot }
    }

    /// The triangle has these corners now.
    pub fn place(&mut self, triangle: u32, corners: &[Point; 3]) {
        self.bvh
            .replace(self.slot[triangle as usize], Cuboid::of(corners));
    }

    /// The triangle is gone.
    pub fn remove(&mut self, triangle: u32) {
        self.bvh
            .replace(self.slot[triangle as usize], Cuboid::NOWHERE);
    }

    /// The triangles whose boxes meet the given one.
    pub fn near(&self, cuboid: &Cuboid, into: &mut Vec<u32>) {
        into.clear();
        self.bvh
            .query(cuboid, |slot| into.push(self.bvh.order[slot as usize]));
    }
}
