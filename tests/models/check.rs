//! The models are what their program makes, and what a user's first model should be: sound, and cut to one outline.

mod shapes;

use furbelow::cut::{self, Outline};
use furbelow::geom::{P2, V3};
use furbelow::mesh::{self, Loaded};
use std::path::{Path, PathBuf};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(name)
}

fn loaded(name: &str) -> Loaded {
    mesh::load(&path(name), &mesh::Settings::default()).unwrap()
}

fn outline(name: &str) -> Outline {
    let mesh = loaded(name).mesh;
    let plane = cut::default_plane(&mesh).unwrap();
    assert!((plane.normal - V3::z()).norm() < 1e-9, "{name} faces {}", plane.normal);
    let cut = cut::cut(&mesh, &plane, &cut::Settings::default()).unwrap();
    assert_eq!(cut.warnings, [], "{name}");
    cut.outline
}

#[test]
fn the_files_are_what_the_program_writes() {
    for (name, shape) in shapes::all() {
        let text = std::fs::read_to_string(path(name)).unwrap();
        assert!(text == shape.to_obj(name.trim_end_matches(".obj")), "{name} is stale: cargo run --example models");
        assert!(text.len() < 300_000, "{name} is {} bytes", text.len());
    }
}

#[test]
fn every_model_is_closed_faces_outward_and_loads_without_a_word() {
    let components = |name: &str| if name == "teddy.obj" { 8 } else { 1 };
    for (name, _) in shapes::all() {
        let loaded = loaded(name);
        assert_eq!(loaded.warnings, [], "{name}");
        assert_eq!(loaded.components, components(name), "{name}");
        assert!(loaded.mesh.is_closed(), "{name}");
        assert_eq!(loaded.mesh.height_range().0, 0.0, "{name}");
    }
}

#[test]
fn models_have_the_sizes_they_are_described_with() {
    for (name, size) in [
        ("cuboid.obj", [100.0, 100.0, 60.0]),
        ("stool.obj", [160.0, 100.0, 90.0]),
        ("teddy.obj", [172.0, 180.0, 68.0]),
        ("lampshade.obj", [145.0, 150.0, 145.0]),
        ("shell.obj", [200.0, 90.0, 120.0]),
    ] {
        let (lo, hi) = loaded(name).mesh.bounds();
        for axis in 0..3 {
            assert!((hi[axis] - lo[axis] - size[axis]).abs() < 1.0, "{name}: {}", hi - lo);
        }
    }
}

#[test]
fn every_model_cuts_to_one_symmetric_outline_on_the_floor() {
    for (name, _) in shapes::all() {
        let outline = outline(name);
        assert!(outline.holes.is_empty(), "{name}");
        assert!(outline.bounds().min.y.abs() < 0.5, "{name}");
        for p in &outline.outer {
            let mirrored = outline.signed_distance(P2::new(-p.x, p.y));
            assert!(mirrored.abs() < 0.25, "{name}: {p} is {mirrored} from its mirror image");
        }
    }
}

#[test]
fn the_stool_has_a_waist_and_a_dip() {
    let stool = outline("stool.obj");
    let width = |v: f64| stool.chords(v).iter().map(|(a, b)| b - a).sum::<f64>();
    assert_eq!(stool.chords(50.0).len(), 1);
    assert!(width(50.0) < 0.85 * width(8.0) && width(50.0) < 0.85 * width(84.0));
    assert_eq!(stool.chords(95.0).len(), 2, "two rims above the dip");
}

#[test]
fn the_teddy_is_cut_through_every_limb() {
    let teddy = outline("teddy.obj");
    for (part, u, v) in [("ear", 36.0, 172.0), ("arm", 80.0, 94.0), ("leg", 26.0, 10.0), ("head", 0.0, 140.0)] {
        assert!(teddy.contains(P2::new(u, v)) && teddy.contains(P2::new(-u, v)), "{part}");
    }
    assert_eq!(teddy.chords(8.0).len(), 2, "two feet");
}
