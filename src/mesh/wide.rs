//! Signs of determinants of any finite coordinates, by plain long integers.
//!
//! Slow (a microsecond or more) and without range limits: the last resort of
//! [`super::frame::Kernel`] where floating-point expansions could underflow,
//! and the oracle of its tests.
//!
//! A finite `f64` is a 53-bit integer times a power of two, so every product
//! of three coordinates is an integer of 159 bits times a power of two. The
//! terms of the expanded determinant are summed in one fixed-point number
//! wide enough for all of them; its sign is the answer.

use crate::geom::Point;

/// Exponent of the lowest bit a product of three doubles can have.
const LOWEST: i32 = -3 * 1074;
/// 32-bit digits from that bit up to the carries of 2^32 largest products.
const DIGITS: usize = ((3 * 1074 + 3 * 1024 + 64) / 32) as usize;

/// A sum of products of up to three doubles, kept exactly.
pub(super) struct Sum([i64; DIGITS]);

impl Sum {
    pub fn new() -> Sum {
        Sum([0; DIGITS])
    }

    /// Adds `± x y z`.
    fn add(&mut self, negative: bool, x: f64, y: f64, z: f64) {
        let ((sx, mx, ex), (sy, my, ey), (sz, mz, ez)) = (parts(x), parts(y), parts(z));
        if mx == 0 || my == 0 || mz == 0 {
            return;
        }
        let negative = negative ^ sx ^ sy ^ sz;
        // mx my mz as six digits of 32 bits, least first.
        let xy = u128::from(mx) * u128::from(my);
        let low = (xy & u128::from(u64::MAX)) * u128::from(mz);
        let high = (xy >> 64) * u128::from(mz) + (low >> 64);
        let words = [low as u64, high as u64, (high >> 64) as u64];
        let offset = (ex + ey + ez - LOWEST) as usize;
        let (digit, shift) = (offset / 32, offset % 32);
        let mut carry = 0u64;
        for k in 0..6 {
            let word = (words[k / 2] >> (32 * (k % 2))) & 0xffff_ffff;
            let shifted = (word << shift) | carry;
            self.put(digit + k, shifted & 0xffff_ffff, negative);
            carry = shifted >> 32;
        }
        self.put(digit + 6, carry, negative);
    }

    fn put(&mut self, digit: usize, value: u64, negative: bool) {
        if value != 0 {
            let value = value as i64;
            self.0[digit] += if negative { -value } else { value };
        }
    }

    pub fn sign(&self) -> i8 {
        let (mut carry, mut nonzero) = (0i64, false);
        for &digit in &self.0 {
            let value = digit + carry;
            carry = value >> 32;
            nonzero |= value & 0xffff_ffff != 0;
        }
        match carry {
            c if c < 0 => -1,
            0 if !nonzero => 0,
            _ => 1,
        }
    }
}

impl Sum {
    /// Adds `det(a, b, c)`: all six terms of all faces make six volumes.
    pub fn add_det(&mut self, [a, b, c]: [Point; 3]) {
        for (odd, [i, j, k]) in [
            (false, [0, 1, 2]),
            (false, [1, 2, 0]),
            (false, [2, 0, 1]),
            (true, [0, 2, 1]),
            (true, [2, 1, 0]),
            (true, [1, 0, 2]),
        ] {
            self.add(odd, a[i], b[j], c[k]);
        }
    }

    /// The sum times two to the power `exponent`, rounded, but for a sum that
    /// is not zero never to zero.
    pub fn value(&self, exponent: i32) -> f64 {
        let sign = self.sign();
        let (mut carry, mut digits) = (0i64, [0u32; DIGITS]);
        for (digit, own) in digits.iter_mut().zip(&self.0) {
            let value = if sign < 0 { carry - own } else { carry + own };
            *digit = value as u32;
            carry = value >> 32;
        }
        let Some(top) = digits.iter().rposition(|&d| d != 0) else {
            return 0.0;
        };
        let from = top.saturating_sub(3);
        let leading =
            (digits[from..=top].iter().rev()).fold(0u128, |n, &d| n << 32 | u128::from(d));
        let size = super::frame::shift(leading as f64, LOWEST + 32 * from as i32 + exponent);
        size.max(f64::from_bits(1)) * f64::from(sign)
    }
}

/// Sign, integer and exponent of a finite double: `± m 2^e`.
fn parts(x: f64) -> (bool, u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    match (bits >> 52) & 0x7ff {
        0 => (x.is_sign_negative(), fraction, -1074),
        e => (x.is_sign_negative(), fraction | 1 << 52, e as i32 - 1075),
    }
}

/// The sign of `det(a - d, b - d, c - d)`.
pub(super) fn orient3d(a: Point, b: Point, c: Point, d: Point) -> i8 {
    let mut sum = Sum::new();
    for (negative, [p, q, r]) in [
        (false, [a, b, c]),
        (true, [a, b, d]),
        (false, [a, c, d]),
        (true, [b, c, d]),
    ] {
        for (odd, [i, j, k]) in [
            (false, [0, 1, 2]),
            (false, [1, 2, 0]),
            (false, [2, 0, 1]),
            (true, [0, 2, 1]),
            (true, [2, 1, 0]),
            (true, [1, 0, 2]),
        ] {
            sum.add(negative ^ odd, p[i], q[j], r[k]);
        }
    }
    sum.sign()
}

/// The sign of `det(a - c, b - c)`: positive when `a`, `b`, `c` turn left.
pub(super) fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i8 {
    let mut sum = Sum::new();
    for [p, q] in [[a, b], [b, c], [c, a]] {
        sum.add(false, p[0], q[1], 1.0);
        sum.add(true, p[1], q[0], 1.0);
    }
    sum.sign()
}

#[cfg(test)]
mod tests {
    use super::*;
    use robust::{Coord, Coord3D};

    fn random(state: &mut u64) -> u64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        *state
    }

    /// Small integers (many zeros) with a last bit's disturbance now and then.
    fn coordinate(state: &mut u64) -> f64 {
        let base = (random(state) % 7) as f64 - 3.0;
        match random(state) % 4 {
            0 => base + 2f64.powi(-50),
            1 => base / 3.0,
            _ => base,
        }
    }

    #[test]
    fn agrees_with_expansions_in_range() {
        let mut state = 88172645463325252;
        let mut zeros = 0;
        for _ in 0..20_000 {
            let mut p = || -> Point { std::array::from_fn(|_| coordinate(&mut state)) };
            let (a, b, c, d) = (p(), p(), p(), p());
            let at = |p: Point| Coord3D {
                x: p[0],
                y: p[1],
                z: p[2],
            };
            let sign = |x: f64| (x > 0.0) as i8 - (x < 0.0) as i8;
            let expected = sign(robust::orient3d(at(a), at(b), at(c), at(d)));
            assert_eq!(orient3d(a, b, c, d), expected, "{a:?} {b:?} {c:?} {d:?}");
            zeros += (expected == 0) as u32;
            let flat = |p: Point| [p[0], p[1]];
            let at = |p: Point| Coord { x: p[0], y: p[1] };
            let expected = sign(robust::orient2d(at(a), at(b), at(c)));
            assert_eq!(orient2d(flat(a), flat(b), flat(c)), expected);
        }
        assert!(zeros > 100);
    }

    #[test]
    fn holds_the_whole_range_of_doubles() {
        let (tiny, huge) = (f64::from_bits(1), f64::MAX);
        let o = [0.0; 3];
        let (x, y, z) = ([tiny, 0., 0.], [0., tiny, 0.], [0., 0., tiny]);
        assert_eq!(orient3d(x, y, z, o), 1);
        assert_eq!(orient3d(y, x, z, o), -1);
        let (x, y, z) = ([huge, 0., 0.], [0., -huge, 0.], [0., 0., huge]);
        assert_eq!(orient3d(x, y, z, o), -1);
        assert_eq!(orient3d([huge; 3], [-huge; 3], z, o), 0);
        assert_eq!(orient2d([tiny, huge], [0., huge], [0., 0.]), 1);
        assert_eq!(orient2d([tiny, tiny], [huge, huge], [0., 0.]), 0);
    }
}
