//! A level of `limn-mesh` as what is packed.

use crate::data::{Faces, Part, SurfaceData};
use limn_mesh::{Faces as Listed, Refined, triangulate};

/// Calls `with` with the surface of a level. `part_of` has the part of each face of the file and may be empty, as may `parts`.
/// `force_corners` is [`SurfaceData::force_corners`].
pub fn level<T>(
    refined: &Refined,
    normals: &[[f32; 3]],
    (parts, part_of): (&[Part], &[u32]),
    force_corners: bool,
    with: impl FnOnce(&SurfaceData<'_>) -> T,
) -> T {
    let faces = match &refined.faces {
        Listed::Polygons { offsets, corners } => Faces::Polygons { offsets, corners },
        Listed::Triangles(corners) => Faces::Triangles(corners),
        Listed::Quads(corners) => Faces::Quads(corners),
    };
    let part = |f: usize| part_of.get(refined.face_source(f as u32) as usize).copied().unwrap_or(0);
    let mut data = SurfaceData::new(&refined.points, normals, faces);
    data.parents = refined.parents();
    data.uv = refined.uv.as_ref().map(|uv| (&uv.values[..], &uv.corners[..]));
    data.colors = &refined.colors;
    data.parts = parts;
    data.part_of = (!part_of.is_empty()).then_some(&part);
    let kind_of = |f: usize| refined.kinds.get(f).map_or(0, |kind| *kind as u32 + 1);
    data.kind_of = (!refined.kinds.is_empty()).then_some(&kind_of);
    data.triangulate = triangulate;
    data.force_corners = force_corners;
    with(&data)
}
