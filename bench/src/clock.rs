//! Time, and what plain stores reach.
//!
//! Cost: a quarter of a microsecond a reading. Limit: where there is no clock of a thread, time passes for everyone.

use std::hint::black_box;

/// Seconds that this thread computed, which other programs on the machine do not count into; elsewhere seconds that passed.
#[cfg(unix)]
pub fn now() -> f64 {
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call writes the one structure that it is given.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut t) };
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

/// Seconds since the first call.
#[cfg(not(unix))]
pub fn now() -> f64 {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed().as_secs_f64()
}

/// What [`now`] counts, in a word.
pub const CLOCK: &str = if cfg!(unix) { "thread" } else { "wall" };

/// How long something takes.
pub fn seconds(run: impl FnOnce()) -> f64 {
    let start = now();
    run();
    now() - start
}

/// The middle one; 0 of none.
pub fn median(times: &[f64]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

/// Bytes a second that plain stores reach on memory that has been touched.
pub fn bandwidth() -> f64 {
    let mut buffer = vec![0u64; 1 << 23];
    let times: Vec<f64> = (1..=12)
        .map(|k| {
            seconds(|| {
                buffer.iter_mut().for_each(|x| *x = k);
                black_box(&buffer);
            })
        })
        .collect();
    (buffer.len() * 8) as f64 / median(&times[1..])
}
