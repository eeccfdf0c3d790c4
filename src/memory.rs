//! How much memory a run takes: measured where the system tells, and
//! predicted before it starts.

use serde::Serialize;

/// The largest amount of memory this process has had so far, in bytes; `None`
/// where the system does not tell (anything but Linux).
pub fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes * 1024)
}

/// The memory this machine or this container has, in bytes, swap included;
/// `None` where the system does not tell (anything but Linux).
pub fn of_machine() -> Option<u64> {
    let whole = machine(&std::fs::read_to_string("/proc/meminfo").ok()?)?;
    let group = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let group = group.and_then(|text| text.trim().parse().ok());
    Some(group.map_or(whole, |group: u64| group.min(whole)))
}

/// Memory and swap, from the text of `/proc/meminfo`.
fn machine(text: &str) -> Option<u64> {
    let kilobytes = |name: &str| -> Option<u64> {
        let line = text.lines().find_map(|l| l.strip_prefix(name))?;
        line.split_whitespace().next()?.parse().ok()
    };
    Some((kilobytes("MemTotal:")? + kilobytes("SwapTotal:").unwrap_or(0)) * 1024)
}

/// What a run is likely to need.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Peak memory of the process in bytes.
    pub memory_bytes: u64,
    /// Seconds, roughly.
    pub seconds: f64,
}

/// Predicts peak memory and time of a reconstruction from the number of
/// points.
///
/// 10 MB for the process, and 2.75 KB a point up to 100,000 points, less from there to
/// 1.74 KB at a million: by measurements on 33 clouds, 29 of which it meets within a quarter
/// (`docs/benchmarks`). Even clouds of smooth surfaces, grids and points that repeat others take less. Time
/// depends on the machine and on the scan by a factor of three.
///
/// ```
/// let estimate = powercrust::memory::estimate(1_000_000);
/// assert!((1.4e9..2.4e9).contains(&(estimate.memory_bytes as f64)));
/// ```
pub fn estimate(points: usize) -> Estimate {
    // Large clouds take memory for all samples at once less often.
    let orders = (points as f64 / MANY).log10().clamp(0.0, 1.0);
    let per_point = PER_POINT + (PER_POINT_OF_MANY - PER_POINT) * orders;
    Estimate {
        memory_bytes: (PROCESS + per_point * points as f64) as u64,
        seconds: SECONDS_PER_POINT * points as f64,
    }
}

/// Bytes.
const PROCESS: f64 = 10e6;
/// Bytes a point, for no more than [`MANY`].
const PER_POINT: f64 = 2750.0;
/// The same for ten times as many, and more.
const PER_POINT_OF_MANY: f64 = 1740.0;
const MANY: f64 = 1e5;
const SECONDS_PER_POINT: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_of_a_machine_is_memory_and_swap() {
        let text = "MemTotal:   2048 kB\nMemFree:  7 kB\nSwapTotal:  1024 kB\n";
        assert_eq!(machine(text), Some(3 << 20));
        assert_eq!(machine("MemTotal: 1 kB"), Some(1024));
        assert_eq!(machine("MemFree: 1 kB"), None);
    }
}
