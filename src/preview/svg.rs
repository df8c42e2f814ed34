//! A canvas as SVG: mm at true size, curves only, so that it looks the same everywhere.

use super::canvas::{Canvas, Shape};
use crate::drawing::{path_data, svg_number};
use crate::geom::P2;
use std::fmt::Write;

impl Canvas {
    /// The picture as a self-contained SVG: one unit is one mm, no fonts, no CSS.
    pub fn to_svg(&self) -> String {
        let [w, h] = [self.area.width(), self.area.height()].map(svg_number);
        let mut svg = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" \
             width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n"
        );
        let origin = P2::new(-self.area.min.x, self.area.max.y);
        for shape in &self.shapes {
            write_shape(&mut svg, shape, origin);
        }
        svg.push_str("</svg>\n");
        svg
    }
}

fn write_shape(svg: &mut String, shape: &Shape, origin: P2) {
    let data: Vec<String> = shape.paths.iter().map(|p| path_data(p, origin)).filter(|d| !d.is_empty()).collect();
    if data.is_empty() {
        return;
    }
    svg.push_str("<path");
    match shape.fill {
        Some(colour) => {
            let _ = write!(svg, " fill=\"{}\" fill-rule=\"evenodd\"", colour.hex());
        }
        None => svg.push_str(" fill=\"none\""),
    }
    if let Some(stroke) = shape.stroke {
        let _ = write!(
            svg,
            " stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"",
            stroke.colour.hex(),
            svg_number(stroke.width_mm)
        );
        if let Some(dash) = stroke.dash_mm {
            let [dash, gap] = dash.map(svg_number);
            let _ = write!(svg, " stroke-dasharray=\"{dash} {gap}\"");
        }
    }
    let _ = writeln!(svg, " d=\"{}\"/>", data.join(" "));
}
