//! JSON schema of machine and profile files, for editors that complete and check TOML.

use serde_json::{Map, Value, json};

use super::error::Kind;
use super::machine::Machine;
use super::profile::Profile;
use super::source::Problem;
use super::tree::{self, Node};

/// The JSON schema (draft 2020-12) of files of a kind.
///
/// A file that inherits may leave out what its base says, so required keys are only asked for in files without `inherits`, and in the rows
/// of lists, which are replaced as a whole. What is missing after merging is for `check` to find.
pub fn schema(kind: Kind) -> Value {
    let mut schema = strict_schema(kind);
    let rows = row_definitions(&schema);
    if let Some(Value::Object(definitions)) = schema.get_mut("$defs") {
        for (_, definition) in definitions.iter_mut().filter(|(name, _)| !rows.contains(name)) {
            if let Value::Object(definition) = definition {
                definition.remove("required");
            }
        }
    }
    if let Value::Object(root) = &mut schema {
        relax_root(root);
    }
    schema
}

/// The schema of a file that stands for itself, or of one merged with its base.
fn strict_schema(kind: Kind) -> Value {
    match kind {
        Kind::Machine => schemars::schema_for!(Machine),
        Kind::Profile => schemars::schema_for!(Profile),
    }
    .to_value()
}

/// Every required key that `root`, merged with its base, does not have. serde stops at the first one; people want to know them all.
pub(super) fn missing_keys(kind: Kind, root: &Node) -> Vec<Problem> {
    let schema = strict_schema(kind);
    let mut problems = Vec::new();
    collect_missing(&schema, &schema, root, &mut problems);
    problems
}

fn collect_missing(all: &Value, schema: &Value, node: &Node, problems: &mut Vec<Problem>) {
    // An optional table is "anyOf: [its definition, null]".
    let schema = schema.pointer("/anyOf/0").unwrap_or(schema);
    let reference = schema.get("$ref").and_then(Value::as_str).and_then(|reference| reference.strip_prefix('#'));
    let schema = reference.and_then(|pointer| all.pointer(pointer)).unwrap_or(schema);
    match &node.value {
        tree::Value::Table(entries) => {
            let required = schema.get("required").and_then(Value::as_array).into_iter().flatten();
            for key in required.filter_map(Value::as_str).filter(|key| !entries.contains_key(*key)) {
                problems.push(node.origin.problem(format!("`{key}` is missing"), None));
            }
            for (name, entry) in entries {
                if let Some(schema) = schema.get("properties").and_then(|properties| properties.get(name)) {
                    collect_missing(all, schema, &entry.node, problems);
                }
            }
        }
        tree::Value::Array(items) => {
            if let Some(schema) = schema.get("items") {
                items.iter().for_each(|item| collect_missing(all, schema, item, problems));
            }
        }
        _ => {}
    }
}

fn relax_root(root: &mut Map<String, Value>) {
    let Some(all) = root.insert("required".into(), json!(["schema", "name"])) else { return };
    root.insert("if".into(), json!({ "not": { "required": ["inherits"] } }));
    root.insert("then".into(), json!({ "required": all }));
}

/// Names of the definitions that are items of a list.
fn row_definitions(schema: &Value) -> Vec<String> {
    let Some(Value::Object(properties)) = schema.get("properties") else { return Vec::new() };
    let items = properties.values().filter_map(|property| property.pointer("/items/$ref")?.as_str());
    items.filter_map(|reference| reference.strip_prefix("#/$defs/")).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_knows_every_key_and_refuses_others() {
        let schema = schema(Kind::Machine);
        assert_eq!(schema["additionalProperties"], json!(false));
        assert_eq!(schema["$defs"]["Tool"]["additionalProperties"], json!(false));
        assert!(schema["$defs"]["Tool"]["properties"]["optical_power_w"]["description"].is_string());
        assert!(schema["$defs"]["ToolClass"].to_string().contains("co2"));
    }

    #[test]
    fn a_file_that_inherits_may_leave_keys_out_but_its_rows_may_not() {
        let schema = schema(Kind::Profile);
        assert_eq!(schema["required"], json!(["schema", "name"]));
        assert!(schema["then"]["required"].as_array().is_some_and(|keys| keys.contains(&json!("thickness_mm"))));
        assert!(schema["$defs"]["Joint"].get("required").is_none());
        assert!(schema["$defs"]["ProcessRow"]["required"].as_array().is_some_and(|k| k.contains(&json!("source"))));
    }
}
