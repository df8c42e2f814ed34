//! What is left when every ruffle is closed.

use super::flow::{Flow, LEADING_MM};
use super::{Book, base_cards, beside, connectors};
use crate::fit::{FootUsed, Part};

const TITLE: &str = "Finish";

/// Writes the last page, or the end of the last page where there is room.
pub(super) fn finish(flow: &mut Flow, job: &Book) {
    let cards = base_cards(job);
    let mut todo: Vec<String> = Vec::new();
    let connectors = connectors(job);
    if !connectors.is_empty() {
        todo.push("See that no end of a connector hangs loose.".into());
    }
    todo.push(
        "Press every joint flat between two fingers, and turn the object over once: no flap may stand loose.".into(),
    );
    for part in job.parts.iter().filter(|part| part.report.foot == FootUsed::Pinned) {
        let (name, apart) = (&part.name, foot_mm(part));
        let card = format!("{name}-base");
        todo.push(match cards.iter().any(|piece| piece.name == card) {
            true => format!(
                "Glue ruffle {name} to piece {card} where its drawing has triangles below the floor: on the two lines of the card, {apart:.0} mm apart. Standing free it tips or sags."
            ),
            false => format!(
                "Glue a stiff strip of card under the bottom of ruffle {name}, from triangle to triangle in its drawing ({apart:.0} mm), or glue it there to what it stands on: free it sags."
            ),
        });
    }
    todo.push("Push it down gently a few times and let it come up: it settles into its shape.".into());
    let pictures = beside::height_mm(flow, &cards);
    // Two lines for every item and its box, and the heading; all of it stays together where it fits one page.
    flow.heading(TITLE, (2.0 * LEADING_MM + 1.4) * todo.len() as f64 + pictures, TITLE);
    for item in &todo {
        flow.check(item, TITLE);
    }
    if !cards.is_empty() {
        flow.skip(3.0);
        beside::draw(flow, &cards, TITLE);
    }
}

/// Distance of the two points that hold a glued foot, mm.
fn foot_mm(part: &Part) -> f64 {
    let [a, b] = part.ruffle.foot.map(|node| part.equilibrium.positions[node.index()]);
    (b - a).norm()
}
