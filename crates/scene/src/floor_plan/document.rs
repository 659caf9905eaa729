//! The JSON of a floor plan, each corner checked where it stands.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};

/// Sides are checked pair by pair.
pub(super) const MOST_POINTS: usize = 5000;

/// Coordinates stay within this, m.
const METRES: f64 = 1e6;

/// What is wrong with `verts` that hold lists of corners.
pub(super) fn lists(bytes: &[u8]) -> Option<String> {
    let document: serde_json::Value = serde_json::from_slice(bytes).ok()?;
    let lists = document.get("verts")?.as_array()?;
    let holds_lists = lists.iter().any(|list| list.get(0).is_some_and(serde_json::Value::is_array));
    holds_lists.then(|| {
        format!(
            "`verts` holds {} lists of corners: must be one outline; give the outer one, and inner walls as sides there and back",
            lists.len()
        )
    })
}

/// The keys that are read.
pub(super) struct Document {
    pub(super) verts: Vec<[f64; 2]>,
}

impl<'de> Deserialize<'de> for Document {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Keys;
        impl<'de> Visitor<'de> for Keys {
            type Value = Document;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("an object with `verts`")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Document, A::Error> {
                let mut verts = None;
                while let Some(key) = map.next_key::<String>()? {
                    if key != "verts" {
                        map.next_value::<serde::de::IgnoredAny>()?;
                    } else if verts.replace(map.next_value::<Verts>()?.0).is_some() {
                        return Err(A::Error::duplicate_field("verts"));
                    }
                }
                verts.map(|verts| Document { verts }).ok_or_else(|| A::Error::missing_field("verts"))
            }
        }
        deserializer.deserialize_map(Keys)
    }
}

/// A list of corners, each checked where it stands, so that a refusal has its line and column.
struct Verts(Vec<[f64; 2]>);

impl<'de> Deserialize<'de> for Verts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Corners;
        impl<'de> Visitor<'de> for Corners {
            type Value = Verts;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a list of corners [x, y] in m")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Verts, A::Error> {
                let mut corners = Vec::new();
                while let Some(corner) = list.next_element::<[f64; 2]>()? {
                    let number = corners.len() + 1;
                    if let Some(far) = corner.into_iter().find(|v| v.abs() > METRES) {
                        let bound = "must lie within 1000000 m of the origin";
                        return Err(A::Error::custom(format!("corner {number}: coordinate {far:e}: {bound}")));
                    }
                    if number > MOST_POINTS {
                        return Err(A::Error::custom(format!(
                            "corner {number}: must be at most {MOST_POINTS} corners"
                        )));
                    }
                    corners.push(corner);
                }
                Ok(Verts(corners))
            }
        }
        deserializer.deserialize_seq(Corners)
    }
}
