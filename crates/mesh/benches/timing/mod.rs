//! What the benchmarks of several crates measure by: the middle of some runs, and what plain stores reach in the same run. A part of
//! each by `#[path]`, since nothing that ships needs it. Limit: time passes for everyone; `bench/src/clock.rs` has the thread's.

use std::hint::black_box;
use std::time::Instant;

/// The middle of what `f` says, called so many times after once.
pub fn middle(runs: usize, mut f: impl FnMut() -> f64) -> f64 {
    f();
    let mut t: Vec<f64> = (0..runs).map(|_| f()).collect();
    t.sort_by(f64::total_cmp);
    t[t.len() / 2]
}

/// The median time of `f`, in seconds.
pub fn median(runs: usize, mut f: impl FnMut()) -> f64 {
    middle(runs, || {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64()
    })
}

/// Bytes a second that plain stores reach on memory that has been touched.
pub fn bandwidth() -> f64 {
    let mut buffer = vec![0u64; 1 << 23];
    let mut k = 0;
    let t = median(9, || {
        k += 1;
        buffer.iter_mut().for_each(|x| *x = k);
        black_box(&buffer);
    });
    (buffer.len() * 8) as f64 / t
}
