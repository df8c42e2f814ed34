//! The card that holds a pinned foot: lines that show where the ends of the bottom rung are glued.

use super::{Piece, Settings};
use crate::drawing::{Drawing, DrawnPath, KerfSide, Role, text_paths, text_width};
use crate::fit::Part;
use crate::geom::{Motion, P2, Path, Rect, V2};

/// Card around the foot, mm: room to press it down with a finger.
const MARGIN_MM: f64 = 8.0;
/// Room around lettering, mm.
const CLEAR_MM: f64 = 1.5;
/// Rounding of the card's corners, mm.
const CORNER_MM: f64 = 3.0;
/// Where the tool cannot mark, the lines' ends are holes of this radius, mm: a pencil finds them, and they weaken nothing.
const HOLE_MM: f64 = 0.75;

/// The base card of a part, seen from above: u to the right, toward the viewer downward. A line across for each end of the bottom rung, as long as the strip is wide
/// there, with the number of the joint where it is one.
pub fn base_card(part: &Part, settings: &Settings) -> Piece {
    let name = format!("{}-base", part.name);
    let joints = part.ruffle.connection_points();
    let height = settings.labels.drawn_mm().unwrap_or(0.0);
    let margin = MARGIN_MM.max(height + 2.0 * CLEAR_MM);
    let foot = part.ruffle.foot.map(|node| {
        let (u, span) = (part.equilibrium.positions[node.index()].x, part.spans[node.index()]);
        let label = joints.iter().find(|c| c.node == node).map(|c| format!("{}{}", part.name, c.joint));
        ([P2::new(u, -span.hi), P2::new(u, -span.lo)], label)
    });
    let title = format!("PIECE {name}");
    let around = Rect::around(foot.iter().flat_map(|(line, _)| line)).grown(margin);
    let short = (0.5 * (text_width(&title, height) + 2.0 * CLEAR_MM - around.width())).max(0.0);
    let card = Rect { min: around.min - V2::new(short, 0.0), max: around.max + V2::new(short, 0.0) };
    let corners = [card.min, P2::new(card.max.x, card.min.y), card.max, P2::new(card.min.x, card.max.y)];
    let mut paths = vec![DrawnPath {
        path: Path::rounded(&corners.map(|p| (p, CORNER_MM)), true),
        role: Role::Outline,
        kerf: KerfSide::Outside,
        joint: None,
    }];
    let inked = |path: Path, role: Role, joint: Option<String>| DrawnPath { path, role, kerf: KerfSide::On, joint };
    for (line, label) in foot {
        if settings.labels.drawn_mm().is_none() {
            let holes = line.map(|p| DrawnPath {
                path: Path::circle(p, HOLE_MM),
                role: Role::Hole,
                kerf: KerfSide::Inside,
                joint: None,
            });
            paths.extend(holes);
            continue;
        }
        paths.push(inked(Path::open(line), Role::Mark, None));
        if let Some(label) = label {
            let width = text_width(&label, height);
            let left = (line[0].x - 0.5 * width).clamp(card.min.x + CLEAR_MM, card.max.x - CLEAR_MM - width);
            let corner = Motion::translation(left, line[0].y - CLEAR_MM - height);
            paths.extend(
                text_paths(&label, height).iter().map(|p| inked(p.moved(&corner), Role::Label, Some(label.clone()))),
            );
        }
    }
    if settings.labels.drawn_mm().is_some() {
        let corner = Motion::translation(card.min.x + CLEAR_MM, card.max.y - CLEAR_MM - height);
        paths.extend(text_paths(&title, height).iter().map(|p| inked(p.moved(&corner), Role::Label, None)));
    }
    Piece::new(
        name.clone(),
        &part.name,
        Drawing { name, paths },
        (card.min.x..card.max.x, Vec::new()),
        settings.grammage_g_per_m2,
    )
}

#[cfg(test)]
mod tests {
    use super::super::Labels;
    use super::super::tests::{part, settings};
    use super::*;
    use crate::geom::contains;

    #[test]
    fn the_card_shows_the_foot_from_above_with_room_around() {
        let part = part(40.0);
        let card = base_card(&part, &settings(5000.0));
        let [a, b] = part.ruffle.foot.map(|n| part.equilibrium.positions[n.index()].x);
        let marks: Vec<Rect> =
            card.drawing.paths.iter().filter(|p| p.role == Role::Mark).map(|p| p.path.bounds()).collect();
        assert_eq!(card.name, "A-base");
        assert_eq!(marks.len(), 2);
        assert_eq!([marks[0].min.x, marks[1].min.x], [a, b]);
        assert!(marks.iter().all(|m| (m.height() - 40.0).abs() < 1e-9));
        let bounds = card.drawing.bounds();
        assert!(marks.iter().all(|m| bounds.holds(&m.grown(5.0), 0.0)));
        let contour = card.drawing.outline().unwrap().flatten(0.01);
        let lettering = || card.drawing.paths.iter().filter(|p| p.role == Role::Label);
        assert!(lettering().count() > 0);
        for label in lettering() {
            assert!(label.path.flatten(0.01).iter().all(|p| contains(&contour, *p)));
            assert!(!marks.iter().any(|m| m.overlaps(&label.path.bounds())));
        }
    }

    #[test]
    fn where_nothing_can_be_marked_small_holes_show_the_lines() {
        let plain = Settings { labels: Labels::Nothing, ..settings(5000.0) };
        let card = base_card(&part(40.0), &plain);
        assert_eq!(card.drawing.paths.iter().filter(|p| p.role == Role::Hole).count(), 4);
        assert!(card.drawing.paths.iter().all(|p| matches!(p.role, Role::Hole | Role::Outline)));
    }
}
