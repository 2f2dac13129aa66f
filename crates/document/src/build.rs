//! From the model as read to the mesh that a scheme refines.
//!
//! ```text
//!   Model ── quads on ──► soup ── triangulate, center, scale in order ──► soup ── weld ──► Mesh   (polygons)
//!                                                                           └─ triangulate ──► Mesh (for a scheme of triangles)
//! ```
//!
//! The journalled edits change polygons, never topology, so vertices keep the file's numbers. Both meshes are built at
//! most once for each state of the document and shared by everything that needs them. Cost: linear in corners, each step;
//! nothing is copied before the first step that changes something.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use limn_formats::Model;
use limn_mesh::pair::{ASK_BELOW, PairReport, pair_triangles};
use limn_mesh::{Honours, Mesh, Note, Soup, TopologyError, Weld, triangulate_soup};

use crate::camera::Bounds;
use crate::command::CreaseWhere;
use crate::numbers::text_single;

/// A change of the model, in the order in which it was made.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Edit {
    Triangulate,
    Center,
    Scale(Option<f32>),
    Crease(CreaseWhere, f32),
    Corner(u32, f32),
    Hole(u32),
    Knot([u32; 2], bool, f32),
}

/// One sentence about the model for the person who opened it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// The sentence, with a capital and a full stop.
    pub text: String,
    /// Whether it is ordinary, so that a page may fold it away.
    pub minor: bool,
}

impl Remark {
    pub(crate) fn new(text: &str, minor: bool) -> Remark {
        Remark { text: crate::words::sentence(text), minor }
    }
}

/// A mesh with what it was made from.
#[derive(Debug)]
pub(crate) struct Built {
    pub mesh: Arc<Mesh>,
    /// The polygons that `mesh.face_source` and `mesh.vertex_source` count; none if they are the model's own.
    soup: Option<Soup>,
    pub remarks: Vec<Remark>,
    pub bounds: Bounds,
    /// Which marks the mesh has, kept because every state of a page asks.
    pub marks: Honours,
}

impl Built {
    pub fn soup<'a>(&'a self, model: &'a Model) -> &'a Soup {
        self.soup.as_ref().unwrap_or(&model.soup)
    }

    fn new(soup: Option<Soup>, model: &Model, weld: Weld, mut remarks: Vec<Remark>) -> Result<Built, TopologyError> {
        let (mesh, report) = Mesh::build(soup.as_ref().unwrap_or(&model.soup), weld)?;
        // Welding is what the format asked for; everything else is worth a look.
        remarks.extend(report.notes.iter().map(|n| Remark::new(&n.to_string(), matches!(n, Note::Welded { .. }))));
        let bounds = Bounds::of(&mesh.positions).unwrap_or_default();
        Ok(Built { marks: mesh.marks(), mesh: Arc::new(mesh), soup, remarks, bounds })
    }
}

/// The meshes of one state of the model.
#[derive(Debug)]
pub(crate) struct Base {
    pub polygons: Arc<Built>,
    triangles: OnceLock<Arc<Built>>,
    weld: Weld,
}

/// Why the pipeline cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The polygons make no mesh.
    #[error("{0}")]
    Topology(#[from] TopologyError),
    /// Coordinates would leave the range of 32-bit floats.
    #[error("scale {} would take coordinates out of range; choose a factor nearer to 1", text_single(*.0))]
    Scale(f32),
    /// All points are in one place.
    #[error("the model has no extent to scale to 1; give a factor, as in `scale 2`")]
    Flat,
}

impl Base {
    /// Runs the pipeline.
    pub fn build(model: &Model, quads: bool, edits: &[Edit], weld: Weld) -> Result<Base, BuildError> {
        let mut remarks = Vec::new();
        let mut soup = Cow::Borrowed(&model.soup);
        if quads {
            // Formats that repeat vertices along seams would keep triangles apart there: weld first.
            let class = Mesh::build(&soup, weld)?.0.weld_class;
            for corner in &mut soup.to_mut().corners {
                *corner = class.get(*corner as usize).copied().unwrap_or(*corner);
            }
            let (paired, remark) = pair(&soup);
            remarks.push(remark);
            soup = Cow::Owned(paired);
        }
        for edit in edits {
            match edit {
                Edit::Triangulate => soup = Cow::Owned(triangulate_soup(&soup).0),
                Edit::Center => {
                    if let Some(bounds) = used_bounds(&soup) {
                        let [x, y, z] = bounds.center().to_array();
                        for p in &mut soup.to_mut().positions {
                            *p = [p[0] - x, p[1] - y, p[2] - z];
                        }
                    }
                }
                Edit::Scale(factor) => scale(soup.to_mut(), *factor)?,
                Edit::Crease(CreaseWhere::Chain(vertices), sharpness) => {
                    let edges = vertices.windows(2).filter_map(|w| <[u32; 2]>::try_from(w).ok());
                    soup.to_mut().marks.creases.extend(edges.map(|edge| (edge, *sharpness)));
                }
                Edit::Crease(CreaseWhere::Angle(degrees), sharpness) => {
                    let edges = Mesh::build(&soup, weld)?.0.edges_bent_by_more(f64::from(*degrees));
                    soup.to_mut().marks.creases.extend(edges.into_iter().map(|edge| (edge, *sharpness)));
                }
                Edit::Crease(CreaseWhere::Everywhere, _) => soup.to_mut().marks.creases.clear(),
                Edit::Corner(vertex, sharpness) => soup.to_mut().marks.corners.push((*vertex, *sharpness)),
                Edit::Hole(face) => soup.to_mut().marks.holes.push(*face),
                Edit::Knot([a, b], both, interval) => {
                    let knots = &mut soup.to_mut().marks.knots;
                    knots.push(([*a, *b], *interval));
                    knots.extend(both.then_some(([*b, *a], *interval)));
                }
            }
        }
        let own = match soup {
            Cow::Borrowed(_) => None,
            Cow::Owned(soup) => Some(soup),
        };
        let polygons = Arc::new(Built::new(own, model, weld, remarks)?);
        Ok(Base { polygons, triangles: OnceLock::new(), weld })
    }

    /// The mesh with every face cut into triangles; the polygons' own if they are all triangles.
    pub fn triangles(&self, model: &Model) -> Result<Arc<Built>, BuildError> {
        if self.polygons.mesh.is_triangles() {
            return Ok(self.polygons.clone());
        }
        if let Some(built) = self.triangles.get() {
            return Ok(built.clone());
        }
        let (soup, cut) = triangulate_soup(self.polygons.soup(model));
        let faces = if cut == 1 { "face was" } else { "faces were" };
        let remark = format!("{cut} {faces} cut into triangles, which is what the scheme refines");
        let remarks = vec![Remark::new(&remark, false)];
        let built = Arc::new(Built::new(Some(soup), model, self.weld, remarks)?);
        Ok(self.triangles.get_or_init(|| built).clone())
    }
}

/// The box of the positions that faces use.
fn used_bounds(soup: &Soup) -> Option<Bounds> {
    Bounds::of(soup.corners.iter().filter_map(|&c| soup.positions.get(c as usize)))
}

fn scale(soup: &mut Soup, factor: Option<f32>) -> Result<(), BuildError> {
    let factor = match factor {
        Some(factor) => factor,
        None => {
            let sides = used_bounds(soup).map(|b| (b.max - b.min).max_element());
            sides.map(f32::recip).filter(|f| *f > 0.0 && f.is_finite()).ok_or(BuildError::Flat)?
        }
    };
    let finite = |p: &[f32; 3]| p.iter().all(|x| x.is_finite());
    for p in &mut soup.positions {
        let scaled = p.map(|x| x * factor);
        if finite(p) && !finite(&scaled) {
            return Err(BuildError::Scale(factor));
        }
        *p = scaled;
    }
    Ok(())
}

fn pair(soup: &Soup) -> (Soup, Remark) {
    let (paired, report) = pair_triangles(soup);
    let PairReport { quads, triangles_left, confidence } = report;
    let text = match (quads, triangles_left) {
        (0, 0) => "there are no triangles to pair".to_owned(),
        (0, left) => format!("none of the {left} triangles could be paired to quads"),
        (quads, left) => format!(
            "{quads} pairs of triangles became quads, {left} triangles are left; the pairing is {} % certain",
            (confidence * 100.0).round() as u32
        ),
    };
    // What is sure and complete needs nobody's attention.
    let sure = quads > 0 && triangles_left == 0 && confidence >= ASK_BELOW;
    (paired, Remark::new(&text, sure))
}
