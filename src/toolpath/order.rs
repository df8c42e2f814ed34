//! In which order, from which end.

use super::Contour;
use crate::drawing::Operation;
use crate::geom::P2;

/// How often a contour is run.
type Passes<'a> = &'a dyn Fn(&Contour) -> u32;

/// Sorts by operation and keeps the drawing order inside each.
pub(super) fn by_operation(mut contours: Vec<Contour>) -> Vec<Contour> {
    contours.sort_by_key(|c| c.operation);
    contours
}

/// Orders contours already sorted by operation: engraving and inner cuts by nearest neighbour, outlines from the far side toward `park`,
/// so that what is freed never lies between the head and uncut sheet. Open paths may be turned round, closed ones start at the corner
/// nearest to where the tool is.
pub(super) fn arrange(contours: Vec<Contour>, passes: Passes, park: P2) -> Vec<Contour> {
    let mut left = contours;
    let mut ordered: Vec<Contour> = Vec::with_capacity(left.len());
    let mut at = park;
    for operation in Operation::ALL {
        let rest = left.split_off(left.partition_point(|c| c.operation <= operation));
        let mut group = std::mem::replace(&mut left, rest);
        if operation == Operation::CutOutline {
            let distance = |c: &Contour| (c.path.bounds().center() - park).norm();
            group.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
            for contour in group {
                let entry = nearest_entry(&contour, at).1;
                at = take(contour, entry, passes, &mut ordered);
            }
        } else {
            while let Some((k, entry)) = nearest(&group, at) {
                at = take(group.remove(k), entry, passes, &mut ordered);
            }
        }
    }
    ordered
}

/// Where the tool may enter a contour.
#[derive(Debug, Clone, Copy)]
enum Entry {
    /// At this corner of a closed path, or at the start of an open one.
    Corner(usize),
    /// At the end of an open path.
    End,
}

fn nearest(group: &[Contour], at: P2) -> Option<(usize, Entry)> {
    let entries = group.iter().enumerate().map(|(k, c)| (k, nearest_entry(c, at)));
    entries.min_by(|a, b| a.1.0.total_cmp(&b.1.0)).map(|(k, (_, entry))| (k, entry))
}

/// The nearest entry and its squared distance, the first of equals.
fn nearest_entry(contour: &Contour, at: P2) -> (f64, Entry) {
    let vertices = &contour.path.vertices;
    let distance = |k: usize| (vertices[k].point - at).norm_squared();
    let last = vertices.len() - 1;
    if contour.path.closed {
        let corners = (0..=last).map(|k| (distance(k), Entry::Corner(k)));
        return corners.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a compensated path has at least two corners");
    }
    if distance(last) < distance(0) { (distance(last), Entry::End) } else { (distance(0), Entry::Corner(0)) }
}

/// Appends the contour as entered; returns where the tool then is.
fn take(mut contour: Contour, entry: Entry, passes: Passes, ordered: &mut Vec<Contour>) -> P2 {
    contour.path = match entry {
        Entry::Corner(k) => contour.path.starting_at(k),
        Entry::End => contour.path.reversed(),
    };
    let exit = ends(&contour, passes).1;
    ordered.push(contour);
    exit
}

/// Where all passes of a contour begin and end: an even number of passes along an open path ends where it began.
fn ends(contour: &Contour, passes: Passes) -> (P2, P2) {
    let first = contour.path.vertices[0].point;
    let last = contour.path.vertices[contour.path.vertices.len() - 1].point;
    let back_at_start = contour.path.closed || passes(contour).is_multiple_of(2);
    (first, if back_at_start { first } else { last })
}

/// Length of the way from `park` through all contours back to `park` outside them, mm.
pub(super) fn travel_mm(contours: &[Contour], passes: Passes, park: P2) -> f64 {
    let mut at = park;
    let mut length = 0.0;
    for contour in contours {
        let (entry, exit) = ends(contour, passes);
        length += (entry - at).norm();
        at = exit;
    }
    length + (park - at).norm()
}

/// Every contour as often as it is run; open paths there and back, so that no travel lies between passes.
pub(super) fn repeat(contours: Vec<Contour>, passes: Passes) -> Vec<Contour> {
    let mut runs = Vec::with_capacity(contours.len());
    for contour in contours {
        let back = Contour { path: contour.path.reversed(), ..contour.clone() };
        for pass in 0..passes(&contour) {
            let turned = !contour.path.closed && pass % 2 == 1;
            runs.push(if turned { back.clone() } else { contour.clone() });
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::super::Air;
    use super::*;
    use crate::drawing::Role;
    use crate::geom::Path;

    fn contour(path: Path, role: Role) -> Contour {
        let operation = role.operation();
        let piece = "A1".to_string();
        Contour { path, operation, role, piece, joint: None, feed_mm_per_min: 900.0, power: 0.5, air: Air::Off }
    }

    fn stroke(from: (f64, f64), to: (f64, f64)) -> Contour {
        contour(Path::open([P2::new(from.0, from.1), P2::new(to.0, to.1)]), Role::Mark)
    }

    #[test]
    fn a_row_of_strokes_is_walked_there_and_back_instead_of_jumped() {
        // Five strokes, all drawn upward: as drawn the tool flies back down after each.
        let strokes: Vec<Contour> = (1..=5).map(|k| stroke((f64::from(k), 0.0), (f64::from(k), 10.0))).collect();
        let park = P2::origin();
        assert!(travel_mm(&strokes, &|_| 1, park) > 45.0);
        let ordered = arrange(strokes, &|_| 1, park);
        assert!((travel_mm(&ordered, &|_| 1, park) - (5.0 + 125.0_f64.sqrt())).abs() < 1e-9);
    }

    #[test]
    fn a_closed_contour_starts_at_its_nearest_corner() {
        let square = Path::closed([(5.0, 5.0), (9.0, 5.0), (9.0, 9.0), (5.0, 9.0)].map(|(x, y)| P2::new(x, y)));
        let near = stroke((20.0, 20.0), (10.0, 10.0));
        let ordered = arrange(by_operation(vec![contour(square, Role::Outline), near]), &|_| 1, P2::new(21.0, 21.0));
        assert_eq!(ordered[1].path.start(), Some(P2::new(9.0, 9.0)));
    }

    #[test]
    fn passes_of_an_open_path_alternate_and_an_even_number_ends_at_the_start() {
        let stroke = stroke((0.0, 0.0), (10.0, 0.0));
        let runs = repeat(vec![stroke.clone()], &|_| 3);
        assert_eq!(runs.len(), 3);
        assert_eq!(runs[1].path.start(), runs[0].path.end());
        assert_eq!(runs[2].path, stroke.path);
        assert_eq!(travel_mm(std::slice::from_ref(&stroke), &|_| 2, P2::origin()), 0.0);
        assert_eq!(travel_mm(&[stroke], &|_| 3, P2::origin()), 10.0);
    }
}
