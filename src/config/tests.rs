//! The room as a whole: built-in files, users' files, inheritance, and what is said about bad ones.

use std::path::Path;

use super::*;

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a scratch folder");
    for (path, text) in files {
        let path = folder.path().join(path);
        std::fs::create_dir_all(path.parent().expect("inside the folder")).expect("created");
        std::fs::write(path, text).expect("written");
    }
    folder
}

fn problems(error: Error) -> Vec<(String, usize, usize, String)> {
    let file =
        |p: &Problem| Path::new(&p.file).file_name().map(|f| f.to_string_lossy().into_owned()).unwrap_or_default();
    let list = error.problems();
    assert!(!list.is_empty(), "{error}");
    list.iter().map(|p| (file(p), p.line, p.column, p.message.clone())).collect()
}

/// The built-in profile with one line of it replaced, read.
fn spoilt(name: &str, line: &str, by: &str) -> (usize, Vec<(String, usize, usize, String)>) {
    let text =
        std::fs::read_to_string(format!("{}/profiles/{name}.toml", env!("CARGO_MANIFEST_DIR"))).expect("in the repo");
    let number = text.lines().position(|l| l.starts_with(line)).expect("a line of the file") + 1;
    let text: Vec<_> = text.lines().enumerate().map(|(i, l)| if i + 1 == number { by } else { l }).collect();
    let error = Library::built_in().profile_in("spoilt.toml", text.join("\n")).expect_err("spoilt");
    (number, problems(error))
}

#[test]
fn every_built_in_file_is_in_order() {
    let library = Library::built_in();
    for listed in library.names(Kind::Machine).expect("built in") {
        let machine = library.machine(&listed.name).expect("in order");
        assert_eq!(machine.name, listed.name);
    }
    for listed in library.names(Kind::Profile).expect("built in") {
        let profile = library.profile(&listed.name).expect("in order");
        assert_eq!(profile.name, listed.name);
        assert!(profile.process.iter().all(|row| row.measured_on.is_none()), "nothing was measured for this project");
    }
}

#[test]
fn every_built_in_pair_that_is_allowed_can_be_cut() {
    let library = Library::built_in();
    for machine in ["diode-400", "k40"] {
        let machine = library.machine(machine).expect("in order");
        for profile in library.names(Kind::Profile).expect("built in") {
            let profile = library.profile(&profile.name).expect("in order");
            let never = profile.allowed.for_tool(machine.tool.class).0 == Some(Verdict::Never);
            match machine.pair(&profile) {
                Ok(pair) => {
                    assert!(!never);
                    assert!(pair.cut.feed_mm_per_min <= machine.max_feed_mm_per_min());
                    assert!((machine.tool.power_floor..=1.0).contains(&pair.cut.power));
                    assert!(pair.cut.kerf_mm > 0.0 && !pair.cut.calibrated);
                }
                Err(error) => assert!(never && matches!(error, Error::Forbidden { .. }), "{error}"),
            }
        }
    }
}

#[test]
fn scissors_cut_every_profile_along_its_lines_and_have_no_board() {
    let library = Library::built_in();
    let print = library.machine("print").expect("in order");
    assert!(print.controller.is_none());
    for profile in library.names(Kind::Profile).expect("built in") {
        let pair = print.pair(&library.profile(&profile.name).expect("in order")).expect("a person can cut it");
        assert!(pair.cut.kerf_mm == 0.0 && pair.engrave.is_some() && pair.warnings.is_empty());
    }
    let folder =
        folder(&[("machines/mine.toml", "schema = 1\nname = 'mine'\ninherits = 'print'\n[tool]\nclass = 'knife'")]);
    let knife = Library::with_folder(folder.path()).machine("mine").expect_err("a knife needs a board");
    assert!(knife.to_string().contains("`controller` is missing"), "{knife}");
}

#[test]
fn the_joints_hold_as_the_table_of_practice_says() {
    let library = Library::built_in();
    let expected = [
        ("paper-80", 13.6, 10.5, 1.55),
        ("paper-160", 11.0, 8.8, 1.1),
        ("polyester-0.1", 10.0, 8.7, 0.65),
        ("felt-stiff-1", 19.0, 14.0, 2.5),
    ];
    for (name, head, slit, retention) in expected {
        let profile = library.profile(name).expect("in order");
        for class in ToolClass::ALL {
            let joint = profile.joint_for(class);
            let found = [joint.head_mm(), joint.slit_length_mm(), joint.retention_mm()];
            let close = found.iter().zip([head, slit, retention]).all(|(a, b)| (a - b).abs() < 1e-9);
            assert!(close, "{name}: {found:?}");
        }
    }
}

#[test]
fn a_users_file_goes_first_and_may_build_on_the_built_in_of_its_own_name() {
    let folder = folder(&[
        ("machines/k40.toml", "schema = 1\nname = 'k40'\ninherits = 'k40'\n[tool]\noptical_power_w = 35"),
        (
            "machines/mine.toml",
            "schema = 1\nname = 'mine'\ninherits = 'k40'\ntitle = 'Mine'\n[work_area]\nwidth_mm = 280",
        ),
        ("machines/notes.txt", "not a machine"),
    ]);
    let library = Library::with_folder(folder.path());
    let names: Vec<_> =
        library.names(Kind::Machine).expect("readable").into_iter().map(|l| (l.name, l.place)).collect();
    assert_eq!(names.len(), 7);
    assert_eq!(names[0], ("diode-400".into(), Place::BuiltIn));
    assert_eq!(names[2], ("k40".into(), Place::File(folder.path().join("machines/k40.toml"))));
    let mine = library.machine("mine").expect("in order");
    // From the file itself, from the user's k40, and from the built-in k40.
    assert_eq!((mine.title.as_str(), mine.reach_mm()), ("Mine", [280.0, 200.0]));
    assert_eq!((mine.tool.optical_power_w, mine.tool.spot_mm), (Some(35.0), Some(0.15)));
    assert_eq!(mine.inherits.as_deref(), Some("k40"));
}

#[test]
fn a_path_works_like_a_name_and_its_base_may_be_a_path_too() {
    let folder = folder(&[
        ("shop/base.toml", "schema = 1\nname = 'base'\ninherits = 'paper-160'\nspacing_mm = 4"),
        ("shop/sub/card.toml", "schema = 1\nname = 'card'\ninherits = '../base.toml'\nthickness_mm = 0.2"),
    ]);
    let path = folder.path().join("shop/sub/card.toml");
    let card = Library::built_in().profile(&path.display().to_string()).expect("in order");
    assert_eq!((card.name.as_str(), card.thickness_mm, card.spacing_mm, card.margin_mm), ("card", 0.2, 4.0, 10.0));
}

#[test]
fn a_circle_of_bases_is_told_where_it_closes() {
    let folder = folder(&[
        ("profiles/a.toml", "schema = 1\nname = 'a'\ninherits = 'b'"),
        ("profiles/b.toml", "schema = 1\nname = 'b'\n\ninherits = 'a'"),
    ]);
    let found = problems(Library::with_folder(folder.path()).profile("a").expect_err("a circle"));
    assert_eq!((found[0].0.as_str(), found[0].1, found[0].2), ("b.toml", 4, 12));
    assert!(found[0].3.contains("circle"), "{}", found[0].3);
}

#[test]
fn unknown_names_get_a_suggestion_and_missing_files_their_path() {
    let library = Library::built_in();
    let text = library.machine("diode400").expect_err("unknown").to_string();
    assert!(text.contains("did you mean \"diode-400\"?") && text.contains("machine list"), "{text}");
    let error = library.profile("./no-such.toml").expect_err("not there");
    assert!(matches!(&error, Error::Read { path, .. } if path == Path::new("./no-such.toml")) && !error.refuses_job());
    let text = "schema = 1\nname = 'x'\ninherits = 'papr-80'";
    let found = problems(library.profile_in("x.toml", text.into()).expect_err("unknown base"));
    assert_eq!((found[0].1, found[0].2), (3, 12));
    assert!(found[0].3.contains("paper-80"), "{}", found[0].3);
}

#[test]
fn the_name_inside_must_be_the_name_outside() {
    let folder = folder(&[("machines/mine.toml", "schema = 1\nname = 'yours'\ninherits = 'k40'")]);
    let found = problems(Library::with_folder(folder.path()).machine("mine").expect_err("misnamed"));
    assert_eq!((found[0].1, found[0].2), (2, 8));
    let unnamed = Library::built_in().machine_in("x", "schema = 1\ninherits = 'k40'".into()).expect_err("no name");
    assert!(problems(unnamed)[0].3.contains("`name` is missing"));
}

#[test]
fn all_missing_keys_are_told_at_the_table_they_belong_to() {
    let text = "schema = 1\ninherits = 'paper-80'\nbread = 3\n[[process]]\ntool = 'pen'\npower = 'x'\n[[stock]]\nsize_mm = [1, 2]";
    let found = problems(Library::built_in().profile_in("x.toml", text.into()).expect_err("incomplete"));
    let told: Vec<_> = found.iter().map(|(_, line, _, message)| (*line, message.as_str())).collect();
    let expected = [
        (1, "`name` is missing"),
        (3, "unknown key `bread`"),
        (4, "`feed_mm_per_min` is missing"),
        (4, "`operation` is missing"),
        (4, "`source` is missing"),
        (6, "the text \"x\" is not a number"),
        (7, "`name` is missing"),
    ];
    assert_eq!(told, expected);
}

#[test]
fn values_out_of_range_are_told_at_the_value() {
    for (line, by, column, words) in [
        ("thickness_mm", "thickness_mm = 0", 16, "above 0"),
        ("power = 0.80", "power = 1.5", 9, "at most 1"),
        ("feed_mm_per_min = 900", "feed_mm_per_min = -900", 19, "above 0"),
        ("slit_extra_mm", "slit_extra_mm = 3", 17, "falls open"),
        ("min_width_mm", "min_width_mm = 18", 16, "at least 19.00 mm"),
        ("margin_mm", "margin_mm = 110 ", 0, "leaves nothing"),
        ("diode = ", "diode = 'never'", 9, "diode_reason"),
        ("co2 = ", "co2 = 'no'", 7, "not known here"),
        ("schema", "schema = 2", 10, "format 2"),
        ("grain = \"directional\"", "grain = 'none'", 0, "differ"),
        ("name", "name = 'Paper 160'", 8, "no name"),
    ] {
        let (number, found) = spoilt("paper-160", line, by);
        let told = found.iter().any(|(file, line, col, message)| {
            let here = column == 0 || (*line, *col) == (number, column);
            file == "spoilt.toml" && here && message.contains(words)
        });
        assert!(told, "{by}: {found:?}");
    }
}

#[test]
fn a_blade_gets_no_detail_it_cannot_turn() {
    let library = Library::built_in();
    let text =
        "schema = 1\nname = 'x'\ninherits = 'paper-160'\n[joint.knife]\nhook_radius_mm = 0.5\nslit_relief_mm = 0.8";
    let found = problems(library.profile_in("x.toml", text.into()).expect_err("too fine"));
    let lines: Vec<_> = found.iter().map(|p| p.1).collect();
    assert_eq!(lines, [5, 6], "{found:?}");
}

#[test]
fn thin_sheet_is_burnt_once_and_thick_as_often_as_it_takes() {
    let twice = "[[process]]\ntool = 'co2'\noperation = 'cut'\nreference_power_w = 40\nfeed_mm_per_min = 900\npower = 0.2\nkerf_mm = 0.2\npasses = 2\nsource = 'x'";
    let profile = |thickness: f64| {
        let text = format!("schema = 1\nname = 'x'\ninherits = 'felt-soft-1'\nthickness_mm = {thickness}\n{twice}");
        Library::built_in().profile_in("x.toml", text)
    };
    let found = problems(profile(0.2).expect_err("thin"));
    assert!(found.iter().any(|p| p.1 == 12 && p.3.contains("one pass")), "{found:?}");
    let thick = profile(1.0).map_err(problems);
    assert!(!matches!(&thick, Err(found) if found.iter().any(|p| p.3.contains("one pass"))), "{thick:?}");
}

#[test]
fn a_machine_must_agree_with_itself() {
    let library = Library::built_in();
    let wrong = |base: &str, text: &str| {
        let text = format!("schema = 1\nname = 'x'\ninherits = '{base}'\n{text}");
        problems(library.machine_in("x.toml", text).expect_err("wrong"))
    };
    let found = wrong("diode-400", "[work_area]\nwidth_mm = 500");
    assert!(found[0].1 == 5 && found[0].3.contains("max_travel_mm = 400"), "{found:?}");
    assert!(wrong("diode-400", "[controller]\nlaser_mode = false")[0].3.contains("$32"));
    assert!(wrong("k40", "[tool]\nframe_power_max = 0.01")[0].3.contains("invisible"));
    assert!(wrong("k40", "[pen]\noffset_mm = [-25, 0]")[0].3.contains("`lift`"));
    assert!(wrong("pen-a3", "[pen]\noffset_mm = [-25, 0]")[0].3.contains("its own tool"));
    let roll = "[roll]\nmedia_width_mm = 610\npinch_margin_mm = 20\nfeed_axis = 'y'\nmax_length_mm = 1000";
    assert!(wrong("k40", roll)[0].3.contains("not both"));
    let found = wrong("k40", "[controller]\nacceleration_mm_per_s2 = [100, 0, 5]\nmax_s = 0");
    // Everything is told at once, also where the base no longer fits.
    let places: Vec<_> = found.iter().map(|(file, line, column, _)| (file.as_str(), *line, *column)).collect();
    assert_eq!(places[1..], [("x.toml", 5, 32), ("x.toml", 6, 9)], "{found:?}");
    assert!(places[0].0 == "k40.toml" && found[0].3.contains("min_s"), "{found:?}");
}

#[test]
fn a_roll_machine_reaches_between_its_pinch_rollers() {
    let mut machine = Library::built_in().machine("k40").expect("in order");
    machine.work_area = None;
    machine.roll = Some(Roll {
        media_width_mm: 610.0,
        pinch_margin_mm: 20.0,
        feed_axis: Axis::Y,
        max_length_mm: 1000.0,
        window_mm: 300.0,
        backing: Backing::Carrier,
    });
    assert_eq!(machine.reach_mm(), [570.0, 1000.0]);
}
