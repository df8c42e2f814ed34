//! What people should know about a part before they cut it.

use super::{Foot, FootUsed, Part, Settings};
use crate::progress::Warning;
use crate::sim::Outcome;

/// What the user should know before cutting.
pub fn warnings(part: &Part, settings: &Settings) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let r = &part.report;
    let mut warn = |warning: Warning| warnings.push(warning.in_part(&part.name));
    if part.equilibrium.self_intersections > 0 {
        let n = part.equilibrium.self_intersections;
        warn(Warning::new(
            "self-intersection",
            format!(
                "the folded strip passes through itself in {n} places; it will fold differently there. Try another number of layers"
            ),
        ));
    }
    if r.foot == FootUsed::Pinned && settings.foot == Foot::Auto {
        warn(Warning::new(
            "foot-pinned",
            "standing free it would tip or fill less: glue both ends of the bottom rung to a base, or set foot = \"free\" in the design",
        ));
    }
    if !r.stands {
        warn(Warning::new(
            "tips",
            "standing free it falls over when pushed: glue both ends of the bottom rung to a base (--foot pinned)",
        ));
    }
    if r.min_radius_mm < settings.min_bend_radius_mm {
        warn(
            Warning::new(
                "bend-tight",
                format!(
                    "the strip bends to a radius of {:.1} mm; below {:.1} mm this material creases. Use fewer layers or make the shape larger",
                    r.min_radius_mm, settings.min_bend_radius_mm
                ),
            )
            .at(format!("section {}", r.tightest_section)),
        );
    }
    if r.min_void_mm < settings.min_void_mm {
        warn(
            Warning::new(
                "void-small",
                format!(
                    "a void is only {:.1} mm thick; tools need {:.1} mm to reach the flaps. Use fewer layers or make the shape larger",
                    r.min_void_mm, settings.min_void_mm
                ),
            )
            .at(format!("u {:.0}, v {:.0} mm", r.thinnest_void.x, r.thinnest_void.y)),
        );
    }
    if part.equilibrium.outcome != Outcome::Converged {
        warn(Warning::new(
            "not-settled",
            format!(
                "the strip had not come to rest (unbalanced force {:.1e} N); its shape may differ",
                part.equilibrium.residual_n
            ),
        ));
    }
    if r.protruding_fraction > 0.1 {
        warn(Warning::new(
            "sticks-out",
            format!(
                "{:.0} % of the outline's area again sticks out of it: narrow places are bridged. Other layers may follow the shape better",
                100.0 * r.protruding_fraction
            ),
        ));
    }
    warnings
}
