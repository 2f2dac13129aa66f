//! Undo and redo: two stacks of shared snapshots.
//!
//! A snapshot is a [`Clone`] that shares its large parts (models and meshes are behind `Arc`), so an entry costs what changed. A
//! slider that is dragged sets its value many times and is one entry: [`History::record`] is told which setting is being
//! dragged and keeps only the state from before the first. Every entry carries the text of the step between it and the
//! present, so that a button can say what it would take back.
//!
//! ```text
//!   past  [a b c]  present d  future [f e]     undo: d goes to the future, c comes back, and so does the step's text
//! ```

/// How many entries are kept; older ones are forgotten.
pub const LIMIT: usize = 256;

/// A state, and the step that leads from it (in the past) or to it (in the future).
#[derive(Clone, Debug)]
struct Entry<S> {
    state: S,
    step: String,
}

/// States before and after the present one.
#[derive(Clone, Debug)]
pub struct History<S> {
    past: Vec<Entry<S>>,
    future: Vec<Entry<S>>,
    /// The setting that is being dragged.
    gesture: Option<&'static str>,
}

impl<S> Default for History<S> {
    fn default() -> Self {
        History { past: Vec::new(), future: Vec::new(), gesture: None }
    }
}

impl<S: Clone> History<S> {
    /// Notes a step from `before` to `now`. `name` says what was set, `step` how, in words; `drag` that that
    /// more of the same may follow and belong to this step, whose words are then the last ones. A step that changes nothing
    /// (`same`) is none, and neither is a drag that ends where it began.
    pub fn record(
        &mut self,
        before: S,
        now: &S,
        name: &'static str,
        step: String,
        drag: bool,
        same: impl Fn(&S, &S) -> bool,
    ) {
        if self.gesture == Some(name)
            && let Some(first) = self.past.last_mut()
        {
            if same(&first.state, now) {
                self.past.pop();
                self.gesture = None;
                return;
            }
            first.step = step;
        } else {
            if same(&before, now) {
                return;
            }
            if self.past.len() >= LIMIT {
                self.past.remove(0);
            }
            self.past.push(Entry { state: before, step });
        }
        self.future.clear();
        self.gesture = drag.then_some(name);
    }

    /// Steps back from `present`; `None` if there is nothing before it.
    pub fn undo(&mut self, present: &S) -> Option<S> {
        self.gesture = None;
        let Entry { state, step } = self.past.pop()?;
        self.future.push(Entry { state: present.clone(), step });
        Some(state)
    }

    /// Steps forward from `present`; `None` if there is nothing after it.
    pub fn redo(&mut self, present: &S) -> Option<S> {
        self.gesture = None;
        let Entry { state, step } = self.future.pop()?;
        self.past.push(Entry { state: present.clone(), step });
        Some(state)
    }

    /// The step that [`Self::undo`] would take back and the one that [`Self::redo`] would do again, in words.
    pub fn steps(&self) -> (Option<&str>, Option<&str>) {
        (self.past.last().map(|e| &*e.step), self.future.last().map(|e| &*e.step))
    }

    /// Whether there is a step back and a step forward.
    pub fn depth(&self) -> (usize, usize) {
        (self.past.len(), self.future.len())
    }

    /// Asks from the newest past entry on, and forgets the first that `forget` holds of and all before it, to give back what
    /// they share.
    pub fn forget_up_to(&mut self, mut forget: impl FnMut(&S) -> bool) {
        if let Some(last) = self.past.iter().rposition(|entry| forget(&entry.state)) {
            self.past.drain(..=last);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(history: &mut History<i32>, present: &mut i32, to: i32, name: &'static str, drag: bool) {
        let before = std::mem::replace(present, to);
        history.record(before, present, name, format!("{name} {to}"), drag, i32::eq);
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
    fn a_step_keeps_its_words_on_its_way_to_and_fro() {
        let (mut h, mut now) = (History::default(), 0);
        assert_eq!(h.steps(), (None, None));
        step(&mut h, &mut now, 1, "level", false);
        for size in [5, 6, 7] {
            step(&mut h, &mut now, size, "size", true);
        }
        assert_eq!(h.steps(), (Some("size 7"), None), "a drag is called by its end");
        now = h.undo(&now).unwrap();
        assert_eq!((now, h.steps()), (1, (Some("level 1"), Some("size 7"))));
        now = h.undo(&now).unwrap();
        assert_eq!((now, h.steps()), (0, (None, Some("level 1"))));
        now = h.redo(&now).unwrap();
        assert_eq!((now, h.steps()), (1, (Some("level 1"), Some("size 7"))));
        step(&mut h, &mut now, 9, "level", false);
        assert_eq!(h.steps(), (Some("level 9"), None));
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
