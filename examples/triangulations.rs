//! Seconds of the two triangulations alone, on any points.
//!
//! ```sh
//! cargo run --release --example triangulations -- points.f64 1
//! ```
//!
//! Reads raw little-endian f64 triples, makes the Delaunay triangulation of the points and the
//! regular one of all their polar balls (nothing merged, no crust) on the given number of
//! threads, and prints seconds, a name and a number a line, as `scripts/bench` reads them, and the
//! counts. `delaunay` includes rounding and sorting the points.

use std::error::Error;
use std::time::Instant;

use powercrust::delaunay::{delaunay, samples};
use powercrust::poles::{poles, PoleOptions};
use powercrust::power::power_diagram;
use powercrust::{Context, Point};

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let (Some(file), Some(threads)) = (words.next(), words.next()) else {
        return Err("usage: triangulations POINTS.f64 THREADS".into());
    };
    let points = triples(&std::fs::read(file)?);
    let context = Context {
        threads: Some(threads.parse()?),
        ..Context::default()
    };
    context.install(|| run(&points, &context))?;
    Ok(())
}

fn triples(bytes: &[u8]) -> Vec<Point> {
    let number = |b: &[u8]| f64::from_le_bytes(b.try_into().unwrap_or_default());
    bytes
        .chunks_exact(24)
        .map(|p| [number(&p[..8]), number(&p[8..16]), number(&p[16..])])
        .collect()
}

fn run(points: &[Point], context: &Context) -> Result<(), powercrust::Error> {
    let start = Instant::now();
    let samples = samples(points, 5.0)?;
    let delaunay = delaunay(&samples, context)?;
    println!("delaunay {:.4}", start.elapsed().as_secs_f64());
    let start = Instant::now();
    let balls = poles(&samples, &delaunay, &PoleOptions::default(), context)?.balls;
    println!("poles {:.4}", start.elapsed().as_secs_f64());
    let start = Instant::now();
    let power = power_diagram(&balls.sites, balls.lattice.step(), context)?;
    println!("power {:.4}", start.elapsed().as_secs_f64());
    println!(
        "samples {} cells {} balls {} regular-cells {}",
        samples.len(),
        delaunay.complex.len(),
        balls.len(),
        power.complex.len()
    );
    Ok(())
}
