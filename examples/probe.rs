use powercrust::*;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let kind = std::env::args().nth(2).unwrap();
    let merge: f64 = std::env::args().nth(3).map_or(0.1, |v| v.parse().unwrap());
    let mut s = 1u64;
    let mut r = || {
        s = s.wrapping_add(0x9e3779b97f4a7c15);
        let mut h = s;
        h = (h ^ (h >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94d049bb133111eb);
        ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    let tau = std::f64::consts::TAU;
    let pts: Vec<[f64; 3]> = match kind.as_str() {
        "cube" => (0..n).map(|_| [r(), r(), r()]).collect(),
        "grid" => {
            let k = (n as f64).cbrt().round() as usize;
            (0..k * k * k)
                .map(|i| [(i % k) as f64, (i / k % k) as f64, (i / k / k) as f64])
                .collect()
        }
        "torus" => (0..n)
            .map(|_| loop {
                let (u, v) = (tau * r(), tau * r());
                if r() * 1.4 < 1.0 + 0.4 * v.cos() {
                    return [
                        (1.0 + 0.4 * v.cos()) * u.cos(),
                        (1.0 + 0.4 * v.cos()) * u.sin(),
                        0.4 * v.sin(),
                    ];
                }
            })
            .collect(),
        _ => {
            let ax = match kind.as_str() {
                "sphere" => [1.0, 1.0, 1.0],
                _ => [3.0, 2.0, 1.0],
            };
            (0..n)
                .map(|_| loop {
                    let p = [2.0 * r() - 1.0, 2.0 * r() - 1.0, 2.0 * r() - 1.0];
                    let d = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
                    if d < 1.0 && d > 0.1 {
                        return [ax[0] * p[0] / d, ax[1] * p[1] / d, ax[2] * p[2] / d];
                    }
                })
                .collect()
        }
    };
    let rec = reconstruct(
        &pts,
        &Options {
            merge,
            flatness: std::env::args().nth(4).map_or(0.05, |v| v.parse().unwrap()),
            ..Options::default()
        },
        &Context::default(),
    )
    .unwrap();
    let st = &rec.stats;
    for (k, v) in &st.seconds {
        print!("{k} {v:.3}  ");
    }
    println!("\ncells {} {:?} poles {} balls {} hidden {} inner {} unreached {} power cells {} faces raw {} polygons {} faces {} vol {} energy {:?}", st.delaunay_cells, st.delaunay_predicates, st.poles, st.balls, st.hidden_balls, st.inner_balls, st.unreached_balls, st.power_cells, st.power_faces, st.polygons, st.faces, st.volume, st.label_energy);
    println!("{:?}", st.power_predicates);
    let m = &rec.crust.mesh;
    let dist = |p: [f64; 3]| match kind.as_str() {
        "torus" => (((p[0] * p[0] + p[1] * p[1]).sqrt() - 1.0).hypot(p[2]) - 0.4).abs(),
        "sphere" => ((p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt() - 1.0).abs(),
        _ => {
            let f = (p[0] / 3.0).powi(2) + (p[1] / 2.0).powi(2) + p[2].powi(2) - 1.0;
            let g = 2.0 * ((p[0] / 9.0).powi(2) + (p[1] / 4.0).powi(2) + p[2].powi(2)).sqrt();
            (f / g).abs()
        }
    };
    let (mut mx, mut sum, mut area, mut vmax) = (0.0f64, 0.0, 0.0, 0.0f64);
    for f in m.faces() {
        let c: Vec<[f64; 3]> = f.iter().map(|&v| m.vertices[v as usize]).collect();
        let g = [0, 1, 2].map(|k| c.iter().map(|p| p[k]).sum::<f64>() / c.len() as f64);
        let a = powercrust::geom::vec3::norm(powercrust::geom::vec3::cross(
            powercrust::geom::vec3::sub(c[1], c[0]),
            powercrust::geom::vec3::sub(c[2], c[0]),
        ));
        mx = mx.max(dist(g));
        sum += a * dist(g);
        area += a;
    }
    for v in &m.vertices {
        vmax = vmax.max(dist(*v));
    }
    println!(
        "polygons/sample {:.2} faces/sample {:.2} error max {:.2e} mean {:.2e} vertex max {:.2e}",
        st.polygons as f64 / st.samples as f64,
        st.faces as f64 / st.samples as f64,
        mx,
        sum / area,
        vmax
    );
}
