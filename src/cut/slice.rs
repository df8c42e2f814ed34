//! From mesh and plane to outline and frame.

use super::union::Region;
use super::{Error, Outline, Plane, PlaneFrame, close, section, simplify, union};
use crate::geom::{P2, Rect, signed_area};
use crate::mesh::TriMesh;
use crate::progress::Warning;

/// Steepest plane (45 degrees from vertical) for which the floor is the mesh's: flatter ones meet the ground far from the body.
const MAX_LEAN: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// So many left-out pieces are named one by one.
const NAMED: usize = 5;

/// How an outline is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Points of the outline are dropped as long as the border moves by no more than this, mm. Default 0.1: a paper's thickness.
    pub simplify_mm: f64,
    /// Holes and separate pieces under this area are ignored, mm^2. Default 10: a strip cannot be folded round less.
    pub min_area_mm2: f64,
    /// Height of the ground along the mesh's up, mm: an object's, when the mesh is one part of it. Default: the mesh's lowest point.
    pub ground_mm: Option<f64>,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings { simplify_mm: 0.1, min_area_mm2: 10.0, ground_mm: None }
    }
}

/// What a plane cuts out of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Where the outline lies. v = 0 is the floor; u = 0 is the middle of the outline's box.
    pub frame: PlaneFrame,
    /// The largest region the plane meets, with its holes: simple loops, mm.
    pub outline: Outline,
    /// Gaps that were closed, and pieces left out.
    pub warnings: Vec<Warning>,
}

/// The outline of `mesh` on `plane`: loops that overlap are united, and the largest region is taken.
///
/// The frame's v is up seen in the plane (see [`PlaneFrame::new`]). The floor v = 0 is where the ground (under the mesh's lowest point, unless the settings say) meets
/// the plane, so that a part keeps its height in the object; for planes more than 45 degrees from vertical it is the outline's lowest point.
///
/// # Errors
/// A plane that misses (with the offsets that would hit), a cut under the smallest area, a plane without direction, an empty mesh.
pub fn cut(mesh: &TriMesh, plane: &Plane, settings: &Settings) -> Result<Cut, Error> {
    if mesh.triangles.is_empty() {
        return Err(Error::EmptyMesh);
    }
    let finite = plane.origin.coords.iter().chain(plane.normal.iter()).all(|x| x.is_finite());
    let normal = plane
        .normal
        .try_normalize(1e-12)
        .filter(|_| finite)
        .ok_or(Error::BadPlane { origin: plane.origin.coords.into(), normal: plane.normal.into() })?;
    // The plane's point nearest to the mesh's middle: plane coordinates then stay small, wherever the plane's own point lies.
    let (lo, hi) = mesh.bounds();
    let middle = nalgebra::center(&lo, &hi);
    let origin = middle - normal * (middle - plane.origin).dot(&normal);
    let frame = PlaneFrame::new(&Plane { origin, normal }, mesh.up);
    let chains = section::chains(mesh, &frame);
    if chains.is_empty() {
        return Err(Error::Misses { hits: section::hits(mesh, &frame) });
    }
    let closed = close::close(chains);
    let mut regions = union::regions(&closed.loops).into_iter();
    let too_small = |area_mm2| Error::TooSmall { area_mm2, min_area_mm2: settings.min_area_mm2 };
    let largest = regions.next().ok_or(too_small(0.0))?;
    if largest.area() < settings.min_area_mm2 {
        return Err(too_small(largest.area()));
    }
    let others: Vec<Region> = regions.filter(|region| region.area() >= settings.min_area_mm2).collect();
    let holes = largest.holes.into_iter().filter(|hole| signed_area(hole).abs() >= settings.min_area_mm2).collect();
    let outline = simplify::simplify(&Outline { outer: largest.outer, holes }, settings.simplify_mm);

    let floor = if normal.dot(&mesh.up).abs() <= MAX_LEAN {
        // Up along v rises by the cosine of the lean.
        let ground = settings.ground_mm.unwrap_or(mesh.height_range().0);
        (ground - frame.origin.coords.dot(&mesh.up)) / frame.v.dot(&mesh.up)
    } else {
        outline.bounds().min.y
    };
    let zero = P2::new(outline.bounds().center().x, floor);
    let shifted = |points: &Vec<P2>| points.iter().map(|p| P2::from(p - zero)).collect();
    let mut warnings = closed.warnings(zero);
    warnings.extend(left_out(&others, zero));
    Ok(Cut {
        frame: PlaneFrame { origin: frame.to_space(zero, 0.0), ..frame },
        outline: Outline { outer: shifted(&outline.outer), holes: outline.holes.iter().map(shifted).collect() },
        warnings,
    })
}

/// Names the pieces the plane also meets.
fn left_out(others: &[Region], zero: P2) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = others
        .iter()
        .take(NAMED)
        .map(|region| {
            let at = Rect::around(&region.outer).center() - zero;
            let message = format!(
                "the plane also meets a separate piece of {:.0} mm2, which is left out; give it a part with a plane of its own",
                region.area()
            );
            Warning::new("cut-piece-left-out", message).at(format!("u {:.1}, v {:.1} mm", at.x, at.y))
        })
        .collect();
    if let Some(next) = others.get(NAMED) {
        let more = others.len() - NAMED;
        let message = format!("{more} more separate pieces, up to {:.0} mm2, are left out", next.area());
        warnings.push(Warning::new("cut-piece-left-out", message));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{P3, V3};
    use crate::mesh::samples::{cuboid, inside_out, sphere, together};
    use proptest::prelude::*;

    fn front(z: f64) -> Plane {
        Plane { origin: P3::new(3.0, 50.0, z), normal: V3::z() }
    }

    fn front_cut(mesh: &TriMesh) -> Cut {
        cut(mesh, &front(0.0), &Settings::default()).unwrap()
    }

    #[test]
    fn a_cuboid_gives_its_rectangle_centred_on_the_floor() {
        let cut = front_cut(&cuboid(P3::new(10.0, 20.0, -30.0), V3::new(100.0, 80.0, 60.0)));
        assert_eq!(cut.warnings, []);
        assert_eq!(cut.outline.outer.len(), 4);
        let corners = [(-50.0, 0.0), (50.0, 0.0), (50.0, 80.0), (-50.0, 80.0)].map(|(x, y)| P2::new(x, y));
        for corner in corners {
            assert!(cut.outline.outer.iter().any(|p| (p - corner).norm() < 1e-5), "{:?}", cut.outline.outer);
        }
        assert!((cut.frame.origin - P3::new(60.0, 20.0, 0.0)).norm() < 1e-5);
        assert!(signed_area(&cut.outline.outer) > 0.0);
    }

    #[test]
    fn the_floor_is_the_lowest_point_of_the_mesh_not_of_the_outline() {
        let tall = cuboid(P3::new(0.0, 10.0, -5.0), V3::repeat(20.0));
        let low = cuboid(P3::new(0.0, 0.0, 50.0), V3::repeat(20.0));
        assert!((front_cut(&together(&[tall, low])).outline.bounds().min.y - 10.0).abs() < 1e-5);
    }

    #[test]
    fn a_leaning_plane_meets_the_ground_at_the_floor_and_a_plan_lies_on_its_lowest_point() {
        let cube = cuboid(P3::new(-50.0, 0.0, -50.0), V3::repeat(100.0));
        let lean = Plane { origin: P3::new(0.0, 50.0, 0.0), normal: V3::new(0.0, 0.5, 1.0) };
        let leaning = cut(&cube, &lean, &Settings::default()).unwrap();
        assert!(leaning.frame.to_space(P2::origin(), 0.0).y.abs() < 1e-5);
        assert!(leaning.outline.bounds().min.y.abs() < 1e-5);
        let flat = Plane { origin: P3::new(0.0, 50.0, 0.0), normal: V3::y() };
        let plan = cut(&cube, &flat, &Settings::default()).unwrap();
        assert!(plan.outline.bounds().min.y.abs() < 1e-9 && (plan.outline.area() - 1e4).abs() < 0.1);
    }

    #[test]
    fn a_part_above_the_ground_keeps_its_height() {
        let part = cuboid(P3::new(0.0, 40.0, -5.0), V3::repeat(20.0));
        let settings = Settings { ground_mm: Some(10.0), ..Settings::default() };
        let cut = cut(&part, &front(0.0), &settings).unwrap();
        assert!((cut.outline.bounds().min.y - 30.0).abs() < 1e-5 && (cut.frame.origin.y - 10.0).abs() < 1e-9);
    }

    #[test]
    fn overlapping_bodies_are_one_outline_and_separate_ones_a_warning() {
        let a = cuboid(P3::new(0.0, 0.0, -5.0), V3::new(20.0, 10.0, 10.0));
        let b = cuboid(P3::new(15.0, 2.0, -5.0), V3::new(20.0, 5.0, 10.0));
        let far = cuboid(P3::new(60.0, 0.0, -5.0), V3::new(10.0, 10.0, 10.0));
        let speck = cuboid(P3::new(90.0, 0.0, -5.0), V3::new(1.0, 1.0, 10.0));
        let cut = front_cut(&together(&[a, far, b, speck]));
        assert!((cut.outline.area() - 275.0).abs() < 1e-3);
        assert_eq!(cut.outline.outer.len(), 8);
        assert_eq!(cut.warnings.len(), 1);
        assert!(cut.warnings[0].message.contains("100 mm2"));
        assert_eq!(cut.warnings[0].place.as_deref(), Some("u 47.5, v 5.0 mm"));
    }

    #[test]
    fn a_hollow_is_a_hole_and_a_tiny_one_is_not() {
        let body = cuboid(P3::new(0.0, 0.0, -50.0), V3::repeat(100.0));
        let hollow = inside_out(cuboid(P3::new(20.0, 20.0, -20.0), V3::repeat(40.0)));
        let bubble = inside_out(cuboid(P3::new(80.0, 80.0, -1.0), V3::repeat(2.0)));
        let cut = front_cut(&together(&[body, hollow, bubble]));
        assert_eq!(cut.outline.holes.len(), 1);
        assert!((cut.outline.area() - 8400.0).abs() < 1e-2);
    }

    #[test]
    fn planes_beside_the_body_say_where_it_is() {
        let cube = cuboid(P3::new(0.0, 0.0, 10.0), V3::repeat(20.0));
        let error = cut(&cube, &front(-5.0), &Settings::default()).unwrap_err();
        assert_eq!(error, Error::Misses { hits: vec![(15.0, 35.0)] });
        assert!(error.to_string().contains("15.00 to 35.00 mm"), "{error}");
        let skimming = Plane { origin: P3::new(0.5, 0.0, 10.5), normal: V3::new(1.0, 0.0, 1.0) };
        assert!(matches!(
            cut(&cube, &skimming, &Settings { min_area_mm2: 60.0, ..Settings::default() }),
            Err(Error::TooSmall { .. })
        ));
        let nowhere = Plane { origin: P3::origin(), normal: V3::zeros() };
        assert!(matches!(cut(&cube, &nowhere, &Settings::default()), Err(Error::BadPlane { .. })));
    }

    proptest! {
        #[test]
        fn every_point_of_the_outline_lies_on_the_surface(
            n in prop::array::uniform3(-1.0..1.0f64), offset in -30.0..30.0f64,
        ) {
            prop_assume!(V3::from(n).norm() > 0.1);
            let n = V3::from(n).normalize();
            let ball = sphere(P3::new(5.0, 60.0, 7.0), 50.0, 48);
            let plane = Plane { origin: P3::new(5.0, 60.0, 7.0) + n * offset, normal: n };
            let cut = cut(&ball, &plane, &Settings::default()).unwrap();
            prop_assert!((cut.frame.u.cross(&cut.frame.v) - n).norm() < 1e-9);
            prop_assert!(cut.outline.holes.is_empty() && cut.outline.outer.len() < 100);
            for p in &cut.outline.outer {
                let on = cut.frame.to_space(*p, 0.0);
                let r = (on - P3::new(5.0, 60.0, 7.0)).norm();
                prop_assert!((49.4..50.001).contains(&r), "{r}");
                prop_assert!((on - plane.origin).dot(&n).abs() < 1e-9);
            }
        }
    }
}
