//! What can be chosen for a whole plan, whatever its schemes: rims, creases, triangles, seams.
//!
//! ```text
//!   none        edge-only   edge-and-corner         the same open mesh's rim
//!    (  )         .--.         +--+
//!     ()         (    )        |  |
//! ```
//!
//! Names and meanings are OpenSubdiv's (its `Sdc::Options`). Limit: schemes for which a choice means nothing do not look at it.

/// What happens at the rim of an open mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// As [`Boundary::EdgeOnly`], and faces that touch the rim are refined but not shown.
    None,
    /// A smooth boundary curve, rounded at corners too.
    EdgeOnly,
    /// A smooth boundary curve; vertices with one face are corners and stay.
    #[default]
    EdgeAndCorner,
}

/// How semi-sharp creases soften from level to level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decay {
    /// By one.
    #[default]
    Uniform,
    /// By Chaikin's rule along the crease, then by one.
    Chaikin,
}

/// What Catmull-Clark makes of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TriangleRule {
    /// The same as of other polygons.
    #[default]
    CatmullClark,
    /// Weights that make them smoother.
    Smooth,
}

/// Which parts of a seam texture coordinates keep linear, as OpenSubdiv has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceVarying {
    /// None: smooth everywhere.
    None,
    /// Corners.
    CornersOnly,
    /// Corners, and where three or more regions meet.
    #[default]
    CornersPlus1,
    /// Those, and darts and concave corners.
    CornersPlus2,
    /// All boundaries of regions.
    Boundaries,
    /// Everything is linear.
    All,
}

/// What holds for every scheme of a plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rules {
    /// What happens at the rim of an open mesh.
    pub boundary: Boundary,
    /// How creases soften.
    pub decay: Decay,
    /// What Catmull-Clark makes of triangles.
    pub triangle: TriangleRule,
    /// What seams do to texture coordinates.
    pub face_varying: FaceVarying,
}

/// What the points inside a face depend on, however often it is cut, and so how many levels can be made at once (`patch/`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// More than the faces around it: level by level.
    Far,
    /// The faces around it alone: a face after the other.
    Ring,
    /// The same; and where all of these are quads, four at every vertex, points are those of a uniform bicubic B-spline.
    Spline,
}
