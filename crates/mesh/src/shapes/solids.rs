//! Small closed solids: the five regular ones, a pyramid, and a T of four cubes.
//!
//! The regular solids stand in a cube or a sphere of radius 1 about the origin. The dodecahedron is made as the dual of the
//! icosahedron, the T from its cells, by dropping the squares that two of them share. The meshes of N. Baumgartner's program
//! (2003) that its table of polygon counts names are here: pyramid, cube and T.

use crate::soup::Soup;

/// The cube from -1 to 1: vertex `x + 2y + 4z` by which coordinates are positive.
pub fn cube() -> Soup {
    let positions = (0..8u32).map(|v| [v & 1, v >> 1 & 1, v >> 2 & 1].map(|bit| 2.0 * bit as f32 - 1.0)).collect();
    Soup::from_faces(positions, &[[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
}

/// A square pyramid of height 1.5 over a base of side 2, the base cut in two: 5 vertices, 6 triangles.
pub fn pyramid() -> Soup {
    let positions = vec![[-1.0, -0.5, -1.0], [1.0, -0.5, -1.0], [1.0, -0.5, 1.0], [-1.0, -0.5, 1.0], [0.0, 1.0, 0.0]];
    Soup::from_faces(positions, &[[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]])
}

/// The regular tetrahedron on four corners of the cube from -1 to 1.
pub fn tetrahedron() -> Soup {
    let positions = vec![[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]];
    Soup::from_faces(positions, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

/// The regular octahedron with its corners at ±1 on the axes, in the order +x, -x, +y, -y, +z, -z.
pub fn octahedron() -> Soup {
    let mut positions = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut p = [0.0; 3];
            p[axis] = sign;
            positions.push(p);
        }
    }
    let faces = [[2, 4, 0], [2, 0, 5], [2, 5, 1], [2, 1, 4], [3, 0, 4], [3, 5, 0], [3, 1, 5], [3, 4, 1]];
    Soup::from_faces(positions, &faces)
}

/// The icosahedron's faces over the vertices of [`icosahedron_points`].
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 1, 4],
    [0, 6, 1],
    [0, 4, 8],
    [0, 9, 6],
    [0, 8, 9],
    [1, 10, 4],
    [1, 6, 11],
    [1, 11, 10],
    [2, 5, 3],
    [2, 3, 7],
    [2, 8, 5],
    [2, 7, 9],
    [2, 9, 8],
    [3, 5, 10],
    [3, 11, 7],
    [3, 10, 11],
    [4, 5, 8],
    [4, 10, 5],
    [6, 9, 7],
    [6, 7, 11],
];

/// The corners of three golden rectangles, scaled to length 1.
fn icosahedron_points() -> Vec<[f64; 3]> {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let scale = 1.0 / (1.0 + golden * golden).sqrt();
    let mut points = Vec::with_capacity(12);
    // The rectangles lie in the planes z = 0, x = 0 and y = 0.
    for axis in 0..3 {
        for (long, short) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let mut p = [0.0; 3];
            p[axis] = short * scale;
            p[(axis + 1) % 3] = long * golden * scale;
            points.push(p);
        }
    }
    points
}

/// The regular icosahedron in the unit sphere.
pub fn icosahedron() -> Soup {
    let positions = icosahedron_points().iter().map(|p| p.map(|x| x as f32)).collect();
    Soup::from_faces(positions, &ICOSAHEDRON)
}

/// The regular dodecahedron in the unit sphere: vertex i lies over the icosahedron's face i, face i over its vertex i.
pub fn dodecahedron() -> Soup {
    let points = icosahedron_points();
    let positions = ICOSAHEDRON
        .iter()
        .map(|face| {
            let sum: [f64; 3] = std::array::from_fn(|k| face.iter().map(|&v| points[v as usize][k]).sum());
            let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
            sum.map(|x| (x / length) as f32)
        })
        .collect();
    let mut soup = Soup { positions, ..Soup::default() };
    for vertex in 0..12 {
        // Walk round the vertex: from each face (vertex, a, b) to the one that has edge (vertex, b) next.
        let after =
            |v: u32, face: &[u32; 3]| face.iter().position(|&x| x == v).map(|i| (face[(i + 1) % 3], face[(i + 2) % 3]));
        let fan: Vec<(u32, u32, u32)> =
            (0..20u32).filter_map(|f| after(vertex, &ICOSAHEDRON[f as usize]).map(|(a, b)| (f, a, b))).collect();
        let mut corners = vec![fan[0].0];
        let mut edge = fan[0].2;
        while corners.len() < fan.len() {
            let (f, _, b) = *fan.iter().find(|(_, a, _)| *a == edge).unwrap_or(&fan[0]);
            corners.push(f);
            edge = b;
        }
        soup.push_face(&corners);
    }
    soup
}

/// Four cubes as an upright T, three across and one below: 20 vertices, 18 squares.
pub fn t_shape() -> Soup {
    // Cells by column and row; each is 2/3 wide, the whole 2 by 4/3 by 2/3.
    cells(&[[0, 1], [1, 1], [2, 1], [1, 0]])
}

/// The surface of a flat figure of unit cells, scaled by 2/3 and centred as a 3 by 2 figure.
fn cells(figure: &[[i32; 2]]) -> Soup {
    let mut soup = Soup::default();
    let mut grid: Vec<[i32; 3]> = Vec::new();
    for &[column, row] in figure {
        for axis in 0..3 {
            for side in 0..2 {
                let mut beyond = [column, row];
                if axis < 2 {
                    beyond[axis] += 2 * side - 1;
                    if figure.contains(&beyond) {
                        continue;
                    }
                }
                // The square across `axis`, anticlockwise seen from outside.
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(s, t)| {
                    let mut p = [column, row, 0];
                    p[axis] += side;
                    p[u] += s;
                    p[v] += t;
                    grid.iter().position(|&q| q == p).unwrap_or_else(|| {
                        grid.push(p);
                        grid.len() - 1
                    }) as u32
                });
                if side == 0 {
                    corners.reverse();
                }
                soup.push_face(&corners);
            }
        }
    }
    soup.positions = grid
        .iter()
        .map(|&[x, y, z]| [(2 * x - 3) as f32 / 3.0, (2 * y - 2) as f32 / 3.0, (2 * z - 1) as f32 / 3.0])
        .collect();
    soup
}
