//! OBJ text to triangles, by tobj.
//!
//! tobj sees only what matters here: vertex positions and the position indices of faces. Colours, texture coordinates, normals, materials
//! and comments in any encoding never reach it, so none of them can break a file whose surface is sound; and the statement it is reading
//! is known when it stops, so errors name the line.

use super::load::{MAX_FACES, Soup};
use super::{Error, polygon};
use crate::geom::P3;
use std::borrow::Cow;
use std::io::{BufRead, Read};

/// Reads every object of the file into one soup. Polygons are cut into triangles.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Soup, Error> {
    let mut source =
        Surface { statements: statements(bytes), line: 0, faces: 0, corners: 0, buffer: Vec::new(), at: 0 };
    let options =
        tobj::LoadOptions { single_index: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let models = match tobj::load_obj_buf(&mut source, &options, no_materials) {
        Ok((models, _)) => models,
        Err(_) if source.is_over_the_limit() => {
            return Err(Error::TooManyFaces { name: name.into(), limit: MAX_FACES });
        }
        Err(tobj::LoadError::FaceVertexOutOfBounds) => return Err(missing_vertex(name, bytes)),
        Err(cause) => {
            let what = match cause {
                tobj::LoadError::PositionParseError => "a vertex needs three numbers".to_string(),
                tobj::LoadError::FaceParseError => "a face corner is not a whole number".to_string(),
                other => other.to_string(),
            };
            return Err(Error::Syntax { name: name.into(), place: format!(":{}", source.line), what });
        }
    };

    let mut soup = Soup::default();
    for model in models {
        let shift = soup.vertices.len() as u32;
        let mesh = model.mesh;
        soup.vertices.extend(mesh.positions.chunks_exact(3).map(|p| P3::new(p[0], p[1], p[2])));
        if mesh.face_arities.is_empty() {
            soup.triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0] + shift, t[1] + shift, t[2] + shift]));
        }
        let mut rest = &mesh.indices[..];
        for arity in mesh.face_arities {
            let (corners, after) = rest.split_at(arity as usize);
            rest = after;
            let corners: Vec<u32> = corners.iter().map(|i| i + shift).collect();
            soup.triangles.extend(polygon::triangulate(&soup.vertices, &corners));
        }
    }
    if soup.vertices.iter().any(|p| !p.coords.iter().all(|x| x.is_finite())) {
        return Err(Error::Syntax {
            name: name.into(),
            place: not_finite(bytes).map(|line| format!(":{line}")).unwrap_or_default(),
            what: "a vertex coordinate is not a finite number".into(),
        });
    }
    Ok(soup)
}

/// The statements of the file with their line numbers. A backslash at the end of a line joins the next one.
fn statements(bytes: &[u8]) -> Statements<'_> {
    Statements { rest: bytes, line: 0 }
}

struct Statements<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Iterator for Statements<'a> {
    type Item = (usize, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let mut joined: Option<(usize, Vec<u8>)> = None;
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|b| *b == b'\n').unwrap_or(self.rest.len());
            let line = self.rest[..end].trim_ascii();
            self.rest = self.rest.get(end + 1..).unwrap_or_default();
            self.line += 1;
            match (line.strip_suffix(b"\\"), &mut joined) {
                (Some(head), None) => joined = Some((self.line, [head, b" "].concat())),
                (Some(head), Some((_, text))) => {
                    text.extend_from_slice(head);
                    text.push(b' ');
                }
                (None, None) => return Some((self.line, Cow::Borrowed(line))),
                (None, Some((_, text))) => {
                    text.extend_from_slice(line);
                    break;
                }
            }
        }
        joined.map(|(line, text)| (line, Cow::Owned(text)))
    }
}

/// Hands tobj one cleaned statement after the other.
struct Surface<'a> {
    statements: Statements<'a>,
    /// Line of the statement in the buffer.
    line: usize,
    faces: usize,
    corners: usize,
    buffer: Vec<u8>,
    at: usize,
}

impl Surface<'_> {
    fn is_over_the_limit(&self) -> bool {
        self.faces > MAX_FACES || self.corners > 3 * MAX_FACES
    }
}

impl Read for Surface<'_> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Surface<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        while self.at >= self.buffer.len() {
            let Some((line, statement)) = self.statements.next() else { return Ok(&[]) };
            self.line = line;
            self.buffer.clear();
            self.at = 0;
            let words: Vec<&[u8]> = words(&statement).collect();
            match words.first() {
                // x y z, with w when it stands alone; more numbers are a colour.
                Some(&b"v") => {
                    self.corners += 1;
                    let keep = if words.len() == 5 { 5 } else { words.len().min(4) };
                    self.buffer = words[..keep].join(&b' ');
                }
                Some(&b"f") => {
                    self.faces += words.len().saturating_sub(3);
                    let positions: Vec<&[u8]> = words.iter().map(|word| position_index(word)).collect();
                    self.buffer = positions.join(&b' ');
                }
                _ => continue,
            }
            if self.is_over_the_limit() {
                return Err(std::io::Error::other("over the limit"));
            }
            // Bytes that are no text become a question mark, which is no number: the error is then about this line.
            self.buffer.iter_mut().filter(|b| !b.is_ascii()).for_each(|b| *b = b'?');
            self.buffer.push(b'\n');
        }
        Ok(&self.buffer[self.at..])
    }

    fn consume(&mut self, count: usize) {
        self.at += count;
    }
}

fn words(statement: &[u8]) -> impl Iterator<Item = &[u8]> {
    statement.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// The part of "7/1/3" that names the position.
fn position_index(word: &[u8]) -> &[u8] {
    word.split(|b| *b == b'/').next().unwrap_or(word)
}

fn number<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Finds the face that names a vertex the file does not have.
fn missing_vertex(name: &str, bytes: &[u8]) -> Error {
    let total = statements(bytes).filter(|(_, s)| words(s).next() == Some(b"v")).count() as i64;
    let (mut so_far, mut face) = (0, 0);
    for (line, statement) in statements(bytes) {
        let mut words = words(&statement);
        match words.next() {
            Some(b"v") => so_far += 1,
            Some(b"f") => {
                face += 1;
                for index in words.filter_map(|word| number::<i64>(position_index(word))) {
                    if index == 0 || index > total || index < -so_far {
                        let what = format!("face {face} names vertex {index}, but there are {total} vertices");
                        return Error::Syntax { name: name.into(), place: format!(":{line}"), what };
                    }
                }
            }
            _ => {}
        }
    }
    Error::Syntax { name: name.into(), place: String::new(), what: "a face names a vertex that does not exist".into() }
}

/// Line of the first vertex with a coordinate that is not finite.
fn not_finite(bytes: &[u8]) -> Option<usize> {
    let bad = |word: &[u8]| number::<f64>(word).is_some_and(|x| !x.is_finite());
    statements(bytes)
        .find(|(_, s)| words(s).next() == Some(b"v") && words(s).skip(1).take(3).any(bad))
        .map(|(line, _)| line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn error(text: &str) -> String {
        read("a.obj", text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn polygons_objects_and_negative_indices_become_one_soup() {
        let text = "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\no b\nv 0 0 5\nv 1 0 5\nv 0 1 5\nf -3 -2 -1\n";
        let soup = read("a.obj", text.as_bytes()).unwrap();
        assert_eq!((soup.vertices.len(), soup.triangles.len()), (7, 3));
        assert_eq!(soup.triangles[2].map(|i| soup.vertices[i as usize].z), [5.0; 3]);
    }

    #[test]
    fn colours_materials_texture_and_odd_comments_do_not_matter() {
        let mut text = b"# caf\xe9\nmtllib\nusemtl\nvt 0\nvn x\nv 0 0 0 1 0\nv 1 0 0 1 0 0\nv 0 1 0\n".to_vec();
        text.extend_from_slice(b"v 0 2 0 2\nf 2/-9223372036854775808/7 3//99 \\\n 4/8\n");
        let soup = read("a.obj", &text).unwrap();
        assert_eq!(soup.triangles.len(), 1);
        assert_eq!(soup.vertices[2], P3::new(0.0, 1.0, 0.0), "w divides");
    }

    #[test]
    fn errors_name_the_line_and_the_face() {
        assert!(error("v 0 0 0\nv 1 x 0\n").starts_with("a.obj:2: a vertex needs three numbers"));
        assert!(error("v 0 0 0\n\nf 1 one 1\n").starts_with("a.obj:3: a face corner is not a whole number"));
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n";
        assert!(error(text).starts_with("a.obj:5: face 2 names vertex 9, but there are 3"));
        assert!(error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n").contains("a.obj:4: face 1 names vertex 0"));
        assert!(error("v 0 0 0\nv 1 0 0\nf 1 2 -3\n").contains("a.obj:3: face 1 names vertex -3"));
        assert!(error("v 0 0 0\nv 1e999 0 0\nv nan 0 0\nf 1 2 3\n").starts_with("a.obj:2: a vertex coordinate"));
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "([vfogl] ?|-?[0-9]{1,2} |/|nan |1e999 |\\\\|\n|v 0 1 2\n|f 1 2 3\n){0,40}") {
            let _ = read("a.obj", text.as_bytes());
        }

        #[test]
        fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = read("a.obj", &bytes);
        }
    }
}
