//! A dry run as one HTML page that needs nothing else: no network, no server, no fonts.
//!
//! The page's parts are written by hand in `html/`. What comes from users enters in two places only: the title, escaped as HTML, and one block of
//! JSON in which `<`, `>` and `&` are written as escapes, so that no text can end the block. The page's policy lets the browser run this one
//! script, known by its hash, and load nothing.

use super::Error;
use super::pack::{Columns, base64, um};
use super::run::{Bed, Run};
use super::shade::{ColorBy, ramps_hex};
use crate::geom::Rect;
use serde::Serialize;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

/// The most moves one page holds, all programs together: about 17 MB, and still drawn in a fraction of a second.
pub const MAX_MOVES: usize = 200_000;

const PAGE: &str = include_str!("html/page.html");
const STYLE: &str = include_str!("html/style.css");
const SCRIPT: [&str; 4] = [
    include_str!("html/model.js"),
    include_str!("html/scene.js"),
    include_str!("html/panel.js"),
    include_str!("html/player.js"),
];

/// Writes the page: every run with all its moves and all lines of its program, coloured by `by` until the reader chooses otherwise. The same
/// input gives the same bytes.
///
/// # Errors
/// [`Error::TooManyMoves`] beyond [`MAX_MOVES`].
pub fn html(title: &str, runs: &[Run], bed: &Bed, by: ColorBy) -> Result<String, Error> {
    let moves = runs.iter().map(|run| run.moves.len()).sum();
    if moves > MAX_MOVES {
        return Err(Error::TooManyMoves { moves, limit: MAX_MOVES });
    }
    let script = SCRIPT.concat();
    let policy = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; base-uri 'none'; form-action 'none'",
        source_hash(&script),
        source_hash(STYLE)
    );
    let data = harmless_json(&data(title, runs, bed, by));
    let parts =
        [("policy", policy), ("title", escaped(title)), ("style", STYLE.into()), ("data", data), ("script", script)];
    Ok(filled(PAGE, &parts))
}

fn data(title: &str, runs: &[Run], bed: &Bed, by: ColorBy) -> Value {
    let scales: Map<String, Value> = ColorBy::ALL
        .iter()
        .map(|by| {
            let scale = by.scale(runs, bed);
            (by.word().into(), json!({"unit": by.unit(bed), "lo": scale.lo, "hi": scale.hi, "steps": scale.steps}))
        })
        .collect();
    let [light, dark] = ramps_hex();
    json!({
        "title": title,
        "machine": bed.machine,
        "reach": corners(&bed.reach),
        "keepOuts": bed.keep_outs.iter().map(|(name, r)| json!({"name": name, "box": corners(r)})).collect::<Vec<_>>(),
        "color": by.word(),
        "scales": scales,
        "ramps": {"light": light, "dark": dark},
        "sheets": runs.iter().map(|run| Sheet::of(run, bed)).collect::<Vec<_>>(),
    })
}

/// One program as the page reads it.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Sheet<'a> {
    name: &'a str,
    stock: Option<Value>,
    labels: Vec<(f64, f64, &'a str)>,
    notes: &'a [String],
    bounds: Option<[f64; 4]>,
    cut_mm: f64,
    travel_mm: f64,
    time_s: f64,
    /// Where the first move begins, um.
    start: [f64; 2],
    count: usize,
    moves: Columns,
    text: &'a str,
}

impl<'a> Sheet<'a> {
    fn of(run: &'a Run, bed: &Bed) -> Sheet<'a> {
        let stock = run.stock.as_ref().map(|s| {
            json!({
                "name": s.name, "x": s.at.x, "y": s.at.y, "width": s.width_mm, "height": s.height_mm,
                "grain": s.grain.map(|g| if g.along_x { "x" } else { "y" }), "grainKnown": s.grain.is_some_and(|g| g.known),
            })
        });
        let lengths = run.lengths(bed);
        let bounds = run.bounds();
        Sheet {
            name: &run.name,
            stock,
            labels: run.labels.iter().map(|(at, text)| (at.x, at.y, text.as_str())).collect(),
            notes: &run.notes,
            bounds: (!bounds.is_empty()).then(|| corners(&bounds)),
            cut_mm: lengths.cut_mm,
            travel_mm: lengths.travel_mm,
            time_s: run.timing.total_s,
            start: run.moves.first().map_or([0.0; 2], |m| um(m.from.xy())),
            count: run.moves.len(),
            moves: Columns::of(run, bed),
            text: &run.text,
        }
    }
}

fn corners(r: &Rect) -> [f64; 4] {
    [r.min.x, r.min.y, r.max.x, r.max.y]
}

/// JSON that can stand inside a script element whatever its strings say.
fn harmless_json(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

/// Text as it stands between tags or in a quoted attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

/// The hash by which a content security policy knows an inline script or style.
fn source_hash(source: &str) -> String {
    format!("sha256-{}", base64(&Sha256::digest(source.as_bytes())))
}

/// Fills in `{{name}}`, in one pass: what is filled in is not looked at again.
fn filled(template: &str, parts: &[(&str, String)]) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        page.push_str(before);
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        page.extend(parts.iter().filter(|(n, _)| *n == name).map(|(_, text)| text.as_str()));
        rest = after;
    }
    page.push_str(rest);
    page
}

#[cfg(test)]
mod tests {
    use super::super::run::tests::{bed, moves, run};
    use super::*;

    fn page_of(title: &str, text: &str) -> String {
        let moves = moves(text);
        html(title, &[run(text, &moves)], &bed(), ColorBy::Power).unwrap()
    }

    /// The block of data, parsed.
    fn data_of(page: &str) -> Value {
        let (_, rest) = page.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    }

    #[test]
    fn hostile_text_stays_text() {
        let hostile = "</script><script>alert`1`</script><!--<img src=x onerror=alert`2`> & \u{2028} {{data}}";
        let text = format!("; {hostile}\nG0X1 ({hostile})\n");
        let page = page_of(hostile, &text);
        let plain = page_of("x", "; harmless\nG0X1\n");
        for tag in ["<script", "</script", "<img", "<!--"] {
            assert_eq!(page.matches(tag).count(), plain.matches(tag).count(), "{tag}");
        }
        let data = data_of(&page);
        assert_eq!(data["sheets"][0]["text"], text);
        assert_eq!(data["title"], hostile);
    }

    #[test]
    fn the_page_asks_nobody_for_anything_and_runs_its_own_script_only() {
        let page = page_of("job", "G0X1");
        for reference in ["http:", "https:", "//cdn", " src=", "@import", "url(", "import("] {
            assert!(!page.contains(reference), "{reference}");
        }
        let script = page.rsplit_once("<script>").unwrap().1.split_once("</script>").unwrap().0;
        let style = page.split_once("<style>").unwrap().1.split_once("</style>").unwrap().0;
        assert!(page.contains(&format!("script-src '{}'", source_hash(script))));
        assert!(page.contains(&format!("style-src '{}'", source_hash(style))));
        assert!(page.contains("default-src 'none'"));
        assert!(!page.contains("unsafe-inline"));
        assert!(!page.contains(" style=\""), "the policy forbids style attributes");
    }

    #[test]
    fn every_run_is_in_it_and_the_same_bytes_come_twice() {
        let (a, b) = ("M4S100\nG1X10F600\nX20", "G0Y5\n; end");
        let (moves_a, moves_b) = (moves(a), moves(b));
        let page = || html("two", &[run(a, &moves_a), run(b, &moves_b)], &bed(), ColorBy::Feed).unwrap();
        assert_eq!(page(), page());
        let data = data_of(&page());
        let sheets = data["sheets"].as_array().unwrap();
        let counts: Vec<u64> = sheets.iter().map(|s| s["count"].as_u64().unwrap()).collect();
        assert_eq!(counts, [moves_a.len() as u64, moves_b.len() as u64]);
        assert_eq!((&data["color"], &sheets[1]["text"]), (&json!("feed"), &json!(b)));
        assert_eq!(data["scales"]["power"]["steps"], json!([10.0]));
    }

    #[test]
    fn more_moves_than_a_browser_bears_are_refused_with_the_way_out() {
        let one = moves("G0X1")[0];
        let many = vec![one; MAX_MOVES + 1];
        let error = html("big", &[run("G0X1", &many)], &bed(), ColorBy::Power).unwrap_err();
        assert!(error.to_string().contains("--out FILE.png"), "{error}");
    }
}
