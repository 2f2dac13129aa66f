//! The compute kernels of refinement: their text, put together of parts.
//!
//! A kernel is one entry point with constants before its text (how many sides faces have, whether it is level 0, whether anything
//! is creased), so that a level's arithmetic has no branch on what cannot be. Bind groups: 0 is what is read of the level, 1 what is
//! computed on. At most eight storage buffers together, which is what every WebGPU device has.

use bytemuck::{Pod, Zeroable};

use crate::patch::Team;
use crate::wgsl::wgsl;

/// Invocations a workgroup, as the shaders have it.
pub(crate) const GROUP: u32 = 256;

/// The numbers of a dispatch: `struct Level` of `work.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Level {
    pub half_edges: u32,
    pub vertices: u32,
    pub faces: u32,
    pub first_face: u32,
    pub first_edge: u32,
    pub owned: u32,
    pub middle: u32,
    pub step: u32,
    pub corners: u32,
    pub chaikin: u32,
    pub marked: u32,
    pub first: u32,
    pub end: u32,
    pub a: f32,
    pub b: f32,
    pub rest: u32,
}

/// How a level's half-edges come of those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Split {
    Quad,
    Triangle,
    Sqrt3,
    Dual,
}

impl Split {
    const ALL: [Split; 4] = [Split::Quad, Split::Triangle, Split::Sqrt3, Split::Dual];

    /// Whether it takes triangles only.
    pub fn is_of_triangles(self) -> bool {
        matches!(self, Split::Triangle | Split::Sqrt3)
    }

    /// Whether it takes closed meshes only: what it makes of rims is no arithmetic.
    pub fn is_of_closed(self) -> bool {
        matches!(self, Split::Sqrt3 | Split::Dual)
    }
}

/// What a kernel of the fused gather is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Variant {
    pub split: Split,
    /// Level 0.
    pub base: bool,
    pub creased: bool,
    /// 0 linear; 1 Catmull-Clark or Loop, 2 Butterfly, 3 modified Butterfly. Of the dual split 1 is the midpoint variant.
    pub scheme: u32,
}

/// Everything that is dispatched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kernel {
    /// The points of the next level.
    Points(Variant),
    /// Its half-edges.
    Split(Variant),
    /// The normals of the last level, from the half-edges of the one before.
    Normals(Variant),
    /// Its faces: indices of quads, corners of triangles.
    Faces(Variant),
    /// Corners of quads.
    QuadCorners(Variant),
    /// What corners carry, from values on these half-edges; `scheme` 1 for colours, 0 for texture coordinates.
    Extras(Variant),
    /// Points from rows; whether constants move them.
    Rows { moved: bool },
    /// How large these constants are for the cage as it is.
    Measure,
    /// Normals of listed faces.
    ListedFaces,
    /// Normals of vertices from these.
    ListedNormals,
    /// Normals of vertices by tangents of the limit.
    LimitNormals,
    /// Corners of triangles with both.
    ListedCorners,
    /// Colours in four bytes.
    Colors,
    /// The box of the points.
    Bounds,
    /// Points and normals of the last levels at once, of patches that are cut so often.
    Patches(Variant, u32),
    /// Normals, faces or corners of quads where the half-edges of the last level but one are not there.
    Climbing(Finish, Variant),
}

/// What can be made by climbing to half-edges that are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Finish {
    Normals,
    Faces,
    QuadCorners,
}

impl Finish {
    /// The same where half-edges are there.
    pub fn kernel(self, variant: Variant) -> Kernel {
        match self {
            Finish::Normals => Kernel::Normals(variant),
            Finish::Faces => Kernel::Faces(variant),
            Finish::QuadCorners => Kernel::QuadCorners(variant),
        }
    }
}

/// How a buffer is bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// The numbers of the dispatch.
    Uniform,
    /// Read alone.
    Read,
    /// Read and written.
    Write,
}

impl Kernel {
    /// One of each text there is.
    fn all() -> Vec<Kernel> {
        let mut all = vec![
            Kernel::Rows { moved: false },
            Kernel::Rows { moved: true },
            Kernel::Measure,
            Kernel::ListedFaces,
            Kernel::ListedNormals,
            Kernel::LimitNormals,
            Kernel::ListedCorners,
            Kernel::Colors,
            Kernel::Bounds,
        ];
        for (split, bits) in Split::ALL.into_iter().flat_map(|split| (0..4).map(move |bits| (split, bits))) {
            let [base, creased] = [0, 1].map(|b| bits >> b & 1 == 1);
            let variant = |scheme| Variant { split, base, creased, scheme };
            match split {
                Split::Quad => all.extend((0..2).map(|scheme| Kernel::Points(variant(scheme)))),
                Split::Triangle => all.extend((0..4).map(|scheme| Kernel::Points(variant(scheme)))),
                // It knows no creases, and its levels are all alike.
                Split::Sqrt3 if bits > 0 => continue,
                Split::Sqrt3 => all.push(Kernel::Points(variant(0))),
                Split::Dual if creased => continue,
                Split::Dual => all.extend((0..2).map(|scheme| Kernel::Points(variant(scheme)))),
            }
            all.push(Kernel::Split(variant(0)));
            if !creased {
                all.extend([Kernel::Normals(variant(0)), Kernel::Faces(variant(0))]);
            }
            if !creased && matches!(split, Split::Quad | Split::Triangle) {
                all.extend([Kernel::Extras(variant(0)), Kernel::Extras(variant(1))]);
            }
            if !creased && split == Split::Quad {
                all.push(Kernel::QuadCorners(variant(0)));
            }
            if bits == 0 && matches!(split, Split::Quad | Split::Triangle) {
                all.extend((2..=5).map(|depth| Kernel::Patches(variant(0), depth)));
                all.extend([Finish::Normals, Finish::Faces].map(|what| Kernel::Climbing(what, variant(0))));
            }
            if bits == 0 && split == Split::Quad {
                all.push(Kernel::Climbing(Finish::QuadCorners, variant(0)));
            }
        }
        all
    }

    /// The name of its entry point.
    pub fn entry(self) -> &'static str {
        match self {
            Kernel::Points(_) | Kernel::Rows { .. } => "points",
            Kernel::Measure => "measure",
            Kernel::Split(_) => "split",
            Kernel::Normals(_) | Kernel::ListedNormals => "normals",
            Kernel::LimitNormals => "limit_normals",
            Kernel::ListedCorners => "listed_corners",
            Kernel::Colors => "colors",
            Kernel::QuadCorners(_) => "quad_corners",
            Kernel::Extras(_) => "extras",
            Kernel::Bounds => "bounds",
            Kernel::Faces(_) | Kernel::ListedFaces => "faces",
            Kernel::Patches(..) => "patches",
            Kernel::Climbing(what, variant) => what.kernel(variant).entry(),
        }
    }

    /// Elements that a workgroup takes on.
    pub fn group(self) -> u32 {
        match self {
            Kernel::Patches(variant, depth) => Team::new(variant.split, depth).teams,
            _ => GROUP,
        }
    }

    /// Its text, as it is handed to the device.
    pub fn source(self) -> String {
        let work = wgsl!("shaders/work.wgsl");
        let variant = match self {
            Kernel::Rows { moved } => {
                let none = "fn moved(i: u32) -> vec4<f32> { return vec4(0.0); }\n";
                let moves = if moved { wgsl!("shaders/moved.wgsl") } else { none };
                return format!("{work}{moves}{}", wgsl!("shaders/rows.wgsl"));
            }
            Kernel::ListedFaces | Kernel::ListedNormals | Kernel::ListedCorners => {
                return format!("{work}{}{}", wgsl!("shaders/pack.wgsl"), wgsl!("shaders/listed.wgsl"));
            }
            Kernel::Measure => return format!("{work}{}", wgsl!("shaders/scale.wgsl")),
            Kernel::LimitNormals => {
                return format!("{work}{}{}", wgsl!("shaders/pack.wgsl"), wgsl!("shaders/limit.wgsl"));
            }
            Kernel::Colors => {
                return format!("{work}{}{}", wgsl!("shaders/srgb.wgsl"), wgsl!("shaders/colors.wgsl"));
            }
            Kernel::Bounds => return format!("{work}{}", wgsl!("shaders/bounds.wgsl")),
            Kernel::Points(v) | Kernel::Split(v) | Kernel::Normals(v) | Kernel::Faces(v) => v,
            Kernel::QuadCorners(v) | Kernel::Extras(v) | Kernel::Patches(v, _) | Kernel::Climbing(_, v) => v,
        };
        let Variant { split, base, creased, scheme } = variant;
        let sides = match (split, base) {
            (Split::Triangle | Split::Sqrt3, _) => 3,
            (Split::Quad, true) | (Split::Dual, _) => 0,
            (Split::Quad, false) => 4,
        };
        let tables = base || split == Split::Dual;
        let held = match self {
            Kernel::Climbing(..) => wgsl!("shaders/climb.wgsl"),
            _ => wgsl!("shaders/stored.wgsl"),
        };
        let head = format!(
            "const SIDES = {sides}u;\nconst BASE = {tables};\nconst FIRST = {base};\nconst CREASED = {creased};\nconst SCHEME = {scheme}u;\n{work}{}{held}",
            wgsl!("shaders/level.wgsl")
        );
        let creases = wgsl!("shaders/creases.wgsl");
        let draw = [wgsl!("shaders/pack.wgsl"), wgsl!("shaders/corner.wgsl")].concat();
        let turns = wgsl!("shaders/turns.wgsl");
        match (self, split) {
            (Kernel::Points(_), Split::Quad) => head + creases + wgsl!("shaders/quads.wgsl"),
            (Kernel::Points(_), Split::Triangle) => head + creases + wgsl!("shaders/triangles.wgsl"),
            (Kernel::Points(_), Split::Sqrt3) => head + wgsl!("shaders/sqrt3.wgsl"),
            (Kernel::Points(_), Split::Dual) => head + wgsl!("shaders/dual.wgsl"),
            (Kernel::Patches(_, depth), _) => {
                Team::new(split, depth).constants() + &head + wgsl!("shaders/pack.wgsl") + wgsl!("shaders/patches.wgsl")
            }
            (Kernel::Extras(_), _) => {
                let quads = split == Split::Quad;
                let [srgb, extras] = [wgsl!("shaders/srgb.wgsl"), wgsl!("shaders/extras.wgsl")];
                format!("const QUADS = {quads};\n{head}{srgb}{extras}")
            }
            (Kernel::Split(_), Split::Quad) => head + creases + wgsl!("shaders/split_quads.wgsl"),
            (Kernel::Split(_), Split::Triangle) => head + creases + wgsl!("shaders/split_triangles.wgsl"),
            (Kernel::Split(_), Split::Sqrt3) => head + wgsl!("shaders/split_sqrt3.wgsl"),
            (Kernel::Split(_), Split::Dual) => head + turns + wgsl!("shaders/split_dual.wgsl"),
            (_, Split::Quad) => head + &draw + wgsl!("shaders/finish_quads.wgsl"),
            (_, Split::Triangle) => head + &draw + wgsl!("shaders/finish_triangles.wgsl"),
            (_, Split::Sqrt3) => head + &draw + wgsl!("shaders/finish_sqrt3.wgsl"),
            (_, Split::Dual) => head + turns + &draw + wgsl!("shaders/finish_dual.wgsl"),
        }
    }

    /// How the buffers of both groups are bound, by rising numbers.
    pub fn access(self) -> [&'static [Access]; 2] {
        use Access::{Read, Uniform, Write};
        const LEVEL: &[Access] = &[Uniform, Read, Read, Read, Read, Read];
        match self {
            Kernel::Points(_) => [LEVEL, &[Read, Write]],
            Kernel::Split(_) => [LEVEL, &[Write, Write, Write]],
            Kernel::Normals(_) => [LEVEL, &[Write]],
            Kernel::Faces(_) | Kernel::QuadCorners(_) => [LEVEL, &[Write, Write]],
            Kernel::Extras(_) => [LEVEL, &[Read, Write]],
            Kernel::Rows { moved: false } => [&[Uniform, Read, Read], &[Read, Write]],
            Kernel::Rows { moved: true } => [&[Uniform, Read, Read, Read], &[Read, Write, Read]],
            Kernel::Measure => [&[Uniform, Read], &[Read, Write]],
            Kernel::ListedFaces | Kernel::ListedNormals => [&[Uniform, Read, Read, Read, Read], &[Write, Write]],
            Kernel::LimitNormals => [&[Uniform, Read, Read], &[Read, Write]],
            Kernel::Colors | Kernel::Bounds => [&[Uniform], &[Read, Write]],
            Kernel::Patches(..) => [LEVEL, &[Read, Write]],
            Kernel::Climbing(what, variant) => what.kernel(variant).access(),
            Kernel::ListedCorners => [&[Uniform, Read, Read, Read, Read, Read], &[Write, Write, Write]],
        }
    }
}

/// The text of every kernel with a name, for tests that validate them.
pub(crate) fn sources() -> Vec<(String, String)> {
    Kernel::all().into_iter().map(|k| (format!("{k:?}"), k.source())).collect()
}
