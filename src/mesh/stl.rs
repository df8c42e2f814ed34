//! STL, binary and ASCII, to triangles, by stl_io.
//!
//! Which of the two it is, how long it has to be and where each solid ends is decided here: stl_io takes every file that starts with
//! "solid " for text, stops after the first solid, and believes a binary header's count.

use super::Error;
use super::load::{MAX_FACES, Soup};
use crate::geom::P3;
use std::io::{Read, Seek, SeekFrom};

/// Bytes before the first facet of a binary file: a free header and the number of facets.
const HEADER: usize = 84;
/// Bytes of a binary facet.
const FACET: usize = 50;
/// stl_io's mark of a text file.
const SOLID: &[u8] = b"solid x\n";

/// Reads every solid of the file into one soup; corners are not merged yet.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Soup, Error> {
    if is_binary(bytes) { binary(name, bytes) } else { ascii(name, bytes) }
}

fn promised(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

/// A file that is exactly as long as its count says is binary, whatever its header reads; otherwise text starts with "solid" and holds no NUL.
fn is_binary(bytes: &[u8]) -> bool {
    if promised(bytes).is_some_and(|count| bytes.len() == HEADER + FACET * count) {
        return true;
    }
    let head = &bytes[..bytes.len().min(1024)];
    !head.trim_ascii_start().to_ascii_lowercase().starts_with(b"solid") || head.contains(&0)
}

fn binary(name: &str, bytes: &[u8]) -> Result<Soup, Error> {
    let syntax = |byte: usize, what: String| Error::Syntax { name: name.into(), place: format!(", byte {byte}"), what };
    let Some(count) = promised(bytes) else {
        return Err(syntax(bytes.len(), format!("neither text STL nor a binary STL header of {HEADER} bytes")));
    };
    let there = (bytes.len() - HEADER) / FACET;
    if there < count {
        let what = format!("the file ends after {there} of the {count} triangles it promises");
        return Err(syntax(bytes.len(), what));
    }
    if count > MAX_FACES {
        return Err(Error::TooManyFaces { name: name.into(), limit: MAX_FACES });
    }
    let mut source = Joined { parts: [&[0; 80], &bytes[80..]], at: 0 };
    let mut soup = Soup::default();
    append(&mut source, &mut soup).map_err(|(facet, what)| syntax(HEADER + FACET * facet, what))?;
    Ok(soup)
}

fn ascii(name: &str, bytes: &[u8]) -> Result<Soup, Error> {
    let mut soup = Soup::default();
    let (mut rest, mut line) = (bytes, 1);
    loop {
        let before = rest.len();
        let solid = rest.trim_ascii_start();
        line += newlines(&rest[..before - solid.len()]);
        if solid.is_empty() {
            return Ok(soup);
        }
        let body = after_line(solid);
        let end = end_of_solid(body);
        let first = soup.triangles.len();
        let mut source = Joined { parts: [SOLID, &body[..end]], at: 0 };
        append(&mut source, &mut soup).map_err(|(facet, what)| {
            if soup.triangles.len() >= MAX_FACES {
                return Error::TooManyFaces { name: name.into(), limit: MAX_FACES };
            }
            let at = line + 1 + line_of_facet(body, facet - first);
            Error::Syntax { name: name.into(), place: format!(":{at}"), what: format!("facet {}: {what}", facet + 1) }
        })?;
        line += 1 + newlines(&body[..end]);
        rest = &body[end..];
    }
}

/// Appends what stl_io reads. On an error: how many triangles the soup holds by then, and what is wrong with the next.
fn append(source: &mut Joined, soup: &mut Soup) -> Result<(), (usize, String)> {
    let facets = stl_io::create_stl_reader(source).map_err(|e| (soup.triangles.len(), e.to_string()))?;
    for facet in facets {
        let facet = facet.map_err(|e| (soup.triangles.len(), e.to_string()))?;
        if soup.triangles.len() >= MAX_FACES {
            return Err((soup.triangles.len(), "too many".into()));
        }
        if !facet.vertices.iter().all(|v| v.0.iter().all(|x| x.is_finite())) {
            return Err((soup.triangles.len(), "a corner coordinate is not a finite number".into()));
        }
        let first = soup.vertices.len() as u32;
        soup.vertices.extend(facet.vertices.iter().map(|v| P3::from(v.0.map(f64::from))));
        soup.triangles.push([first, first + 1, first + 2]);
    }
    Ok(())
}

fn newlines(text: &[u8]) -> usize {
    text.iter().filter(|b| **b == b'\n').count()
}

fn after_line(text: &[u8]) -> &[u8] {
    text.iter().position(|b| *b == b'\n').map_or(&[], |end| &text[end + 1..])
}

/// Length of the text up to and including its first "endsolid" line.
fn end_of_solid(text: &[u8]) -> usize {
    let mut rest = text;
    while !rest.is_empty() {
        let next = after_line(rest);
        if rest.trim_ascii_start().starts_with(b"endsolid") {
            return text.len() - next.len();
        }
        rest = next;
    }
    text.len()
}

/// Lines before facet number `facet` (from 0) of the text, or before its end when it has fewer.
fn line_of_facet(text: &[u8], facet: usize) -> usize {
    let starts = text.split(|b| *b == b'\n').enumerate().filter(|(_, l)| l.trim_ascii_start().starts_with(b"facet"));
    starts.map(|(line, _)| line).nth(facet).unwrap_or_else(|| newlines(text.trim_ascii_end()))
}

/// Two byte strings read as one, so that a header can be replaced without copying the file.
struct Joined<'a> {
    parts: [&'a [u8]; 2],
    at: usize,
}

impl Read for Joined<'_> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let first = self.parts[0].len();
        let mut from = match self.parts[0].get(self.at..) {
            Some(head) if !head.is_empty() => head,
            _ => self.parts[1].get(self.at - first..).unwrap_or_default(),
        };
        let count = from.read(into)?;
        self.at += count;
        Ok(count)
    }
}

impl Seek for Joined<'_> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        let SeekFrom::Start(at) = to else {
            return Err(std::io::Error::other("only positions from the start"));
        };
        self.at = usize::try_from(at).map_err(std::io::Error::other)?;
        Ok(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FACET_TEXT: &str =
        "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";

    fn binary_file(header: &[u8], promised: u32, corners: &[[f32; 9]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(promised.to_le_bytes());
        for facet in corners {
            bytes.extend([0; 12]);
            bytes.extend(facet.iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

    fn error(bytes: &[u8]) -> String {
        read("a.stl", bytes).unwrap_err().to_string()
    }

    #[test]
    fn a_binary_file_whose_header_says_solid_is_still_binary() {
        let soup = read("a.stl", &binary_file(b"solid made by somebody", 2, &[CORNERS, CORNERS])).unwrap();
        assert_eq!((soup.triangles.len(), soup.vertices[4]), (2, P3::new(1.0, 0.0, 0.0)));
    }

    #[test]
    fn a_header_that_promises_four_billion_triangles_is_an_error_not_an_allocation() {
        let message = error(&binary_file(b"", u32::MAX, &[CORNERS]));
        assert!(message.contains("byte 134") && message.contains("after 1 of the 4294967295"), "{message}");
        assert!(error(&binary_file(b"", 0, &[])[..50]).contains("byte 50"));
    }

    #[test]
    fn a_coordinate_that_is_not_finite_is_named_by_its_byte() {
        let mut bad = CORNERS;
        bad[5] = f32::NAN;
        let message = error(&binary_file(b"", 2, &[CORNERS, bad]));
        assert!(message.contains("byte 134") && message.contains("finite"), "{message}");
    }

    #[test]
    fn every_solid_of_a_text_file_is_read_and_the_name_may_be_missing() {
        let text = format!("\n solid\n{FACET_TEXT}endsolid\nsolid b\n{FACET_TEXT}{FACET_TEXT}endsolid b\n\n");
        assert_eq!(read("a.stl", text.as_bytes()).unwrap().triangles.len(), 3);
    }

    #[test]
    fn errors_in_text_name_line_and_facet() {
        let text = format!("solid a\n{FACET_TEXT}endsolid\nsolid b\n{FACET_TEXT}facet normal 0 0 x\n");
        let message = error(text.as_bytes());
        assert!(message.starts_with("a.stl:18: facet 3:"), "{message}");
        let cut = format!("solid a\n{FACET_TEXT}");
        assert!(error(cut.as_bytes()).starts_with("a.stl:8: facet 2:"), "{}", error(cut.as_bytes()));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(text in "(solid|endsolid|facet normal 0 0 1|outer loop|vertex 0 0 1|[a-z]|\n| ){0,30}", raw in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = read("a.stl", text.as_bytes());
            let _ = read("a.stl", &raw);
        }
    }
}
