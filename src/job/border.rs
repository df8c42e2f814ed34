//! What a file burns, to trace its border.

use std::path::Path;

use super::Error;
use crate::drawing::read_svg;
use crate::gcode::{parse, trace};
use crate::geom::tolerance;
use crate::stream::Extent;

/// Adds what a file burns to an extent, mm in work coordinates. A drawing (.svg) counts as it is drawn, before the kerf; of G-code, all that burns, or
/// for a machine that does not burn, all that is fed.
///
/// # Errors
/// The file is neither G-code nor a drawing of ours at true size, or cannot be carried out.
pub fn take_in(extent: &mut Extent, file: &str, text: &str, burns: bool) -> Result<(), Error> {
    let is_svg = Path::new(file).extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
    if is_svg {
        let drawings = read_svg(text).map_err(|source| Error::Drawing { file: file.to_owned(), source })?;
        let paths = drawings.iter().flat_map(|drawing| &drawing.paths);
        paths.for_each(|drawn| extent.add(drawn.path.flatten(tolerance::FLATTEN_MM)));
        return Ok(());
    }
    let program = parse(text).map_err(|source| Error::Parse { file: file.to_owned(), source })?;
    let moves = trace(&program).map_err(|source| Error::Trace { sheet: file.to_owned(), source })?;
    let counts = |m: &&crate::gcode::Move| if burns { m.burns() } else { m.feeds() };
    moves.iter().filter(counts).for_each(|m| extent.add_move(m));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::P2;

    #[test]
    fn a_drawing_and_its_program_have_the_same_border() {
        let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80">
            <g class="piece" data-name="A1"><path class="outline" d="M10 70 H90 V20 H10 Z"/></g></svg>"#;
        let nc = "G21G90\nG0X99Y79\nG0X10Y10\nM4S500\nG1X90F1000\nY60\nX10\nY10\nM5\nG0X0Y0\n";
        let hull = |file: &str, text: &str, burns| {
            let mut extent = Extent::default();
            take_in(&mut extent, file, text, burns).unwrap();
            extent.hull().map(|frame| frame.corners)
        };
        let corners = Some(vec![P2::new(10.0, 10.0), P2::new(90.0, 10.0), P2::new(90.0, 60.0), P2::new(10.0, 60.0)]);
        assert_eq!(hull("sheet.svg", svg, true), corners);
        assert_eq!(hull("sheet.nc", nc, true), corners);
        assert_eq!(hull("pen.nc", &nc.replace("M4S500", "M5"), false), corners);
        assert_eq!(hull("pen.nc", &nc.replace("M4S500", "M5"), true), None);
        assert!(take_in(&mut Extent::default(), "a.svg", "<g>", true).unwrap_err().to_string().starts_with("a.svg"));
    }
}
