//! What building a mesh did to its polygons, in sentences that the page shows as they are.
//!
//! Each kind of thing is told once, with how often it happened and where it happened first, in the file's numbering. An
//! empty report means that the mesh is exactly what the file says.

use std::fmt;

/// What building did beyond copying. Elements are numbered as in the soup.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// One entry for each kind of thing that happened, in a fixed order.
    pub notes: Vec<Note>,
}

/// One kind of thing that building did.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// Positions that became one vertex with another.
    Welded {
        /// How many vertices fewer.
        count: u64,
    },
    /// Positions that no face uses; they are not part of the mesh.
    Isolated {
        /// How many.
        count: u64,
        /// The first.
        first: u32,
    },
    /// Faces with fewer than three different corners; left out.
    Degenerate {
        /// How many.
        count: u64,
        /// The first.
        first: u32,
    },
    /// Faces with repeated corners or spikes that were taken out, the rest kept.
    Repaired {
        /// How many.
        count: u64,
        /// The first.
        first: u32,
    },
    /// Faces turned over so that neighbours agree.
    Turned {
        /// How many.
        count: u64,
        /// The first.
        first: u32,
    },
    /// Edges with more than two faces, cut apart.
    NonManifoldEdges {
        /// How many.
        count: u64,
        /// The first, by its two positions.
        first: [u32; 2],
    },
    /// Vertices where several fans of faces met, split.
    NonManifoldVertices {
        /// How many.
        count: u64,
        /// The first.
        first: u32,
    },
    /// Creases, corners, knots or holes at places where there is no such edge, vertex or face.
    LostMarks {
        /// How many.
        count: u64,
        /// The first, by its two positions (twice the same for a corner; a face's number and [`crate::NONE`] for a hole).
        first: [u32; 2],
    },
    /// Edges cut because the surface has one side only.
    OneSided {
        /// How many.
        count: u64,
        /// The first, by its two positions.
        first: [u32; 2],
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = |n: &u64| if *n == 1 { "" } else { "s" };
        match self {
            Note::Welded { count } => write!(f, "{count} duplicate position{} welded", s(count)),
            Note::Isolated { count, first } => {
                write!(f, "{count} vertex position{} used by no face (first: {first}) left out", s(count))
            }
            Note::Degenerate { count, first } => {
                write!(f, "{count} face{} with fewer than three different corners (first: {first}) left out", s(count))
            }
            Note::Repaired { count, first } => {
                write!(f, "{count} face{} with repeated corners (first: {first}) cleaned", s(count))
            }
            Note::Turned { count, first } => {
                write!(f, "{count} face{} (first: {first}) turned over to agree with the neighbours", s(count))
            }
            Note::NonManifoldEdges { count, first: [a, b] } => {
                write!(f, "{count} edge{} with more than two faces (first: {a}-{b}) cut apart and kept sharp", s(count))
            }
            Note::NonManifoldVertices { count, first } => {
                write!(
                    f,
                    "{count} vertex{} where separate fans of faces meet (first: {first}) split",
                    if *count == 1 { "" } else { " positions" }
                )
            }
            Note::LostMarks { count, first: [a, b] } => {
                let place = match *b {
                    crate::NONE => format!("face {a}"),
                    _ if a == b => format!("vertex {a}"),
                    _ => format!("edge {a}-{b}"),
                };
                write!(f, "{count} mark{} on what the model does not have (first: {place}) left out", s(count))
            }
            Note::OneSided { count, first: [a, b] } => {
                write!(f, "the surface has one side only; cut along {count} edge{} (first: {a}-{b})", s(count))
            }
        }
    }
}

/// An amount of memory, as people read it: "52 kB", "1.4 MB", "18 MB", "1.5 GB".
pub fn memory(bytes: u64) -> String {
    let tenths = |unit: u64| bytes.saturating_add(unit / 20) / (unit / 10);
    match bytes {
        1_000_000_000.. => format!("{}.{} GB", tenths(1_000_000_000) / 10, tenths(1_000_000_000) % 10),
        10_000_000.. => format!("{} MB", bytes.saturating_add(500_000) / 1_000_000),
        100_000.. => format!("{}.{} MB", tenths(1_000_000) / 10, tenths(1_000_000) % 10),
        _ => format!("{} kB", bytes.div_ceil(1_000)),
    }
}

/// A count with commas, as people read it.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (i, d) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(d);
    }
    out
}
