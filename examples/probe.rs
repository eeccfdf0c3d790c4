use powercrust::{delaunay::*, Context};
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let kind = std::env::args().nth(2).unwrap();
    let mut s = 1u64;
    let mut r = || {
        s = s.wrapping_add(0x9e3779b97f4a7c15);
        let mut h = s;
        h = (h ^ (h >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94d049bb133111eb);
        ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    let pts: Vec<[f64; 3]> = match kind.as_str() {
        "cube" => (0..n).map(|_| [r(), r(), r()]).collect(),
        "grid" => {
            let k = (n as f64).cbrt().round() as usize;
            (0..k * k * k)
                .map(|i| [(i % k) as f64, (i / k % k) as f64, (i / k / k) as f64])
                .collect()
        }
        _ => (0..n)
            .map(|_| loop {
                let p = [2.0 * r() - 1.0, 2.0 * r() - 1.0, 2.0 * r() - 1.0];
                let d = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
                if d < 1.0 && d > 0.1 {
                    return [3.0 * p[0] / d, 2.0 * p[1] / d, p[2] / d];
                }
            })
            .collect(),
    };
    let t = std::time::Instant::now();
    let sm = samples(&pts, 5.0).unwrap();
    println!("samples {} {:.3}", sm.len(), t.elapsed().as_secs_f64());
    let t = std::time::Instant::now();
    let dt = delaunay(&sm, &Context::default()).unwrap();
    println!(
        "delaunay {} cells {:.3} {:?}",
        dt.complex.len(),
        t.elapsed().as_secs_f64(),
        dt.counts
    );
    println!("bad {}", dt.complex.check().len());
    let t = std::time::Instant::now();
    let po = powercrust::poles::poles(&sm, &dt, &Default::default(), &Context::default()).unwrap();
    println!("poles {} {:.3}", po.balls.len(), t.elapsed().as_secs_f64());
    let t = std::time::Instant::now();
    let pd = powercrust::power::power_diagram(&po.balls.sites, po.balls.lattice.step(), &Context::default()).unwrap();
    println!("power cells {} hidden {} {:.3} {:?}", pd.complex.len(), pd.hidden.len(), t.elapsed().as_secs_f64(), pd.counts);
    println!("bad {}", pd.complex.check().len());
}
