//! What `info` tells: counts of the present level, what kind of surface it is, and what there is to remark.
//!
//! The JSON form is one object with fixed keys in a fixed order, for other programs:
//!
//! ```json
//! {"name":"cube","source":"builtin:cube","scheme":"catmull-clark","level":1,"limit":false,"vertices":26,"edges":48,"faces":24,
//!  "boundary_loops":0,"components":1,"genus":0,"orientable":true,
//!  "bounds":{"min":[-1,-1,-1],"max":[1,1,1]},"bytes":816,"warnings":[]}
//! ```
//!
//! Boundary loops, components and genus are those of the mesh after it was made manifold; refinement does not change them.
//! The genus of a surface of several components is the sum of theirs, an open one counts as if each boundary loop were
//! capped by a disc (from Euler's V - E + F = 2C - 2g - b), and a surface with one side only has none: `null`, and
//! `orientable` is false. The writer here is a few lines because the same code runs in the page, where a JSON library would
//! be a tenth of its size.

use std::fmt::Write;
use std::sync::Arc;

use limn_mesh::{Counts, Family, Honours, Stats, refine::grouped};

use crate::build::Remark;
use crate::camera::Bounds;
use crate::document::Document;
use crate::numbers::text_single;

/// Facts about the present level. See the module's text.
#[derive(Clone, Debug, PartialEq)]
pub struct Info {
    /// The model's name.
    pub name: String,
    /// Where it came from, as `open` has it.
    pub source: String,
    /// The scheme's id.
    pub scheme: &'static str,
    /// The level.
    pub level: u32,
    /// Whether its points are in the limit.
    pub limit: bool,
    /// Counts of that level.
    pub counts: Counts,
    /// Boundary loops, components and genus.
    pub stats: Stats,
    /// The box of the level's points, if it has any that are finite.
    pub bounds: Bounds,
    /// Bytes that refining to this level takes.
    pub bytes: u64,
    /// One sentence each.
    pub warnings: Vec<String>,
}

impl Document {
    /// Facts about the present level; none without a model, or if its counts leave 64 bits. `points` are the level's points,
    /// which the host has if it has refined: without them the bounds are those of level 0. Cost: linear in the mesh and the
    /// points.
    pub fn info(&self, points: Option<&[[f32; 3]]>) -> Option<Info> {
        let (mesh, plan, model) = (self.mesh()?, self.plan()?, self.model()?);
        let prediction = self.predict(plan.level)?;
        Some(Info {
            name: model.name.clone(),
            source: self.source()?.to_string(),
            scheme: plan.scheme.info.id,
            level: plan.level,
            limit: plan.limit,
            counts: prediction.counts,
            stats: mesh.stats(),
            bounds: points.and_then(Bounds::of).unwrap_or_else(|| self.bounds()),
            bytes: prediction.bytes,
            warnings: self.remarks().into_iter().map(|r| r.text).collect(),
        })
    }

    /// What there is to say about the model: from the file, from building the mesh, from what was changed for the scheme.
    pub fn remarks(&self) -> Vec<Remark> {
        let Some(state) = &self.state else { return Vec::new() };
        let mut remarks = state.imported.to_vec();
        remarks.extend(state.adapted.clone());
        let polygons = &state.base.polygons.remarks;
        remarks.extend(polygons.iter().cloned());
        if !Arc::ptr_eq(&state.base.polygons, &state.built) {
            // Building the triangles meets the same trouble again: only what is new is said.
            remarks.extend(state.built.remarks.iter().filter(|r| !polygons.contains(r)).cloned());
        }
        if let Some((scheme, honours)) = state.plan().ignores(state.built.marks) {
            remarks.push(Remark::new(&ignored(&scheme.info, honours), false));
        }
        remarks
    }
}

/// What a scheme leaves out of creases and corners.
fn ignored(scheme: &limn_mesh::Info, honours: Honours) -> String {
    let name = scheme.name;
    let others = "Catmull–Clark and Loop honour all";
    match honours {
        Honours { creases: true, .. } => {
            format!("of creases and corners {name} honours those that are infinitely sharp; {others}")
        }
        _ if scheme.family == Family::Dual => format!(
            "creases and corners are not honoured by {name}; Catmull–Clark and Loop do, and `scheme nurss` makes a crease \
             of a row of vertices A by `knot A-B 0` to every B beside it"
        ),
        _ => format!("creases and corners are not honoured by {name}; Catmull–Clark and Loop do"),
    }
}

impl Info {
    /// One JSON object without line breaks.
    pub fn json(&self) -> String {
        let mut out = String::from("{\"name\":");
        string(&self.name, &mut out);
        out.push_str(",\"source\":");
        string(&self.source, &mut out);
        out.push_str(",\"scheme\":");
        string(self.scheme, &mut out);
        let Counts { vertices, edges, faces, .. } = self.counts;
        let Stats { boundary_loops, components, genus, .. } = self.stats;
        // Writing to a string cannot fail.
        let _ = write!(out, ",\"level\":{},\"limit\":{},\"vertices\":{vertices}", self.level, self.limit);
        let _ = write!(out, ",\"edges\":{edges},\"faces\":{faces}");
        let _ = write!(out, ",\"boundary_loops\":{boundary_loops},\"components\":{components},\"genus\":");
        match genus {
            Some(genus) => _ = write!(out, "{genus},\"orientable\":true"),
            None => out.push_str("null,\"orientable\":false"),
        }
        let [min, max] = self.corners(",");
        let _ = write!(out, ",\"bounds\":{{\"min\":[{min}],\"max\":[{max}]}}");
        let _ = write!(out, ",\"bytes\":{},\"warnings\":[", self.bytes);
        for (i, warning) in self.warnings.iter().enumerate() {
            if i > 0 {
                out.push(',');
            }
            string(warning, &mut out);
        }
        out.push_str("]}");
        out
    }

    /// The box's two corners, their coordinates joined.
    fn corners(&self, between: &str) -> [String; 2] {
        [self.bounds.min, self.bounds.max].map(|corner| corner.to_array().map(text_single).join(between))
    }

    /// The same for people, a line a fact, without the warnings.
    pub fn text(&self) -> String {
        let Counts { vertices, edges, faces, .. } = self.counts;
        let Stats { boundary_loops, components, genus, .. } = self.stats;
        let genus = genus.map_or_else(|| "none (the surface has one side only)".to_owned(), |g| g.to_string());
        let [min, max] = self.corners(" ");
        format!(
            "model           {} ({})\n\
             scheme          {}, level {}{}\n\
             vertices        {}\n\
             edges           {}\n\
             faces           {}\n\
             boundary loops  {boundary_loops}\n\
             components      {components}\n\
             genus           {genus}\n\
             bounds          {min} to {max}\n\
             memory          {} bytes\n",
            self.name,
            self.source,
            self.scheme,
            self.level,
            if self.limit { ", in the limit" } else { "" },
            grouped(vertices),
            grouped(edges),
            grouped(faces),
            grouped(self.bytes),
        )
    }
}

/// Appends `text` as a JSON string (RFC 8259).
fn string(text: &str, out: &mut String) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            c if (c as u32) < 0x20 => _ = write!(out, "\\u{:04x}", c as u32),
            c => out.push(c),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_are_escaped() {
        let mut out = String::new();
        string("a\"b\\c\n\u{1}é", &mut out);
        assert_eq!(out, "\"a\\\"b\\\\c\\n\\u0001é\"");
    }
}
