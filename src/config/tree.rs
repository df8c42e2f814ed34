//! A parsed TOML file in which every key and value knows where it was written, and the merging of one onto another.

use std::collections::BTreeMap;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::source::{Origin, Problem, Source};

/// A value and where it stands.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub value: Value,
    pub origin: Origin,
}

/// What TOML can hold. Dates have no use in our files and are refused where a type is expected.
#[derive(Debug, Clone)]
pub(super) enum Value {
    Table(BTreeMap<String, Entry>),
    Array(Vec<Node>),
    Text(String),
    Integer(i64),
    Float(f64),
    Bool(bool),
    Date,
}

/// A key of a table.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    /// Where the key was written.
    pub key: Origin,
    pub node: Node,
}

impl Node {
    /// Parses a file.
    pub fn parse(source: Arc<Source>) -> Result<Node, Vec<Problem>> {
        let table = DeTable::parse(&source.text).map_err(|error| {
            let origin = Origin { source: source.clone(), span: error.span().unwrap_or(0..0) };
            vec![origin.problem(format!("this is not TOML: {}", error.message()), None)]
        })?;
        let mut problems = Vec::new();
        let span = table.span();
        let value = table_value(table.into_inner(), &source, &mut problems);
        if problems.is_empty() { Ok(Node { value, origin: Origin { source, span } }) } else { Err(problems) }
    }

    /// This file laid over its base: tables are merged key by key, everything else (arrays too) replaces what the base said.
    pub fn over(self, base: Node) -> Node {
        match (self.value, base.value) {
            (Value::Table(own), Value::Table(mut merged)) => {
                for (name, entry) in own {
                    let node = match merged.remove(&name) {
                        Some(under) => entry.node.over(under.node),
                        None => entry.node,
                    };
                    merged.insert(name, Entry { key: entry.key, node });
                }
                Node { value: Value::Table(merged), origin: self.origin }
            }
            (value, _) => Node { value, origin: self.origin },
        }
    }

    /// The value of a key of this table.
    pub fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(entries) => entries.get(key).map(|e| &e.node),
            Value::Array(items) => key.parse::<usize>().ok().and_then(|i| items.get(i)),
            _ => None,
        }
    }

    /// Takes a key out of this table.
    pub fn remove(&mut self, key: &str) -> Option<Node> {
        match &mut self.value {
            Value::Table(entries) => entries.remove(key).map(|e| e.node),
            _ => None,
        }
    }

    /// Follows `path` ("process.2.power") as far as it exists: the last value met, so that a missing key is reported at its table.
    pub fn nearest(&self, path: &str) -> &Node {
        let mut node = self;
        for key in path.split('.') {
            match node.get(key) {
                Some(next) => node = next,
                None => break,
            }
        }
        node
    }
}

fn table_value(table: DeTable<'_>, source: &Arc<Source>, problems: &mut Vec<Problem>) -> Value {
    let entries = table.into_iter().map(|(key, value)| {
        let origin = Origin { source: source.clone(), span: key.span() };
        (key.into_inner().into_owned(), Entry { key: origin, node: node(value, source, problems) })
    });
    Value::Table(entries.collect())
}

fn node(spanned: Spanned<DeValue<'_>>, source: &Arc<Source>, problems: &mut Vec<Problem>) -> Node {
    let origin = Origin { source: source.clone(), span: spanned.span() };
    let mut refuse = |message: String| {
        problems.push(origin.problem(message, None));
        Value::Float(0.0)
    };
    let value = match spanned.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Boolean(flag) => Value::Bool(flag),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(number) => Value::Integer(number),
            Err(_) => refuse(format!("{digits} is too large a number")),
        },
        DeValue::Float(digits) => match digits.as_str().parse::<f64>() {
            Ok(number) if number.is_finite() => Value::Float(number),
            _ => refuse(format!("{digits} is not a finite number")),
        },
        DeValue::Array(items) => Value::Array(items.into_iter().map(|item| node(item, source, problems)).collect()),
        DeValue::Table(table) => table_value(table, source, problems),
    };
    Node { value, origin }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(name: &str, text: &str) -> Result<Node, Vec<Problem>> {
        Node::parse(Arc::new(Source { name: name.into(), text: text.into() }))
    }

    #[test]
    fn a_merged_value_still_knows_the_file_it_came_from() {
        let base =
            parse("base", "[tool]\nclass = 'co2'\nspot_mm = 0.2\n[[stock]]\nname = 'A4'\n[[stock]]\nname = 'A3'")
                .expect("TOML");
        let own = parse("own", "[tool]\nspot_mm = 0.1\n[[stock]]\nname = 'A5'").expect("TOML");
        let merged = own.over(base);
        let place = |path: &str| {
            let problem = merged.nearest(path).origin.problem("", None);
            (problem.file, problem.line, problem.column)
        };
        assert_eq!(place("tool.class"), ("base".into(), 2, 9));
        assert_eq!(place("tool.spot_mm"), ("own".into(), 2, 11));
        // Arrays are replaced whole: A3 of the base is gone.
        assert_eq!(place("stock.0.name"), ("own".into(), 4, 8));
        assert!(merged.get("stock").and_then(|s| s.get("1")).is_none());
    }

    #[test]
    fn what_cannot_be_a_measure_is_refused_where_it_stands() {
        let problems = parse("x", "a = nan\nb = 1\nc = [inf]\nd = 99999999999999999999").expect_err("not finite");
        let places: Vec<_> = problems.iter().map(|p| (p.line, p.column)).collect();
        assert_eq!(places, [(1, 5), (3, 6), (4, 5)]);
    }

    #[test]
    fn broken_toml_names_the_place() {
        let problems = parse("x", "schema = 1\nname = \"k40\n").expect_err("an open string");
        assert_eq!((problems[0].line, problems[0].file.as_str()), (2, "x"));
    }
}
