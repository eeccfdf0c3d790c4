//! The order of insertion: rounds of growing size (BRIO: Amenta, Choi, Rote
//! 2003), each along a Hilbert curve.
//!
//! Sites get their ids along the curve, so what is near in space is near in
//! memory. The round of a site is drawn from a hash of its coordinates.
//! There is no seed to choose: by the
//! uniqueness of the perturbed triangulation the order cannot change the result, only the time.
//! A round is eight times as large as the one before, not twice: that sweeps
//! the memory less often.

/// Bits of a coordinate in a Hilbert key.
const BITS: u32 = 21;

/// log2 of how many times larger each round is than the one before.
const RATIO: u32 = 3;

/// Place along a Hilbert curve through the cube of side `2^BITS` (Skilling
/// 2004: transposed axes, then bits interleaved).
pub fn hilbert(cell: [u32; 3]) -> u64 {
    let mut x = cell;
    let mut q = 1u32 << (BITS - 1);
    while q > 1 {
        let p = q - 1;
        for i in 0..3 {
            if x[i] & q != 0 {
                x[0] ^= p;
            } else {
                let t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
        q >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut t = 0;
    q = 1 << (BITS - 1);
    while q > 1 {
        if x[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let spread = |v: u32| {
        let mut v = v as u64 & 0x1f_ffff;
        v = (v | v << 32) & 0x001f_0000_0000_ffff;
        v = (v | v << 16) & 0x001f_0000_ff00_00ff;
        v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
        v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
        (v | v << 2) & 0x1249_2492_4924_9249
    };
    spread(x[0] ^ t) << 2 | spread(x[1] ^ t) << 1 | spread(x[2] ^ t)
}

/// The Hilbert key of a site whose coordinates lie in `[-half, half]`.
pub fn key(site: &[f64; 4], half: f64) -> u64 {
    let scale = (1u32 << (BITS - 1)) as f64 / half;
    let top = ((1u32 << BITS) - 1) as f64;
    hilbert([0, 1, 2].map(|k| ((site[k] + half) * scale).clamp(0.0, top) as u32))
}

/// The round of a site among `rounds`, the last holding about seven eighths of
/// all sites, the one before an eighth of that, and so on.
pub fn round(site: &[f64; 4], rounds: u32) -> u32 {
    let mut h = 0u64;
    for v in site {
        h = mix(h ^ v.to_bits());
    }
    let back = (h.trailing_ones() / RATIO).min(rounds - 1);
    rounds - 1 - back
}

/// Rounds worth having for so many sites: below a few hundred sites a round
/// gains nothing.
pub fn rounds(count: usize) -> u32 {
    ((count.max(1) as f64 / 256.0).log2() / f64::from(RATIO))
        .ceil()
        .max(0.0) as u32
        + 1
}

/// The finaliser of splitmix64.
fn mix(mut h: u64) -> u64 {
    h = h.wrapping_add(0x9e37_79b9_7f4a_7c15);
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    h ^ (h >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_steps_between_neighbours() {
        let shift = BITS - 3;
        let mut cells: Vec<(u64, [u32; 3])> = Vec::new();
        for x in 0..8u32 {
            for y in 0..8 {
                for z in 0..8 {
                    cells.push((hilbert([x << shift, y << shift, z << shift]), [x, y, z]));
                }
            }
        }
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let step: u32 = (0..3).map(|k| pair[0].1[k].abs_diff(pair[1].1[k])).sum();
            assert_eq!(step, 1, "{pair:?}");
        }
    }

    #[test]
    fn each_round_is_eight_times_the_one_before() {
        let mut sizes = [0usize; 3];
        for k in 0..32_000 {
            sizes[round(&[k as f64, 0.0, 0.0, 0.0], 3) as usize] += 1;
        }
        let share = |k: usize, wanted: f64| (sizes[k] as f64 / 32_000.0 - wanted).abs() < 0.01;
        let last = 7.0 / 8.0;
        assert!(share(2, last) && share(1, last / 8.0), "{sizes:?}");
    }

    #[test]
    fn few_sites_are_one_round() {
        assert_eq!([1, 256, 257, 2048, 2049].map(rounds), [1, 1, 2, 2, 3]);
    }
}
