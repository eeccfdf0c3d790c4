//! LZF decompression: runs of bytes as they are, and copies of earlier ones.

/// The most bytes that one compressed byte can stand for: three make 264.
const MOST: usize = 88;

/// Exactly `size` bytes out of `data`; or where in `data` it goes wrong.
pub fn decompress(data: &[u8], size: usize) -> Result<Vec<u8>, usize> {
    if size > data.len().saturating_mul(MOST) {
        return Err(data.len());
    }
    let mut out = Vec::with_capacity(size);
    let mut at = 0;
    while at < data.len() {
        let start = at;
        let control = usize::from(data[at]);
        at += 1;
        if control < 32 {
            let run = data.get(at..at + control + 1).ok_or(start)?;
            out.extend_from_slice(run);
            at += run.len();
        } else {
            let mut length = control >> 5;
            if length == 7 {
                length += usize::from(*data.get(at).ok_or(start)?);
                at += 1;
            }
            let low = usize::from(*data.get(at).ok_or(start)?);
            at += 1;
            let distance = ((control & 31) << 8 | low) + 1;
            let from = out.len().checked_sub(distance).ok_or(start)?;
            // The copy may overlap what it writes.
            for k in from..from + length + 2 {
                out.push(out[k]);
            }
        }
        if out.len() > size {
            return Err(start);
        }
    }
    match out.len() == size {
        true => Ok(out),
        false => Err(data.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::decompress;

    #[test]
    fn runs_and_copies() {
        // abc, then six bytes from three back, then a long copy of the last.
        let data = [2, b'a', b'b', b'c', 4 << 5, 2, 7 << 5, 1, 0];
        let expected = b"abcabcabccccccccccc";
        assert_eq!(decompress(&data, expected.len()).unwrap(), expected);
    }

    #[test]
    fn damage_is_found() {
        assert_eq!(decompress(&[3, 1, 2], 4), Err(0));
        assert_eq!(decompress(&[0, 1, 32, 5], 4), Err(2));
        assert_eq!(decompress(&[0, 1], 2), Err(2));
        assert_eq!(decompress(&[1, 1, 2], 1), Err(0));
        assert_eq!(decompress(&[0, 1, 224], 200), Err(2));
        assert_eq!(decompress(&[], 1), Err(0));
    }
}
