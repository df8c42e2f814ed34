//! The way from a file to a checked mesh.

use super::edges;
use super::holes::{self, Hole};
use super::weld::Dropped;
use super::{Error, TriMesh, obj, orient, size, stl, weld};
use crate::geom::{P3, V3};
use crate::progress::Warning;
use std::io::Read;
use std::path::Path;

/// Longest file that is read, bytes.
pub const MAX_BYTES: u64 = 1 << 30;
/// Most triangles that are kept: ten times a detailed scan, and about 1 GiB of memory at the widest point of the way.
pub(super) const MAX_FACES: usize = 4_000_000;
/// So many holes and gaps are named one by one; the rest is counted.
const NAMED: usize = 5;

/// A mesh file's format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// STL, binary or ASCII.
    Stl,
}

impl Format {
    /// The format a file's extension names, in any case.
    pub fn from_path(path: &Path) -> Option<Format> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(Format::Obj),
            "stl" => Some(Format::Stl),
            _ => None,
        }
    }
}

/// Which axis of the file points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Up {
    /// The file's x axis.
    X,
    /// The file's y axis: usual for OBJ.
    Y,
    /// The file's z axis: usual for STL.
    Z,
}

impl Up {
    /// The axis as a unit vector.
    pub fn vector(self) -> V3 {
        match self {
            Up::X => V3::x(),
            Up::Y => V3::y(),
            Up::Z => V3::z(),
        }
    }
}

/// How a file is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Which axis points up; `None`: y for OBJ, z for STL.
    pub up: Option<Up>,
    /// Height the mesh is scaled to, mm; `None`: a file unit is a mm, if that makes sense.
    pub height_mm: Option<f64>,
    /// Longest side of the machine's bed, mm: without a height, a mesh over five times as high is refused.
    pub bed_mm: f64,
    /// Holes whose rim is at most this fraction of the mesh's diagonal wide are closed.
    pub max_hole_fraction: f64,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings { up: None, height_mm: None, bed_mm: 400.0, max_hole_fraction: 0.1 }
    }
}

/// A mesh, and what was learnt on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The mesh, mm.
    pub mesh: TriMesh,
    /// Pieces that share no edge.
    pub components: usize,
    /// mm per unit of the file.
    pub scale: f64,
    /// What was mended, and what is still wrong.
    pub warnings: Vec<Warning>,
}

/// Triangles on the way to being a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Soup {
    pub(super) vertices: Vec<P3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Soup {
    pub(super) fn corners(&self, triangle: usize) -> [P3; 3] {
        self.triangles[triangle].map(|i| self.vertices[i as usize])
    }
}

/// Reads the file at `path`; its extension says the format.
///
/// # Errors
/// What [`parse`] gives, and files that cannot be read, are over 1 GiB, or neither .obj nor .stl.
pub fn load(path: &Path, settings: &Settings) -> Result<Loaded, Error> {
    let name = path.display().to_string();
    let format = Format::from_path(path).ok_or_else(|| Error::UnknownFormat { name: name.clone() })?;
    let unreadable = |source| Error::Read { name: name.clone(), source };
    let file = std::fs::File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    // Not by the length the system tells: pipes and devices have none.
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(Error::TooLarge { name, limit: MAX_BYTES });
    }
    parse(&name, &bytes, format, settings)
}

/// Makes a mesh of a file's bytes; `name` is what messages call it.
///
/// # Errors
/// Broken syntax, indices or numbers (with the place), no faces, over four million triangles, a flat or gigantic body, and a height that
/// makes no sense in mm when none is given.
pub fn parse(name: &str, bytes: &[u8], format: Format, settings: &Settings) -> Result<Loaded, Error> {
    // Some programs begin text files with a byte order mark.
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if bytes.is_empty() {
        return Err(Error::NoFaces { name: name.into() });
    }
    let (mut soup, usual_up) = match format {
        Format::Obj => (obj::read(name, bytes)?, Up::Y),
        Format::Stl => (stl::read(name, bytes)?, Up::Z),
    };
    if soup.triangles.is_empty() {
        return Err(Error::NoFaces { name: name.into() });
    }
    let up = settings.up.unwrap_or(usual_up).vector();
    let scale = size::scale(name, &soup, up, settings)?;
    soup.vertices.iter_mut().for_each(|p| *p *= scale);
    let used = soup.triangles.iter().flatten().map(|i| &soup.vertices[*i as usize]);
    let (lo, hi) = super::trimesh::bounds(used);
    let diagonal_mm = (hi - lo).norm();

    let (mut soup, dropped) = weld::weld(soup, weld::TOLERANCE * diagonal_mm);
    if soup.triangles.is_empty() {
        return Err(Error::NoFaces { name: name.into() });
    }
    let mut warnings = drop_warnings(&dropped);
    let turned = orient::agree(&mut soup.triangles);
    let (small, large): (Vec<Hole>, Vec<Hole>) =
        holes::find(&soup).into_iter().partition(|hole| hole.extent <= settings.max_hole_fraction * diagonal_mm);
    small.iter().for_each(|hole| holes::close(&mut soup, hole));
    let patches = orient::outward(&mut soup);

    if turned > 0 {
        let message = format!("{turned} triangles faced the other way than their neighbours and were turned");
        warnings.push(Warning::new("mesh-turned", message));
    }
    if patches > 0 {
        let message = format!("{patches} closed or bulging parts of the surface faced inward and were turned outward");
        warnings.push(Warning::new("mesh-inside-out", message));
    }
    warnings.extend(hole_warnings(&small, &large));
    warnings.extend(edge_warnings(&soup, &large));
    let (_, components) = edges::groups(soup.triangles.len(), &edges::of(&soup.triangles), |_| true);
    let mesh = TriMesh { vertices: soup.vertices, triangles: soup.triangles, up };
    Ok(Loaded { mesh, components, scale, warnings })
}

fn drop_warnings(dropped: &Dropped) -> Vec<Warning> {
    let say =
        |count: usize, code, what: &str| (count > 0).then(|| Warning::new(code, format!("{count} triangles {what}")));
    [
        say(dropped.degenerate, "mesh-degenerate", "had two corners in one place and were dropped"),
        say(dropped.repeated, "mesh-repeated", "were there twice and were dropped"),
        say(dropped.back_sides, "mesh-double-sided", "were back sides of others and were dropped"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn hole_warnings(small: &[Hole], large: &[Hole]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let mut name = |holes: &[Hole], code, begin: &str, end: &str| {
        for hole in holes.iter().take(NAMED) {
            let message = format!("{begin} {:.2} mm wide with {} edges {end}", hole.extent, hole.rim.len());
            warnings.push(Warning::new(code, message).at(place(hole.middle)));
        }
        if let Some(more) = holes.len().checked_sub(NAMED).filter(|more| *more > 0) {
            let widest = holes[NAMED..].iter().map(|hole| hole.extent).fold(0.0, f64::max);
            warnings.push(Warning::new(code, format!("{more} more like this, up to {widest:.2} mm wide")));
        }
    };
    name(small, "mesh-hole-closed", "a hole", "was closed");
    name(large, "mesh-open", "an opening", "stays open; cuts across it are closed by a straight line");
    warnings
}

fn edge_warnings(soup: &Soup, large: &[Hole]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if let (count @ 1.., Some(first)) = holes::non_manifold(soup) {
        let message =
            format!("more than two triangles meet at {count} edges; cuts there take the nearest sensible loop");
        warnings.push(Warning::new("mesh-non-manifold", message).at(place(first)));
    }
    if let (count @ 1.., Some(first)) = holes::unbalanced(soup)
        && large.is_empty()
    {
        let message = format!(
            "{count} edges are open or have both triangles facing the same way; repair the mesh if the outline looks wrong"
        );
        warnings.push(Warning::new("mesh-open", message).at(place(first)));
    }
    warnings
}

fn place(p: P3) -> String {
    format!("x {:.1}, y {:.1}, z {:.1} mm", p.x, p.y, p.z)
}

#[cfg(test)]
mod tests {
    use super::super::samples::{cuboid, inside_out, obj_text, sphere, together};
    use super::*;

    fn parsed(mesh: &TriMesh) -> Loaded {
        parse("a.obj", obj_text(mesh).as_bytes(), Format::Obj, &Settings::default()).unwrap()
    }

    fn codes(loaded: &Loaded) -> Vec<&str> {
        loaded.warnings.iter().map(|w| w.code).collect()
    }

    #[test]
    fn a_sound_mesh_is_kept_in_its_axes_without_a_word() {
        let mesh = together(&[
            cuboid(P3::new(1.0, 2.0, 3.0), V3::new(10.0, 20.0, 30.0)),
            sphere(P3::new(90.0, 10.0, 0.0), 10.0, 16),
        ]);
        let loaded = parsed(&mesh);
        assert_eq!(codes(&loaded), Vec::<&str>::new());
        assert_eq!((loaded.components, loaded.scale, loaded.mesh.up), (2, 1.0, V3::y()));
        assert!((loaded.mesh.volume() - mesh.volume()).abs() < 1e-6);
        assert_eq!(loaded.mesh.bounds().0, mesh.bounds().0);
    }

    #[test]
    fn height_scales_along_the_axis_that_is_up() {
        let text = obj_text(&cuboid(P3::origin(), V3::new(1.0, 2.0, 3.0)));
        let settings = Settings { up: Some(Up::X), height_mm: Some(120.0), ..Settings::default() };
        let loaded = parse("a.obj", text.as_bytes(), Format::Obj, &settings).unwrap();
        assert_eq!(loaded.scale, 120.0);
        assert_eq!(loaded.mesh.height_range(), (0.0, 120.0));
        assert_eq!(loaded.mesh.bounds().1, P3::new(120.0, 240.0, 360.0));
    }

    #[test]
    fn an_inside_out_mesh_is_turned_and_a_small_hole_closed_with_a_word() {
        let mut mesh = inside_out(sphere(P3::new(0.0, 50.0, 0.0), 50.0, 40));
        let whole = mesh.volume().abs();
        mesh.triangles.pop();
        let loaded = parsed(&mesh);
        assert_eq!(codes(&loaded), ["mesh-inside-out", "mesh-hole-closed"]);
        assert!(loaded.mesh.is_closed());
        assert!((loaded.mesh.volume() - whole).abs() < 1e-6);
        assert!(loaded.warnings[1].place.as_ref().unwrap().contains("y 0"), "{:?}", loaded.warnings[1]);
    }

    #[test]
    fn a_large_opening_stays_open_and_is_said() {
        let mut mesh = cuboid(P3::origin(), V3::repeat(100.0));
        mesh.triangles.retain(|t| !t.iter().all(|i| mesh.vertices[*i as usize].y > 99.0));
        let loaded = parsed(&mesh);
        assert_eq!(codes(&loaded), ["mesh-open"]);
        assert_eq!(loaded.warnings[0].place.as_deref(), Some("x 50.0, y 100.0, z 50.0 mm"));
        assert!(!loaded.mesh.is_closed());
    }

    #[test]
    fn files_without_a_body_are_errors() {
        let error = |bytes: &[u8], format| parse("a", bytes, format, &Settings::default()).unwrap_err();
        assert!(matches!(error(b"", Format::Obj), Error::NoFaces { .. }));
        assert!(matches!(error(b"Dear Sir,\nthis is no mesh.\n", Format::Obj), Error::NoFaces { .. }));
        assert!(matches!(error(b"\x89PNG\r\n\x1a\n\0\0\0", Format::Obj), Error::NoFaces { .. }));
        assert!(matches!(error(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", Format::Obj), Error::Flat { .. }));
        assert!(matches!(error(b"", Format::Stl), Error::NoFaces { .. }));
        assert!(matches!(error(b"solid a\nendsolid a\n", Format::Stl), Error::NoFaces { .. }));
        assert!(matches!(error(b"Dear Sir", Format::Stl), Error::Syntax { .. }));
        assert!(matches!(load(Path::new("no/such.obj"), &Settings::default()), Err(Error::Read { .. })));
        assert!(matches!(load(Path::new("a.step"), &Settings::default()), Err(Error::UnknownFormat { .. })));
    }

    #[test]
    fn the_extension_says_the_format_in_any_case() {
        assert_eq!(Format::from_path(Path::new("x/A.OBJ")), Some(Format::Obj));
        assert_eq!(Format::from_path(Path::new("a.b.stl")), Some(Format::Stl));
        assert_eq!(Format::from_path(Path::new("obj")), None);
    }
}
