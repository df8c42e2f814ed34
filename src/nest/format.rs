//! What stands in the files: jagua-rs's instances and solutions, and three keys of ours in items that it passes over.

use serde::{Deserialize, Serialize};

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct File {
    #[serde(default)]
    pub(super) name: String,
    #[serde(default)]
    pub(super) min_item_separation: f64,
    pub(super) items: Vec<FileItem>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) strip_height: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) bins: Option<Vec<FileBin>>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct FileItem {
    pub(super) id: u64,
    pub(super) demand: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) orientation: Option<Orientation>,
    #[serde(default, skip_serializing)]
    pub(super) allowed_orientations: Option<Vec<f64>>,
    /// Ours: see [`super::Item`].
    #[serde(default, skip_serializing_if = "is_usual")]
    pub(super) priority: i32,
    /// Ours: see [`super::Item`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) set: Option<u32>,
    /// Ours: where it lies already, as a solution says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) fixed: Option<FileFixed>,
    pub(super) shape: Shape,
}

/// A place in a container, which goes by its number in the file.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct FileFixed {
    pub(super) container_id: usize,
    /// Degrees.
    pub(super) rotation: f64,
    pub(super) translation: [f64; 2],
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Orientation {
    pub(super) rotation: Rotation,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) reflection_axes: Vec<f64>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "mode", rename_all = "snake_case")]
pub(super) enum Rotation {
    Discrete { angles: Vec<f64> },
    Stepped { step: f64 },
    Continuous {},
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "type", content = "data", rename_all = "snake_case")]
pub(super) enum Shape {
    Rectangle {
        x_min: f64,
        y_min: f64,
        width: f64,
        height: f64,
    },
    SimplePolygon(Vec<[f64; 2]>),
    /// Holes in items are not used for placing; those in bins are blocked.
    Polygon {
        outer: Vec<[f64; 2]>,
        #[serde(default)]
        inner: Vec<Vec<[f64; 2]>>,
    },
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct FileBin {
    pub(super) id: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) stock: Option<u32>,
    #[serde(default = "one")]
    pub(super) cost: f64,
    pub(super) shape: Shape,
}

fn is_usual(priority: &i32) -> bool {
    *priority == 0
}

fn one() -> f64 {
    1.0
}

/// Placements in jagua-rs's form: turned over (y becomes -y), turned, moved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Solution {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) strip_width: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) cost: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) layout: Option<FileLayout>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) layouts: Option<Vec<FileLayout>>,
    pub(super) density: f64,
    pub(super) run_time_sec: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct FileLayout {
    pub(super) container_id: usize,
    pub(super) placed_items: Vec<FilePlacement>,
    pub(super) density: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct FilePlacement {
    pub(super) item_id: u64,
    pub(super) transformation: FileTransformation,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct FileTransformation {
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(super) reflected: bool,
    /// Degrees.
    pub(super) rotation: f64,
    pub(super) translation: [f64; 2],
}
