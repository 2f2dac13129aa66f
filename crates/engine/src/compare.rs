//! Schemes side by side, as the page shows them: what stands under each picture, and what its buttons send.
//!
//! ```text
//!   +---------------+---------------+
//!   |   picture 0   |   picture 1   |     one camera, one size; the free part of the canvas is split by
//!   | Loop        x | Butterfly   x |     [`Viewport::split`](crate::gestures::Viewport::split), the rest goes to the outer ones
//!   +---------------+---------------+
//! ```

use limn_document::compare::{MOST_BESIDE, Pane};
use limn_document::{Document, parameters};
use limn_mesh::Run;

use crate::gestures::Viewport;
use crate::protocol::{Compare, Count, Pane as Shown};

/// How far the free part of the canvas reaches under the page's words, in CSS pixels: `web/main.js` has it too.
pub const OVERLAP: f32 = 16.0;
/// What stands under a picture takes so much of it, in CSS pixels.
pub const WORDS: f32 = 58.0;

/// What is to be shown side by side. `about` tells counts, and why a pane that could be shown is not.
pub fn compare(
    document: &Document,
    panes: &[Pane],
    views: &[Viewport],
    about: impl Fn(usize) -> (Count, Option<String>),
) -> Compare {
    let beside = document.beside();
    let add = if panes.is_empty() || beside.len() >= MOST_BESIDE {
        String::new()
    } else if beside.is_empty() {
        "compare ".to_owned()
    } else {
        format!("{} ", Document::compare_command(beside))
    };
    if beside.is_empty() {
        return Compare { panes: Vec::new(), add };
    }
    let one = |(i, (pane, view)): (usize, (&Pane, &Viewport))| {
        let run = pane.plan.run(0);
        let (count, failed) = about(i);
        let note = match (&pane.refused, failed) {
            (Some(why), _) => limn_document::words::sentence(why),
            (None, Some(why)) => limn_document::words::sentence(&why),
            (None, None) if pane.triangulated => "Faces cut into triangles first".to_owned(),
            (None, None) => String::new(),
        };
        let others: Vec<Run> = beside.iter().filter(|other| **other != run).copied().collect();
        let (choose, leave) = match i {
            0 => Default::default(),
            _ => (parameters::command(&pane.plan).to_string(), Document::compare_command(&others)),
        };
        let size = view.max - view.min;
        let foot = (WORDS.min(size.y / 1.5)).max(0.0);
        let rect = [view.min.x, view.min.y, size.x, size.y + foot];
        Shown { scheme: run.scheme.info.id, name: name(&run), count, note, rect, choose, leave }
    };
    Compare { panes: panes.iter().zip(views).enumerate().map(one).collect(), add }
}

/// A scheme's name, with what was set of it: "Loop, weights warren".
pub fn name(run: &Run) -> String {
    let mut name = run.scheme.info.name.to_owned();
    for (key, value) in parameters::words(run).parameters {
        name.push_str(&format!(", {key} {value}"));
    }
    name
}

/// The part of the canvas that picture `i` of `views` is cut to, in device pixels: left, top, width, height. What lies beside
/// the free part goes to the pictures next to it.
pub fn clip(views: &[Viewport], i: usize, ratio: f32, size: [u32; 2]) -> [u32; 4] {
    let Some(view) = views.get(i) else { return [0, 0, size[0], size[1]] };
    let next = |low: f32, high: fn(&Viewport) -> f32| {
        views.iter().map(high).filter(|v| *v > low + 0.5).fold(f32::INFINITY, f32::min)
    };
    let first = |low: f32, of: fn(&Viewport) -> f32| views.iter().all(|v| of(v) >= low - 0.5);
    let pixel = |css: f32, most: u32| (css * ratio).round().clamp(0.0, most as f32) as u32;
    let [w, h] = size;
    let x = if first(view.min.x, |v| v.min.x) { 0 } else { pixel(view.min.x, w) };
    let y = if first(view.min.y, |v| v.min.y) { 0 } else { pixel(view.min.y, h) };
    let right = pixel(next(view.min.x, |v| v.min.x), w);
    let below = pixel(next(view.min.y, |v| v.min.y), h);
    [x, y, right.saturating_sub(x), below.saturating_sub(y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn clips_cover_the_canvas_once() {
        let view = Viewport::new(Vec2::new(900.0, 600.0), [44.0, 120.0, 150.0, 0.0]);
        for count in 1..=4 {
            let views = view.split(count, WORDS);
            let clips: Vec<_> = (0..count).map(|i| clip(&views, i, 1.5, [1350, 900])).collect();
            assert_eq!(clips.iter().map(|c| u64::from(c[2]) * u64::from(c[3])).sum::<u64>(), 1350 * 900, "{clips:?}");
            let has = |x: u32, y: u32| {
                clips.iter().filter(|[a, b, w, h]| (*a..a + w).contains(&x) && (*b..b + h).contains(&y)).count()
            };
            for at in [[0, 0], [1349, 899], [600, 400], [650, 300], [0, 899]] {
                assert_eq!(has(at[0], at[1]), 1, "{count} {at:?}");
            }
        }
    }

    #[test]
    fn words_and_buttons() {
        let mut document = Document::new(1 << 30);
        let view = Viewport::new(Vec2::new(900.0, 600.0), [0.0; 4]);
        let tell = |document: &Document| {
            let panes = document.panes();
            compare(document, &panes, &view.split(panes.len(), WORDS), |i| {
                (Count::default(), (i == 2).then(|| "it did not work".into()))
            })
        };
        assert_eq!(tell(&document), Compare::default());
        document.run("open builtin:cube").unwrap();
        assert_eq!(tell(&document), Compare { panes: Vec::new(), add: "compare ".into() });
        document.run("compare loop weights=warren").unwrap();
        assert_eq!(tell(&document).add, "compare loop weights=warren ");
        document.run("compare loop weights=warren doo-sabin linear").unwrap();
        let Compare { panes, add } = tell(&document);
        assert_eq!(add, "", "four is all there is room for");
        assert_eq!(
            panes.iter().map(|p| &*p.name).collect::<Vec<_>>(),
            ["Catmull–Clark", "Loop, weights warren", "Doo–Sabin", "Linear"]
        );
        assert_eq!(panes[0].leave, "");
        assert_eq!(panes[1].leave, "compare doo-sabin linear");
        assert_eq!(panes[1].choose, "scheme loop weights=warren");
        assert_eq!(panes[1].note, "Faces cut into triangles first");
        assert_eq!(panes[2].note, "It did not work.");
        assert_eq!(panes[3].rect, [450.0, 300.0, 450.0, 300.0]);
        document.run(&panes[1].choose).unwrap();
        document.run("compare linear").unwrap();
        assert_eq!(tell(&document).panes[1].leave, "compare off");
        document.set_budget(2_000);
        document.run("level 1").unwrap();
        document.set_budget(1);
        assert!(tell(&document).panes[1].note.contains("the budget is"), "{:?}", tell(&document).panes[1].note);
    }
}
