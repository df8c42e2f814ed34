//! A strip whose lengths are given: it is not filled into anything, it only settles.

use super::{Edits, Error, Foot, FootUsed, MAX_STRAIN, Part, Settings, Target, part, solver};
use crate::progress::Observer;
use crate::ruffle::Drawn;
use crate::sim::Outcome;

/// Lets a drawing settle with the lengths it has, after the edits. With [`Foot::Auto`] it stands free if it does not tip over then.
///
/// # Errors
/// An edit that does not apply; a strip that does not come to rest.
pub fn rest(
    target: &Target,
    settings: &Settings,
    drawn: &Drawn,
    edits: Option<&Edits>,
    observer: &mut dyn Observer,
) -> Result<Part, Error> {
    let name = || target.name.to_owned();
    let edited = match edits {
        Some(edits) => edits.edited(drawn).map_err(|source| Error::Edit { part: name(), source })?,
        None => drawn.clone(),
    };
    let feet: &[FootUsed] = match settings.foot {
        Foot::Auto => &[FootUsed::Free, FootUsed::Pinned],
        Foot::Free => &[FootUsed::Free],
        Foot::Pinned => &[FootUsed::Pinned],
    };
    let spans = target.extruder.spans(&edited.ruffle, &edited.positions);
    let mut unsettled = (None, f64::INFINITY);
    for foot in feet {
        let error = |source| Error::Solve { part: name(), source };
        let mut solver = solver(target, settings, &edited.ruffle, &spans, *foot).map_err(error)?;
        let equilibrium = solver.solve(&edited.positions, observer).map_err(error)?;
        if equilibrium.outcome != Outcome::Converged || equilibrium.max_strain > MAX_STRAIN {
            unsettled.1 = equilibrium.residual_n.min(unsettled.1);
            continue;
        }
        let settled = part(target, edited.ruffle.clone(), spans.clone(), equilibrium, *foot);
        if settled.report.stands || *foot == FootUsed::Pinned {
            return Ok(settled);
        }
        unsettled.0 = Some(settled);
    }
    let (tipping, residual_n) = unsettled;
    tipping.ok_or(Error::Unsettled { part: name(), tried: feet.len(), residual_n })
}
