//! Where a part's shape comes from and how it is filled, as a design file says it.

use crate::ruffle::Direction;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// `stack = "vertical"`, or `stack = { layers = 2, inner_mm = 52.8, outer_mm = 47.12 }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Stack {
    /// Which way the layers of a filled outline lie.
    Toward(Direction),
    /// A stack of its own: no outline is filled, the strip has the lengths that are given.
    Given(GivenStack),
}

/// A stack of equal layers with given lengths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenStack {
    /// Layers.
    pub layers: usize,
    /// Length of a rung, mm.
    pub inner_mm: f64,
    /// Length of a loop, mm: half a circle, so a layer is 2/pi of it high.
    pub outer_mm: f64,
}

impl GivenStack {
    /// Height of a layer, mm.
    pub fn layer_mm(&self) -> f64 {
        self.outer_mm * std::f64::consts::FRAC_2_PI
    }
}

/// `outline = "seat.svg"`, or loops of points in mm: the outer one first, then the holes.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OutlineSource {
    /// An SVG file, relative to the design file.
    File(String),
    /// The loops themselves: u to the right, v up, the floor at v = 0.
    Loops(Vec<Vec<[f64; 2]>>),
}

/// How section lengths are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The paper's rule (its section 4.2), as a yardstick.
    Paper,
}

impl<'de> Deserialize<'de> for Stack {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Stack, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Stack;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(
                    "\"vertical\", \"horizontal\", \"along-curve\" or { layers = N, inner_mm = MM, outer_mm = MM }",
                )
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Stack, E> {
                Direction::deserialize(serde::de::value::StrDeserializer::new(text)).map(Stack::Toward)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Stack, A::Error> {
                GivenStack::deserialize(MapAccessDeserializer::new(map)).map(Stack::Given)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

impl<'de> Deserialize<'de> for OutlineSource {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<OutlineSource, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = OutlineSource;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("the name of an SVG file, or loops of points in mm: [[[0, 0], [80, 0], [80, 60]]]")
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<OutlineSource, E> {
                Ok(OutlineSource::File(text.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<OutlineSource, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(seq)).map(OutlineSource::Loops)
            }
        }
        deserializer.deserialize_any(Either)
    }
}
