//! The document as the page shows it: the ruler's notches, a line about the model, its facts.
//!
//! Facts that take a walk over the mesh or the model's polygons ([`Facts`]) are made once for each mesh; everything else is
//! cheap enough for every state message, of which an orbiting camera sends five a second.

use limn_document::Document;
use limn_document::numbers::significant;
use limn_document::view::insert_name;
use limn_mesh::{Connectivity, Mesh, Stats};
use limn_mesh::{grouped, memory, order};

use crate::protocol::{Count, Fact, Group, Level};

/// The lowest and the highest number of notches on the ruler.
const NOTCHES: (u32, u32) = (5, 10);

/// The ruler: every level that fits up to nine, and the next one with the reason why it does not.
pub fn ruler(document: &Document) -> Vec<Level> {
    let Some(plan) = document.plan() else { return Vec::new() };
    let highest = document.highest_level();
    let last = (highest + 1).clamp(NOTCHES.0 - 1, NOTCHES.1 - 1).max(plan.level);
    let mut levels = Vec::new();
    for level in 0..=last {
        // Counts that leave 64 bits have no notch.
        let Some(p) = document.predict(level) else { break };
        let allowed = level <= highest;
        let (faces, size) = (grouped(p.counts.faces), memory(p.bytes));
        let title = match (level, allowed) {
            (0, _) => format!("As loaded: {faces} faces, {} vertices", grouped(p.counts.vertices)),
            (_, true) => format!("Level {level}: {faces} faces, {} vertices, {size}", grouped(p.counts.vertices)),
            (_, false) => {
                format!(
                    "Level {level} would make {faces} faces and take {size}; the budget is {}",
                    memory(document.budget())
                )
            }
        };
        let count = Count { vertices: p.counts.vertices, edges: p.counts.edges, faces: p.counts.faces, bytes: p.bytes };
        levels.push(Level {
            level,
            label: level.to_string(),
            count,
            allowed,
            title,
            command: format!("level {level}"),
        });
    }
    levels
}

/// What a walk over the mesh and the model's polygons tells.
pub struct Facts {
    /// Loops, components, genus, bounds.
    pub stats: Stats,
    /// "304 triangles", "53 quads, 1 hexagon".
    polygons: String,
    /// "1,450 quads": the most frequent kind.
    most: String,
    /// Whether the file has triangles.
    pub triangles: bool,
    /// How many of the file's faces are in each group.
    groups: Vec<u64>,
}

impl Facts {
    /// Walks the mesh and the polygons of a document. Cost: linear.
    pub fn of(document: &Document, mesh: &Mesh) -> Facts {
        let t = &mesh.topology;
        let mut kinds: Vec<(u32, u64)> = Vec::new();
        for f in 0..t.faces() {
            let n = t.face_half_edges(f).len() as u32;
            match kinds.iter_mut().find(|k| k.0 == n) {
                Some(kind) => kind.1 += 1,
                None => kinds.push((n, 1)),
            }
        }
        // The most frequent first.
        let mut kinds: Vec<(u64, u32)> = kinds.into_iter().map(|(n, count)| (!count, n)).collect();
        order::sort(&mut kinds);
        let text = |&(count, n): &(u64, u32)| {
            let count = !count;
            let name = match n {
                3 => "triangle".to_owned(),
                4 => "quad".to_owned(),
                5 => "pentagon".to_owned(),
                6 => "hexagon".to_owned(),
                n => format!("{n}-gon"),
            };
            format!("{} {name}{}", grouped(count), if count == 1 { "" } else { "s" })
        };
        let mut polygons = kinds.iter().take(4).map(text).collect::<Vec<_>>().join(", ");
        if kinds.len() > 4 {
            polygons.push_str(" and others");
        }
        let most = match kinds.as_slice() {
            [one] => text(one),
            _ => format!("{} faces", grouped(u64::from(t.faces()))),
        };
        let mut facts = Facts { stats: mesh.stats(), polygons, most, triangles: false, groups: Vec::new() };
        if let Some(model) = document.model() {
            facts.triangles = model.soup.offsets.windows(2).any(|w| matches!(w, &[a, b] if b - a == 3));
            facts.groups = vec![0; model.groups.len()];
            for &group in &model.soup.face_groups {
                if let Some(count) = facts.groups.get_mut(group as usize) {
                    *count += 1;
                }
            }
        }
        facts
    }

    /// The groups that can be hidden: none if there is one only.
    pub fn groups(&self, document: &Document) -> Vec<Group> {
        let (Some(model), view) = (document.model(), document.view()) else { return Vec::new() };
        if model.groups.len() < 2 {
            return Vec::new();
        }
        model
            .groups
            .iter()
            .zip(&self.groups)
            .map(|(name, &faces)| {
                let hidden = view.hides(name);
                let mut names: Vec<String> = view.hidden.iter().filter(|n| *n != name).cloned().collect();
                if !hidden {
                    insert_name(&mut names, name.clone());
                }
                let set = limn_document::ViewSet::Hide(names);
                let command = format!("view {}", limn_document::words::quote(&set.to_string()));
                Group { name: name.clone(), faces, hidden, command }
            })
            .collect()
    }

    /// One line under the model's name.
    pub fn summary(&self) -> String {
        let Stats { boundary_loops, components, genus, .. } = self.stats;
        let mut line = self.most.clone();
        if components > 1 {
            line.push_str(&format!(", {} parts", grouped(components)));
        }
        match boundary_loops {
            0 => line.push_str(", closed"),
            1 => line.push_str(", open"),
            n => line.push_str(&format!(", {} open rims", grouped(n))),
        }
        match genus {
            None => line.push_str(", one-sided"),
            Some(0) => {}
            Some(genus) => line.push_str(&format!(", genus {}", grouped(genus))),
        }
        line
    }

    /// Rows of the report.
    pub fn rows(&self, document: &Document) -> Vec<Fact> {
        let Some(mesh) = document.mesh() else { return Vec::new() };
        let (counts, s) = (mesh.counts(), &self.stats);
        let [low, high] = s.bounds;
        let [x, y, z] = [(low[0], high[0]), (low[1], high[1]), (low[2], high[2])]
            .map(|(low, high)| significant(f64::from(high - low), 4));
        let mut rows = vec![
            Fact { label: "Vertices", value: grouped(counts.vertices) },
            Fact { label: "Edges", value: grouped(counts.edges) },
            Fact { label: "Faces", value: self.polygons.clone() },
            Fact { label: "Open rims", value: grouped(s.boundary_loops) },
            Fact { label: "Parts", value: grouped(s.components) },
            Fact { label: "Genus", value: s.genus.map_or("none, it has one side only".to_owned(), grouped) },
            Fact { label: "Size", value: format!("{x} × {y} × {z}") },
        ];
        let model = document.model();
        let named = [
            ("Groups", model.map_or(0, |m| m.groups.len())),
            ("Materials", model.map_or(0, |m| m.materials.len())),
            ("Pictures", model.map_or(0, |m| m.images.len())),
        ];
        rows.extend(named.into_iter().filter(|n| n.1 > 0).map(|(label, n)| Fact { label, value: grouped(n as u64) }));
        let carries = [("vertex colours", !mesh.colors.is_empty()), ("texture coordinates", mesh.uv.is_some())];
        let carries: Vec<_> = carries.into_iter().filter(|c| c.1).map(|c| c.0).collect();
        if !carries.is_empty() {
            rows.push(Fact { label: "Carries", value: carries.join(", ") });
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(text: &str, budget: u64) -> Document {
        let mut document = Document::new(budget);
        for line in text.lines() {
            document.run(line).unwrap();
        }
        document
    }

    #[test]
    fn notches_say_what_fits_and_why_not() {
        let document = open("open builtin:cube", 200_000);
        let levels = ruler(&document);
        assert_eq!(levels.iter().map(|l| l.count.faces).collect::<Vec<_>>()[..3], [6, 24, 96]);
        let highest = document.highest_level() as usize;
        assert_eq!(levels.len(), highest + 2);
        assert!(levels[highest].allowed && !levels[highest + 1].allowed);
        assert!(levels[highest + 1].title.ends_with("the budget is 0.2 MB"), "{}", levels[highest + 1].title);
        assert_eq!(levels[0].title, "As loaded: 6 faces, 8 vertices");
        assert_eq!(ruler(&open("open builtin:cube", u64::MAX)).len(), 10);
        assert!(ruler(&Document::new(1)).is_empty());
    }

    #[test]
    fn a_model_in_one_line() {
        let line = |name: &str| {
            let document = open(&format!("open builtin:{name}"), 1 << 30);
            Facts::of(&document, document.mesh().unwrap()).summary()
        };
        assert_eq!(line("cube"), "6 quads, closed");
        assert_eq!(line("torus"), "128 quads, closed, genus 1");
        assert_eq!(line("grid"), "64 quads, open");
        assert_eq!(line("moebius"), "16 quads, open, one-sided");
        assert_eq!(line("mouse"), "54 faces, closed");
        let document = open("open builtin:mouse", 1 << 30);
        let rows = Facts::of(&document, document.mesh().unwrap()).rows(&document);
        let row = |label: &str| rows.iter().find(|r| r.label == label).unwrap().value.clone();
        assert_eq!(row("Faces"), "53 quads, 1 hexagon");
        assert_eq!(row("Edges"), "109");
    }
}
