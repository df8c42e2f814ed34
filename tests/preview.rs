//! `furbelow preview` and the page `make` writes, as their users have them: the real binary, and a browser where one is installed.

use furbelow::gcode::{self, Move};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

fn furbelow(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(args)
        .current_dir(folder)
        .env("FURBELOW_CONFIG_DIR", folder.join("config"))
        .output()
        .expect("the program starts")
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("an exit code")
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Makes a model into `out`; returns the page.
fn made(folder: &Path, name: &str) -> String {
    let shape = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(format!("{name}.obj"));
    let shape = shape.to_str().expect("plain path");
    let output = furbelow(folder, &["make", shape, "-m", "diode-400", "-p", "paper-160", "--out", "out"]);
    assert_eq!(code(&output), 0, "{}", told(&output));
    fs::read_to_string(folder.join("out/preview.html")).expect("make writes the page")
}

/// Previews a text as job.nc; returns the page.
fn previewed(folder: &Path, text: &str, args: &[&str]) -> String {
    fs::write(folder.join("job.nc"), text).unwrap();
    let output = furbelow(folder, &[&["preview", "job.nc", "-m", "diode-400"], args].concat());
    assert_eq!(code(&output), 0, "{}", told(&output));
    fs::read_to_string(folder.join("job.html")).unwrap()
}

fn data(page: &str) -> Value {
    let (_, rest) = page.split_once("<script type=\"application/json\" id=\"data\">").expect("a block of data");
    serde_json::from_str(rest.split_once("</script>").expect("its end").0).expect("JSON")
}

fn decoded(base64: &Value) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => panic!("not base64: {c}"),
    };
    let letters: Vec<u8> = base64.as_str().expect("text").bytes().filter(|c| *c != b'=').collect();
    let mut bytes = Vec::new();
    for four in letters.chunks(4) {
        let bits = four.iter().fold(0u32, |bits, c| bits << 6 | u32::from(value(*c))) << (6 * (4 - four.len()));
        bytes.extend_from_slice(&bits.to_be_bytes()[1..four.len()]);
    }
    bytes
}

fn integers(base64: &Value) -> Vec<i32> {
    decoded(base64).chunks(4).map(|b| i32::from_le_bytes(b.try_into().expect("four bytes"))).collect()
}

fn floats(base64: &Value) -> Vec<f32> {
    decoded(base64).chunks(4).map(|b| f32::from_le_bytes(b.try_into().expect("four bytes"))).collect()
}

fn moves(text: &str) -> Vec<Move> {
    gcode::trace(&gcode::parse(text).unwrap()).unwrap()
}

/// Fails unless every element that is opened is closed in its turn.
fn assert_nests(page: &str) {
    const VOID: [&str; 4] = ["meta", "input", "!DOCTYPE", "br"];
    let mut open: Vec<&str> = Vec::new();
    let mut rest = page;
    while let Some(at) = rest.find('<') {
        let (tag, after) = rest[at + 1..].split_once('>').expect("a tag ends");
        let name = tag.split([' ', '/', '\n']).find(|part| !part.is_empty()).expect("a name");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "closes {name}");
        } else if !tag.ends_with('/') && !VOID.contains(&name) {
            open.push(name);
        }
        // What scripts and styles hold is no markup.
        rest = if matches!(name, "script" | "style") && !tag.starts_with('/') {
            &after[after.find(&format!("</{name}")).expect("its end")..]
        } else {
            after
        };
    }
    assert!(open.is_empty(), "left open: {open:?}");
}

#[test]
fn the_page_of_a_job_holds_every_sheet_line_and_move_and_asks_nobody_for_anything() {
    let folder = tempfile::tempdir().unwrap();
    let page = made(folder.path(), "stool");
    assert_nests(&page);
    for reference in ["http:", "https:", " src=", "@import", "url("] {
        assert!(!page.contains(reference), "{reference}");
    }
    let data = data(&page);
    let sheets = data["sheets"].as_array().unwrap();
    let report: Value = serde_json::from_slice(&fs::read(folder.path().join("out/report.json")).unwrap()).unwrap();
    assert_eq!(sheets.len(), report["sheets"].as_array().unwrap().len());
    for (sheet, reported) in sheets.iter().zip(report["sheets"].as_array().unwrap()) {
        let text = fs::read_to_string(folder.path().join("out").join(reported["file"].as_str().unwrap())).unwrap();
        assert_eq!(sheet["text"].as_str().unwrap(), text);
        let moves = moves(&text);
        let columns = &sheet["moves"];
        let lines: Vec<i32> = moves.iter().map(|m| m.line as i32).collect();
        assert_eq!(integers(&columns["line"]), lines);
        let ends: Vec<i32> = moves.iter().flat_map(|m| [m.to.x, m.to.y]).map(|v| (v * 1e3).round() as i32).collect();
        assert_eq!(integers(&columns["end"]), ends);
        let time_s: f64 = floats(&columns["time"]).iter().map(|t| f64::from(*t)).sum();
        assert!((time_s - reported["time_s"].as_f64().unwrap()).abs() < 1e-3);
        let burning = floats(&columns["power"]).iter().filter(|p| **p > 0.0).count();
        assert_eq!(burning, moves.iter().filter(|m| m.burns()).count());
        assert_eq!(sheet["stock"]["grain"], "x");
    }
}

#[test]
fn a_hostile_file_is_shown_and_does_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let hostile =
        "; </script><script>document.title='owned'</script> <!-- & \"'\nG0X1 ; <img src=x onerror=alert(1)>\n";
    let page = previewed(folder.path(), hostile, &[]);
    assert_nests(&page);
    assert_eq!(page.matches("<script").count(), 2);
    assert!(!page.contains("<img"));
    assert_eq!(data(&page)["sheets"][0]["text"], hostile);
    let bytes = [b"; \xfc\xff in another encoding\nG0X1\n".as_slice(), b"; end"].concat();
    fs::write(folder.path().join("latin.nc"), bytes).unwrap();
    assert_eq!(code(&furbelow(folder.path(), &["preview", "latin.nc"])), 0);
}

const SQUARE: &str = "G21G90\nM4S0\nG0X20Y20\nG1X60S80F1800\nG0X20Y30S0\nG1X60S500F1200\nG3X60Y70J20\nM5\nG0X0Y0\nM2\n";

#[test]
fn the_same_job_gives_the_same_bytes_in_every_form_and_colours_differ() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("job.nc"), SQUARE).unwrap();
    let written = |out: &str, color: &str| {
        let output = furbelow(folder.path(), &["preview", "job.nc", "--out", out, "--color", color]);
        assert_eq!(code(&output), 0, "{}", told(&output));
        fs::read(folder.path().join(out)).unwrap()
    };
    for out in ["a.html", "a.svg", "a.png"] {
        assert_eq!(written(out, "power"), written(out, "power"));
        assert_ne!(written(out, "power"), written(out, "order"), "{out}");
    }
    let svg = String::from_utf8(written("a.svg", "feed")).unwrap();
    assert!(roxmltree::Document::parse(&svg).unwrap().root_element().attribute("width").unwrap().ends_with("mm"));
    assert!(written("a.png", "energy").starts_with(b"\x89PNG"));
}

#[test]
fn what_cannot_be_shown_is_refused_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |text: &str, args: &[&str], exit: i32, says: &str| {
        fs::write(folder.path().join("job.nc"), text).unwrap();
        let output = furbelow(folder.path(), &[&["preview", "job.nc"], args].concat());
        assert_eq!(code(&output), exit, "{}", told(&output));
        assert!(told(&output).contains(says), "{}", told(&output));
        assert!(!folder.path().join("job.html").exists());
    };
    refused("G0X1\n%%\n", &[], 2, "line 2");
    refused(SQUARE, &["--out", "job.gif"], 2, ".html, .svg or .png");
    refused(SQUARE, &["--machine", "nothing"], 2, "nothing");
    let long: String = (0..200_001).map(|k| format!("G0X{}\n", k % 2)).collect();
    refused(&long, &[], 1, "--out FILE.png");
    assert_eq!(code(&furbelow(folder.path(), &["preview", "missing.nc"])), 2);
}

/// A browser that can be driven from the command line.
struct Browser {
    program: PathBuf,
    profile: tempfile::TempDir,
}

impl Browser {
    /// The first of the usual ones that is installed.
    fn find() -> Option<Browser> {
        let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
        let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
        let program = names.iter().find_map(|n| folders.iter().map(|f| f.join(n)).find(|p| p.is_file()))?;
        Some(Browser { program, profile: tempfile::tempdir().ok()? })
    }

    /// Opens a file at a fragment and returns what the browser prints; nothing when it does not get that far.
    fn run(&self, page: &Path, fragment: &str, what: &str) -> String {
        let output = self.profile.path().join("stdout");
        let mut child = Command::new(&self.program)
            // The sandbox needs rights that containers do not give, and the page is our own.
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--virtual-time-budget=3000"])
            .args(["--window-size=1200,800", "--force-device-scale-factor=1", what])
            .arg(format!("--user-data-dir={}", self.profile.path().join("profile").display()))
            .arg(format!("file://{}#{fragment}", page.display()))
            .stdout(fs::File::create(&output).unwrap())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let deadline = Instant::now() + Duration::from_secs(60);
        while child.try_wait().expect("it can be asked").is_none() {
            if Instant::now() > deadline {
                let _ = child.kill();
                let _ = child.wait();
                break;
            }
            std::thread::sleep(Duration::from_millis(30));
        }
        String::from_utf8_lossy(&fs::read(output).unwrap()).into_owned()
    }

    /// What the page says of its state: `name="value"` on its root.
    fn state(&self, page: &Path, fragment: &str) -> Option<State> {
        let dom = self.run(page, fragment, "--dump-dom");
        let root = dom.split_once("<html")?.1.split_once('>')?.0.to_owned();
        Some(State { root })
    }

    fn picture(&self, page: &Path, fragment: &str) -> Option<tiny_skia::Pixmap> {
        let file = self.profile.path().join("shot.png");
        self.run(page, fragment, &format!("--screenshot={}", file.display()));
        tiny_skia::Pixmap::decode_png(&fs::read(file).ok()?).ok()
    }
}

struct State {
    root: String,
}

impl State {
    fn text(&self, name: &str) -> &str {
        let found = self.root.split_once(&format!("data-{name}=\"")).and_then(|(_, rest)| rest.split_once('"'));
        found.unwrap_or_else(|| panic!("no data-{name} in {}", self.root)).0
    }

    fn number(&self, name: &str) -> f64 {
        self.text(name).parse().expect("a number")
    }
}

/// The browser, once it has shown that it can open a page; says so when there is none.
fn browser(page: &Path) -> Option<Browser> {
    let found = Browser::find().filter(|b| b.state(page, "").is_some());
    if found.is_none() {
        eprintln!("skipped: no Chromium that opens a page from the command line is installed");
    }
    found
}

#[test]
fn in_a_browser_the_tool_is_where_the_machine_is_at_that_time() {
    let folder = tempfile::tempdir().unwrap();
    let text = "M4S500\nG1X100F1200\n; half a circle\nG3X60I-20\nM5\n";
    previewed(folder.path(), text, &[]);
    let page = folder.path().join("job.html");
    let Some(browser) = browser(&page) else { return };
    let at = |fragment: &str| browser.state(&page, fragment).expect("a page");
    let all = at("");
    assert_eq!((all.text("ready"), all.number("moves"), all.number("lines")), ("true", 4.0, 5.0));
    assert!((all.number("x") - 60.0).abs() < 1e-3, "it opens at the end");
    // From rest at 500 mm/s2 to 20 mm/s, once M4 is through.
    let began_s = at("line=2").number("time");
    let after = |s: f64| format!("t={:.4}s", began_s + s);
    let speeding = at(&after(0.02));
    assert!((speeding.number("x") - 0.5 * 500.0 * 0.02 * 0.02).abs() < 2e-3, "{}", speeding.root);
    assert!((speeding.number("speed") - 600.0).abs() < 3.0, "{}", speeding.root);
    let cruising = at(&(after(1.0) + "&color=feed&theme=dark"));
    assert!((cruising.number("x") - (0.4 + 20.0 * 0.96)).abs() < 2e-2, "{}", cruising.root);
    assert_eq!((cruising.text("color"), cruising.text("theme"), cruising.number("line")), ("feed", "dark", 2.0));
    let round = at(&after(6.6));
    let radius = (round.number("x") - 80.0).hypot(round.number("y"));
    assert!((radius - 20.0).abs() < 2e-3 && round.number("line") == 4.0, "on the arc: {}", round.root);
    let half = at("t=0.5");
    assert!((half.number("time") / half.number("total") - 0.5).abs() < 1e-3);
}

#[test]
fn in_a_browser_the_slider_moves_the_picture_and_nothing_hostile_runs() {
    let folder = tempfile::tempdir().unwrap();
    made(folder.path(), "stool");
    let page = folder.path().join("out/preview.html");
    let Some(browser) = browser(&page) else { return };
    // Pixels in the full colour of the strongest cut, on the stage left of the panel and above the slider.
    let solid = |fragment: &str| {
        let picture = browser.picture(&page, fragment).expect("a picture");
        let right = picture.width().saturating_sub(310);
        let stage = (60..picture.height() - 70).flat_map(|y| (0..right).map(move |x| (x, y)));
        let strong = |(x, y): &(u32, u32)| {
            let p = picture.pixel(*x, *y).expect("inside");
            p.red().abs_diff(45) < 25 && p.green().abs_diff(16) < 25 && p.blue().abs_diff(92) < 25
        };
        stage.filter(strong).count()
    };
    let [start, middle, end] = ["t=0", "t=0.6", "t=1"].map(|t| solid(&format!("theme=light&color=power&{t}")));
    assert!(start < 100 && middle > start + 300 && end > middle + 300, "{start} {middle} {end}");
    let second = browser.state(&page, "sheet=2").expect("a page");
    let programs = |f: &fs::DirEntry| f.path().extension().is_some_and(|e| e == "nc");
    let sheets =
        fs::read_dir(folder.path().join("out/sheets")).unwrap().filter(|f| f.as_ref().is_ok_and(programs)).count();
    assert_eq!(
        (second.text("sheet"), second.text("sheets"), second.text("ready")),
        ("2", sheets.to_string().as_str(), "true")
    );

    let hostile = "; </script><script>document.documentElement.dataset.owned='yes'</script>\nG0X1\n";
    previewed(folder.path(), hostile, &[]);
    let state = browser.state(&folder.path().join("job.html"), "").expect("a page");
    assert!(state.text("ready") == "true" && !state.root.contains("owned"), "{}", state.root);
    // Nothing to do is no reason to fail.
    previewed(folder.path(), "; nothing\n", &[]);
    assert_eq!(browser.state(&folder.path().join("job.html"), "").expect("a page").text("ready"), "true");
}
