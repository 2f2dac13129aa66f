//! Undo and redo: two stacks of shared snapshots.
//!
//! A snapshot is a [`Clone`] that shares its large parts (models and meshes are behind `Arc`), so an entry costs what changed. A
//! slider that is dragged sets its value many times and is one entry: [`History::record`] is told which setting is being
//! dragged and keeps only the state from before the first.
//!
//! ```text
//!   past  [a b c]  present d  future [f e]     undo: d goes to the future, c comes back
//! ```

/// How many entries are kept; older ones are forgotten.
pub const LIMIT: usize = 256;

/// States before and after the present one.
#[derive(Clone, Debug)]
pub struct History<S> {
    past: Vec<S>,
    future: Vec<S>,
    /// The setting that is being dragged.
    gesture: Option<&'static str>,
}

impl<S> Default for History<S> {
    fn default() -> Self {
        History { past: Vec::new(), future: Vec::new(), gesture: None }
    }
}

impl<S: Clone> History<S> {
    /// Notes a step from `before` to `now`. `name` says what was set; `drag` that more of the same may follow and belong to
    /// this step. A step that changes nothing (`same`) is none, and neither is a drag that ends where it began.
    pub fn record(&mut self, before: S, now: &S, name: &'static str, drag: bool, same: impl Fn(&S, &S) -> bool) {
        if self.gesture == Some(name) {
            if self.past.last().is_some_and(|first| same(first, now)) {
                self.past.pop();
                self.gesture = None;
                return;
            }
        } else {
            if same(&before, now) {
                return;
            }
            if self.past.len() >= LIMIT {
                self.past.remove(0);
            }
            self.past.push(before);
        }
        self.future.clear();
        self.gesture = drag.then_some(name);
    }

    /// Steps back from `present`; `None` if there is nothing before it.
    pub fn undo(&mut self, present: &S) -> Option<S> {
        self.gesture = None;
        let before = self.past.pop()?;
        self.future.push(present.clone());
        Some(before)
    }

    /// Steps forward from `present`; `None` if there is nothing after it.
    pub fn redo(&mut self, present: &S) -> Option<S> {
        self.gesture = None;
        let after = self.future.pop()?;
        self.past.push(present.clone());
        Some(after)
    }

    /// Whether there is a step back and a step forward.
    pub fn depth(&self) -> (usize, usize) {
        (self.past.len(), self.future.len())
    }

    /// Asks from the newest past entry on, and forgets the first that `forget` holds of and all before it, to give back what
    /// they share.
    pub fn forget_up_to(&mut self, forget: impl FnMut(&S) -> bool) {
        if let Some(last) = self.past.iter().rposition(forget) {
            self.past.drain(..=last);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(history: &mut History<i32>, present: &mut i32, to: i32, name: &'static str, drag: bool) {
        let before = std::mem::replace(present, to);
        history.record(before, present, name, drag, i32::eq);
    }

    #[test]
    fn a_drag_is_one_step_and_a_click_is_one_each() {
        let (mut h, mut now) = (History::default(), 0);
        for level in [1, 2, 3] {
            step(&mut h, &mut now, level, "level", true);
        }
        step(&mut h, &mut now, 3, "level", false); // release, at the same value
        step(&mut h, &mut now, 4, "level", false);
        assert_eq!(h.depth(), (2, 0));
        now = h.undo(&now).unwrap();
        assert_eq!(now, 3);
        now = h.undo(&now).unwrap();
        assert_eq!(now, 0);
        assert_eq!(h.undo(&now), None);
        now = h.redo(&now).unwrap();
        assert_eq!((now, h.depth()), (3, (1, 1)));
        step(&mut h, &mut now, 5, "level", false);
        assert_eq!((h.redo(&now), h.depth()), (None, (2, 0)));
    }

    #[test]
    fn a_drag_back_to_its_start_is_no_step() {
        let (mut h, mut now) = (History::default(), 7);
        for level in [8, 9, 7] {
            step(&mut h, &mut now, level, "level", true);
        }
        assert_eq!(h.depth(), (0, 0));
        step(&mut h, &mut now, 8, "level", true); // and on it goes
        assert_eq!(h.depth(), (1, 0));
        step(&mut h, &mut now, 1, "other", true);
        assert_eq!(h.depth(), (2, 0));
        assert_eq!(h.undo(&now), Some(8));
    }

    #[test]
    fn nothing_new_is_no_step_and_old_ones_are_forgotten() {
        let (mut h, mut now) = (History::default(), 0);
        step(&mut h, &mut now, 0, "level", false);
        assert_eq!(h.depth(), (0, 0));
        for i in 1..=LIMIT as i32 + 10 {
            step(&mut h, &mut now, i, "level", false);
        }
        assert_eq!(h.depth(), (LIMIT, 0));
        h.forget_up_to(|s| *s < 20);
        assert_eq!(h.depth(), (LIMIT - 10, 0));
    }
}
