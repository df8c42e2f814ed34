//! Toolpath to program.

use super::arcs::rounded;
use super::program::{Program, round3};
use super::writer::Writer;
use crate::geom::PathVertex;
use crate::toolpath::{Contour, Toolpath};

/// What the machine's controller wants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dialect {
    /// The S word of full power (GRBL $30), above 0.
    pub max_s: f64,
    /// How the tool is put to work and taken off.
    pub tool: ToolWords,
    /// The job lies where the head stands when it starts: its X0 Y0 is set there for as long as it runs (G92).
    pub from_here: bool,
    /// How air is switched; `None` when it is done by hand.
    pub air: Option<AirWords>,
}

/// How a tool is put to work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ToolWords {
    /// Power words on moves; M4 (power follows speed) but for contours that ask for the same power at any speed.
    Laser {
        /// M3 (the same power at any speed) for all.
        constant_power: bool,
    },
    /// A servo on the spindle's output ($32 = 0) swings the tool down and up.
    Servo {
        /// S word for down.
        down_s: f64,
        /// S word for up.
        up_s: f64,
        /// Time it takes, s.
        dwell_s: f64,
    },
    /// The z axis lowers and lifts the tool.
    Lift {
        /// Height on the sheet, mm.
        down_mm: f64,
        /// Height for travel, mm.
        up_mm: f64,
        /// Feed of the way down, mm/min.
        feed_mm_per_min: f64,
        /// Rest on the sheet before it moves on, s.
        dwell_s: f64,
    },
}

/// Which M words switch air on, 7 (mist) or 8 (flood); M9 switches it off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AirWords {
    /// For [`crate::toolpath::Air::Low`].
    pub low: u8,
    /// For [`crate::toolpath::Air::High`].
    pub high: u8,
}

/// What people read at the top of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Header {
    /// Written as `; key: value`, one line each, in this order. Made ASCII and cut to what a line holds.
    pub entries: Vec<(String, String)>,
}

/// Why no program was written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The dialect makes no sense.
    #[error("{name} of the machine is {value}; it must be {needed}")]
    Dialect {
        /// Which setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed.
        needed: &'static str,
    },
    /// A run that cannot be written.
    #[error("the {role} of piece {piece} cannot be written: {flaw}")]
    Contour {
        /// Name of the piece.
        piece: String,
        /// Role of the path.
        role: &'static str,
        /// What is wrong.
        flaw: &'static str,
    },
}

/// Writes a toolpath for GRBL 1.1.
///
/// The tool is off by default: a laser has S0 on every travel and a power only on the first move of each run, a pen or a blade is lifted before
/// every travel. Words are written only when they change, numbers with three decimals. The program states all modes it relies on and ends with the
/// tool off at the park point.
///
/// # Errors
/// A dialect out of range; a run whose path, feed or power is no number or out of range.
pub fn emit(toolpath: &Toolpath, header: &Header, dialect: &Dialect) -> Result<Program, Error> {
    check_dialect(dialect)?;
    let mut writer = Writer::new(*dialect);
    writer.comment(concat!("furbelow ", env!("CARGO_PKG_VERSION")));
    for (key, value) in &header.entries {
        writer.comment(&format!("{key}: {value}"));
    }
    writer.words(&[('G', 21.0), ('G', 90.0), ('G', 94.0), ('G', 17.0), ('G', 54.0), ('M', 5.0), ('S', 0.0)]);
    if dialect.from_here {
        writer.words(&[('G', 92.0), ('X', 0.0), ('Y', 0.0)]);
    }
    let mut operation = None;
    for contour in &toolpath.contours {
        check_contour(contour)?;
        if operation.replace(contour.operation) != Some(contour.operation) {
            writer.comment(contour.operation.id());
        }
        writer.run(contour);
    }
    writer.lift();
    writer.words(&[('M', 5.0), ('S', 0.0)]);
    if writer.air_used {
        writer.words(&[('M', 9.0)]);
    }
    writer.refocus();
    writer.travel(toolpath.home.iter().copied());
    let park = rounded(toolpath.park);
    writer.words(&[('G', 0.0), ('X', park.x), ('Y', park.y)]);
    if dialect.from_here {
        writer.words(&[('G', 92.1)]);
    }
    writer.words(&[('M', 2.0)]);
    Ok(Program { lines: writer.lines })
}

fn check_dialect(dialect: &Dialect) -> Result<(), Error> {
    let max_s = dialect.max_s;
    if !(max_s.is_finite() && max_s > 0.0) {
        return Err(Error::Dialect { name: "the S word of full power", value: max_s, needed: "a number above 0" });
    }
    let (numbers, needed): (Vec<f64>, _) = match dialect.tool {
        ToolWords::Laser { .. } => (Vec::new(), ""),
        ToolWords::Servo { down_s, up_s, dwell_s } => (vec![down_s, up_s, dwell_s], "at least 0"),
        ToolWords::Lift { feed_mm_per_min, dwell_s, .. } => {
            (vec![feed_mm_per_min - 1.0, dwell_s], "a feed of at least 1 mm/min")
        }
    };
    if let Some(value) = numbers.into_iter().find(|v| !(v.is_finite() && *v >= 0.0)) {
        return Err(Error::Dialect { name: "a number that lowers or lifts the tool", value, needed });
    }
    for code in dialect.air.iter().flat_map(|air| [air.low, air.high]) {
        if !(7..=8).contains(&code) {
            return Err(Error::Dialect { name: "the M word for air", value: f64::from(code), needed: "7 or 8" });
        }
    }
    Ok(())
}

pub(super) fn check_contour(contour: &Contour) -> Result<(), Error> {
    let finite = |v: &PathVertex| v.point.x.is_finite() && v.point.y.is_finite() && v.bulge.is_finite();
    let flaw = if contour.path.vertices.len() < 2 || !contour.path.vertices.iter().all(finite) {
        "its path has fewer than two corners or one that is not a finite number"
    } else if !(contour.feed_mm_per_min.is_finite() && round3(contour.feed_mm_per_min) > 0.0) {
        "its feed must be above 0 mm/min"
    } else if !(0.0..=1.0).contains(&contour.power) {
        "its power must be a fraction from 0 to 1"
    } else {
        return Ok(());
    };
    Err(Error::Contour { piece: contour.piece.clone(), role: contour.role.class(), flaw })
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::check::tests::diode;
    use super::super::{Action, CheckSettings, Move, check, parse, trace};
    use super::*;
    use crate::drawing::Role;
    use crate::geom::{Motion, P2, Path, Rect, Segment, V2, cross, distance_to_segment};
    use crate::toolpath::Air;
    use proptest::prelude::*;

    const DIALECT: Dialect = Dialect {
        max_s: 1000.0,
        tool: ToolWords::Laser { constant_power: false },
        from_here: false,
        air: Some(AirWords { low: 7, high: 8 }),
    };

    pub(crate) fn contour(path: Path, role: Role, air: Air) -> Contour {
        let piece = "A1".to_string();
        let operation = role.operation();
        let (constant_power, depth_mm, way) = (false, 0.0, Vec::new());
        let (joint, feed_mm_per_min, power) = (None, 1200.0, 0.5);
        Contour { path, operation, role, piece, joint, feed_mm_per_min, power, constant_power, depth_mm, air, way }
    }

    pub(crate) fn toolpath(contours: Vec<Contour>) -> Toolpath {
        Toolpath {
            width_mm: 400.0,
            height_mm: 400.0,
            motion: Motion::identity(),
            park: P2::origin(),
            contours,
            home: Vec::new(),
            crosses: Vec::new(),
            travel_mm: 0.0,
            travel_unordered_mm: 0.0,
            max_kerf_deviation_mm: 0.0,
            max_curve_deviation_mm: 0.0,
            warnings: Vec::new(),
        }
    }

    fn line(x0: f64, y0: f64, x1: f64, y1: f64) -> Path {
        Path::open([P2::new(x0, y0), P2::new(x1, y1)])
    }

    fn text(contours: Vec<Contour>, dialect: &Dialect) -> String {
        emit(&toolpath(contours), &Header::default(), dialect).unwrap().to_string()
    }

    #[test]
    fn a_sheet_reads_like_this() {
        let contours = vec![
            contour(line(10.0, 5.0, 10.0, 15.0), Role::Mark, Air::Off),
            contour(line(20.0, 15.0, 20.12345, 5.0), Role::Slit, Air::High),
            contour(Path::circle(P2::new(50.0, 5.0), 10.0), Role::Outline, Air::High),
        ];
        let header = Header { entries: vec![("job".into(), "stool".into()), ("sheet".into(), "1/2".into())] };
        let program = emit(&toolpath(contours), &header, &DIALECT).unwrap();
        let version = concat!("; furbelow ", env!("CARGO_PKG_VERSION"));
        let expected = [
            version,
            "; job: stool",
            "; sheet: 1/2",
            "G21G90G94G17G54M5S0",
            "; engrave",
            "G0X10Y5S0",
            "M4S0",
            "G1Y15S500F1200",
            "; cut-inner",
            "G0X20S0",
            "M8",
            "G1X20.123Y5S500",
            "; cut-outline",
            "G0X40S0",
            "G3X60I10S500",
            "X40I-10",
            "M5S0",
            "M9",
            "G0X0Y0",
            "M2",
        ];
        assert_eq!(program.to_string().lines().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn constant_power_is_m3_and_air_by_hand_writes_no_m_words() {
        let dialect = Dialect { tool: ToolWords::Laser { constant_power: true }, air: None, ..DIALECT };
        let text = text(vec![contour(line(10.0, 5.0, 10.0, 15.0), Role::Slit, Air::Low)], &dialect);
        assert!(text.contains("\nM3S0\n") && !text.contains("M4"));
        assert!(!text.contains("M7") && !text.contains("M8") && !text.contains("M9"));
    }

    #[test]
    fn the_beam_is_out_before_the_air_is_switched_on_the_spot() {
        let contours = vec![
            contour(line(10.0, 5.0, 10.0, 15.0), Role::Slit, Air::Low),
            contour(line(10.0, 15.0, 20.0, 15.0), Role::Slit, Air::High),
        ];
        let text = text(contours, &DIALECT);
        assert!(text.contains("G1Y15S500F1200\nS0\nM9\nM8\nX20S500\n"), "{text}");
    }

    #[test]
    fn a_contour_that_would_starve_is_cut_at_constant_power_and_the_next_is_not() {
        let cut =
            |x: f64, constant_power| Contour { constant_power, ..contour(line(x, 0.0, x, 9.0), Role::Slit, Air::Off) };
        let text = text(vec![cut(1.0, true), cut(2.0, true), cut(3.0, false)], &DIALECT);
        let modes: Vec<&str> = text.lines().filter(|l| l.starts_with("M3") || l.starts_with("M4")).collect();
        assert_eq!(modes, ["M3S0", "M4S0"], "{text}");
        assert!(text.contains("G0X2Y0S0\nG1Y9S500\nG0X3Y0S0\nM4S0\nG1Y9S500"), "{text}");
    }

    #[test]
    fn a_second_pass_goes_deeper_and_a_way_round_is_a_travel() {
        let stroke = contour(line(1.0, 0.0, 1.0, 9.0), Role::Slit, Air::Off);
        let back = contour(line(1.0, 9.0, 1.0, 0.0), Role::Slit, Air::Off);
        let round =
            Contour { way: vec![P2::new(50.0, 60.0)], ..contour(line(70.0, 0.0, 80.0, 0.0), Role::Slit, Air::Off) };
        let text = text(vec![stroke, Contour { depth_mm: 0.5, ..back }, round], &DIALECT);
        assert!(text.contains("G1Y9S500F1200\nG0Z-0.5S0\nG1Y0S500"), "{text}");
        assert!(text.contains("G0X50Y60S0\nX70Y0S0\nG0Z0S0\nG1X80S500"), "{text}");
        let deep = Contour { depth_mm: 0.5, ..contour(line(1.0, 9.0, 1.0, 0.0), Role::Slit, Air::Off) };
        let text = self::text(vec![deep], &DIALECT);
        assert!(text.ends_with("M5S0\nG0Z0\nG0X0Y0\nM2\n"), "it ends where it was focused: {text}");
    }

    #[test]
    fn a_pen_is_lowered_for_every_run_and_lifted_before_every_travel() {
        let runs = || {
            vec![
                contour(line(1.0, 0.0, 1.0, 9.0), Role::Slit, Air::Off),
                contour(line(3.0, 0.0, 3.0, 9.0), Role::Slit, Air::Off),
            ]
        };
        let servo = Dialect { tool: ToolWords::Servo { down_s: 90.0, up_s: 40.0, dwell_s: 0.2 }, ..DIALECT };
        let by_servo = text(runs(), &servo);
        assert!(
            by_servo.contains("M3S40\nG4P0.2\nG0X1Y0\nM3S90\nG4P0.2\nG1Y9F1200\nM3S40\nG4P0.2\nG0X3Y0\nM3S90"),
            "{by_servo}"
        );
        let lift = ToolWords::Lift { down_mm: 0.0, up_mm: 3.0, feed_mm_per_min: 800.0, dwell_s: 0.0 };
        let by_z = text(runs(), &Dialect { tool: lift, ..DIALECT });
        assert!(by_z.contains("G0Z3\nX1Y0\nG1Z0F800\nY9F1200\nG0Z3\nX3Y0\nG1Z0F800\nY9F1200\nG0Z3\nM5S0"), "{by_z}");
    }

    #[test]
    fn a_job_from_here_sets_its_zero_for_itself_only() {
        let text = text(
            vec![contour(line(1.0, 0.0, 1.0, 9.0), Role::Slit, Air::Off)],
            &Dialect { from_here: true, ..DIALECT },
        );
        assert!(text.contains("M5S0\nG92X0Y0\n") && text.ends_with("G0X0Y0\nG92.1\nM2\n"), "{text}");
    }

    #[test]
    fn what_cannot_be_written_is_refused() {
        let good = || contour(line(0.0, 0.0, 1.0, 0.0), Role::Slit, Air::Off);
        let refused = |c: Contour| emit(&toolpath(vec![c]), &Header::default(), &DIALECT).is_err();
        assert!(!refused(good()));
        assert!(refused(Contour { power: 1.5, ..good() }));
        assert!(refused(Contour { feed_mm_per_min: f64::NAN, ..good() }));
        assert!(refused(contour(line(0.0, f64::NAN, 1.0, 0.0), Role::Slit, Air::Off)));
        let bad = Dialect { max_s: 0.0, ..DIALECT };
        assert!(matches!(emit(&toolpath(vec![]), &Header::default(), &bad), Err(Error::Dialect { .. })));
    }

    prop_compose! {
        /// A path of lines and arcs, some below the last digit, some nearly full circles.
        fn path()(
            x in 100.0..300.0f64, y in 100.0..300.0f64, closed in any::<bool>(),
            steps in prop::collection::vec(
                (prop_oneof![0.0..0.01f64, 0.01..0.2f64, 0.2..30.0f64], 0.0..6.3f64, prop_oneof![Just(0.0), -1.0..1.0f64, -0.01..0.01f64, -3.0..3.0f64]),
                1..12,
            ),
        ) -> Path {
            let mut at = P2::new(x, y);
            let mut vertices = Vec::new();
            for (length, angle, bulge) in steps {
                vertices.push(PathVertex { point: at, bulge });
                at += V2::new(angle.cos(), angle.sin()) * length;
            }
            vertices.push(PathVertex { point: at, bulge: 0.0 });
            Path { vertices, closed }
        }
    }

    /// A stretch of a curve: its ends, and for an arc its centre and signed turn.
    type Stretch = (P2, P2, Option<(P2, f64)>);

    fn drawn(path: &Path) -> Vec<Stretch> {
        let stretch = |s: Segment| match s {
            Segment::Line { from, to } => (from, to, None),
            Segment::Arc { from, to, center, sweep_rad, .. } => (from, to, Some((center, sweep_rad))),
        };
        path.segments().map(stretch).collect()
    }

    fn followed(run: &[Move]) -> Vec<Stretch> {
        let stretch = |m: &Move| match m.action {
            Action::Arc { center, sweep_rad, .. } => (m.from.xy(), m.to.xy(), Some((center, sweep_rad))),
            _ => (m.from.xy(), m.to.xy(), None),
        };
        run.iter().map(stretch).collect()
    }

    fn distance(p: P2, (from, to, arc): &Stretch) -> f64 {
        let Some((center, sweep_rad)) = arc else { return distance_to_segment(p, *from, *to) };
        let (start, v) = (from - center, p - center);
        let turn = cross(start, v).atan2(start.dot(&v)) * sweep_rad.signum();
        let on_sweep = turn.rem_euclid(std::f64::consts::TAU) <= sweep_rad.abs();
        let to_ends = (p - from).norm().min((p - to).norm());
        if on_sweep { to_ends.min((v.norm() - start.norm()).abs()) } else { to_ends }
    }

    /// How far points of one curve lie from another, mm.
    fn apart(curve: &[Stretch], other: &[Stretch]) -> f64 {
        let points = curve.iter().flat_map(|(from, to, arc)| {
            (0..=24).map(move |k| match (k, arc) {
                (24, _) => *to,
                (_, Some((center, sweep_rad))) => {
                    center + nalgebra::Rotation2::new(sweep_rad * f64::from(k) / 24.0) * (from - center)
                }
                _ => from + (to - from) * (f64::from(k) / 24.0),
            })
        });
        points.map(|p| other.iter().map(|s| distance(p, s)).fold(f64::INFINITY, f64::min)).fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn what_is_written_retraces_the_toolpath_with_the_beam_on_and_travels_with_it_off(
            paths in prop::collection::vec(path(), 1..4), constant_power in any::<bool>(),
        ) {
            let contours: Vec<Contour> = paths.into_iter().map(|p| contour(p, Role::Slit, Air::Off)).collect();
            let toolpath = toolpath(contours.clone());
            let program = emit(&toolpath, &Header::default(), &Dialect { tool: ToolWords::Laser { constant_power }, ..DIALECT }).unwrap();
            prop_assert_eq!(&parse(&program.to_string()).unwrap(), &program);
            prop_assert!(program.to_string().lines().all(|l| l.len() < 79));
            let moves = trace(&program).unwrap();
            prop_assert!(moves.iter().all(|m| m.action != Action::Rapid || m.power_s == 0.0));
            let settings = CheckSettings { work_area: toolpath.bounds().with(P2::origin()).grown(1e-3), ..diode() };
            let report = check(&program, &settings);
            prop_assert!(report.errors.is_empty() && report.warnings.is_empty(), "{report:?}");

            let runs: Vec<&[Move]> = moves.split(|m| !m.burns()).filter(|run| !run.is_empty()).collect();
            let written: Vec<&Contour> = contours.iter().filter(|c| c.path.length() > 0.1).collect();
            if written.len() == contours.len() {
                prop_assert_eq!(runs.len(), contours.len());
                for (run, contour) in runs.iter().zip(&contours) {
                    let (wanted, made) = (drawn(&contour.path), followed(run));
                    prop_assert!(apart(&made, &wanted) < 0.001, "strays by {}", apart(&made, &wanted));
                    prop_assert!(apart(&wanted, &made) < 0.001, "leaves out {}", apart(&wanted, &made));
                    let length: f64 = run.iter().map(Move::length_mm).sum();
                    prop_assert!((length - contour.path.length()).abs() < 0.003 * (made.len() + wanted.len()) as f64);
                }
            }
        }
    }

    #[test]
    fn everything_lies_where_the_toolpath_lies() {
        let program = emit(
            &toolpath(vec![contour(Path::circle(P2::new(50.0, 50.0), 30.0), Role::Hole, Air::Off)]),
            &Header::default(),
            &DIALECT,
        );
        let burning = trace(&program.unwrap())
            .unwrap()
            .into_iter()
            .filter(Move::burns)
            .fold(Rect::EMPTY, |r, m| r.union(m.bounds()));
        assert!((burning.min - P2::new(20.0, 20.0)).norm() < 1e-9 && (burning.max - P2::new(80.0, 80.0)).norm() < 1e-9);
    }
}
