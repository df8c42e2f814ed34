//! The arrows of the house: every `crate::` path outside tests must lead to a room its own room may use.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Who may use whom. Every room may use geom and progress.
const ARROWS: &[(&str, &[&str])] = &[
    ("geom", &[]),
    ("progress", &[]),
    ("drawing", &[]),
    ("mesh", &[]),
    ("config", &[]),
    ("cut", &["mesh"]),
    ("ruffle", &["cut"]),
    ("extrude", &["mesh", "cut", "ruffle"]),
    ("sim", &["ruffle"]),
    ("fit", &["cut", "ruffle", "extrude", "sim"]),
    ("design", &["config", "cut", "ruffle"]),
    ("strip", &["drawing", "cut", "ruffle", "extrude", "sim", "fit"]),
    ("nest", &[]),
    ("toolpath", &["drawing", "nest"]),
    ("gcode", &["toolpath"]),
    ("emulator", &["gcode"]),
    ("stream", &["gcode", "emulator"]),
    ("preview", &["drawing", "nest", "gcode", "cut", "ruffle", "extrude", "sim", "fit"]),
    ("assembly", &["mesh", "cut", "ruffle", "extrude", "sim", "fit", "strip", "nest", "drawing"]),
    ("calibrate", &["drawing", "strip"]),
    (
        "job",
        &[
            "assembly",
            "drawing",
            "mesh",
            "config",
            "cut",
            "ruffle",
            "extrude",
            "sim",
            "fit",
            "design",
            "strip",
            "nest",
            "toolpath",
            "gcode",
            "preview",
            "stream",
            "calibrate",
        ],
    ),
    ("cli", &["job", "design", "preview", "gcode", "nest", "config", "stream", "calibrate"]),
];
const EVERYONE: &[&str] = &["geom", "progress"];

/// A path from one room to another: the file, its line, the room it names.
#[derive(Debug, PartialEq)]
struct Use {
    line: usize,
    room: String,
}

/// Rooms named by `crate::` paths in a source text, test modules left out.
fn uses(text: &str) -> Vec<Use> {
    let mut found = Vec::new();
    for (line, code) in without_tests(text) {
        for (at, _) in code.match_indices("crate::") {
            let rest = &code[at + "crate::".len()..];
            let rooms: Vec<&str> = match rest.strip_prefix('{') {
                // `use crate::{cut, fit, sim};`
                Some(group) => group.split(['}', ';']).next().unwrap_or("").split(',').collect(),
                None => vec![rest],
            };
            for room in rooms {
                let name: String = room.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                if !name.is_empty() {
                    found.push(Use { line, room: name });
                }
            }
        }
    }
    found
}

/// Numbered lines of code: comments and everything from `#[cfg(test)]` on a module to its closing brace left out.
fn without_tests(text: &str) -> Vec<(usize, String)> {
    let mut kept = Vec::new();
    let mut lines = text.lines().enumerate().peekable();
    while let Some((i, line)) = lines.next() {
        let code = line.split("//").next().unwrap_or("");
        if !code.trim_start().starts_with("#[cfg(test)]") {
            kept.push((i + 1, code.to_owned()));
            continue;
        }
        // The item that follows: up to its closing brace, or to the `;` of a declaration.
        let mut depth = 0;
        for (_, item) in lines.by_ref() {
            depth += item.matches('{').count() as i64 - item.matches('}').count() as i64;
            let opened = item.contains('{') || item.contains(';') || item.contains('}');
            if depth <= 0 && opened && !item.trim_start().starts_with("#[") {
                break;
            }
        }
    }
    kept
}

fn allowed(from: &str, to: &str) -> bool {
    let arrows = ARROWS.iter().find(|(room, _)| *room == from).map(|(_, to)| *to);
    from == to || EVERYONE.contains(&to) || arrows.is_some_and(|rooms| rooms.contains(&to))
}

fn source_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(source_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

fn room_of(file: &Path, src: &Path) -> String {
    let inside = file.strip_prefix(src).unwrap();
    let first = inside.components().next().unwrap().as_os_str().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").to_owned()
}

#[test]
fn every_room_uses_only_what_the_design_allows() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut forbidden = Vec::new();
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for file in source_files(&src) {
        let room = room_of(&file, &src);
        // A room's tests.rs is declared for tests only.
        if room == "lib" || room == "main" || file.ends_with("tests.rs") {
            continue;
        }
        *seen.entry(room.clone()).or_default() += 1;
        let text = fs::read_to_string(&file).unwrap();
        for Use { line, room: to } in uses(&text) {
            if !allowed(&room, &to) {
                forbidden.push(format!("{}:{line}: {room} uses {to}", file.display()));
            }
        }
    }
    assert!(forbidden.is_empty(), "{}", forbidden.join("\n"));
    for (room, _) in ARROWS {
        assert!(seen.contains_key(*room), "the table names a room that is not there: {room}");
    }
    for room in seen.keys() {
        assert!(ARROWS.iter().any(|(r, _)| r == room), "the table does not name {room}");
    }
}

#[test]
fn a_forbidden_arrow_is_noticed_wherever_it_stands() {
    let text = "use crate::geom::P2;\nuse crate::{cut, fit::Part};\nfn f() { crate::gcode::trace(); }\n// crate::job is a comment\n#[cfg(test)]\nmod tests {\n    use crate::cli::Cli;\n}\nuse crate::mesh;\n";
    let rooms: Vec<(usize, String)> = uses(text).into_iter().map(|u| (u.line, u.room)).collect();
    let expected = [(1, "geom"), (2, "cut"), (2, "fit"), (3, "gcode"), (9, "mesh")];
    assert_eq!(rooms, expected.map(|(l, r)| (l, r.to_owned())));
    assert!(!allowed("nest", "ruffle"));
    assert!(!allowed("sim", "fit"));
    assert!(allowed("fit", "sim") && allowed("nest", "geom"));
}
