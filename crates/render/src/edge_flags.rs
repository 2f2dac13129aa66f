//! Which edges of a triangle are drawn, and how: shared with `limn-compute`, whose rows make the same corners.

/// The six edge bits of one triangle of a polygon of `n` corners.
pub fn edge_flags(local: [u32; 3], global: [u32; 3], n: u32, parents: Option<[u32; 2]>) -> u32 {
    let mut flags = 0;
    for c in 0..3 {
        let (i, j) = ((c + 1) % 3, (c + 2) % 3);
        let (a, b) = (local[i], local[j]);
        if (a + 1) % n != b && (b + 1) % n != a {
            continue;
        }
        flags |= 1 << c;
        let (low, high) = (global[i].min(global[j]), global[i].max(global[j]));
        if parents.is_none_or(|[old, faces]| low < old && high >= faces) {
            flags |= 8 << c;
        }
    }
    flags
}
