//! From the file's unit to mm.

use super::Error;
use super::load::{Settings, Soup};
use super::trimesh::bounds;
use crate::geom::V3;

/// A body lower than this was hardly meant in mm.
const MIN_HEIGHT_MM: f64 = 10.0;
/// A body higher than this many beds was hardly meant in mm.
const MAX_BEDS: f64 = 5.0;
/// Nothing larger is made of ruffles, and f64 keeps 1e-11 mm here.
const MAX_EXTENT_MM: f64 = 100_000.0;
/// Coordinates in files stay below this: products of three of them are then far from overflow.
const MAX_COORDINATE: f64 = 1e12;
/// Extents below this fraction of the largest are no extent.
const FLAT: f64 = 1e-6;

/// The factor from the file's unit to mm, from the wanted height, or 1 when the file's numbers make sense as mm.
pub(super) fn scale(name: &str, soup: &Soup, up: V3, settings: &Settings) -> Result<f64, Error> {
    let used = soup.triangles.iter().flatten().map(|i| &soup.vertices[*i as usize]);
    let (lo, hi) = bounds(used);
    let reach = lo.coords.amax().max(hi.coords.amax());
    if reach > MAX_COORDINATE {
        let what = format!("a coordinate of {reach:.3e}");
        return Err(Error::Gigantic { name: name.into(), what, limit: MAX_COORDINATE, unit: "file units" });
    }
    let size = hi - lo;
    // The second term: a cube of side 1 a million million away has lost its digits.
    if size.amin() <= (FLAT * size.amax()).max(8.0 * f64::EPSILON * reach) {
        return Err(Error::Flat { name: name.into(), x: size.x, y: size.y, z: size.z });
    }
    let height = size.dot(&up.abs());
    let scale = match settings.height_mm {
        Some(height_mm) if height_mm > 0.0 && height_mm <= MAX_EXTENT_MM => height_mm / height,
        Some(height_mm) => return Err(Error::BadHeight { height_mm, limit_mm: MAX_EXTENT_MM }),
        None => {
            check_height(name, height, MAX_BEDS * settings.bed_mm)?;
            1.0
        }
    };
    let largest = size.amax() * scale;
    if largest > MAX_EXTENT_MM {
        let what = format!("an extent of {largest:.0} mm");
        return Err(Error::Gigantic { name: name.into(), what, limit: MAX_EXTENT_MM, unit: "mm" });
    }
    Ok(scale)
}

fn check_height(name: &str, height_mm: f64, limit_mm: f64) -> Result<(), Error> {
    let option = |unit: &str, factor: f64| format!("--height-mm {} if its unit is {unit}", rounded(height_mm * factor));
    let units = if height_mm < MIN_HEIGHT_MM {
        [option("m", 1000.0), option("cm", 10.0)]
    } else if height_mm > limit_mm {
        [option("um", 0.001), option("1/100 mm", 0.01)]
    } else {
        return Ok(());
    };
    Err(Error::Height {
        name: name.into(),
        height_mm: rounded(height_mm),
        too_small: height_mm < MIN_HEIGHT_MM,
        limit_mm,
        suggestions: format!("{}, or any other, such as --height-mm 120", units.join(", ")),
    })
}

/// Three significant digits: these are suggestions.
fn rounded(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::super::samples::cuboid;
    use super::*;
    use crate::geom::P3;

    fn of(size: V3, height_mm: Option<f64>) -> Result<f64, Error> {
        let mesh = cuboid(P3::new(5.0, 5.0, 5.0), size);
        let soup = Soup { vertices: mesh.vertices, triangles: mesh.triangles };
        scale("a.obj", &soup, V3::y(), &Settings { height_mm, bed_mm: 400.0, ..Settings::default() })
    }

    #[test]
    fn a_given_height_is_the_extent_along_up() {
        assert_eq!(of(V3::new(1.0, 3.0, 2.0), Some(120.0)).unwrap(), 40.0);
        assert_eq!(of(V3::new(100.0, 100.0, 60.0), None).unwrap(), 1.0);
    }

    #[test]
    fn a_body_of_a_few_mm_gets_three_suggestions() {
        let message = of(V3::new(1.0, 0.154, 1.0), None).unwrap_err().to_string();
        for part in [
            "0.154 mm high",
            "--height-mm 154 if its unit is m",
            "--height-mm 1.54 if its unit is cm",
            "--height-mm 120",
        ] {
            assert!(message.contains(part), "{message}");
        }
        assert!(of(V3::new(1.0, 2001.0, 1.0), None).unwrap_err().to_string().contains("over 2000 mm"));
        assert!(of(V3::new(1.0, 1999.0, 1.0), None).is_ok());
    }

    #[test]
    fn flat_gigantic_and_impossible_sizes_are_errors() {
        assert!(matches!(of(V3::new(10.0, 20.0, 0.0), Some(120.0)), Err(Error::Flat { .. })));
        assert!(matches!(of(V3::new(10.0, 20.0, 1e-6), None), Err(Error::Flat { .. })));
        assert!(matches!(of(V3::repeat(1e13), Some(120.0)), Err(Error::Gigantic { .. })));
        assert!(matches!(of(V3::new(1e5, 1.0, 1.0), Some(120.0)), Err(Error::Gigantic { .. })));
        for bad in [0.0, -3.0, f64::NAN, f64::INFINITY, 2e5] {
            assert!(matches!(of(V3::repeat(20.0), Some(bad)), Err(Error::BadHeight { .. })));
        }
    }
}
