//! What every long call receives: threads, progress, cancellation.
//!
//! The library keeps no globals. A caller that wants a progress bar, a stop
//! button or a thread limit passes a [`Context`]; [`Context::default`] asks
//! for nothing.

use std::num::NonZeroUsize;
use std::ops::ControlFlow;

/// A stage of the pipeline, in the order of the paper's section 5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Rounding to the lattice, merging duplicates.
    Samples,
    /// How noisy the samples are, and moving them onto the surface.
    Noise,
    /// Delaunay triangulation of the samples and the frame.
    Delaunay,
    /// Poles and polar balls.
    Poles,
    /// Regular triangulation of the polar balls.
    Power,
    /// Inner and outer labels.
    Labels,
    /// Faces between inner and outer cells.
    Crust,
    /// Judging a mesh.
    Check,
    /// Reducing the number of triangles.
    Reduce,
    /// Simplifying a medial axis.
    Simplify,
    /// Asking a medial axis.
    Query,
}

impl Stage {
    /// A short name for people: `delaunay`, `poles`, ...
    pub fn name(self) -> &'static str {
        match self {
            Stage::Samples => "samples",
            Stage::Noise => "noise",
            Stage::Delaunay => "delaunay",
            Stage::Poles => "poles",
            Stage::Power => "power",
            Stage::Labels => "labels",
            Stage::Crust => "crust",
            Stage::Check => "check",
            Stage::Reduce => "reduce",
            Stage::Simplify => "simplify",
            Stage::Query => "query",
        }
    }
}

/// Receives progress and may stop the work.
pub trait Progress: Sync {
    /// Called now and then (every few thousand items) from a working thread.
    /// `ControlFlow::Break` cancels: the running stage returns
    /// [`Cancelled`] soon after.
    fn advance(&self, stage: Stage, done: u64, total: u64) -> ControlFlow<()>;
}

/// Ignores progress and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn advance(&self, _: Stage, _: u64, _: u64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// The caller's progress handler asked to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// The most threads that a call starts, however many are asked for: a hundred
/// thousand would bring the machine to a standstill.
pub const MOST_THREADS: usize = 256;

/// Threads, progress and cancellation for one call.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Threads to use, at most [`MOST_THREADS`]; `None` takes all the machine
    /// offers. The result does not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Where progress goes and where cancellation comes from.
    pub progress: &'a dyn Progress,
}

impl Default for Context<'_> {
    fn default() -> Self {
        Context {
            threads: None,
            progress: &Silent,
        }
    }
}

impl Context<'_> {
    /// Runs `work` on as many threads as asked for.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        let pool = self.threads.and_then(|n| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(n.get().min(MOST_THREADS))
                .build()
                .ok()
        });
        match pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Reports progress; an error when the caller wants to stop.
    pub fn advance(&self, stage: Stage, done: u64, total: u64) -> Result<(), Cancelled> {
        match self.progress.advance(stage, done, total) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Cancelled),
        }
    }
}

/// A part of a stage, as a share of the whole of it.
#[derive(Clone, Copy)]
pub struct Portion<'a> {
    /// Where progress goes.
    pub context: &'a Context<'a>,
    /// The stage.
    pub stage: Stage,
    /// Where in the stage the part begins and ends, in `0..=100`.
    pub percent: [u64; 2],
}

impl Portion<'_> {
    /// Reports that `done` of `total` items of the part are done; an error
    /// when the caller wants to stop.
    pub fn advance(&self, done: usize, total: usize) -> Result<(), Cancelled> {
        let [from, to] = self.percent;
        let within = (to - from) * 100 * done as u64 / total.max(1) as u64;
        self.context
            .advance(self.stage, from * 100 + within, 10_000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_as_many_as_asked_for_up_to_a_limit() {
        for (asked, started) in [(1, 1), (3, 3), (100_000, MOST_THREADS)] {
            let context = Context {
                threads: NonZeroUsize::new(asked),
                ..Context::default()
            };
            assert_eq!(context.install(rayon::current_num_threads), started);
        }
    }
}
