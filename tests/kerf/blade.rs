//! What a drag knife makes of its moves.

use crate::kerf::compare::{Found, compared};
use crate::kerf::plane::{at, walk};
use crate::kerf::program::Run;
use crate::kerf::sheet::Nominal;

/// The blade: its tip is drawn behind the axis that the runs are for; it was left pointing anywhere. A pen drew the marks before.
pub fn blade(nominal: &[Nominal], runs: &[Run], pen: &[Run], trail_mm: f64) -> Found {
    let mut tip = at(-1.0, -1.0);
    let mut cuts = pen.to_vec();
    for run in runs {
        let axis = walk(&run.points, 0.01);
        // Lifted, it keeps its heading: where it comes down, the tip lies as far behind as before.
        let first = axis[0].0;
        let behind = at(tip.x, tip.y);
        let mut place = at(
            first.x + behind.x * trail_mm / behind.to(at(0.0, 0.0)),
            first.y + behind.y * trail_mm / behind.to(at(0.0, 0.0)),
        );
        let mut points = vec![place];
        for (to, _) in &axis {
            let distance = place.to(*to);
            if distance > trail_mm {
                place = to.between(place, trail_mm / distance);
                points.push(place);
            }
        }
        let last = run.points[run.points.len() - 1];
        tip = at(place.x - last.x, place.y - last.y);
        cuts.push(Run { operation: run.operation.clone(), points });
    }
    compared(nominal, &cuts, 0.0)
}
