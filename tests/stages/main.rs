//! The kernel, stage by stage, against naive twins: the same answers from
//! programs too slow and too plain to be wrong.

#[path = "../common/mod.rs"]
mod common;

mod crust;
mod exact;
mod hold;
mod labels;
mod merge;
mod poles;
mod power;
mod run;
mod samples;
mod sites;
mod triangulation;
