//! A canvas as PNG.

use super::Error;
use super::canvas::{Canvas, Shape, Stroke};
use crate::geom::P2;
use tiny_skia::{FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, StrokeDash, Transform};

/// The most pixels on a side: an image of that size fills 256 MB.
const LIMIT_PX: u32 = 8192;

/// Chords stay this close to their arcs, in pixels: less than antialiasing can show.
const FLATTEN_PX: f64 = 0.05;

impl Canvas {
    /// The picture as PNG, its longer side `longer_px` pixels, antialiased on white. The same canvas gives the same bytes.
    ///
    /// # Errors
    /// [`Error::NoArea`] for an empty canvas, [`Error::Size`] for no pixels or more than 8192 on a side.
    pub fn to_png(&self, longer_px: u32) -> Result<Vec<u8>, Error> {
        let (width_mm, height_mm) = (self.area.width(), self.area.height());
        let longer_mm = width_mm.max(height_mm);
        if !(width_mm > 0.0 && height_mm > 0.0 && longer_mm.is_finite()) {
            return Err(Error::NoArea { width_mm, height_mm });
        }
        let px_per_mm = f64::from(longer_px) / longer_mm;
        let [width_px, height_px] = [width_mm, height_mm].map(|mm| (mm * px_per_mm).round().max(1.0) as u32);
        let size = Error::Size { width_px, height_px, limit_px: LIMIT_PX };
        if longer_px == 0 || longer_px > LIMIT_PX {
            return Err(size);
        }
        let mut pixmap = Pixmap::new(width_px, height_px).ok_or(size)?;
        pixmap.fill(tiny_skia::Color::WHITE);
        for shape in &self.shapes {
            self.paint(&mut pixmap, shape, px_per_mm);
        }
        pixmap.encode_png().map_err(|e| Error::Encode(e.to_string()))
    }

    fn paint(&self, pixmap: &mut Pixmap, shape: &Shape, px_per_mm: f64) {
        let mut builder = PathBuilder::new();
        let to_px = |p: P2| {
            let p = (p.x - self.area.min.x, self.area.max.y - p.y);
            ((p.0 * px_per_mm) as f32, (p.1 * px_per_mm) as f32)
        };
        for path in &shape.paths {
            for (i, point) in path.flatten(FLATTEN_PX / px_per_mm).into_iter().enumerate() {
                let (x, y) = to_px(point);
                if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
            }
            if path.closed {
                builder.close();
            }
        }
        // Nothing but single points, or coordinates that are no numbers: nothing to see.
        let Some(path) = builder.finish() else { return };
        let paint = |colour: super::Colour| {
            let mut paint = Paint { anti_alias: true, ..Paint::default() };
            paint.set_color_rgba8(colour.0, colour.1, colour.2, 255);
            paint
        };
        if let Some(fill) = shape.fill {
            pixmap.fill_path(&path, &paint(fill), FillRule::EvenOdd, Transform::identity(), None);
        }
        if let Some(stroke) = shape.stroke {
            pixmap.stroke_path(&path, &paint(stroke.colour), &pen(&stroke, px_per_mm), Transform::identity(), None);
        }
    }
}

fn pen(stroke: &Stroke, px_per_mm: f64) -> tiny_skia::Stroke {
    let px = |mm: f64| (mm * px_per_mm) as f32;
    tiny_skia::Stroke {
        width: px(stroke.width_mm),
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        dash: stroke.dash_mm.and_then(|d| StrokeDash::new(d.map(px).to_vec(), 0.0)),
        ..tiny_skia::Stroke::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Path, Rect};
    use crate::preview::{Align, Colour, Text};

    fn scene() -> Canvas {
        let mut canvas = Canvas::new(Rect { min: P2::new(-10.0, -5.0), max: P2::new(30.0, 15.0) });
        let square = |a: f64, b: f64| vec![P2::new(a, a), P2::new(b, a), P2::new(b, b), P2::new(a, b)];
        canvas.region([&square(0.0, 10.0), &square(4.0, 6.0)], Some(Colour::REGION), None);
        canvas.disc(P2::new(20.0, 10.0), 2.0, Colour::RED, None);
        canvas.curves(vec![Path::open([P2::new(-8.0, 0.0), P2::new(-8.0, 12.0)])], Stroke::new(Colour::BLUE, 1.0));
        canvas
    }

    fn colour_at(pixmap: &Pixmap, canvas: &Canvas, x: f64, y: f64) -> Colour {
        let scale = f64::from(pixmap.width()) / canvas.area.width();
        let px = |mm: f64| (mm * scale) as u32;
        let c = pixmap.pixel(px(x - canvas.area.min.x), px(canvas.area.max.y - y)).unwrap();
        Colour(c.red(), c.green(), c.blue())
    }

    #[test]
    fn things_are_painted_where_they_stand_with_y_up() {
        let canvas = scene();
        let pixmap = Pixmap::decode_png(&canvas.to_png(400).unwrap()).unwrap();
        assert_eq!((pixmap.width(), pixmap.height()), (400, 200));
        let at = |x, y| colour_at(&pixmap, &canvas, x, y);
        assert_eq!(at(2.0, 2.0), Colour::REGION);
        assert_eq!(at(5.0, 5.0), Colour::WHITE, "the hole");
        assert_eq!(at(20.0, 10.0), Colour::RED);
        assert_eq!(at(20.0, 4.0), Colour::WHITE, "not mirrored");
        assert_eq!(at(-8.0, 11.0), Colour::BLUE);
    }

    #[test]
    fn the_same_canvas_gives_the_same_bytes() {
        assert_eq!(scene().to_png(333).unwrap(), scene().to_png(333).unwrap());
    }

    #[test]
    fn a_dashed_line_has_gaps() {
        let mut canvas = Canvas::new(Rect::from_size(40.0, 4.0));
        let stroke = Stroke::new(Colour::INK, 1.0).dashed(4.0, 6.0);
        canvas.polyline(&[P2::new(2.0, 2.0), P2::new(38.0, 2.0)], stroke);
        let pixmap = Pixmap::decode_png(&canvas.to_png(400).unwrap()).unwrap();
        let dark: Vec<bool> =
            (0..40).map(|x| colour_at(&pixmap, &canvas, f64::from(x) + 0.5, 2.0) == Colour::INK).collect();
        assert!(dark[3] && !dark[8] && dark[13] && !dark[18], "{dark:?}");
    }

    #[test]
    fn text_is_lettered_where_its_box_says() {
        let mut canvas = Canvas::new(Rect::from_size(60.0, 20.0));
        let text =
            Text { at: P2::new(30.0, 5.0), align: Align::Middle, height_mm: 8.0, colour: Colour::INK, text: "HIH" };
        canvas.text(text);
        let pixmap = Pixmap::decode_png(&canvas.to_png(600).unwrap()).unwrap();
        let b = text.bounds();
        assert!((b.center().x - 30.0).abs() < 1e-9 && b.min.y == 5.0 && b.max.y == 13.0);
        assert_eq!(colour_at(&pixmap, &canvas, b.min.x, 12.0), Colour::INK, "the left stem of the first H");
        assert_eq!(colour_at(&pixmap, &canvas, b.max.x, 6.0), Colour::INK, "the right stem of the last H");
        assert_eq!(colour_at(&pixmap, &canvas, b.min.x - 1.0, 9.0), Colour::WHITE);
    }

    #[test]
    fn sizes_that_make_no_picture_are_refused() {
        assert!(matches!(Canvas::new(Rect::EMPTY).to_png(100), Err(Error::NoArea { .. })));
        assert!(matches!(scene().to_png(0), Err(Error::Size { .. })));
        assert!(matches!(scene().to_png(9000), Err(Error::Size { limit_px: 8192, .. })));
    }

    #[test]
    fn svg_holds_the_same_curves() {
        let svg = scene().to_svg();
        let document = roxmltree::Document::parse(&svg).unwrap();
        assert_eq!(document.root_element().attribute("viewBox"), Some("0 0 40 20"));
        let paths: Vec<_> = document.descendants().filter(|n| n.has_tag_name("path")).collect();
        assert_eq!(paths.len(), 3);
        assert_eq!(paths[0].attribute("fill"), Some("#bcd6ee"));
        assert_eq!(paths[0].attribute("d"), Some("M10 15 H20 V5 H10 Z M14 11 H16 V9 H14 Z"));
        assert_eq!(paths[2].attribute("d"), Some("M2 15 V3"));
        assert_eq!(paths[2].attribute("stroke"), Some("#1446c8"));
    }
}
