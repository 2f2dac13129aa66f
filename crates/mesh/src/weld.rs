//! Welding: which positions are one vertex.
//!
//! Formats without shared indices (glTF at seams, STL everywhere) repeat a vertex once a face or once a texture seam, and a
//! surface only subdivides smoothly when the copies are one again. Exact welding joins equal coordinates; relative welding
//! joins positions closer than a fraction of the bounding box. Every position maps to the *lowest* index of its class, so
//! the numbering of a file survives.
//!
//! ```text
//!   exact     hash of the three bit patterns -> first index with the same
//!   relative  cells of one tolerance; a position looks into its 27 for the first representative within it
//! ```
//!
//! The tables use open addressing and are never iterated, so the result does not depend on the hash. Cost: linear, 15 to
//! 25 ns a position exact. Limit: relative classes are grown from their first member, never chained, so a class is at most
//! two tolerances wide.

/// How positions become vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// Equal coordinates are one vertex (-0 equals 0).
    Exact,
    /// Positions within this fraction of the bounding box's diagonal are one vertex. Useful from 1e-7 to 1e-2.
    Relative(f32),
    /// Every position is a vertex of its own, as the file says.
    #[default]
    Off,
}

/// The lowest position index of every position's class. Positions must be finite.
/// `parts` (empty, or one for each position) keeps positions of different parts apart.
pub(crate) fn weld(positions: &[[f32; 3]], parts: &[u32], weld: Weld) -> Vec<u32> {
    match weld {
        Weld::Off => (0..positions.len() as u32).collect(),
        Weld::Exact => exact(positions, parts),
        Weld::Relative(fraction) => relative(positions, parts, fraction),
    }
}

fn part(parts: &[u32], i: usize) -> u32 {
    parts.get(i).copied().unwrap_or(0)
}

/// Smallest and largest coordinates; zeros for no positions.
pub fn bounds(positions: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let Some(first) = positions.first() else { return [[0.0; 3]; 2] };
    let mut b = [*first; 2];
    for p in positions {
        for k in 0..3 {
            b[0][k] = b[0][k].min(p[k]);
            b[1][k] = b[1][k].max(p[k]);
        }
    }
    b
}

const EMPTY: u32 = u32::MAX;

/// Mixes three words into a table slot (the finaliser of MurmurHash3, applied to each).
fn slot<const N: usize>(key: [u32; N], mask: usize) -> usize {
    let mut x = 0u64;
    for k in key {
        x = (x ^ u64::from(k)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        x ^= x >> 32;
    }
    x as usize & mask
}

fn table(entries: usize) -> Vec<u32> {
    vec![EMPTY; (entries.max(4) * 2).next_power_of_two()]
}

/// So many positions are looked up together.
const BLOCK: usize = 32;

fn exact(positions: &[[f32; 3]], parts: &[u32]) -> Vec<u32> {
    // Adding zero turns -0 into 0, so that the bit patterns of equal numbers are equal.
    let key = |i: usize| {
        let [x, y, z] = positions[i].map(|x| (x + 0.0).to_bits());
        [x, y, z, part(parts, i)]
    };
    // A triangle's corner is one of six with its position, as a rule: the table grows where it is not. (Not in the page's first
    // module, where code counts more.)
    let (mut slots, mut used) = (table(positions.len() / if crate::FULL { 8 } else { 1 }), 0);
    let mut class: Vec<u32> = Vec::with_capacity(positions.len());
    let mut at = [0; BLOCK];
    while class.len() < positions.len() {
        if crate::FULL && 2 * (used + BLOCK) > slots.len() {
            slots = table(slots.len().max(BLOCK));
            let mask = slots.len() - 1;
            for i in (0..class.len()).filter(|&i| class[i] == i as u32) {
                let mut s = slot(key(i), mask);
                while slots[s] != EMPTY {
                    s = (s + 1) & mask;
                }
                slots[s] = i as u32;
            }
        }
        let mask = slots.len() - 1;
        let from = class.len();
        let block = from..positions.len().min(from + BLOCK);
        // Slots, and what stands there, are fetched by all of a block before any has to wait for its answer.
        for (s, i) in at.iter_mut().zip(block.clone()) {
            *s = slot(key(i), mask);
            if crate::FULL {
                std::hint::black_box(positions[from.min(slots[*s] as usize)]);
            }
        }
        for (&s, i) in at.iter().zip(block) {
            let (k, mut s) = (key(i), s);
            let lowest = loop {
                match slots[s] {
                    EMPTY => {
                        slots[s] = i as u32;
                        used += 1;
                        break i as u32;
                    }
                    j if key(j as usize) == k => break j,
                    _ => s = (s + 1) & mask,
                }
            };
            class.push(lowest);
        }
    }
    class
}

fn relative(positions: &[[f32; 3]], parts: &[u32], fraction: f32) -> Vec<u32> {
    let [low, high] = bounds(positions).map(|c| c.map(f64::from));
    let diagonal = (0..3).map(|k| (high[k] - low[k]) * (high[k] - low[k])).sum::<f64>().sqrt();
    let tolerance = diagonal * f64::from(fraction);
    if tolerance <= 0.0 || tolerance.is_nan() {
        return exact(positions, parts);
    }
    // Far-off cells only cost time, never correctness: distances are checked.
    let cell_of = |p: &[f32; 3]| -> [i64; 3] {
        std::array::from_fn(|k| ((f64::from(p[k]) - low[k]) / tolerance).min(9e15) as i64)
    };
    let mut slots = table(positions.len());
    let mask = slots.len() - 1;
    let mut next = vec![EMPTY; positions.len()]; // representatives that share a slot, newest first
    let mut class = Vec::with_capacity(positions.len());
    for (i, p) in positions.iter().enumerate() {
        let cell = cell_of(p);
        let mut best = i as u32;
        for n in 0..27 {
            let around = [cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1];
            let mut j = slots[slot(around.map(|c| c as u32), mask)];
            while j != EMPTY {
                let q = &positions[j as usize];
                let d: f64 =
                    (0..3).map(|k| (f64::from(p[k]) - f64::from(q[k])) * (f64::from(p[k]) - f64::from(q[k]))).sum();
                if d <= tolerance * tolerance && part(parts, i) == part(parts, j as usize) {
                    best = best.min(j);
                }
                j = next[j as usize];
            }
        }
        if best == i as u32 {
            let s = slot(cell.map(|c| c as u32), mask);
            next[i] = slots[s];
            slots[s] = i as u32;
        }
        class.push(best);
    }
    class
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_joins_equal_and_nothing_else() {
        let p = [[0.0, 1.0, 2.0], [-0.0, 1.0, 2.0], [0.0, 1.0, 2.0000002], [0.0, 1.0, 2.0]];
        assert_eq!(weld(&p, &[], Weld::Exact), [0, 0, 2, 0]);
        assert_eq!(weld(&p, &[], Weld::Off), [0, 1, 2, 3]);
    }

    #[test]
    fn parts_stay_apart() {
        let p = [[0.0; 3], [0.0; 3], [0.0; 3], [1.0; 3]];
        assert_eq!(weld(&p, &[0, 1, 1, 1], Weld::Exact), [0, 1, 1, 3]);
        assert_eq!(weld(&p, &[0, 1, 0, 1], Weld::Relative(1e-3)), [0, 1, 0, 3]);
    }

    #[test]
    fn relative_takes_the_lowest_within_reach_across_cells() {
        let p = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.999, 0.0, 0.0], [0.0011, 0.0, 0.0], [0.5, 0.0, 0.0]];
        assert_eq!(weld(&p, &[], Weld::Relative(0.002)), [0, 1, 1, 0, 4]);
        assert_eq!(weld(&p, &[], Weld::Relative(0.0)), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn exact_is_the_first_of_equals_while_the_table_grows() {
        // Most are new at first, and hardly any at the end; zeros of both signs; two parts.
        let mut state = 1u32;
        let mut next = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        let positions: Vec<[f32; 3]> = (0..6000).map(|_| [(); 3].map(|()| next(24) as f32 * -0.5)).collect();
        for parts in [vec![], (0..6000).map(|_| next(2)).collect::<Vec<_>>()] {
            let mut first = std::collections::HashMap::new();
            let key = |i: usize| (positions[i].map(|x| (x + 0.0).to_bits()), part(&parts, i));
            let expected: Vec<u32> = (0..6000).map(|i| *first.entry(key(i)).or_insert(i as u32)).collect();
            assert_eq!(weld(&positions, &parts, Weld::Exact), expected);
            for few in [0, 1, 31, 32, 33, 65] {
                assert_eq!(weld(&positions[..few], &parts[..few.min(parts.len())], Weld::Exact), expected[..few]);
            }
        }
    }

    #[test]
    fn many_positions_in_one_place_stay_linear() {
        let p = vec![[1.0, 2.0, 3.0]; 200_000];
        assert!(weld(&p, &[], Weld::Exact).iter().all(|&c| c == 0));
        assert!(weld(&p, &[], Weld::Relative(1e-3)).iter().all(|&c| c == 0));
    }
}
