//! A computer mouse: a box of 4 by 4 by 1 cells, bent into shape, with a wheel on top and a lens underneath.
//!
//! ```text
//!    front (+z)                           vertices   edges   faces
//!   ┌────┬─┬────┐    box, 4 by 4 by 1        50        96      48
//!   ├────┼─┼────┤    two cells joined         0        -1      -1
//!   ├────┤ ├────┤ <- wheel, a raised         +6       +12      +6
//!   ├────┼─┼────┤    hexagon
//!   └────┴─┴────┘    lens, a vertex opened   +1        +2      +1
//!                                            57       109      54
//! ```
//!
//! The same counts as the mouse in Z. Xu and K. Kondo's adaptive Doo–Sabin paper (1999): three steps give 3,490 faces, four 13,954.

use crate::soup::Soup;

/// Front to back: z, half width and height of the top's rows, half width of the bottom's.
const ROWS: [[f32; 4]; 5] = [
    [0.92, 0.46, -0.12, 0.50],
    [0.58, 0.56, 0.10, 0.62],
    [0.10, 0.58, 0.27, 0.64],
    [-0.48, 0.64, 0.34, 0.72],
    [-0.92, 0.44, 0.06, 0.48],
];

/// Where the columns stand between the left side and the right, on top and underneath; how far the top's sag; and how far
/// their ends bulge to the front and the back.
const COLUMNS: [[f32; 4]; 5] = [
    [-1.0, -1.0, 0.16, -0.08],
    [-0.24, -0.5, 0.01, 0.10],
    [0.0, 0.0, 0.0, 0.12],
    [0.24, 0.5, 0.01, 0.10],
    [1.0, 1.0, 0.16, -0.08],
];

/// Height of the bottom.
const FLOOR: f32 = -0.36;

/// The wheel's top: x, y, z of its six corners, round from the front left.
const WHEEL: [[f32; 3]; 6] = [
    [-0.08, 0.19, 0.50],
    [0.0, 0.20, 0.53],
    [0.08, 0.19, 0.50],
    [0.08, 0.28, 0.20],
    [0.0, 0.29, 0.17],
    [-0.08, 0.28, 0.20],
];

/// The mouse: 57 vertices, 109 edges, 53 quads and a hexagon.
pub fn mouse() -> Soup {
    let top = |row: u32, column: u32| row * 5 + column;
    // Where the lens is, the bottom has a vertex on either side of the middle line: the left one keeps the place in the
    // grid, the right one comes after it.
    let bottom = |row: u32, column: u32| 25 + row * 5 + column;
    let (lens_left, lens_right) = (bottom(2, 2), 50);
    let wheel = 51;

    // Only the rows at the ends bulge.
    let end = |z: f32| if z.abs() > 0.9 { z.signum() } else { 0.0 };
    let mut soup = Soup::default();
    for [z, half, height, _] in ROWS {
        soup.positions.extend(COLUMNS.map(|[x, _, sag, bulge]| [x * half, height - sag, z + end(z) * bulge]));
    }
    for [z, _, _, half] in ROWS {
        soup.positions.extend(COLUMNS.map(|[_, x, _, bulge]| [x * half, FLOOR, z + end(z) * bulge]));
    }
    soup.positions[lens_left as usize][0] = -0.125;
    soup.positions.push([0.125, FLOOR, ROWS[2][0]]);
    soup.positions.extend(WHEEL);

    for row in 0..4 {
        for column in 0..4 {
            if row != 1 || column == 0 || column == 3 {
                soup.push_face(
                    &[(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
                        .map(|(r, c)| top(r, c)),
                );
            }
            let right = column >= 2;
            let corners =
                [(row, column), (row + 1, column), (row + 1, column + 1), (row, column + 1)].map(|(r, c)| bottom(r, c));
            soup.push_face(&corners.map(|v| if right && v == lens_left { lens_right } else { v }));
        }
    }
    soup.push_face(&[bottom(1, 2), lens_left, bottom(3, 2), lens_right]);

    // The well, round as seen from above, and the wheel over it.
    let well = [top(1, 1), top(1, 2), top(1, 3), top(2, 3), top(2, 2), top(2, 1)];
    for i in 0..6u32 {
        let j = (i + 1) % 6;
        soup.push_face(&[well[i as usize], well[j as usize], wheel + j, wheel + i]);
    }
    soup.push_face(&[0, 1, 2, 3, 4, 5].map(|i| wheel + i));

    // The rim, anticlockwise seen from above.
    let rim: Vec<(u32, u32)> = (0..4)
        .map(|i| (0, i))
        .chain((0..4).map(|i| (i, 4)))
        .chain((0..4).map(|i| (4, 4 - i)))
        .chain((0..4).map(|i| (4 - i, 0)))
        .collect();
    for (i, &(r, c)) in rim.iter().enumerate() {
        let (s, d) = rim[(i + 1) % rim.len()];
        soup.push_face(&[top(s, d), top(r, c), bottom(r, c), bottom(s, d)]);
    }
    soup
}
