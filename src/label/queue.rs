//! The queue of figure 8: balls by priority, equal ones by id.
//!
//! A heap of four children a node that knows where each ball stands in it, so
//! that a priority can change in place.

/// 'Not in the queue' among places.
const OUT: u32 = u32::MAX;

/// A priority as bits that compare as it does, and the ball.
#[derive(Clone, Copy)]
struct Entry {
    bits: u64,
    ball: u32,
}

impl Entry {
    /// Whether this comes before another.
    #[inline]
    fn leads(&self, other: &Entry) -> bool {
        self.bits > other.bits || self.bits == other.bits && self.ball < other.ball
    }
}

/// The bits of a float, in its total order.
#[inline]
fn ordered(value: f64) -> u64 {
    let bits = value.to_bits();
    bits ^ ((bits as i64 >> 63) as u64 | 1 << 63)
}

/// Balls by priority.
pub(super) struct Queue {
    heap: Vec<Entry>,
    /// Where each ball is in the heap.
    place: Vec<u32>,
}

impl Queue {
    /// An empty queue for balls below `balls`.
    pub fn new(balls: usize) -> Queue {
        Queue {
            heap: Vec::new(),
            place: vec![OUT; balls],
        }
    }

    /// Puts a ball in, or gives it a new priority.
    #[inline]
    pub fn set(&mut self, ball: u32, priority: f64) {
        let entry = Entry {
            bits: ordered(priority),
            ball,
        };
        let at = match self.place[ball as usize] {
            OUT => {
                self.heap.push(entry);
                self.heap.len() - 1
            }
            at => at as usize,
        };
        let risen = self.rise(at, entry);
        if risen == at {
            self.sink(at, entry);
        }
    }

    /// Takes out the first ball.
    pub fn pop(&mut self) -> Option<(u32, f64)> {
        let last = self.heap.pop()?;
        let first = self.heap.first().copied().unwrap_or(last);
        self.place[first.ball as usize] = OUT;
        if !self.heap.is_empty() {
            self.sink(0, last);
        }
        let bits = first.bits;
        let value = f64::from_bits(bits ^ ((!bits as i64 >> 63) as u64 | 1 << 63));
        Some((first.ball, value))
    }

    /// Moves the gap at `at` up to where the entry belongs.
    #[inline]
    fn rise(&mut self, mut at: usize, entry: Entry) -> usize {
        while at > 0 {
            let parent = (at - 1) / 4;
            let above = self.heap[parent];
            if !entry.leads(&above) {
                break;
            }
            self.put(at, above);
            at = parent;
        }
        self.put(at, entry);
        at
    }

    /// Moves the gap at `at` down to where the entry belongs.
    #[inline]
    fn sink(&mut self, mut at: usize, entry: Entry) {
        loop {
            let first = 4 * at + 1;
            let children = self.heap.len().min(first + 4);
            let mut best = first;
            for child in first + 1..children {
                if self.heap[child].leads(&self.heap[best]) {
                    best = child;
                }
            }
            if first >= children || !self.heap[best].leads(&entry) {
                break;
            }
            self.put(at, self.heap[best]);
            at = best;
        }
        self.put(at, entry);
    }

    #[inline]
    fn put(&mut self, at: usize, entry: Entry) {
        self.heap[at] = entry;
        self.place[entry.ball as usize] = at as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_is_that_of_a_search() {
        let mut state = 5u64;
        let mut next = move |n: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) % n
        };
        let mut queue = Queue::new(50);
        let mut all: Vec<Option<f64>> = vec![None; 50];
        for _ in 0..5_000 {
            if next(3) > 0 {
                let ball = next(50);
                // Few values, so that many are equal.
                let priority = next(9) as f64 / 4.0 - 1.0;
                queue.set(ball as u32, priority);
                all[ball as usize] = Some(priority);
                continue;
            }
            let mut best: Option<(u32, f64)> = None;
            for (ball, priority) in (0..).zip(&all) {
                if let Some(p) = priority.filter(|p| best.is_none_or(|b| *p > b.1)) {
                    best = Some((ball, p));
                }
            }
            assert_eq!(queue.pop(), best);
            if let Some((ball, _)) = best {
                all[ball as usize] = None;
            }
        }
    }
}
