//! What is left of a sheet, as a drawing for the next job.

use crate::drawing::{self, Drawing, DrawnPath, Role};
use crate::geom::{Path, Rect};
use crate::nest::{self, Container, Item, Layout, Settings};

/// Narrower rests are thrown away, mm: no ruffle's strip with room around it comes out of them.
const MIN_SIDE_MM: f64 = 40.0;

/// The largest rectangle left of a sheet, if it is worth keeping. What is left of a roll stays on the roll.
pub(super) fn offcut(items: &[Item], containers: &[Container], layout: &Layout, settings: &Settings) -> Option<Rect> {
    let is_sheet = matches!(containers.get(layout.container)?, Container::Sheet { .. });
    let rest = nest::offcut(items, containers, layout, settings).filter(|_| is_sheet)?;
    (rest.width().min(rest.height()) >= MIN_SIDE_MM).then_some(rest)
}

/// The file of an offcut: its name tells the sheet and the size, its drawing is the border at true size.
pub(super) fn file(sheet: &str, rest: &Rect) -> (String, String) {
    // Rounded down: what is promised is there.
    let (width, height) = (rest.width().floor(), rest.height().floor());
    let border = Rect::from_size(width, height);
    let corners = [border.min, [width, 0.0].into(), border.max, [0.0, height].into()];
    let (role, path) = (Role::Outline, Path::closed(corners));
    let name = format!("{sheet}-{width}x{height}");
    let paths = vec![DrawnPath { path, role, kerf: role.usual_kerf(), joint: None }];
    let svg = drawing::piece_svg(&Drawing { name: name.clone(), paths }, 0.0);
    (format!("offcuts/{name}.svg"), svg)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::P2;

    #[test]
    fn an_offcut_is_drawn_at_true_size_and_read_back_as_one() {
        let rest = Rect { min: P2::new(100.5, 0.0), max: P2::new(297.0, 120.9) };
        let (name, svg) = file("sheet-01", &rest);
        assert_eq!(name, "offcuts/sheet-01-196x120.svg");
        let loops = drawing::read_loops(&svg).unwrap();
        assert_eq!(Rect::around(&loops[0]), Rect::from_size(196.0, 120.0));
    }
}
