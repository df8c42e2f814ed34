//! A strip whose lengths are given: it is not filled into anything, it only settles.

use super::report::Origin;
use super::{Error, Foot, FootUsed, MAX_STRAIN, Part, Settings, Spent, Target, agreed, part, solver};
use crate::cut::Outline;
use crate::geom::{P2, enclosed, signed_area};
use crate::progress::Observer;
use crate::ruffle::{Direction, Drawn, Ruffle};
use crate::sim::Outcome;

/// What a drawing goes round. Little stacks may pinch it: the largest piece.
pub fn own_outline(ruffle: &Ruffle, positions: &[P2]) -> Outline {
    let segments: Vec<(P2, P2)> = ruffle.segments().map(|(i, j)| (positions[i], positions[j])).collect();
    let largest = enclosed(&segments).loops.into_iter().max_by(|a, b| signed_area(a).total_cmp(&signed_area(b)));
    Outline { outer: largest.unwrap_or_default(), holes: Vec::new() }
}

/// Lets a drawing settle with the lengths it has, above the lowest point of the target's outline. What it goes round then is the part's outline. With
/// [`Foot::Auto`] it stands free if it does not tip over.
///
/// # Errors
/// A strip that does not come to rest.
pub fn rest(target: &Target, settings: &Settings, drawn: &Drawn, observer: &mut dyn Observer) -> Result<Part, Error> {
    let feet: &[FootUsed] = match settings.foot {
        Foot::Auto => &[FootUsed::Free, FootUsed::Pinned],
        Foot::Free => &[FootUsed::Free],
        Foot::Pinned => &[FootUsed::Pinned],
    };
    let ruffle = &drawn.ruffle;
    let mut tipping = None;
    for foot in feet {
        let spans = target.extruder.spans(ruffle, &drawn.positions);
        let mut solver =
            solver(target, settings, ruffle, &spans, *foot).map_err(|source| target.solve_error(source))?;
        let (spans, equilibrium) = agreed(target, &mut solver, ruffle, spans, &drawn.positions, observer)?;
        if equilibrium.outcome != Outcome::Converged || equilibrium.max_strain > MAX_STRAIN {
            continue;
        }
        let origin = Origin { foot: *foot, direction: Direction::Vertical, spent: Spent::default() };
        let outline = own_outline(ruffle, &equilibrium.positions);
        let settled = part(&Target { outline: &outline, ..*target }, ruffle.clone(), spans, equilibrium, origin);
        if settled.report.stands || *foot == FootUsed::Pinned {
            return Ok(settled);
        }
        tipping = Some(settled);
    }
    tipping.ok_or(Error::Unsettled { part: target.name.into(), tried: feet.len() })
}
