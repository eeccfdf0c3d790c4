//! Which skinniness bound `lambda` is taken, and of which samples it is asked.
//!
//! The paper leaves lambda to the user, one for the whole cloud. Asked of clean
//! samples it only takes away: thin parts and edges have fat cells too. Amid noise it
//! takes away what noise made, and legs and ears with it. Since handles thinner than the noise are
//! cut, surfaces are nearer to the truth without it, and as often of the right topology, where the noise is up to one and
//! a half of the spacing; where it is twice the spacing and more, topology is right more often with 0.4
//! (`docs/noise.md`). So it is 0.4 at the samples amid such noise, and
//! no pole of any other is dropped.

use crate::options::LambdaOption;

/// Lambda amid noise.
const AMID_NOISE: f64 = 0.4;

/// Noise over spacing above which lambda is asked: fitted.
pub const LOUD: f64 = 2.0;

/// The skinniness bound and the samples it is asked of.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Bound {
    /// Every pole is kept.
    #[default]
    None,
    /// Lambda, asked of every sample.
    All(f64),
    /// Lambda, asked of the samples so marked.
    Some(f64, Vec<bool>),
}

/// Which bound was taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct BoundReport {
    /// Lambda; `None` where every pole was kept.
    pub lambda: Option<f64>,
    /// Whether the program chose it.
    pub chosen: bool,
    /// Samples it was asked of.
    pub asked: usize,
}

impl Bound {
    /// What is asked of `samples` samples, if the noise at each is this share of the
    /// spacing; `noise` is empty where there is none to speak of.
    pub fn choose(option: LambdaOption, samples: usize, noise: &[f32]) -> (Bound, BoundReport) {
        let report = |lambda, chosen, asked| BoundReport {
            lambda,
            chosen,
            asked,
        };
        match option {
            LambdaOption::Off => (Bound::None, report(None, false, 0)),
            LambdaOption::Value(lambda) => {
                let report = report(Some(lambda), false, samples);
                (Bound::All(lambda), report)
            }
            LambdaOption::Auto => {
                let loud: Vec<bool> = noise.iter().map(|&n| f64::from(n) > LOUD).collect();
                match loud.iter().filter(|&&l| l).count() {
                    0 => (Bound::None, report(None, true, 0)),
                    asked => {
                        let report = report(Some(AMID_NOISE), true, asked);
                        (Bound::Some(AMID_NOISE, loud), report)
                    }
                }
            }
        }
    }

    /// Lambda for one sample.
    #[inline]
    pub(super) fn of(&self, sample: usize) -> Option<f64> {
        match self {
            Bound::None => None,
            Bound::All(lambda) => Some(*lambda),
            Bound::Some(lambda, asked) => asked[sample].then_some(*lambda),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lambda_is_asked_amid_noise_only() {
        let noise = [0.0, 0.9, 2.5];
        let (bound, report) = Bound::choose(LambdaOption::Auto, 3, &noise);
        assert_eq!(
            [0, 1, 2].map(|s| bound.of(s).is_some()),
            [false, false, true]
        );
        assert_eq!((report.lambda, report.asked), (Some(AMID_NOISE), 1));
        assert_eq!(Bound::choose(LambdaOption::Auto, 3, &[]).0, Bound::None);
        assert_eq!(Bound::choose(LambdaOption::Off, 3, &noise).0, Bound::None);
        let (bound, report) = Bound::choose(LambdaOption::Value(0.2), 3, &noise);
        assert_eq!((bound.of(0), report.asked), (Some(0.2), 3));
    }
}
