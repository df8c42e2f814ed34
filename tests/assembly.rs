//! The printed sheets of a job, read back from the files as any PDF reader would: what they say, and how large it comes out of the printer.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// PDF units in a millimetre.
const POINTS_PER_MM: f64 = 72.0 / 25.4;

fn furbelow(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(args)
        .current_dir(folder)
        .env("FURBELOW_CONFIG_DIR", folder.join("config"))
        .output()
        .expect("the program starts")
}

fn make(folder: &Path, model: &str, extra: &[&str]) -> Output {
    let shape = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(format!("{model}.obj"));
    let args = ["make", shape.to_str().expect("plain path"), "--material", "paper-160", "--out", "out"];
    furbelow(folder, &[&args, extra].concat())
}

fn made(folder: &Path, model: &str, extra: &[&str]) -> PathBuf {
    let output = make(folder, model, extra);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join("out")
}

fn json(path: PathBuf) -> Value {
    serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON")
}

/// A page: its size, what is written on it, and its lines, all in points.
#[derive(Debug, Default)]
struct Page {
    size: [f64; 2],
    texts: Vec<String>,
    lines: Vec<Vec<[f64; 2]>>,
}

/// Reads a file the strict way: cross-reference table, then objects by their offsets, then pages and the operators of their contents.
fn read(bytes: &[u8]) -> Vec<Page> {
    // One character a byte, so that offsets stay what they are.
    let text: String = bytes.iter().map(|b| if b.is_ascii() { char::from(*b) } else { '?' }).collect();
    assert!(text.starts_with("%PDF-1."), "no PDF");
    assert!(text.trim_end().ends_with("%%EOF"));
    let after = |text: &str, key: &str| text.split_once(key).unwrap_or_else(|| panic!("no {key}")).1.to_owned();
    let number = |text: &str| text.split_whitespace().next().and_then(|n| n.parse::<usize>().ok()).expect("a number");
    let table = &text[number(&after(&text, "startxref"))..];
    assert!(table.starts_with("xref"));
    let mut rows = table.lines().skip(1);
    let count = number(rows.next().expect("a size").split(' ').nth(1).expect("a size"));
    let objects: Vec<&str> = rows
        .take(count)
        .enumerate()
        .map(|(id, row)| {
            let object = &text[number(row)..];
            if row.contains(" n") {
                assert!(object.starts_with(&format!("{id} 0 obj")), "entry {id} leads elsewhere");
                return object.split("endobj").next().expect("an object");
            }
            ""
        })
        .collect();
    let pages: Vec<&&str> = objects.iter().filter(|o| o.contains("/Type /Page\n")).collect();
    let tree = objects.iter().find(|o| o.contains("/Type /Pages")).expect("a page tree");
    assert_eq!(number(&after(tree, "/Count ")), pages.len());
    let page = |object: &&&str| {
        let media = after(object, "/MediaBox [");
        let media: Vec<f64> = media.split(']').next().expect("a box").split(' ').map(|n| n.parse().unwrap()).collect();
        let content = objects[number(&after(object, "/Contents "))];
        let stream = after(content, "stream\n");
        let length = number(&after(content, "/Length "));
        assert!(stream[length..].trim_start().starts_with("endstream"));
        let mut page = contents(&stream[..length]);
        page.size = [media[2] - media[0], media[3] - media[1]];
        page
    };
    pages.iter().map(page).collect()
}

/// What a content stream draws. Only the operators that change where lines and texts are matter here.
fn contents(stream: &str) -> Page {
    let mut page = Page::default();
    let mut scale = 1.0;
    let mut operands: Vec<f64> = Vec::new();
    for line in stream.lines() {
        if let Some(shown) = line.strip_suffix(" Tj") {
            let inner = shown.trim_start_matches('(').trim_end_matches(')');
            page.texts.push(inner.replace("\\(", "(").replace("\\)", ")"));
            continue;
        }
        for token in line.split_whitespace() {
            if let Ok(value) = token.parse() {
                operands.push(value);
                continue;
            }
            let [x, y] = [operands.first(), operands.get(1)].map(|v| v.copied().unwrap_or_default());
            let at = [scale * x, scale * y];
            match token {
                "cm" => {
                    assert_eq!(operands[1..3], [0.0, 0.0]);
                    assert_eq!(operands[0], operands[3]);
                    scale *= x;
                }
                "m" => page.lines.push(vec![at]),
                "l" => page.lines.last_mut().expect("a start").push(at),
                _ => {}
            }
            operands.clear();
        }
    }
    page
}

/// Width and height of a line's box, mm.
fn extent_mm(line: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let values = || line.iter().map(|p| p[axis]);
        let span = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        span / POINTS_PER_MM
    })
}

fn is_size(page: &Page, [width, height]: [f64; 2]) -> bool {
    let near = |a: f64, b: f64| (a / POINTS_PER_MM - b).abs() < 0.01;
    near(page.size[0], width) && near(page.size[1], height)
}

/// A cuboid whose strip is divided for A4, its sheets on Letter: several tests read them.
fn letter() -> &'static Path {
    static MADE: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        made(
            folder.path(),
            "cuboid",
            &["--machine", "diode-400", "--stock", "A4", "--paper", "letter", "--foot", "pinned"],
        );
        folder
    });
    folder.path()
}

/// The same cuboid for printer and scissors, on A4, under a name in other letters.
fn print() -> &'static Path {
    static MADE: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/cuboid.obj");
        fs::copy(model, folder.path().join("Медведь \u{141}.obj")).unwrap();
        let args = ["make", "Медведь \u{141}.obj", "--machine", "print", "--material", "paper-160", "--out", "out"];
        let output = furbelow(folder.path(), &args);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        folder
    });
    folder.path()
}

/// A strip that is not searched for, for what does not depend on the shape.
const STACK: &str = r#"schema = 1
machine = "diode-400"
material = "paper-160"
stock = ["A3"]

[[part]]
name = "A"
stack = { layers = 3, inner_mm = 70, outer_mm = 80 }
width_mm = 60
"#;

/// Makes the stack, with more in its design and on the command line.
fn made_stack(folder: &Path, design: &str, extra: &[&str]) -> PathBuf {
    fs::write(folder.join("stack.toml"), design).unwrap();
    let output = furbelow(folder, &[&["make", "stack.toml", "--out", "out", "--force"], extra].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join("out")
}

fn texts(pages: &[Page]) -> Vec<&str> {
    pages.iter().flat_map(|page| &page.texts).map(String::as_str).collect()
}

fn assert_tells_all(out: &Path, size: [f64; 2]) {
    let bytes = fs::read(out.join("assembly.pdf")).unwrap();
    assert!(bytes.len() < 5_000_000, "{} bytes", bytes.len());
    let raw = String::from_utf8_lossy(&bytes);
    assert!(!raw.contains("/FontFile") && !raw.contains("/CreationDate"));
    assert!(!raw.contains(" rg\n") && !raw.contains(" RG\n") && !raw.contains(" k\n"), "greys only");
    let pages = read(&bytes);
    assert!(pages.len() >= 5 && pages.iter().all(|page| is_size(page, size)));
    let all = texts(&pages);
    let report = json(out.join("report.json"));
    for piece in report["pieces"].as_array().unwrap() {
        let name = format!("Piece {}", piece["name"].as_str().unwrap());
        assert!(all.iter().any(|text| text.starts_with(&name)), "{name} is not drawn flat");
        assert!(all.contains(&piece["name"].as_str().unwrap()), "{name} is not in the cut list");
    }
    let ruffle = json(out.join("ruffle.json"));
    for point in ruffle["parts"][0]["connection_points"].as_array().unwrap() {
        let joint = point["joint"].as_str().unwrap();
        // Folded, flat twice or more, and its step.
        let shown = all.iter().filter(|text| **text == joint).count();
        assert!(shown >= 4, "joint {joint} is written {shown} times");
    }
    let joints = ruffle["parts"][0]["connection_points"].as_array().unwrap().len();
    assert!(all.contains(&format!("step {joints} of {joints}").as_str()));
    assert_eq!(all.iter().any(|text| text.starts_with("UNCALIBRATED")), report["machine"] == "diode-400");
    let last = format!("page {} of {}", pages.len(), pages.len());
    assert!(pages[pages.len() - 1].texts.contains(&last));
}

#[test]
fn the_sheets_name_every_joint_and_piece_on_pages_of_the_size_asked_for() {
    assert_tells_all(&letter().join("out"), [215.9, 279.4]);
    assert_tells_all(&print().join("out"), [210.0, 297.0]);
}

#[test]
fn what_sheets_are_printed_on_is_kept_in_the_design_and_patterns_are_laid_out_for_it() {
    let design = fs::read_to_string(letter().join("out/design.toml")).unwrap();
    assert!(design.contains("paper = \"letter\""), "{design}");
    let text = fs::read_to_string(print().join("out/design.toml")).unwrap();
    assert!(!text.contains("paper ="), "A4 goes without saying");
    let folder = tempfile::tempdir().unwrap();
    let out = made_stack(
        folder.path(),
        &STACK.replace("stock = [\"A3\"]\n", ""),
        &["--machine", "print", "--paper", "letter"],
    );
    let pages = read(&fs::read(out.join("print.pdf")).unwrap());
    assert!(pages.iter().all(|p| is_size(p, [215.9, 279.4]) || is_size(p, [279.4, 215.9])));
    let report = json(out.join("report.json"));
    assert!(report["sheets"].as_array().unwrap().iter().all(|sheet| sheet["stock"] == "Letter"));
}

#[test]
fn nothing_lies_beyond_the_paper() {
    for (i, page) in read(&fs::read(letter().join("out/assembly.pdf")).unwrap()).iter().enumerate() {
        let margin = 8.0 * POINTS_PER_MM;
        let inside = |p: &[f64; 2]| (0..2).all(|axis| p[axis] >= margin && p[axis] <= page.size[axis] - margin);
        let beyond = page.lines.iter().flatten().find(|p| !inside(p));
        assert!(beyond.is_none(), "page {}: {beyond:?} of {:?}", i + 1, page.size);
    }
}

#[test]
fn a_step_says_where_its_flap_is_which_slits_it_goes_through_and_which_way_it_folds() {
    let pages = read(&fs::read(letter().join("out/assembly.pdf")).unwrap());
    let all = texts(&pages).join(" ");
    for words in ["Flap on piece", "through the", "Fold toward the lettered", "Fold away from the lettered"] {
        assert!(all.contains(words), "{words}");
    }
    for words in
        ["How a joint closes", "lettered sides up", "paper clip", "How the grain runs in this stock is not known"]
    {
        assert!(all.contains(words), "{words}");
    }
    // What is asked before cutting stands before what is done after it.
    let page_of = |word: &str| pages.iter().position(|p| p.texts.iter().any(|t| t.contains(word))).expect("a page");
    assert!(page_of("Tear a corner") <= page_of("sheet-01") && page_of("sheet-01") < page_of("Before folding"));
}

#[test]
fn strips_across_the_grain_are_told_and_felt_says_how_its_notches_read() {
    let folder = tempfile::tempdir().unwrap();
    let told = |design: &str| {
        let out = made_stack(folder.path(), design, &[]);
        texts(&read(&fs::read(out.join("assembly.pdf")).unwrap())).join(" ")
    };
    let across = told(&format!("strip_along = \"across\"\n{STACK}"));
    assert!(across.contains("All strips run across the grain") && !across.contains("run along the grain:"));
    let felt = told(&STACK.replace("paper-160", "felt-stiff-1"));
    assert!(felt.contains("a deep notch counts five") && felt.contains("Needle and thread"), "{felt}");
    assert!(!felt.contains("write the numbers") && !felt.contains("lettered") && !felt.contains("grain"));
}

#[test]
fn names_in_any_script_can_be_read() {
    let pages = read(&fs::read(print().join("out/assembly.pdf")).unwrap());
    assert!(texts(&pages).contains(&"Medved' L"));
}

#[test]
fn patterns_come_out_at_true_size_and_nothing_is_written_for_a_machine() {
    let out = print().join("out");
    let report = json(out.join("report.json"));
    let sheets = report["sheets"].as_array().unwrap();
    let pages = read(&fs::read(out.join("print.pdf")).unwrap());
    assert_eq!(pages.len(), sheets.len(), "A4 stock goes on one page each");
    for page in &pages {
        let rule = |line: &&Vec<[f64; 2]>| (extent_mm(line)[0] - 100.0).abs() < 1e-3 && extent_mm(line)[1] < 1e-9;
        assert_eq!(page.lines.iter().filter(rule).count(), 1, "one rule of 100 mm");
        assert!(page.texts.iter().any(|text| text.starts_with("100 mm")));
    }
    for piece in report["pieces"].as_array().unwrap() {
        let size = ["length_mm", "width_mm"].map(|key| piece[key].as_f64().unwrap());
        let same = |line: &Vec<[f64; 2]>| (0..2).all(|axis| (extent_mm(line)[axis] - size[axis]).abs() < 0.03);
        assert!(pages.iter().flat_map(|p| &p.lines).any(same), "no contour is {size:?} mm");
    }
    let names = fs::read_dir(out.join("sheets")).unwrap().flatten().map(|e| e.file_name());
    let names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    assert!(names.iter().all(|name| name.ends_with(".svg") || name.ends_with(".dxf")), "{names:?}");
    assert!(!out.join("preview.html").exists());
}

#[test]
fn a_pattern_larger_than_the_paper_goes_on_several_pages_that_say_where_they_belong() {
    let folder = tempfile::tempdir().unwrap();
    let out = made_stack(folder.path(), STACK, &["--machine", "print"]);
    let sheets = json(out.join("report.json"))["sheets"].as_array().unwrap().len();
    let pages = read(&fs::read(out.join("print.pdf")).unwrap());
    assert!(pages.len() > sheets);
    let told = |number: usize| pages.iter().flat_map(|p| &p.texts).any(|t| t.contains(&format!("page {number} of ")));
    assert!(told(1) && told(2));
}

#[test]
fn the_same_job_gives_the_same_sheets_and_a_laser_job_leaves_no_patterns_behind() {
    let folder = tempfile::tempdir().unwrap();
    let printed = || {
        let out = made_stack(folder.path(), STACK, &["--machine", "print"]);
        ["assembly.pdf", "print.pdf"].map(|name| fs::read(out.join(name)).unwrap())
    };
    let first = printed();
    assert!(first == printed());
    let out = made_stack(folder.path(), STACK, &[]);
    assert!(!out.join("print.pdf").exists() && out.join("preview.html").exists());
}

#[test]
fn nothing_can_be_sent_to_scissors() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("job.nc"), "G21\nG0X1\n").unwrap();
    let output = furbelow(folder.path(), &["check", "job.nc", "--machine", "print"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("has no controller"));
}
