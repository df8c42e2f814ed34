//! From a tree with places to typed values: a serde deserializer that collects *every* unknown key, each with a suggestion, and
//! gives a wrong type or a missing key the place it has in the file.

use std::cell::RefCell;
use std::fmt;

use serde::de::{self, DeserializeOwned, IntoDeserializer, Visitor};

use super::source::{Origin, Problem, nearest};
use super::tree::{Entry, Node, Value};

/// Reads a typed value. What is wrong is added to `problems`; `None` when no value could be made.
pub(super) fn read<T: DeserializeOwned>(root: &Node, problems: &mut Vec<Problem>) -> Option<T> {
    let unknown = RefCell::new(Vec::new());
    let result = T::deserialize(Reader { node: root, path: String::new(), unknown: &unknown });
    problems.append(&mut unknown.into_inner());
    match result {
        Ok(value) => Some(value),
        Err(fault) => {
            problems.push(fault.origin.unwrap_or_else(|| root.origin.clone()).problem(fault.message, fault.help));
            None
        }
    }
}

#[derive(Clone)]
struct Reader<'a> {
    node: &'a Node,
    /// Where this value lives, for messages: "tool", "process.2".
    path: String,
    unknown: &'a RefCell<Vec<Problem>>,
}

/// Why a value could not be made. The place is filled in by the innermost reader that knows one.
#[derive(Debug)]
struct Fault {
    message: String,
    help: Option<String>,
    origin: Option<Origin>,
}

impl Fault {
    fn at(mut self, origin: &Origin) -> Fault {
        self.origin.get_or_insert_with(|| origin.clone());
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

impl de::Error for Fault {
    fn custom<T: fmt::Display>(message: T) -> Fault {
        Fault { message: message.to_string(), help: None, origin: None }
    }

    fn invalid_type(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> Fault {
        Fault::custom(format!("{} is not {}", plain_found(found), plain_expected(&expected.to_string())))
    }

    fn invalid_value(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> Fault {
        Fault::invalid_type(found, expected)
    }

    fn unknown_variant(word: &str, known: &'static [&'static str]) -> Fault {
        let help = match nearest(word, known.iter().copied()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("it can be {}", known.iter().map(|k| format!("\"{k}\"")).collect::<Vec<_>>().join(", ")),
        };
        Fault { help: Some(help), ..Fault::custom(format!("\"{word}\" is not known here")) }
    }

    fn missing_field(field: &'static str) -> Fault {
        Fault::custom(format!("`{field}` is missing"))
    }
}

/// What serde calls the found value, in words for people who write TOML.
fn plain_found(found: de::Unexpected<'_>) -> String {
    match found {
        de::Unexpected::Str(text) => format!("the text \"{text}\""),
        de::Unexpected::Signed(number) => format!("the number {number}"),
        de::Unexpected::Float(number) => format!("the number {number}"),
        de::Unexpected::Bool(flag) => format!("{flag}"),
        de::Unexpected::Seq => "a list".into(),
        de::Unexpected::Map => "a table".into(),
        other => other.to_string(),
    }
}

/// What serde expected, in the same words.
fn plain_expected(expected: &str) -> String {
    match expected {
        "f64" => "a number".into(),
        "u32" | "u64" | "usize" => "a whole number from 0".into(),
        "a boolean" => "true or false".into(),
        "a string" => "a text in quotes".into(),
        "a sequence" => "a list".into(),
        _ if expected.starts_with("struct ") => "a table".into(),
        _ => expected.into(),
    }
}

impl<'a> Reader<'a> {
    fn child(&self, key: &str, node: &'a Node) -> Reader<'a> {
        let path = if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        Reader { node, path, unknown: self.unknown }
    }

    fn unexpected(&self) -> de::Unexpected<'a> {
        match &self.node.value {
            Value::Table(_) => de::Unexpected::Map,
            Value::Array(_) => de::Unexpected::Seq,
            Value::Text(text) => de::Unexpected::Str(text),
            Value::Integer(number) => de::Unexpected::Signed(*number),
            Value::Float(number) => de::Unexpected::Float(*number),
            Value::Bool(flag) => de::Unexpected::Bool(*flag),
            Value::Date => de::Unexpected::Other("a date"),
        }
    }

    fn report_unknown(&self, name: &str, entry: &Entry, known: &[&'static str]) {
        let table = if self.path.is_empty() { String::new() } else { format!(" in {}", self.path) };
        // A long list helps nobody; the schema command is there for that.
        let listed = || (known.len() <= 10).then(|| format!("known keys: {}", known.join(", ")));
        let help = nearest(name, known.iter().copied()).map(|near| format!("did you mean `{near}`?")).or_else(listed);
        self.unknown.borrow_mut().push(entry.key.problem(format!("unknown key `{name}`{table}"), help));
    }
}

impl<'de> de::Deserializer<'de> for Reader<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let origin = &self.node.origin;
        match &self.node.value {
            Value::Table(entries) => {
                let entries = entries.iter().collect();
                visitor.visit_map(Entries { reader: self.clone(), entries, next: 0 })
            }
            Value::Array(items) => {
                let mut list = Items { reader: self.clone(), items, next: 0 };
                visitor.visit_seq(&mut list).and_then(|value| {
                    if list.next == items.len() {
                        return Ok(value);
                    }
                    Err(de::Error::custom(format!("{} values where {} are expected", items.len(), list.next)))
                })
            }
            Value::Text(text) => visitor.visit_borrowed_str(text),
            Value::Integer(number) => visitor.visit_i64(*number),
            Value::Float(number) => visitor.visit_f64(*number),
            Value::Bool(flag) => visitor.visit_bool(*flag),
            Value::Date => Err(de::Error::invalid_type(self.unexpected(), &visitor)),
        }
        .map_err(|fault| fault.at(origin))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match &self.node.value {
            Value::Text(word) => visitor.visit_enum(IntoDeserializer::<Fault>::into_deserializer(word.as_str())),
            _ => {
                let words = format!("one of \"{}\"", variants.join("\", \""));
                Err(de::Error::invalid_type(self.unexpected(), &words.as_str()))
            }
        }
        .map_err(|fault: Fault| fault.at(&self.node.origin))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let Value::Table(entries) = &self.node.value else {
            return self.deserialize_any(visitor);
        };
        // Unknown keys are reported here and left out, so that reading goes on and finds the next one too.
        let (known, unknown): (Vec<_>, Vec<_>) = entries.iter().partition(|(name, _)| fields.contains(&name.as_str()));
        for (name, entry) in unknown {
            self.report_unknown(name, entry, fields);
        }
        let origin = &self.node.origin;
        visitor.visit_map(Entries { reader: self.clone(), entries: known, next: 0 }).map_err(|fault| fault.at(origin))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map identifier ignored_any
    }
}

struct Entries<'a> {
    reader: Reader<'a>,
    entries: Vec<(&'a String, &'a Entry)>,
    next: usize,
}

impl<'de> de::MapAccess<'de> for Entries<'de> {
    type Error = Fault;

    fn next_key_seed<K: de::DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Fault> {
        match self.entries.get(self.next) {
            Some((name, entry)) => {
                let name: de::value::StrDeserializer<'_, Fault> = name.as_str().into_deserializer();
                seed.deserialize(name).map(Some).map_err(|fault| fault.at(&entry.key))
            }
            None => Ok(None),
        }
    }

    fn next_value_seed<S: de::DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Fault> {
        let (name, entry) = self.entries[self.next];
        self.next += 1;
        seed.deserialize(self.reader.child(name, &entry.node))
    }
}

struct Items<'a> {
    reader: Reader<'a>,
    items: &'a [Node],
    next: usize,
}

impl<'de> de::SeqAccess<'de> for &mut Items<'de> {
    type Error = Fault;

    fn next_element_seed<S: de::DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, Fault> {
        let Some(item) = self.items.get(self.next) else { return Ok(None) };
        let reader = self.reader.child(&self.next.to_string(), item);
        self.next += 1;
        seed.deserialize(reader).map(Some)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use serde::Deserialize;

    use super::super::source::Source;
    use super::*;

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Outer {
        count: u32,
        size_mm: [f64; 2],
        inner: Option<Inner>,
        #[serde(default)]
        rows: Vec<Inner>,
    }

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        kind: Kind,
        feed_mm_per_min: Option<f64>,
    }

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(rename_all = "kebab-case")]
    enum Kind {
        FrontLeft,
        BackRight,
    }

    fn outer(text: &str) -> (Option<Outer>, Vec<(usize, usize, String)>) {
        let root = Node::parse(Arc::new(Source { name: "x".into(), text: text.into() })).expect("TOML");
        let mut problems = Vec::new();
        let value = read(&root, &mut problems);
        let told = problems.into_iter().map(|p| (p.line, p.column, p.message + "; " + &p.help.unwrap_or_default()));
        (value, told.collect())
    }

    #[test]
    fn whole_numbers_serve_as_lengths_and_options_may_be_absent() {
        let (value, problems) = outer("count = 3\nsize_mm = [1, 2.5]\ninner = { kind = 'front-left' }");
        assert!(problems.is_empty(), "{problems:?}");
        let inner = Some(Inner { kind: Kind::FrontLeft, feed_mm_per_min: None });
        assert_eq!(value, Some(Outer { count: 3, size_mm: [1.0, 2.5], inner, rows: vec![] }));
    }

    #[test]
    fn every_unknown_key_is_found_at_once_with_a_suggestion() {
        let (_, problems) =
            outer("cuont = 3\ncount = 3\nsize_mm = [1, 2]\n[[rows]]\nkind = 'back-right'\nfeed = 5\nzzz = 1");
        assert_eq!(problems.len(), 3, "{problems:?}");
        assert_eq!(problems[0], (1, 1, "unknown key `cuont`; did you mean `count`?".into()));
        assert_eq!(problems[1], (6, 1, "unknown key `feed` in rows.0; did you mean `feed_mm_per_min`?".into()));
        assert_eq!(problems[2], (7, 1, "unknown key `zzz` in rows.0; known keys: kind, feed_mm_per_min".into()));
    }

    #[test]
    fn wrong_types_words_and_lengths_are_told_at_the_value() {
        let wrong = |text: &str| outer(text).1.pop().expect("a problem");
        assert_eq!(wrong("count = 'three'"), (1, 9, "the text \"three\" is not a whole number from 0; ".into()));
        assert_eq!(wrong("count = -1").1, 9);
        assert_eq!(wrong("count = 1979-05-27").1, 9);
        let (line, column, message) = wrong("count = 1\nsize_mm = [1, 2, 3]");
        assert_eq!((line, column, message.as_str()), (2, 11, "3 values where 2 are expected; "));
        let word = wrong("count = 1\nsize_mm = [1, 2]\ninner = { kind = 'front-lft' }");
        assert_eq!(word, (3, 18, "\"front-lft\" is not known here; did you mean \"front-left\"?".into()));
        assert_eq!(wrong("count = 1\nsize_mm = [1, 2]\n[inner]\nkind = 3").0, 4);
        assert_eq!(wrong("count = 1\nsize_mm = [1, 2]\n[inner]\n"), (3, 1, "`kind` is missing; ".into()));
    }
}
