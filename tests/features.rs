//! What surfaces carry, how they are taken apart, reduced and written: through
//! the public library.

use powercrust::io::{as_written, write_mesh, MeshAttributes, MeshFormat, WriteOptions};
use powercrust::mesh::{check, decimate, deviation, CheckOptions, DecimateError};
use powercrust::surface::{filter_shells, Keep, MinVolume, ShellFilter, Shells, NONE};
use powercrust::{reconstruct, Context, Options, Point, PolygonMesh, Reconstruction};

// ------------------------------------------------------------------ shapes

/// Points spread evenly over a sphere.
fn sphere(count: usize, radius: f64, centre: Point) -> Vec<Point> {
    (0..count)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / count as f64;
            let (ring, turn) = ((1.0 - z * z).sqrt(), 2.399_963_229_728_653 * i as f64);
            let p = [ring * turn.cos(), ring * turn.sin(), z];
            std::array::from_fn(|k| centre[k] + radius * p[k])
        })
        .collect()
}

/// Two balls of which the first has a ball-shaped cavity.
fn hollow_and_solid() -> Vec<Point> {
    let mut points = sphere(2000, 1.0, [0.0; 3]);
    points.extend(sphere(800, 0.5, [0.0; 3]));
    points.extend(sphere(500, 0.4, [3.0, 0.0, 0.0]));
    points
}

fn crust(points: &[Point]) -> Reconstruction {
    reconstruct(points, &Options::default(), &Context::default()).unwrap()
}

#[track_caller]
fn assert_sound(mesh: &PolygonMesh) {
    let report = check(mesh, &CheckOptions::default(), &Context::default()).unwrap();
    assert!(report.is_watertight(), "{:?}", report.counts);
}

fn near(a: f64, b: f64, share: f64) -> bool {
    (a - b).abs() < share * b.abs()
}

// -------------------------------------------------------------- attributes

#[test]
fn values_come_from_the_first_point_at_a_place_or_from_those_next_to_it() {
    let mut points = sphere(600, 1.0, [0.0; 3]);
    points.push(points[7]);
    let result = crust(&points);
    let sources = result.vertex_sources();
    assert_eq!(sources.len(), result.crust.mesh.vertices.len());
    let mut values: Vec<f64> = points.iter().map(|p| p[2] + 0.25).collect();
    values[600] = 99.0;
    let heights = sources.numbers(&values);
    let classes: Vec<f64> = points.iter().map(|p| p[2].signum()).collect();
    let classes = sources.numbers(&classes);
    let colours: Vec<[u8; 4]> = (0..601).map(|i| [(i % 256) as u8, 3, 200, 255]).collect();
    let colours = sources.colours(&colours);
    let mut blended = 0;
    for (v, p) in result.crust.mesh.vertices.iter().enumerate() {
        let weights: f32 = sources.of_vertex(v).iter().map(|e| e.1).sum();
        assert!((weights - 1.0).abs() < 1e-5);
        assert_eq!(colours[v][1..], [3, 200, 255]);
        match result.crust.vertex_samples[v] {
            NONE => {
                blended += 1;
                assert!(
                    (heights[v] - p[2] - 0.25).abs() < 0.4,
                    "{} {p:?}",
                    heights[v]
                );
                assert!(classes[v].abs() == 1.0);
            }
            sample => {
                let point = result.sample_source[sample as usize] as usize;
                assert!(point < 600);
                assert_eq!(heights[v], values[point]);
                assert_eq!(colours[v][0], (point % 256) as u8);
            }
        }
    }
    assert!(blended > 0);
}

#[test]
fn normals_look_outward_and_follow_the_input() {
    let points = sphere(600, 2.0, [5.0, 5.0, 5.0]);
    let result = crust(&points);
    let own = result.vertex_normals();
    for (n, p) in own.iter().zip(&result.crust.mesh.vertices) {
        let out: f64 = (0..3).map(|k| f64::from(n[k]) * (p[k] - 5.0) / 2.0).sum();
        assert!(out > 0.9, "{out}");
    }
    // Normals of the input are taken as they are, also inward.
    let inward: Vec<[f32; 3]> = (points.iter())
        .map(|p| p.map(|c| (5.0 - c) as f32 / 2.0))
        .collect();
    let carried = result.vertex_sources().normals(&inward, &own);
    for ((n, p), s) in (carried.iter())
        .zip(&result.crust.mesh.vertices)
        .zip(&result.crust.vertex_samples)
    {
        let out: f64 = (0..3).map(|k| f64::from(n[k]) * (p[k] - 5.0) / 2.0).sum();
        assert!(out < -0.9, "{out}");
        if *s != NONE {
            assert_eq!(*n, inward[result.sample_source[*s as usize] as usize]);
        }
    }
}

#[test]
fn thickness_is_that_of_the_solid_and_holes_are_where_samples_are_missing() {
    let whole = sphere(3000, 1.0, [0.0; 3]);
    let result = crust(&whole);
    let mut thickness = result.face_thickness();
    thickness.sort_by(f64::total_cmp);
    assert!(near(thickness[thickness.len() / 2], 2.0, 0.02));
    let (both, gap) = (result.face_polar_radii(), result.face_gap());
    assert_eq!(both.len(), gap.len());
    for ((both, gap), thick) in both.iter().zip(gap).zip(result.face_thickness()) {
        assert!(near(*both, (gap + thick) / 2.0, 1e-12));
    }
    // Needles of nearly flat power faces go.
    let shapes = [result.stats.shape_before, result.stats.shape_after];
    let needles = shapes.map(|s| s.aspects[4..].iter().sum::<u64>());
    let all = shapes.map(|s| s.aspects.iter().sum::<u64>());
    assert_eq!(all[1], result.crust.mesh.face_count() as u64);
    assert!(needles[1] * all[0] <= needles[0] * all[1], "{shapes:?}");
    assert!(
        shapes[1].smallest_angle > shapes[0].smallest_angle,
        "{shapes:?}"
    );
    assert!(result.face_holes().iter().all(|&h| h == 0));

    // Of a bowl less than half a sphere is there: the balls inside and above
    // bulge through its opening.
    let bowl = |p: &&Point| p[2] < -0.6;
    let open: Vec<Point> = whole.iter().filter(bowl).copied().collect();
    let result = crust(&open);
    let mesh = &result.crust.mesh;
    let holes = result.face_holes();
    let (mut closing, mut flagged) = (0, 0);
    for (face, &hole) in mesh.faces().zip(&holes) {
        let mean = |k: usize| {
            face.iter()
                .map(|&v| mesh.vertices[v as usize][k])
                .sum::<f64>()
                / face.len() as f64
        };
        let middle = [mean(0), mean(1), mean(2)];
        let on_sphere = middle.iter().map(|c| c * c).sum::<f64>() > 0.97;
        match on_sphere {
            // At the rim either may be.
            true => assert!(hole == 0 || middle[2] > -0.65, "{middle:?}"),
            false => {
                closing += 1;
                flagged += u32::from(hole);
            }
        }
    }
    assert!(
        closing > 0 && flagged * 10 >= closing * 9,
        "{flagged} of {closing}"
    );
}

// ------------------------------------------------------------------- planes

/// The largest and the number of the distances from samples to their vertices.
fn moved(points: &[Point], options: &Options) -> (f64, usize) {
    let result = reconstruct(points, options, &Context::default()).unwrap();
    assert_sound(&result.crust.mesh);
    let samples = result.crust.vertex_samples.iter();
    let pairs = result.crust.mesh.vertices.iter().zip(samples);
    let far = pairs.filter(|(_, &s)| s != NONE).map(|(v, &s)| {
        let p = points[result.sample_source[s as usize] as usize];
        (0..3).map(|k| (v[k] - p[k]).powi(2)).sum::<f64>().sqrt()
    });
    far.fold((0.0, 0), |(most, count), d| {
        (f64::max(most, d), count + usize::from(d > 0.0))
    })
}

/// MeshLab found crossings between triangles of one tilted plane that shared
/// nothing: rounding alone told them apart.
#[test]
fn samples_amid_tilted_planes_leave_them_by_a_hair() {
    let mut cube = Vec::new();
    for i in 0..900 {
        let part = |share: f64| 2.0 * (f64::from(i) * share).fract() - 1.0;
        let mut p = [part(0.754_877_666), part(0.569_840_296), 0.0];
        p[2] = if i % 2 == 0 { 1.0 } else { -1.0 };
        p.rotate_right(i as usize % 3);
        cube.push(p);
    }
    let turn = |[x, y, z]: Point| {
        let third = 1.0 / 3.0;
        [
            third * (2.0 * x - y + 2.0 * z),
            third * (2.0 * x + 2.0 * y - z),
            third * (-x + 2.0 * y + 2.0 * z),
        ]
    };
    let tilted: Vec<Point> = cube.iter().copied().map(turn).collect();
    let plain = Options::default();
    let (most, count) = moved(&tilted, &plain);
    assert!(most < 2f64.powi(-42) * 4.0, "{most:e}");
    assert!(count > 100, "{count}");
    // To the last bit along the axes, and where it is asked for.
    assert_eq!(moved(&cube, &plain), (0.0, 0));
    let exact = Options {
        interpolate: Some(true),
        ..plain
    };
    assert_eq!(moved(&tilted, &exact), (0.0, 0));
}

// -------------------------------------------------------------- components

#[test]
fn parts_and_cavities_are_told_apart() {
    let result = crust(&hollow_and_solid());
    let shells = Shells::of(&result.crust.mesh);
    let ball = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r * r * r;
    assert_eq!(shells.part_volumes.len(), 2);
    assert!(near(shells.part_volumes[0], ball(1.0), 0.02));
    assert!(near(shells.part_volumes[1], ball(0.4), 0.03));
    assert_eq!(shells.cavities.len(), 1);
    assert!(near(shells.cavities[0].0, ball(0.5), 0.03));
    assert_eq!(shells.cavities[0].1, 0);
    assert_eq!(shells.part_of_face.len(), result.crust.mesh.face_count());

    let plain = ShellFilter::default();
    let keep = Keep::Largest(1);
    let one = ShellFilter { keep, ..plain };
    let drop_cavities = true;
    let filled = ShellFilter {
        drop_cavities,
        ..plain
    };
    let min_volume = Some(MinVolume::Share(0.1));
    let large = ShellFilter {
        min_volume,
        ..plain
    };
    for (filter, volume) in [
        (plain, ball(1.0) - ball(0.5) + ball(0.4)),
        (one, ball(1.0) - ball(0.5)),
        (filled, ball(1.0) + ball(0.4)),
        (large, ball(1.0) - ball(0.5)),
    ] {
        let (kept, selection) = filter_shells(&result.crust, &filter);
        assert!(near(kept.mesh.volume(), volume, 0.03), "{filter:?}");
        assert_sound(&kept.mesh);
        assert_eq!(kept.vertex_samples.len(), kept.mesh.vertices.len());
        assert_eq!(kept.face_balls.len(), kept.mesh.face_count());
        for (new, &old) in selection.vertices.iter().enumerate() {
            assert_eq!(
                kept.mesh.vertices[new],
                result.crust.mesh.vertices[old as usize]
            );
            assert_eq!(
                kept.vertex_samples[new],
                result.crust.vertex_samples[old as usize]
            );
        }
        for (new, &old) in selection.faces.iter().enumerate() {
            assert_eq!(kept.face_balls[new], result.crust.face_balls[old as usize]);
        }
    }
}

// -------------------------------------------------------------- decimation

#[test]
fn reduced_surfaces_stay_sound_and_near() {
    for points in [hollow_and_solid(), sphere(3000, 1.0, [4e6, 5e5, 100.0])] {
        let result = crust(&points);
        let mesh = &result.crust.mesh;
        for part in [2, 4, 20] {
            let target = mesh.face_count() / part;
            let fewer = decimate(mesh, target, &Context::default()).unwrap();
            assert!(fewer.mesh.face_count() <= target);
            assert!(fewer.mesh.face_count() + 2 > target);
            assert_sound(&fewer.mesh);
            for (p, &v) in fewer.mesh.vertices.iter().zip(&fewer.vertices) {
                assert_eq!(*p, mesh.vertices[v as usize]);
            }
            assert_eq!(fewer.faces.len(), fewer.mesh.face_count());
            let shells = |m: &PolygonMesh| {
                let shells = Shells::of(m);
                (shells.part_volumes.len(), shells.cavities.len())
            };
            assert_eq!(shells(&fewer.mesh), shells(mesh));
            let moved = deviation(mesh, &fewer.mesh, &Context::default()).unwrap();
            // A sphere, flattened: the error grows as the number of faces falls.
            let most = 3e-4 * part as f64;
            assert!(moved.mean_of_diagonal < most, "{part}: {moved:?}");
            assert!(moved.max >= moved.mean);
        }
    }
}

#[test]
fn a_thin_wall_is_not_pierced() {
    // A bowl: the inner side would come through the outer one.
    let mut points = sphere(3000, 1.0, [0.0; 3]);
    points.extend(sphere(3000, 0.93, [0.0; 3]));
    let result = crust(&points);
    assert_sound(&result.crust.mesh);
    let fewer = decimate(&result.crust.mesh, 4, &Context::default()).unwrap();
    assert!(fewer.refused > 0);
    assert!(fewer.mesh.face_count() < result.crust.mesh.face_count() / 10);
    assert_sound(&fewer.mesh);
}

#[test]
fn what_cannot_be_reduced_is_refused() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut mesh = PolygonMesh::with_vertices(corners);
    for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3]] {
        mesh.push_face(&face);
    }
    let cx = Context::default();
    let open = decimate(&mesh, 4, &cx).unwrap_err();
    assert!(matches!(open, DecimateError::NotManifold { .. }));
    mesh.push_face(&[2, 0, 3]);
    // A tetrahedron is as small as it gets.
    assert_eq!(decimate(&mesh, 0, &cx).unwrap().mesh, mesh);
    mesh.push_face(&[0, 1, 2, 3]);
    let error = decimate(&mesh, 4, &cx).unwrap_err();
    assert_eq!(error, DecimateError::NoTriangle { face: 4 });
    let none = PolygonMesh::default();
    assert_eq!(decimate(&none, 4, &cx).unwrap().mesh.face_count(), 0);
}

// --------------------------------------------------------------------- GLB

/// The JSON part and the binary part of a GLB file.
fn parse_glb(bytes: &[u8]) -> (serde_json::Value, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!(&bytes[..4], b"glTF");
    assert_eq!((word(4), word(8) as usize), (2, bytes.len()));
    let head = word(12) as usize;
    assert_eq!((head % 4, &bytes[16..20]), (0, &b"JSON"[..]));
    let json = serde_json::from_slice(&bytes[20..20 + head]).unwrap();
    let body = word(20 + head) as usize;
    assert_eq!(&bytes[24 + head..28 + head], b"BIN\0");
    assert_eq!(28 + head + body, bytes.len());
    (json, &bytes[28 + head..])
}

/// The bytes of an accessor.
fn accessor<'a>(json: &serde_json::Value, body: &'a [u8], at: &serde_json::Value) -> &'a [u8] {
    let accessor = &json["accessors"][at.as_u64().unwrap() as usize];
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let number = |key: &str| view[key].as_u64().unwrap() as usize;
    assert_eq!(number("byteOffset") % 4, 0);
    &body[number("byteOffset")..number("byteOffset") + number("byteLength")]
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    let number = |b: &[u8]| f32::from_le_bytes(b.try_into().unwrap());
    bytes.chunks_exact(4).map(number).collect()
}

#[test]
fn glb_holds_the_mesh_about_its_middle() {
    // Far from the origin 32 bits would be half a unit apart.
    let result = crust(&sphere(300, 1.0, [4_000_000.1, 500_000.2, 77.0]));
    let mesh = &result.crust.mesh;
    let normals = result.vertex_normals();
    let colours = vec![[255, 128, 0, 255]; mesh.vertices.len()];
    let attributes = MeshAttributes {
        normals: Some(&normals),
        colours: Some(&colours),
        ..MeshAttributes::default()
    };
    let mut bytes = Vec::new();
    let plain = WriteOptions::default();
    write_mesh(&mut bytes, MeshFormat::Glb, mesh, &attributes, &plain).unwrap();
    let (json, body) = parse_glb(&bytes);
    assert_eq!(json["asset"]["version"], "2.0");
    let primitive = &json["meshes"][0]["primitives"][0];
    let names = &primitive["attributes"];
    let moved: Vec<f64> = serde_json::from_value(json["nodes"][0]["translation"].clone()).unwrap();
    let positions = floats(accessor(&json, body, &names["POSITION"]));
    let written = as_written(MeshFormat::Glb, &mesh.vertices, &plain);
    for (v, local) in positions.chunks_exact(3).enumerate() {
        for k in 0..3 {
            assert_eq!(written[v][k], moved[k] + f64::from(local[k]));
            assert!((written[v][k] - mesh.vertices[v][k]).abs() < 1e-6);
        }
    }
    let lowest = positions.chunks_exact(3).fold(f32::MAX, |m, p| m.min(p[2]));
    let entry = names["POSITION"].as_u64().unwrap() as usize;
    assert_eq!(
        json["accessors"][entry]["min"][2].as_f64().unwrap() as f32,
        lowest
    );
    for n in floats(accessor(&json, body, &names["NORMAL"])).chunks_exact(3) {
        assert!((n.iter().map(|c| c * c).sum::<f32>() - 1.0).abs() < 1e-5);
    }
    // Colours as light: full, a little more than a fifth, none.
    let colour: Vec<u16> = (accessor(&json, body, &names["COLOR_0"])[..8].chunks_exact(2))
        .map(|b| u16::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(colour, [65535, 14146, 0, 65535]);
    let indices: Vec<u32> = (accessor(&json, body, &primitive["indices"]).chunks_exact(4))
        .map(|b| u32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(indices, mesh.corners);
}

#[test]
fn glb_keeps_32_bit_coordinates_and_refuses_what_does_not_fit() {
    let options = Options {
        single: true,
        ..Options::default()
    };
    let points = sphere(300, 1.0, [10.0, 0.0, 0.0]);
    let result = reconstruct(&points, &options, &Context::default()).unwrap();
    let vertices = &result.crust.mesh.vertices;
    let plain = WriteOptions::default();
    assert_eq!(as_written(MeshFormat::Glb, vertices, &plain), *vertices);
    assert_eq!(as_written(MeshFormat::Stl, vertices, &plain), *vertices);
    let float32 = WriteOptions {
        float32: true,
        ..plain.clone()
    };
    assert_eq!(as_written(MeshFormat::Ply, vertices, &float32), *vertices);
    let digits = WriteOptions {
        digits: Some(2),
        ..plain.clone()
    };
    assert_eq!(
        as_written(MeshFormat::Obj, &[[1.26, 0.0, -123.0]], &digits),
        [[1.3, 0.0, -120.0]]
    );

    let mut bytes = Vec::new();
    let mut write = |mesh: &PolygonMesh| {
        let none = MeshAttributes::default();
        write_mesh(&mut bytes, MeshFormat::Glb, mesh, &none, &plain)
    };
    assert!(write(&PolygonMesh::with_vertices(vec![[0.0; 3]])).is_err());
    let mut wide = PolygonMesh::with_vertices(vec![[0.0; 3], [1e300, 0.0, 0.0], [0.0, 1e300, 0.0]]);
    wide.push_face(&[0, 1, 2]);
    assert!(write(&wide).is_err());
}
