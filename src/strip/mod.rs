//! Lays a fitted part flat: the pieces that are cut, with flaps, slits, splices and labels.
//!
//! Strip frame: s along the strip from its first connection point, w across (the plane's normal), mm. Pieces are seen from the side that the first loop
//! shows outward.

mod edge;
mod fasten;
mod fold;
mod hold;
mod joint;
mod label;
mod mating;
mod passage;
mod seats;
mod splice;

pub use fold::Face;
pub use hold::Hold;
pub use joint::{Dashes, Joint};
pub use passage::{Half, Passage, Seat};
pub use splice::{Splice, SpliceKind};

use crate::drawing::{Drawing, DrawnPath, KerfSide, Role};
use crate::fit::Part;
use crate::geom::Path;
use crate::progress::Warning;
use edge::Edges;
use std::ops::Range;

/// How strips are made into pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The joint, nominal.
    pub joint: Joint,
    /// Longest piece that fits the stock, mm.
    pub max_piece_mm: f64,
    /// How far two pieces of one strip overlap where they are joined, mm.
    pub splice_overlap_mm: f64,
    /// Height of engraved lettering, mm; `None` where the tool cannot mark the material: then no lines are marked either.
    pub label_mm: Option<f64>,
    /// Mass per area, g/m².
    pub grammage_g_per_m2: f64,
}

/// One thing to cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Unique name: part letter and number.
    pub name: String,
    /// The part it belongs to.
    pub part: String,
    /// What is cut and engraved, strip frame.
    pub drawing: Drawing,
    /// The stretch of the strip it is, mm, laps and end tabs included; the first connection point is at 0.
    pub stations_mm: Range<f64>,
    /// Where it carries flaps and slits, by station.
    pub passages: Vec<Passage>,
    /// Extent along s, mm.
    pub length_mm: f64,
    /// Extent along w, mm.
    pub width_mm: f64,
    /// Mass, g.
    pub mass_g: f64,
}

/// All pieces of one part and how well their joints are defined.
#[derive(Debug, Clone, PartialEq)]
pub struct Pieces {
    /// In strip order.
    pub pieces: Vec<Piece>,
    /// How each piece is joined to the next.
    pub splices: Vec<Splice>,
    /// Largest distance between where a flap's root finds its slit and where it should, from the drawn cuts, mm.
    pub max_mating_error_mm: f64,
    /// Labels that overlap a cut or another label.
    pub label_collisions: usize,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Why a part cannot be laid flat.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The stock is shorter than a piece can be.
    #[error(
        "part {part}: the stock takes pieces of at most {max_piece_mm:.0} mm, but two splices need {least_mm:.0} mm; use larger stock (--stock)"
    )]
    StockTooShort {
        /// The part.
        part: String,
        /// Longest piece.
        max_piece_mm: f64,
        /// Least length needed.
        least_mm: f64,
    },
    /// No gap between joints is long enough for a splice.
    #[error(
        "part {part}: between {from_mm:.0} and {to_mm:.0} mm of the strip no stretch of {need_mm:.0} mm is free of joints, so the strip cannot be divided for pieces of {max_piece_mm:.0} mm; use longer stock (--stock) or fewer layers"
    )]
    NoRoomForSplice {
        /// The part.
        part: String,
        /// Where the search began.
        from_mm: f64,
        /// And ended.
        to_mm: f64,
        /// Free length needed.
        need_mm: f64,
        /// Longest piece.
        max_piece_mm: f64,
    },
}

/// Lays `part` flat and divides it into pieces.
pub fn pieces(part: &Part, settings: &Settings) -> Result<Pieces, Error> {
    let edges = Edges::new(part, settings.joint.end_tab_mm);
    let (passages, mut warnings) = fasten::passages(part, &edges, &settings.joint);
    let ranges = splice::divide(part, &edges, &passages, settings)?;
    let mut label_collisions = 0;
    let mut pieces = Vec::with_capacity(ranges.len());
    for (i, range) in ranges.iter().enumerate() {
        let name = format!("{}{}", part.name, i + 1);
        let own: Vec<Passage> = passages.iter().filter(|p| range.contains(&p.station_mm)).cloned().collect();
        let mut paths = vec![DrawnPath {
            path: edges.contour(range.clone()),
            role: Role::Outline,
            kerf: KerfSide::Outside,
            joint: None,
        }];
        paths.extend(own.iter().flat_map(|f| f.paths(&settings.joint)));
        if let Some(height_mm) = settings.label_mm {
            paths.extend(splice::marks(&edges, &ranges, i, settings.splice_overlap_mm));
            let (labels, collisions) = label::labels(&name, &paths, &own, &settings.joint, height_mm);
            paths.extend(labels);
            label_collisions += collisions;
        }
        let outline_mm2 = paths[0].path.signed_area();
        let drawing = Drawing { name: name.clone(), paths };
        let bounds = drawing.bounds();
        pieces.push(Piece {
            name,
            part: part.name.clone(),
            drawing,
            stations_mm: range.clone(),
            passages: own,
            length_mm: bounds.width(),
            width_mm: bounds.height(),
            mass_g: outline_mm2 * 1e-6 * settings.grammage_g_per_m2,
        });
    }
    if ranges.len() > 1 {
        warnings.push(
            Warning::new(
                "spliced",
                format!(
                    "the strip of {:.0} mm is longer than the stock: {} pieces, each glued over the next by {:.0} mm",
                    edges.length_mm(),
                    ranges.len(),
                    settings.splice_overlap_mm
                ),
            )
            .in_part(&part.name),
        );
    }
    let cuts = pieces.iter().flat_map(|piece| &piece.drawing.paths);
    let max_mating_error_mm = mating::worst_mating_error_mm(part, cuts, &settings.joint);
    let splice = |(i, pair): (usize, &[Range<f64>])| Splice {
        kind: SpliceKind::Lap,
        pieces: [pieces[i].name.clone(), pieces[i + 1].name.clone()],
        stations_mm: pair[1].start..pair[0].end,
        joints: Vec::new(),
    };
    let splices = ranges.windows(2).enumerate().map(splice).collect();
    Ok(Pieces { pieces, splices, max_mating_error_mm, label_collisions, warnings })
}

/// An uncut line across the strip.
fn line(path: Path, role: Role) -> DrawnPath {
    DrawnPath { path, role, kerf: KerfSide::On, joint: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::{Outline, PlaneFrame};
    use crate::extrude::Extruder;
    use crate::fit::{self, Target};
    use crate::geom::{P2, P3, V3, contains, tolerance};
    use crate::progress::Quiet;
    use crate::sim::Material;

    fn part(width_mm: f64) -> Part {
        let outer = [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)].map(|(x, y)| P2::new(x, y)).to_vec();
        let material = Material {
            flexural_rigidity_n_mm: 2.1,
            membrane_stiffness_n_per_mm: 600.0,
            grammage_g_per_m2: 160.0,
            thickness_mm: 0.19,
        };
        let target = Target {
            name: "A",
            frame: &PlaneFrame { origin: P3::origin(), u: V3::x(), v: V3::y(), normal: V3::z() },
            outline: &Outline { outer, holes: Vec::new() },
            extruder: &Extruder::constant(-0.5 * width_mm, 0.5 * width_mm).unwrap(),
            material: &material,
        };
        fit::fit(&target, &fit::Settings { rounds: 0, ..fit::Settings::default() }, &mut Quiet).unwrap()
    }

    fn settings(max_piece_mm: f64) -> Settings {
        Settings {
            joint: joint::paper(),
            max_piece_mm,
            splice_overlap_mm: 20.0,
            label_mm: Some(3.0),
            grammage_g_per_m2: 160.0,
        }
    }

    #[test]
    fn a_short_strip_is_one_piece_as_long_as_strip_and_tabs() {
        let part = part(40.0);
        let laid = pieces(&part, &settings(5000.0)).unwrap();
        assert_eq!(laid.pieces.len(), 1);
        let piece = &laid.pieces[0];
        assert!((piece.length_mm - (part.ruffle.strip_length() + 18.0)).abs() < 1e-6);
        assert_eq!((piece.width_mm, piece.name.as_str()), (40.0, "A1"));
        let sheet_g = piece.length_mm * 40.0 * 160e-6;
        assert!((piece.mass_g - sheet_g).abs() < 1e-6, "{} {sheet_g}", piece.mass_g);
    }

    #[test]
    fn pieces_fit_the_stock_and_their_lengths_sum_to_strip_and_laps() {
        let part = part(40.0);
        let laid = pieces(&part, &settings(277.0)).unwrap();
        let n = laid.pieces.len();
        assert!(n > 2);
        assert!(laid.pieces.iter().all(|p| p.length_mm <= 277.0 + 1e-9));
        let sum: f64 = laid.pieces.iter().map(|p| p.length_mm).sum();
        let expected = part.ruffle.strip_length() + 18.0 + 20.0 * (n - 1) as f64;
        assert!((sum - expected).abs() < 0.01, "{sum} against {expected}");
        assert!(laid.warnings.iter().any(|w| w.code == "spliced"));
        let marks = laid.pieces.iter().map(|p| p.drawing.paths.iter().filter(|d| d.role == Role::Mark).count());
        assert_eq!(marks.sum::<usize>(), 2 * (n - 1));
    }

    #[test]
    fn every_joint_has_flaps_on_one_pass_and_as_many_slits_on_the_other() {
        for (width, across) in [(30.0, 1), (80.0, 2), (140.0, 3)] {
            let part = part(width);
            let laid = pieces(&part, &settings(277.0)).unwrap();
            for connection in part.ruffle.connection_points() {
                let joint = Some(format!("A{}", connection.joint));
                let count = |role: Role| {
                    let paths = laid.pieces.iter().flat_map(|p| &p.drawing.paths);
                    paths.filter(|d| d.role == role && d.joint == joint).count()
                };
                assert_eq!((count(Role::Flap), count(Role::Slit)), (across, across), "{joint:?}, {width} mm");
            }
            assert!(laid.max_mating_error_mm < 1e-6, "{}", laid.max_mating_error_mm);
        }
    }

    #[test]
    fn cuts_and_labels_lie_inside_their_piece_and_apart() {
        let laid = pieces(&part(40.0), &settings(277.0)).unwrap();
        assert_eq!(laid.label_collisions, 0);
        for piece in &laid.pieces {
            let contour = piece.drawing.outline().unwrap().flatten(tolerance::FLATTEN_MM);
            let inner: Vec<&DrawnPath> =
                piece.drawing.paths.iter().filter(|p| !matches!(p.role, Role::Outline | Role::Mark)).collect();
            for path in &inner {
                assert!(path.path.flatten(0.01).iter().all(|p| contains(&contour, *p)), "{:?}", path.role);
            }
            let cuts = || inner.iter().filter(|p| p.role != Role::Label);
            for label in inner.iter().filter(|p| p.role == Role::Label) {
                let clash = cuts().find(|cut| cut.path.bounds().overlaps(&label.path.bounds()));
                assert!(clash.is_none(), "label over {clash:?}");
            }
        }
    }

    #[test]
    fn a_slit_that_moves_or_leads_the_wrong_way_shows_in_the_mating_error() {
        let part = part(40.0);
        let laid = pieces(&part, &settings(5000.0)).unwrap();
        let joint = joint::paper();
        let drawn = &laid.pieces[0].drawing.paths;
        let error = |paths: &[DrawnPath]| mating::worst_mating_error_mm(&part, paths.iter(), &joint);
        for (ds, dw, least) in [(0.3, 0.0, 0.2), (-0.3, 0.0, 0.2), (0.0, 0.2, 0.2)] {
            let mut spoilt = drawn.clone();
            let slit = spoilt.iter_mut().find(|p| p.role == Role::Slit).unwrap();
            slit.path = slit.path.moved(&crate::geom::Motion::translation(ds, dw));
            assert!(error(&spoilt) > least, "{ds} {dw}: {}", error(&spoilt));
        }
        let behind = Joint { slit_ahead_mm: -joint.slit_ahead_mm, ..joint };
        assert!(mating::worst_mating_error_mm(&part, drawn.iter(), &behind) > 0.9);
    }

    #[test]
    fn stock_shorter_than_splices_is_refused_with_the_length_needed() {
        let error = pieces(&part(40.0), &settings(50.0)).unwrap_err();
        assert!(matches!(error, Error::NoRoomForSplice { .. }), "{error}");
        let error = pieces(&part(40.0), &settings(30.0)).unwrap_err();
        assert!(error.to_string().contains("at most 30 mm"), "{error}");
    }
}
