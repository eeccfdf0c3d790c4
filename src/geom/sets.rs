//! Disjoint sets of numbers.

/// Disjoint sets of `0..count`. The smallest member stands for a set, so what is found does not
/// depend on the order in which sets were joined.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    /// Each number in a set of its own.
    pub fn new(count: usize) -> Sets {
        Sets((0..count as u32).collect())
    }

    /// Parts all again, and makes it so many.
    pub fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count as u32);
    }

    /// How many numbers there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The number that stands for the set of another.
    #[inline]
    pub fn find(&mut self, mut x: u32) -> u32 {
        while self.0[x as usize] != x {
            let up = self.0[self.0[x as usize] as usize];
            self.0[x as usize] = up;
            x = up;
        }
        x
    }

    /// Makes the sets of two numbers one; whether they were two.
    #[inline]
    pub fn join(&mut self, x: u32, y: u32) -> bool {
        let (x, y) = (self.find(x), self.find(y));
        self.0[x.max(y) as usize] = x.min(y);
        x != y
    }

    /// What stands for the set of each number.
    pub fn flatten(mut self) -> Vec<u32> {
        for x in 0..self.0.len() {
            // Parents are smaller, so theirs are final already.
            self.0[x] = self.0[self.0[x] as usize];
        }
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_member_stands_for_a_set() {
        let mut sets = Sets::new(6);
        assert!(sets.join(5, 3) && sets.join(3, 1) && sets.join(4, 2));
        assert!(!sets.join(1, 5));
        assert_eq!((sets.find(5), sets.find(4), sets.len()), (1, 2, 6));
        assert_eq!(sets.clone().flatten(), [0, 1, 2, 1, 2, 1]);
        sets.reset(2);
        assert_eq!(sets.flatten(), [0, 1]);
    }
}
