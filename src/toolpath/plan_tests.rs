use super::*;
use proptest::prelude::*;

pub(super) fn process(feed_mm_per_min: f64, power: f64) -> Process {
    Process { feed_mm_per_min, passes: vec![Pass { power, depth_mm: 0.0 }], air: Air::Off, dashes: None }
}

pub(super) fn settings() -> Settings {
    Settings {
        tool: Tool::Laser { strike: None },
        share: Share::All,
        kerf_mm: 0.15,
        engrave: Some(process(3000.0, 0.1)),
        cut_inner: process(900.0, 0.8),
        cut_outline: process(900.0, 0.8),
        curve_tolerance_mm: 0.02,
        trials: Vec::new(),
        bridges: None,
        held: false,
        lead_mm: 0.0,
        overcut_mm: 0.0,
        cool_mm: 0.0,
        common_edges: false,
        crosses: false,
        window_mm: None,
        cross_cut: false,
        frame: Frame::PLAIN,
        work_area: Rect::from_size(400.0, 400.0),
        keep_outs: Vec::new(),
        park: P2::origin(),
    }
}

pub(super) fn contour(path: Path, role: Role) -> Contour {
    Contour {
        path,
        operation: role.operation(),
        role,
        piece: "A1".into(),
        joint: None,
        feed_mm_per_min: 900.0,
        power: 0.5,
        constant_power: false,
        depth_mm: 0.0,
        air: Air::Off,
        way: Vec::new(),
    }
}

fn drawn(path: Path, role: Role, kerf: KerfSide) -> DrawnPath {
    DrawnPath { path, role, kerf, joint: None }
}

fn piece(name: &str, x: f64, y: f64) -> Drawing {
    let p = |dx: f64, dy: f64| P2::new(x + dx, y + dy);
    let outline = Path::closed([p(0.0, 0.0), p(60.0, 0.0), p(60.0, 20.0), p(0.0, 20.0)]);
    let slit = Path::open([p(30.0, 5.0), p(30.0, 15.0)]);
    let mark = Path::open([p(10.0, 5.0), p(10.0, 15.0)]);
    let paths = vec![
        drawn(outline, Role::Outline, KerfSide::Outside),
        drawn(slit, Role::Slit, KerfSide::On),
        drawn(mark, Role::Mark, KerfSide::On),
        drawn(Path::circle(p(45.0, 10.0), 3.0), Role::Hole, KerfSide::Inside),
    ];
    Drawing { name: name.into(), paths }
}

fn sheet() -> Vec<Drawing> {
    vec![piece("A1", 10.0, 10.0), piece("A2", 200.0, 300.0), piece("A3", 10.0, 100.0), piece("A4", 100.0, 10.0)]
}

#[test]
fn the_whole_sheet_is_engraved_then_cut_inside_then_freed_from_the_far_side() {
    let toolpath = plan(&sheet(), 400.0, 400.0, &settings()).unwrap();
    let operations: Vec<Operation> = toolpath.contours.iter().map(|c| c.operation).collect();
    assert!(operations.is_sorted());
    assert_eq!(operations.len(), 16);
    let outlines = toolpath.contours.iter().filter(|c| c.role == Role::Outline);
    assert_eq!(outlines.map(|c| c.piece.as_str()).collect::<Vec<_>>(), ["A2", "A4", "A3", "A1"]);
}

#[test]
fn lengths_are_those_of_the_compensated_paths() {
    let toolpath = plan(&[piece("A1", 10.0, 10.0)], 400.0, 400.0, &settings()).unwrap();
    assert!((toolpath.engrave_mm() - 10.0).abs() < 1e-9);
    let rounded_outline = 160.0 + std::f64::consts::TAU * 0.075;
    let hole = std::f64::consts::TAU * (3.0 - 0.075);
    assert!((toolpath.cut_mm() - (rounded_outline + hole + 10.0)).abs() < 1e-6);
    assert!((toolpath.bounds().min - P2::new(9.925, 9.925)).norm() < 1e-6);
    assert!(toolpath.max_kerf_deviation_mm < 1e-6);
}

#[test]
fn a_second_pass_runs_an_open_cut_back_without_travel() {
    let mut settings = settings();
    settings.cut_inner.passes.push(Pass { power: 0.8, depth_mm: 0.0 });
    let once = plan(&sheet(), 400.0, 400.0, &self::settings()).unwrap();
    let twice = plan(&sheet(), 400.0, 400.0, &settings).unwrap();
    let inner = |t: &Toolpath| t.length_mm(Operation::CutInner);
    assert!((inner(&twice) - 2.0 * inner(&once)).abs() < 1e-9);
    let slits: Vec<&Contour> = twice.contours.iter().filter(|c| c.role == Role::Slit).collect();
    assert_eq!(slits.len(), 8);
    for passes in slits.chunks(2) {
        assert_eq!(passes[0].piece, passes[1].piece);
        assert_eq!(passes[0].path.end(), passes[1].path.start());
    }
}

#[test]
fn whatever_leaves_the_sheet_or_the_reach_is_refused_with_the_distance() {
    let far = plan(&[piece("A9", 345.0, 10.0)], 500.0, 400.0, &settings()).unwrap_err();
    assert!(matches!(&far, Error::Outside { limit: "work area", by_mm, .. } if (by_mm - 5.075).abs() < 1e-6));
    assert!(far.to_string().contains("A9"), "{far}");
    let off = plan(&[piece("A9", 10.0, 0.0)], 400.0, 400.0, &settings()).unwrap_err();
    assert!(matches!(&off, Error::Outside { limit: "sheet", by_mm, .. } if (by_mm - 0.075).abs() < 1e-6));
}

#[test]
fn a_mark_is_never_cut_for_want_of_an_engraving() {
    let settings = Settings { engrave: None, ..settings() };
    let refused = plan(&sheet(), 400.0, 400.0, &settings).unwrap_err();
    assert!(matches!(refused, Error::NoProcess { role: "mark", .. }), "{refused}");
}

#[test]
fn settings_out_of_range_are_refused() {
    let with = |change: &dyn Fn(&mut Settings)| {
        let mut settings = settings();
        change(&mut settings);
        plan(&[], 10.0, 10.0, &settings)
    };
    assert!(with(&|_| ()).is_ok());
    assert!(matches!(with(&|s| s.kerf_mm = -0.1), Err(Error::Setting { .. })));
    assert!(matches!(with(&|s| s.cut_inner.passes[0].power = 1.1), Err(Error::Setting { .. })));
    assert!(matches!(with(&|s| s.cut_inner.feed_mm_per_min = 0.0), Err(Error::Setting { .. })));
    assert!(matches!(with(&|s| s.cut_outline.passes.clear()), Err(Error::Setting { .. })));
    assert!(matches!(with(&|s| s.park.x = f64::NAN), Err(Error::Setting { .. })));
}

proptest! {
    #[test]
    fn ordering_keeps_every_contour_and_walks_what_it_reports(
        corners in prop::collection::vec((1.0..330.0f64, 1.0..370.0f64), 1..12),
    ) {
        let drawings: Vec<Drawing> =
            corners.iter().enumerate().map(|(i, (x, y))| piece(&format!("P{i}"), *x, *y)).collect();
        let toolpath = plan(&drawings, 400.0, 400.0, &settings()).unwrap();
        prop_assert_eq!(toolpath.contours.len(), 4 * drawings.len());
        for drawing in &drawings {
            for role in [Role::Outline, Role::Slit, Role::Mark, Role::Hole] {
                let same = |c: &&Contour| c.piece == drawing.name && c.role == role;
                prop_assert_eq!(toolpath.contours.iter().filter(same).count(), 1);
            }
        }
        let mut at = toolpath.park;
        let mut travel = 0.0;
        for contour in &toolpath.contours {
            travel += (contour.path.start().unwrap() - at).norm();
            at = contour.path.end().unwrap();
        }
        travel += (toolpath.park - at).norm();
        prop_assert!((travel - toolpath.travel_mm).abs() < 1e-6);
    }
}

fn with(change: impl Fn(&mut Settings)) -> Settings {
    let mut settings = settings();
    change(&mut settings);
    settings
}

#[test]
fn held_sheets_are_toured_the_short_way_and_loose_ones_from_the_far_side() {
    let loose = plan(&sheet(), 400.0, 400.0, &settings()).unwrap();
    let held = plan(&sheet(), 400.0, 400.0, &with(|s| s.held = true)).unwrap();
    assert!(held.travel_mm < loose.travel_mm && loose.travel_mm < loose.travel_unordered_mm);
    assert!((held.cut_mm() - loose.cut_mm()).abs() < 1e-9);
}

#[test]
fn crosses_come_first_on_scrap_and_not_where_the_job_is_placed_by_hand() {
    let marked = with(|s| s.crosses = true);
    let toolpath = plan(&sheet(), 400.0, 400.0, &marked).unwrap();
    assert_eq!(toolpath.crosses.len(), 2);
    assert!(toolpath.contours[..4].iter().all(|c| c.piece == "cross" && c.operation == Operation::Engrave));
    let by_hand = Settings { frame: Frame { zero: Zero::Job(Anchor::LOWER_LEFT), ..Frame::PLAIN }, ..marked };
    assert!(plan(&sheet(), 400.0, 400.0, &by_hand).unwrap().crosses.is_empty());
}

#[test]
fn a_roll_is_made_length_by_length_and_cut_off_last() {
    let roll = with(|s| {
        s.window_mm = Some(150.0);
        s.cross_cut = true;
        s.work_area = Rect::from_size(400.0, 1000.0);
        s.frame = Frame { turned: true, ..Frame::PLAIN };
    });
    let toolpath = plan(&sheet(), 400.0, 400.0, &roll).unwrap();
    let (last, others) = toolpath.contours.split_last().unwrap();
    assert_eq!(last.piece, "cross-cut");
    assert!((last.path.length() - 400.0).abs() < 1e-9 && (last.path.start().unwrap().y - 265.075).abs() < 1e-6);
    let knife = Settings { tool: Tool::Knife { offset_mm: 0.25 }, kerf_mm: 0.0, held: true, ..roll.clone() };
    let by_blade = plan(&sheet(), 400.0, 400.0, &knife).unwrap();
    assert_eq!(by_blade.contours.last().unwrap().piece, "cross-cut", "its axis stays within reach");
    // A1 and A3 lie in the first 150 mm of feed, A4 and A2 in the second.
    let second = others.iter().position(|c| ["A2", "A4"].contains(&c.piece.as_str())).unwrap();
    assert!(others[..second].iter().all(|c| ["A1", "A3"].contains(&c.piece.as_str())));
    assert!(others[second..].iter().all(|c| ["A2", "A4"].contains(&c.piece.as_str())));
    // The feed runs along y and the sheet is not mirrored: its lower left corner lies at the right.
    let a1 = others.iter().find(|c| c.piece == "A1" && c.role == Role::Outline).unwrap().path.bounds();
    assert!((a1.min - P2::new(400.0 - 30.075, 9.925)).norm() < 1e-6, "{a1:?}");
}

#[test]
fn travel_goes_round_what_stands_on_the_bed() {
    let magnet = ("magnet".to_owned(), Rect { min: P2::new(100.0, 100.0), max: P2::new(180.0, 280.0) });
    let round = with(|s| s.keep_outs = vec![magnet.clone()]);
    let toolpath = plan(&sheet(), 400.0, 400.0, &round).unwrap();
    assert!(toolpath.contours.iter().any(|c| !c.way.is_empty()) || !toolpath.home.is_empty());
    let blocked = Settings { keep_outs: vec![("clamp".into(), Rect::from_size(30.0, 30.0))], ..round };
    assert!(matches!(plan(&sheet(), 400.0, 400.0, &blocked), Err(Error::KeepOut { .. })));
}

#[test]
fn two_tools_share_a_sheet_its_zero_and_its_crosses() {
    let of = |share| plan(&sheet(), 400.0, 400.0, &with(|s| (s.share, s.crosses) = (share, true))).unwrap();
    let (all, marks, cuts) = (of(Share::All), of(Share::Marks), of(Share::Cuts));
    assert!(marks.crosses == all.crosses && cuts.crosses == all.crosses);
    assert_eq!(marks.contours.len() + cuts.contours.len(), all.contours.len() + 4);
    assert_eq!((marks.cut_mm(), cuts.length_mm(Operation::CutOutline)), (0.0, all.length_mm(Operation::CutOutline)));
}

#[test]
fn a_starving_tube_gets_constant_power_and_its_outlines_a_lead_on_scrap() {
    let tube = with(|s| {
        s.tool = Tool::Laser { strike: Some(Strike { floor: 0.1, acceleration_mm_per_s2: 500.0 }) };
        s.cut_inner = process(2700.0, 0.13);
        s.cut_outline = process(2700.0, 0.13);
        s.lead_mm = 1.0;
    });
    let toolpath = plan(&sheet(), 400.0, 400.0, &tube).unwrap();
    let cuts = toolpath.contours.iter().filter(|c| c.operation != Operation::Engrave);
    assert!(cuts.clone().all(|c| c.constant_power));
    for c in cuts.filter(|c| c.role == Role::Outline) {
        assert!(!c.path.closed, "in and out");
    }
    assert!(plan(&sheet(), 400.0, 400.0, &settings()).unwrap().contours.iter().all(|c| !c.constant_power));
}

#[test]
fn a_knife_keeps_to_the_sheet_and_its_crosses_set_the_blade_first() {
    let knife = with(|s| {
        s.tool = Tool::Knife { offset_mm: 0.25 };
        (s.kerf_mm, s.overcut_mm, s.held, s.crosses) = (0.0, 0.5, true, true);
    });
    let toolpath = plan(&sheet(), 400.0, 400.0, &knife).unwrap();
    let first = &toolpath.contours[0].path;
    assert!((first.end().unwrap() - first.start().unwrap()).y.abs() < 1e-9, "along x");
    assert_eq!(toolpath.warnings, []);
}

#[test]
fn a_trial_changes_feed_and_power_of_its_piece_alone() {
    let square = |name: &str, x: f64| Drawing {
        name: name.into(),
        paths: vec![drawn(
            Path::closed([(x, 5.0), (x + 9.0, 5.0), (x + 9.0, 14.0), (x, 14.0)].map(|(x, y)| P2::new(x, y))),
            Role::Outline,
            KerfSide::On,
        )],
    };
    let trials = vec![Trial { piece: "b".into(), feed_mm_per_min: 333.0, power: 0.21 }];
    let made = plan(&[square("a", 5.0), square("b", 25.0)], 60.0, 40.0, &Settings { trials, ..settings() }).unwrap();
    for contour in made.contours.iter().filter(|c| c.operation != Operation::Engrave) {
        let tried = (contour.feed_mm_per_min, contour.power) == (333.0, 0.21);
        assert_eq!(tried, contour.piece == "b", "{contour:?}");
    }
    assert!(made.contours.iter().any(|c| c.piece == "b"));
    let wild = vec![Trial { piece: "b".into(), feed_mm_per_min: 333.0, power: 1.2 }];
    assert!(matches!(
        plan(&[square("b", 5.0)], 60.0, 40.0, &Settings { trials: wild, ..settings() }),
        Err(Error::Setting { .. })
    ));
}
