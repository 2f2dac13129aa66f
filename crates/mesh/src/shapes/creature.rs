//! The creature of the first visit: a closed cage of 1,450 quads.

use crate::soup::Soup;

/// The creature.
pub fn creature() -> Soup {
    // The surface of a box of cells, rounded.
    let size = [20i32, 5, 25];
    let mut soup = Soup::default();
    let mut ids = std::collections::BTreeMap::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, size[axis]] {
            for s in 0..size[u] {
                for t in 0..size[v] {
                    let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| {
                        let mut p = [0; 3];
                        p[axis] = side;
                        p[u] = s + i;
                        p[v] = t + j;
                        let next = ids.len() as u32;
                        *ids.entry(p).or_insert_with(|| {
                            let q: [f64; 3] = std::array::from_fn(|k| f64::from(2 * p[k]) / f64::from(size[k]) - 1.0);
                            let length = libm::sqrt(q.iter().map(|x| x * x).sum());
                            soup.positions.push(q.map(|x| (x / length) as f32));
                            next
                        })
                    });
                    if side == 0 {
                        corners.reverse();
                    }
                    soup.push_face(&corners);
                }
            }
        }
    }
    soup
}
