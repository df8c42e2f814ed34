//! The strips of the paper's load tests (section 5.2, figure 16), built in.

use super::{Drawn, EditError, EditSettings, Limits, Role, densify, set_length, uniform_stack};

/// A strip of the paper's load tests: two layers, 30 mm high.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Strip {
    /// Inner sections 52.8 mm long: 468 mm of strip, 486 with its end tabs.
    Default,
    /// Inner sections 106.7 mm long: 730 mm of strip, 749 with its end tabs.
    Wide,
    /// The default with its four outer loops densified: 797 mm of strip with its end tabs.
    Dense,
}

/// Layers of a load-test strip.
const LAYERS: usize = 2;
/// Height of a layer, mm.
const LAYER_MM: f64 = 30.0;
/// Length of the inner sections, mm: with them the strips are as long as the paper's table says, less their end tabs.
const INNER_MM: f64 = 52.8;
const WIDE_INNER_MM: f64 = 106.7;
/// The dense strip's inner sections against the default's: with it that strip too is as long as the table says.
const DENSE_INNER: f64 = 0.87;

impl Strip {
    /// All of them.
    pub const ALL: [Strip; 3] = [Strip::Default, Strip::Wide, Strip::Dense];

    /// Name of the built-in design.
    pub fn name(self) -> &'static str {
        match self {
            Strip::Default => "paper-default",
            Strip::Wide => "paper-wide",
            Strip::Dense => "paper-dense",
        }
    }
}

/// Draws a load-test strip, its first rung from the origin to the right, in segments of about `segment_mm`.
///
/// # Errors
/// Segments so long that the dense strip's little loops cannot be drawn with them.
pub fn load_test(strip: Strip, segment_mm: f64) -> Result<Drawn, EditError> {
    let inner_mm = if strip == Strip::Wide { WIDE_INNER_MM } else { INNER_MM };
    let plain = uniform_stack(LAYERS, LAYER_MM, inner_mm, segment_mm);
    if strip != Strip::Dense {
        return Ok(plain);
    }
    let settings = EditSettings { segment_mm, limits: Limits::default() };
    let loops: Vec<usize> = (0..LAYERS).flat_map(|layer| [4 * layer + 1, 4 * layer + 3]).collect();
    let mut dense = densify(&plain, &loops, 1, &settings)?;
    for section in 0..dense.ruffle.sections.len() {
        if dense.ruffle.sections[section].role == Role::Inner {
            let length_mm = DENSE_INNER * dense.ruffle.section_length(section);
            dense = set_length(&dense, section, length_mm, &settings)?;
        }
    }
    Ok(dense)
}
