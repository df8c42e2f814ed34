//! Strips of real parts, laid flat whole and in pieces.

use super::*;
use crate::cut::{Outline, PlaneFrame};
use crate::drawing::{DrawnPath, Role};
use crate::extrude::{Extruder, Span};
use crate::fit::{self, Target};
use crate::geom::{Motion, P2, P3, V3, contains, enclosed, segments_cross, tolerance};
use crate::progress::Quiet;
use crate::ruffle::{self, load_test};
use crate::sim::Material;
use proptest::prelude::*;
use std::sync::OnceLock;

/// A square of 100 mm, filled, its strip this wide.
pub(super) fn part(width_mm: f64) -> Part {
    static SQUARE: OnceLock<Part> = OnceLock::new();
    let square = SQUARE.get_or_init(|| {
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
            extruder: &Extruder::constant(-20.0, 20.0).unwrap(),
            material: &material,
            loads_n: &[],
        };
        fit::fit(&target, &fit::Settings { effort: 0, ..fit::Settings::default() }, None, &mut Quiet).unwrap()
    });
    let spans = vec![Span { lo: -0.5 * width_mm, hi: 0.5 * width_mm }; square.spans.len()];
    Part { spans, ..square.clone() }
}

/// A load-test strip as it is drawn.
fn load_test_part(strip: ruffle::Strip) -> Part {
    let drawn = load_test(strip, 2.0).unwrap();
    let segments: Vec<(P2, P2)> =
        drawn.ruffle.segments().map(|(i, j)| (drawn.positions[i], drawn.positions[j])).collect();
    let mut part = part(80.0);
    part.spans = vec![Span { lo: -40.0, hi: 40.0 }; drawn.positions.len()];
    part.report.covered = enclosed(&segments).loops;
    part.equilibrium.positions = drawn.positions;
    part.ruffle = drawn.ruffle;
    part
}

pub(super) fn settings(max_piece_mm: f64) -> Settings {
    let kind = SpliceKind::Connection;
    Settings {
        joint: joint::paper(),
        kerf_mm: 0.15,
        max_piece_mm,
        splice: SpliceSettings { kind, connection_mm: 14.0, lap_mm: 20.0, rows_mm: 12.0, thread_hole_mm: None },
        labels: Labels::Strokes { height_mm: 3.0 },
        clean_outside: false,
        grammage_g_per_m2: 160.0,
    }
}

fn spliced(kind: SpliceKind, max_piece_mm: f64) -> Settings {
    let mut settings = settings(max_piece_mm);
    settings.splice.kind = kind;
    settings
}

const KINDS: [SpliceKind; 4] = [SpliceKind::Connection, SpliceKind::Lap, SpliceKind::DovetailTape, SpliceKind::Finger];

fn of_role(pieces: &[Piece], role: Role) -> Vec<&DrawnPath> {
    pieces.iter().flat_map(|p| &p.drawing.paths).filter(|p| p.role == role).collect()
}

fn is_simple(corners: &[P2]) -> bool {
    let n = corners.len();
    let side = |i: usize| (corners[i], corners[(i + 1) % n]);
    (0..n).all(|i| (i + 2..n).all(|j| !segments_cross(side(i).0, side(i).1, side(j).0, side(j).1)))
}

#[test]
fn a_short_strip_is_one_piece_as_long_as_strip_and_tabs() {
    let part = part(40.0);
    let laid = pieces(&part, &[], &settings(5000.0)).unwrap();
    assert_eq!((laid.pieces.len(), laid.splices.len()), (1, 0));
    let piece = &laid.pieces[0];
    assert!((piece.length_mm - (part.ruffle.strip_length() + 18.0)).abs() < 1e-6);
    assert_eq!((piece.width_mm, piece.name.as_str()), (40.0, "A1"));
    let sheet_g = piece.length_mm * 40.0 * 160e-6;
    assert!((piece.mass_g - sheet_g).abs() < 1e-6, "{} {sheet_g}", piece.mass_g);
}

#[test]
fn pieces_fit_the_stock_and_their_lengths_sum_to_strip_and_splices() {
    let part = part(40.0);
    for kind in KINDS {
        let laid = pieces(&part, &[], &spliced(kind, 277.0)).unwrap();
        let n = laid.pieces.len();
        assert!(n > 2);
        assert!(laid.pieces.iter().all(|p| p.length_mm <= 277.0 + 1e-9), "{kind:?}");
        let sum: f64 = laid.pieces.iter().map(|p| p.length_mm).sum();
        let overlaps: f64 = laid.splices.iter().map(|s| s.stations_mm.end - s.stations_mm.start).sum();
        let expected = part.ruffle.strip_length() + 18.0 + overlaps;
        assert!((sum - expected).abs() < 1e-6, "{kind:?}: {sum} against {expected}");
        assert!(laid.warnings.iter().any(|w| w.code == "spliced"));
        assert_eq!(of_role(&laid.pieces, Role::Mark).len(), 4 * (n - 1), "ticks where each neighbour ends");
        assert!(laid.max_mating_error_mm < 1e-6, "{kind:?}: {}", laid.max_mating_error_mm);
        assert_eq!(laid.label_collisions, 0);
        assert!(!laid.warnings.iter().any(|w| w.code == "labels-left-out"), "{:?}", laid.warnings);
    }
}

#[test]
fn a_strip_of_two_metres_goes_on_sheets_of_400_mm() {
    let square = part(40.0);
    for strips in [2.0, 4.0, 6.0] {
        let mut part = square.clone();
        let scale = 1000.0 * strips / part.ruffle.strip_length();
        part.ruffle.rest_lengths.iter_mut().for_each(|l| *l *= scale);
        part.equilibrium.positions.iter_mut().for_each(|p| *p *= scale);
        for max in [380.0, 277.0] {
            let laid = pieces(&part, &[], &settings(max)).unwrap();
            assert!(laid.pieces.iter().all(|p| p.length_mm <= max), "{strips} m on {max} mm");
        }
    }
}

#[test]
fn at_a_joint_both_ends_carry_its_slits_and_its_flap_goes_through_both() {
    let laid = pieces(&part(40.0), &[], &settings(277.0)).unwrap();
    let at_joints: Vec<&Splice> = laid.splices.iter().filter(|s| s.kind == SpliceKind::Connection).collect();
    assert!(!at_joints.is_empty());
    for splice in at_joints {
        let joint = &splice.joints[0];
        let on = |name: &String| laid.pieces.iter().find(|p| p.name == *name).unwrap();
        let [earlier, later] = splice.pieces.each_ref().map(on);
        let here = |p: &&Passage| p.joint == *joint && splice.stations_mm.contains(&p.station_mm);
        let passage = |piece: &Piece| piece.passages.iter().find(here).cloned().unwrap();
        let (a, b) = (passage(earlier), passage(later));
        assert_eq!(a.station_mm, b.station_mm);
        assert_eq!(a.sheets, 2);
        assert!(a.half == Half::Slit || b.half == Half::Slit);
        assert!((splice.stations_mm.end - splice.stations_mm.start - 14.0).abs() < 1e-9);
        assert!((0.5 * (splice.stations_mm.end + splice.stations_mm.start) - a.station_mm).abs() < 1e-9);
    }
}

#[test]
fn a_lap_is_held_by_flaps_of_each_piece_in_slits_of_the_other() {
    let laid = pieces(&part(40.0), &[], &spliced(SpliceKind::Lap, 277.0)).unwrap();
    let joints = part(40.0).ruffle.connection_points().len() as u32;
    for splice in &laid.splices {
        assert_eq!(splice.joints.len(), 2);
        for joint in &splice.joints {
            assert!(joint[1..].parse::<u32>().unwrap() > joints, "{joint} is a number of its own");
            let carriers: Vec<(&str, Half)> = laid
                .pieces
                .iter()
                .flat_map(|p| p.passages.iter().map(move |q| (p.name.as_str(), q)))
                .filter(|(_, q)| q.joint == *joint)
                .map(|(name, q)| (name, q.half))
                .collect();
            assert_eq!(carriers.len(), 2);
            assert_ne!(carriers[0].0, carriers[1].0);
            assert!(carriers.iter().any(|c| c.1 == Half::Flap) && carriers.iter().any(|c| c.1 == Half::Slit));
        }
    }
    let mut sewn = spliced(SpliceKind::Lap, 277.0);
    sewn.splice.thread_hole_mm = Some(1.5);
    let laid = pieces(&part(40.0), &[], &sewn).unwrap();
    let stitches =
        of_role(&laid.pieces, Role::Hole).into_iter().filter(|h| (h.path.bounds().width() - 1.5).abs() < 1e-9);
    assert!(stitches.count() >= 2 * 2 * 4 * laid.splices.len());
}

#[test]
fn every_joint_has_flaps_on_one_pass_and_as_many_slits_on_the_other() {
    for (width, across) in [(30.0, 1), (80.0, 2), (140.0, 3)] {
        let part = part(width);
        let laid = pieces(&part, &[], &settings(5000.0)).unwrap();
        for connection in part.ruffle.connection_points() {
            let joint = Some(format!("A{}", connection.joint));
            let count = |role: Role| of_role(&laid.pieces, role).iter().filter(|d| d.joint == joint).count();
            assert_eq!((count(Role::Flap), count(Role::Slit)), (across, across), "{joint:?}, {width} mm");
        }
        assert!(laid.max_mating_error_mm < 1e-6, "{}", laid.max_mating_error_mm);
    }
}

/// The ladder is known: from the floor up, each sheet of a joint lies over or under the other.
#[test]
fn flaps_fold_toward_the_side_on_which_their_partner_lies() {
    let part = load_test_part(ruffle::Strip::Default);
    let laid = pieces(&part, &[], &settings(5000.0)).unwrap();
    let flap = |joint: &str| {
        let mut passages = laid.pieces[0].passages.iter();
        passages.find(|p| p.joint == joint && p.half == Half::Flap).unwrap().clone()
    };
    // The bottom rung walks to the right: its right hand, the front, looks at the floor, and the diagonal lies on its back.
    let foot = flap("A1");
    assert_eq!((foot.station_mm, foot.face), (0.0, Face::Back));
    // Every slit is entered from where its flap is: walking against each other, front lies on front; walking alike, front on back.
    for p in &laid.pieces[0].passages {
        let partner = laid.pieces[0].passages.iter().find(|q| q.joint == p.joint && q.half != p.half).unwrap();
        let alike = p.seats[0].direction == partner.seats[0].direction;
        assert_eq!(p.face == partner.face, !alike, "{}", p.joint);
    }
    // Half of the joints touch front to front, half back to back.
    let fronts = laid.pieces[0].passages.iter().filter(|p| p.half == Half::Flap && p.face == Face::Front).count();
    assert!((1..4).contains(&fronts), "{fronts}");
}

#[test]
fn cuts_and_labels_lie_inside_their_piece_and_apart() {
    let looks =
        [Labels::Strokes { height_mm: 3.0 }, Labels::Strokes { height_mm: 5.0 }, Labels::Perforated { height_mm: 6.0 }];
    for labels in looks {
        let laid = pieces(&part(40.0), &[], &Settings { labels, ..settings(277.0) }).unwrap();
        assert_eq!(laid.label_collisions, 0);
        for piece in &laid.pieces {
            let contour = piece.drawing.outline().unwrap().flatten(tolerance::FLATTEN_MM);
            let inner = piece.drawing.paths.iter().filter(|p| !matches!(p.role, Role::Outline | Role::Mark));
            for path in inner {
                assert!(path.path.flatten(0.01).iter().all(|p| contains(&contour, *p)), "{:?}", path.role);
            }
            let labelled = |joint: &str| {
                let mut labels = piece.drawing.paths.iter().filter(|p| matches!(p.role, Role::Label | Role::Hole));
                labels.any(|p| p.joint.as_deref() == Some(joint))
            };
            assert!(piece.passages.iter().all(|p| labelled(&p.joint)), "{}", piece.name);
        }
    }
}

#[test]
fn notches_tell_joints_where_nothing_can_be_written() {
    let laid = pieces(&part(40.0), &[], &Settings { labels: Labels::Notches, ..settings(5000.0) }).unwrap();
    let plain = pieces(&part(40.0), &[], &Settings { labels: Labels::Nothing, ..settings(5000.0) }).unwrap();
    let corners = |laid: &Pieces| laid.pieces[0].drawing.outline().unwrap().vertices.len();
    let notches: usize =
        laid.pieces[0].passages.iter().map(|p| p.joint[1..].parse::<usize>().unwrap()).map(|n| n / 5 + n % 5).sum();
    assert_eq!(corners(&laid), corners(&plain) + 3 * notches);
    assert!(is_simple(&laid.pieces[0].drawing.outline().unwrap().flatten(0.05)));
    // Of a lap's two rows one is told, at both ends that it joins.
    let mut sewn = spliced(SpliceKind::Lap, 277.0);
    sewn.labels = Labels::Notches;
    let notched = pieces(&part(40.0), &[], &sewn).unwrap();
    let bare = pieces(&part(40.0), &[], &Settings { labels: Labels::Nothing, ..sewn }).unwrap();
    let joints = part(40.0).ruffle.connection_points().len();
    for (with, without) in notched.pieces.iter().zip(&bare.pieces) {
        let numbers = with.passages.iter().map(|p| p.joint[1..].parse::<usize>().unwrap());
        let told = numbers.filter(|n| *n <= joints || (n - joints) % 2 == 1).map(|n| n / 5 + n % 5).sum::<usize>();
        let corners = |piece: &Piece| piece.drawing.outline().unwrap().vertices.len();
        assert_eq!(corners(with), corners(without) + 3 * told, "{}", with.name);
    }
    assert!(of_role(&laid.pieces, Role::Label).is_empty() && of_role(&laid.pieces, Role::Mark).is_empty());
}

#[test]
fn a_clean_outside_has_no_marks_and_a_mirrored_piece_reads_from_its_back() {
    let part = part(40.0);
    let laid = pieces(&part, &[], &Settings { clean_outside: true, ..settings(277.0) }).unwrap();
    assert_eq!(laid.label_collisions, 0);
    let mut mirrored = 0;
    for piece in &laid.pieces {
        let back = piece.seen_from == Face::Back;
        mirrored += usize::from(back);
        let bounds = piece.drawing.outline().unwrap().bounds();
        let (start, end) = (piece.stations_mm.start, piece.stations_mm.end);
        let expected = if back { (-end, -start) } else { (start, end) };
        assert!((bounds.min.x - expected.0).abs() < 1e-6 && (bounds.max.x - expected.1).abs() < 1e-6);
        let outside = visible::outward(&part, &piece.passages, piece.seen_from);
        for label in piece.drawing.paths.iter().filter(|p| matches!(p.role, Role::Label | Role::Mark)) {
            let s = label.path.bounds().center().x * if back { -1.0 } else { 1.0 };
            assert!(!outside.iter().any(|r| r.contains(&s)), "a label at {s} in {outside:?}");
        }
        // The letters are the alphabet's, shifted: readable, not mirrored with the piece.
        let upright = crate::drawing::text_paths("P", 3.0)[0].clone();
        let same = |p: &DrawnPath| {
            let shift = p.path.vertices[0].point - upright.vertices[0].point;
            p.path.vertices.len() == upright.vertices.len()
                && p.path
                    .vertices
                    .iter()
                    .zip(&upright.vertices)
                    .all(|(v, u)| (v.point - u.point - shift).norm() < 1e-9 && (v.bulge - u.bulge).abs() < 1e-9)
        };
        assert!(piece.drawing.paths.iter().any(same), "the P of {}", piece.name);
    }
    assert!(mirrored > 0, "one of the pieces shows less of its back");
}

#[test]
fn other_fastenings_take_the_place_of_flap_and_slit() {
    let part = part(40.0);
    let joints = part.ruffle.connection_points().len();
    let holes = Joint { fastening: Fastening::Holes { diameter_mm: 3.2 }, edge_distance_mm: 5.0, ..joint::paper() };
    let laid = pieces(&part, &[], &Settings { joint: holes, ..settings(5000.0) }).unwrap();
    assert_eq!(of_role(&laid.pieces, Role::Hole).len(), 2 * joints);
    assert!(of_role(&laid.pieces, Role::Flap).is_empty());
    let marked = Joint { fastening: Fastening::Mark, ..joint::paper() };
    let laid = pieces(&part, &[], &Settings { joint: marked, ..settings(5000.0) }).unwrap();
    let crosses = of_role(&laid.pieces, Role::Mark);
    assert!(crosses.len() == 4 * joints && crosses.iter().all(|c| c.joint.is_some()));
}

#[test]
fn a_slit_that_moves_or_leads_the_wrong_way_shows_in_the_mating_error() {
    let part = part(40.0);
    let laid = pieces(&part, &[], &settings(5000.0)).unwrap();
    let joint = joint::paper();
    let drawn = &laid.pieces[0].drawing.paths;
    let error = |paths: &[DrawnPath]| mating::worst_mating_error_mm(&part, &[], paths.iter(), &joint);
    for (ds, dw, least) in [(0.3, 0.0, 0.2), (-0.3, 0.0, 0.2), (0.0, 0.2, 0.2)] {
        let mut spoilt = drawn.clone();
        let slit = spoilt.iter_mut().find(|p| p.role == Role::Slit).unwrap();
        slit.path = slit.path.moved(&Motion::translation(ds, dw));
        assert!(error(&spoilt) > least, "{ds} {dw}: {}", error(&spoilt));
    }
    let mut mislabelled = drawn.clone();
    let slit = mislabelled.iter_mut().find(|p| p.role == Role::Slit).unwrap();
    slit.joint = Some("A99".into());
    assert!(error(&mislabelled) > 1.0);
    let behind = Joint { slit_ahead_mm: -joint.slit_ahead_mm, ..joint };
    assert!(mating::worst_mating_error_mm(&part, &[], drawn.iter(), &behind) > 0.9);
}

#[test]
fn stock_too_short_for_any_splice_and_joints_that_fall_open_are_refused_with_a_way_out() {
    let error = pieces(&part(40.0), &[], &settings(40.0)).unwrap_err();
    assert!(matches!(error, Error::NoRoomForSplice { .. }) && error.to_string().contains("--stock"), "{error}");
    let loose = Joint { slit_length_mm: 10.0, ..joint::paper() };
    let error = pieces(&part(40.0), &[], &Settings { joint: loose, ..settings(500.0) }).unwrap_err();
    assert!(matches!(error, Error::FallsOpen { .. }) && error.to_string().contains("0.60 mm are needed"), "{error}");
    let thick = Joint { thickness_mm: 1.0, ..joint::paper() };
    assert!(matches!(
        pieces(&part(40.0), &[], &Settings { joint: thick, ..settings(500.0) }),
        Err(Error::NeckShort { .. })
    ));
}

/// The paper's table of load-test samples: 486, 749 and 797 mm, 6, 10 and 10 g at 80 mm of width.
#[test]
fn the_load_test_strips_are_as_long_and_as_heavy_as_published() {
    for (strip, length, mass) in
        [(ruffle::Strip::Default, 486.0, 6.0), (ruffle::Strip::Wide, 749.0, 10.0), (ruffle::Strip::Dense, 797.0, 10.0)]
    {
        let laid = pieces(&load_test_part(strip), &[], &settings(5000.0)).unwrap();
        let piece = &laid.pieces[0];
        assert!((piece.length_mm - length).abs() <= 2.0, "{strip:?}: {}", piece.length_mm);
        assert!((piece.mass_g - mass).abs() <= 0.5, "{strip:?}: {}", piece.mass_g);
        assert!(laid.max_mating_error_mm < 1e-6, "{strip:?}: {}", laid.max_mating_error_mm);
        assert_eq!(laid.label_collisions, 0);
    }
}

/// Widths along a strip that swell and shrink as a body does: least half width, swell, waves, phase, lean of the middle.
fn swelling() -> impl Strategy<Value = [f64; 5]> {
    (10.0..30.0f64, 0.0..45.0f64, 0.5..6.0f64, 0.0..6.3f64, -20.0..20.0f64).prop_map(|(a, b, c, d, e)| [a, b, c, d, e])
}

fn swollen([least, swell, waves, phase, lean]: [f64; 5], share: f64) -> Span {
    let half = least + swell * 0.5 * (1.0 + (phase + std::f64::consts::TAU * waves * share).sin());
    let middle = lean * (phase + 7.0 * share).cos();
    Span { lo: middle - half, hi: middle + half }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]
    #[test]
    fn strips_of_any_width_keep_their_cuts_inside_and_their_contours_simple(
        span in swelling(), max in 150.0..600.0f64, kind in 0..4usize,
    ) {
        let mut part = part(40.0);
        let stations = part.ruffle.stations();
        let length = part.ruffle.strip_length();
        for (node, station) in part.ruffle.walk.iter().zip(&stations) {
            part.spans[node.index()] = swollen(span, station / length);
        }
        let laid = pieces(&part, &[], &spliced(KINDS[kind], max)).unwrap();
        prop_assert!(laid.max_mating_error_mm < 1e-6 && laid.label_collisions == 0);
        let narrow = laid.warnings.iter().find(|w| w.code == "joint-narrow");
        for piece in &laid.pieces {
            prop_assert!(piece.length_mm <= max + 1e-9);
            let contour = piece.drawing.outline().unwrap().flatten(0.05);
            prop_assert!(is_simple(&contour), "{}", piece.name);
            let cuts = piece.drawing.paths.iter().filter(|p| matches!(p.role, Role::Flap | Role::Slit | Role::Hole));
            for cut in cuts {
                // A joint that is told to be too narrow may come to the edge.
                let told = narrow.is_some_and(|w| w.place.as_deref().unwrap_or("").contains(cut.joint.as_deref().unwrap_or("-")));
                prop_assert!(told || cut.path.flatten(0.05).iter().all(|p| contains(&contour, *p)), "{cut:?}");
            }
            for passage in &piece.passages {
                prop_assert!(!passage.seats.is_empty());
                let ahead = passage.seats.iter().filter(|s| s.direction > 0.0).count();
                let abreast = ahead.max(passage.seats.len() - ahead);
                let (lo, hi) = edge::Edges::new(&part, 9.0).at(passage.station_mm);
                prop_assert!(abreast == 1 || abreast as f64 * settings(max).joint.cut_out_mm() <= 0.35 * (hi - lo) + 1e-9);
            }
        }
    }
}
