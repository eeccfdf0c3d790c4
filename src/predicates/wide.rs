//! A 256-bit signed integer: just what exact predicates on a lattice need.
//!
//! With coordinates below 2^46 in size every determinant here stays below
//! 2^250, so wrapping arithmetic never wraps (see [`super`] for the count).

use super::Sign;

/// A 256-bit two's complement integer, least significant limb first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wide([u64; 4]);

impl Wide {
    /// Zero.
    pub const ZERO: Wide = Wide([0; 4]);

    /// The full product of two 128-bit integers.
    #[inline]
    pub fn product(a: i128, b: i128) -> Wide {
        let (x, y) = (a.unsigned_abs(), b.unsigned_abs());
        let [x0, x1] = [x as u64, (x >> 64) as u64].map(u128::from);
        let [y0, y1] = [y as u64, (y >> 64) as u64].map(u128::from);
        let low = x0 * y0;
        // None of these sums can carry beyond 128 bits.
        let middle = x1 * y0 + (low >> 64);
        let other = x0 * y1 + (middle & u128::from(u64::MAX));
        let high = x1 * y1 + (middle >> 64) + (other >> 64);
        let out = Wide([low as u64, other as u64, high as u64, (high >> 64) as u64]);
        if (a < 0) != (b < 0) {
            out.negated()
        } else {
            out
        }
    }

    /// `self * b`, modulo 2^256.
    #[inline]
    pub fn times(self, b: i128) -> Wide {
        let negative = b < 0;
        let magnitude = b.unsigned_abs();
        let (low, high) = (magnitude as u64, (magnitude >> 64) as u64);
        let mut out = [0u64; 4];
        let mut carry = 0u128;
        for k in 0..4 {
            let t = self.0[k] as u128 * low as u128 + carry;
            out[k] = t as u64;
            carry = t >> 64;
        }
        if high != 0 {
            carry = 0;
            for k in 0..3 {
                let t = self.0[k] as u128 * high as u128 + out[k + 1] as u128 + carry;
                out[k + 1] = t as u64;
                carry = t >> 64;
            }
        }
        if negative {
            Wide(out).negated()
        } else {
            Wide(out)
        }
    }

    /// `self + other`, modulo 2^256.
    #[inline]
    pub fn plus(self, other: Wide) -> Wide {
        let mut out = [0u64; 4];
        let mut carry = false;
        for (k, limb) in out.iter_mut().enumerate() {
            let (sum, first) = self.0[k].overflowing_add(other.0[k]);
            let (sum, second) = sum.overflowing_add(carry as u64);
            *limb = sum;
            carry = first | second;
        }
        Wide(out)
    }

    /// `-self`, modulo 2^256.
    #[inline]
    pub fn negated(self) -> Wide {
        Wide(self.0.map(|limb| !limb)).plus(Wide([1, 0, 0, 0]))
    }

    /// `self - other`, modulo 2^256.
    #[inline]
    pub fn minus(self, other: Wide) -> Wide {
        self.plus(other.negated())
    }

    /// The sign.
    #[inline]
    pub fn sign(self) -> Sign {
        if (self.0[3] as i64) < 0 {
            Sign::Negative
        } else if self.0 == [0; 4] {
            Sign::Zero
        } else {
            Sign::Positive
        }
    }

    /// The value as the unevaluated sum of two floats, to about 2^-100 of
    /// itself.
    pub fn to_double(self) -> (f64, f64) {
        let negative = self.sign() == Sign::Negative;
        let magnitude = if negative { self.negated() } else { self };
        let (mut high, mut low) = (0.0f64, 0.0f64);
        let mut unit = 2f64.powi(224);
        for limb in magnitude.0.iter().rev() {
            for half in [limb >> 32, limb & 0xffff_ffff] {
                let term = half as f64 * unit;
                let sum = high + term;
                // Terms come largest first: the error of the sum is exact.
                let lost = if high >= term {
                    (high - sum) + term
                } else {
                    (term - sum) + high
                };
                high = sum;
                low += lost;
                unit /= 4_294_967_296.0;
            }
        }
        let sum = high + low;
        let (high, low) = (sum, low - (sum - high));
        if negative {
            (-high, -low)
        } else {
            (high, low)
        }
    }
}

impl From<i128> for Wide {
    #[inline]
    fn from(v: i128) -> Wide {
        let fill = if v < 0 { u64::MAX } else { 0 };
        Wide([v as u64, (v >> 64) as u64, fill, fill])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_products_agree_with_native_arithmetic() {
        let values = [0i128, 1, -1, 7, -13, 1 << 40, -(1 << 60), 123_456_789_012];
        for &a in &values {
            for &b in &values {
                assert_eq!(Wide::product(a, b), Wide::from(a * b), "{a} * {b}");
                assert_eq!(Wide::from(a).plus(b.into()), Wide::from(a + b));
                assert_eq!(Wide::from(a).minus(b.into()), Wide::from(a - b));
            }
        }
    }

    #[test]
    fn large_products_cancel_exactly() {
        let (a, b) = (i128::MAX / 3, -(i128::MAX / 5));
        let left = Wide::product(a, b);
        assert_eq!(left.sign(), Sign::Negative);
        assert_eq!(left.minus(Wide::product(b, a)).sign(), Sign::Zero);
        assert_eq!(left.minus(Wide::product(b, a - 1)), Wide::from(b));
        let ratio = left.to_double().0 / (a as f64 * b as f64);
        assert!((ratio - 1.0).abs() < 1e-15);
    }

    #[test]
    fn doubles_keep_a_hundred_bits() {
        let v = (1i128 << 100) + 1;
        let (high, low) = Wide::from(-v).to_double();
        assert_eq!((high, low), (-(2f64.powi(100)), -1.0));
    }
}
