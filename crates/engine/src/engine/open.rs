//! Opening: from files, addresses and links to a document.
//!
//! ```text
//!   drop ──► main file ──► read ──► load ──► sync
//!   link ──► new document ──► replay until a source ──► builtin: goes on at once
//!                                                       address: fetch ──► read, load, replay the rest
//!                                                       file: a card asks for it, the rest waits
//! ```
//!
//! A link is replayed into a document of its own, which takes the place of the present one only when all of it worked: the
//! last good model stays on the screen.

use std::sync::Arc;

use limn_document::command::{Command, parse_script};
use limn_document::words::sentence;
use limn_document::{Document, Outcome, Replayed, Source, Stamp};
use limn_formats::parcel::Parcel;
use wasm_bindgen::JsValue;

use super::Engine;
use crate::protocol::{Card, Message};

/// What a first visit shows.
const FIRST: &str = "#1;open+builtin:creature;scheme+catmull-clark;level+2";
/// A source that is on its way.
pub(super) struct Opening {
    source: Source,
    /// The document that it is for; none if it is for the present one.
    document: Option<Document>,
    /// Commands of a link that come after it.
    rest: Vec<Command>,
    /// What the surroundings were asked with.
    turn: u32,
    /// A file of the right name that was not the one: given once more, it is opened as a new model.
    refused: Option<Stamp>,
}

impl Opening {
    /// Whether an address is being read: something comes without anybody doing anything.
    pub(super) fn comes(&self) -> bool {
        matches!(self.source, Source::Url(_))
    }
}

/// Whether two names mean the same file: folders and capitals aside.
fn same_file(a: &str, b: &str) -> bool {
    let last = |name: &str| name.rsplit(['/', '\\']).next().unwrap_or(name).to_ascii_lowercase();
    last(a) == last(b)
}

impl Engine {
    /// Begins with a link, a document's text, or the first visit's model.
    pub(super) fn start(&mut self, text: &str, parcel: Option<Parcel>) {
        self.stop_opening();
        match commands_of(text) {
            Ok(commands) => self.replay_into_new(commands, parcel),
            Err(error) => self.bad_link(&error),
        }
        if self.document.mesh().is_none() {
            // Never an empty page: something to look at stands behind the card, or until the file comes.
            let _ = Document::from_link(FIRST).map(|commands| self.document.replay(&commands));
            self.sync();
        }
        self.dirty.state = true;
    }

    fn bad_link(&mut self, error: &str) {
        let lines =
            vec![sentence(error), "The address was left as it is, so that it can be compared with its source.".into()];
        self.card(Card {
            id: "link",
            kind: "error",
            title: "This link cannot be read".into(),
            lines,
            ..Card::default()
        });
    }

    fn replay_into_new(&mut self, commands: Vec<Command>, parcel: Option<Parcel>) {
        let mut document = Document::new(self.document.budget());
        document.set_aspect(self.document.aspect());
        self.go_on(document, &commands, parcel);
    }

    /// Replays commands into a document that is not shown yet, as far as they go.
    fn go_on(&mut self, mut document: Document, commands: &[Command], mut parcel: Option<Parcel>) {
        let mut commands = commands.to_vec();
        loop {
            match document.replay(&commands) {
                Err(error) => return self.bad_link(&error.to_string()),
                Ok(Replayed::Done) => {
                    self.document = document;
                    self.opening = None;
                    self.tween = None;
                    self.no_card("link");
                    self.no_card("ask");
                    self.sync();
                    return self.report_card();
                }
                Ok(Replayed::Waiting { source, rest }) => {
                    if let Source::File { name, .. } = &source
                        && let Some(parcel) = parcel.take_if(|p| same_file(&p.name, name))
                    {
                        if !self.read_into(&mut document, parcel, &source) {
                            return;
                        }
                        commands = rest;
                        continue;
                    }
                    self.wait_for(source.clone(), Some(document), rest);
                    return self.ask(&source);
                }
            }
        }
    }

    /// Asks the surroundings, or the visitor, for a source.
    fn ask(&mut self, source: &Source) {
        match source {
            Source::Builtin(_) => {}
            Source::Url(url) => {
                self.since = self.clock.now();
                self.told = Some(self.since);
                let what = format!("Reading {}", source.name());
                self.post.send(&Message::Progress { what, done: -1.0, cancel: true });
                self.post.send(&Message::Fetch { url: url.clone(), turn: self.turn });
            }
            Source::File { stamp, .. } => {
                let name = source.name().to_owned();
                let mut lines = vec!["A link names a file but does not hold it. Drop it here, with the files that belong to it, or open it.".to_owned()];
                if let Some(stamp) = stamp {
                    lines.push(format!("It has {} bytes.", limn_mesh::refine::grouped(stamp.size)));
                }
                let title = format!("This link shows {name}");
                self.card(Card { id: "ask", kind: "note", title, lines, ask: name });
            }
        }
    }

    /// A command asked for a source.
    pub(super) fn fetch_source(&mut self, source: Source) {
        self.stop_opening_quietly();
        self.wait_for(source.clone(), None, Vec::new());
        self.ask(&source);
    }

    fn wait_for(&mut self, source: Source, document: Option<Document>, rest: Vec<Command>) {
        self.turn += 1;
        self.opening = Some(Opening { source, document, rest, turn: self.turn, refused: None });
    }

    /// The file that dropped ones should be searched for: one that a link or `text` names, or, to read it `again`, the
    /// present one.
    pub(super) fn wanted_file(&self, text: &str, again: bool) -> Option<String> {
        let file = |source: &Source| match source {
            Source::File { name, .. } => Some(name.clone()),
            _ => None,
        };
        if !text.is_empty() {
            let commands = commands_of(text).ok()?;
            return commands.iter().rev().find_map(|c| if let Command::Open(source) = c { file(source) } else { None });
        }
        if again {
            return self.document.source().and_then(file);
        }
        self.opening.as_ref().and_then(|o| file(&o.source))
    }

    /// Files were dropped or chosen, and read.
    pub(super) fn open_parcel(&mut self, parcel: Parcel) {
        // The file that a link waits for?
        if let Some(opening) = self.opening.take() {
            let stamp = Stamp { size: parcel.size, hash: parcel.hash };
            let wanted = matches!(&opening.source, Source::File { name, .. } if same_file(name, &parcel.name))
                && opening.refused != Some(stamp);
            match (wanted, opening.document) {
                (true, Some(mut document)) => {
                    if self.read_into(&mut document, parcel, &opening.source) {
                        self.go_on(document, &opening.rest, None);
                    } else if document.apply(&Command::Open(opening.source.clone()), false).is_ok() {
                        // The right one is still waited for.
                        let Opening { source, rest, turn, .. } = opening;
                        self.opening =
                            Some(Opening { source, document: Some(document), rest, turn, refused: Some(stamp) });
                    }
                    return;
                }
                (_, None) => self.document.cancel_open(),
                (false, Some(_)) => {}
            }
            self.no_card("ask");
        }
        let source = Source::File { name: parcel.name.clone(), stamp: None };
        match self.document.apply(&Command::Open(source.clone()), false) {
            Ok(_) => self.take_parcel(parcel, &source),
            Err(error) => self.refuse("open", &error),
        }
    }

    /// Loads a parcel into the present document, which asked for `source`.
    fn take_parcel(&mut self, parcel: Parcel, source: &Source) {
        let mut document = std::mem::replace(&mut self.document, Document::new(0));
        let good = self.read_into(&mut document, parcel, source);
        self.document = document;
        if good {
            self.loaded(source);
        }
    }

    fn loaded(&mut self, source: &Source) {
        self.log(&format!("open {}", limn_document::words::quote(&source.to_string())), String::new(), true);
        self.no_card("link");
        self.tween = None;
        self.sync();
        self.report_card();
    }

    /// Reads the present model again.
    pub(super) fn reload(&mut self, parcel: Option<Parcel>) {
        match self.document.apply(&Command::Reload, false) {
            Ok(Outcome::Open(source @ Source::File { .. })) => match parcel {
                Some(parcel) => self.take_parcel(parcel, &source),
                None => {
                    self.document.cancel_open();
                    let name = source.name().to_owned();
                    let lines = vec!["Open it or drop it again.".to_owned()];
                    let title = format!("{name} cannot be read again");
                    self.card(Card { id: "read", kind: "error", title, lines, ask: name });
                }
            },
            Ok(Outcome::Open(source)) => self.fetch_source(source),
            Ok(_) => {}
            Err(error) => self.refuse("reload", &error),
        }
    }

    /// Loads a parcel as the source that `document` waits for. A card says what is wrong if it cannot.
    fn read_into(&mut self, document: &mut Document, parcel: Parcel, asked: &Source) -> bool {
        let start = self.clock.now();
        let Parcel { name, size, hash, result } = parcel;
        let source = match asked {
            Source::Url(_) => asked.clone(),
            _ => Source::File { name: name.clone(), stamp: Some(Stamp { size, hash }) },
        };
        let loaded = match result {
            Ok((model, notices)) => document.load(source, model, &notices).map_err(|error| error.to_string()),
            Err(message) => Err(message),
        };
        match loaded {
            Ok(_) => {
                self.times.read = self.clock.now() - start;
                self.no_card("read");
                self.no_card("ask");
                true
            }
            Err(message) => {
                document.cancel_open();
                let title = format!("{} could not be opened", name.rsplit('/').next().unwrap_or(&name));
                let lines = vec![sentence(&message)];
                self.card(Card { id: "read", kind: "error", title, lines, ..Card::default() });
                false
            }
        }
    }

    /// What came from an address.
    pub(super) fn take_download(&mut self, url: &str, turn: u32, parcel: Option<Parcel>, error: &str) {
        let Some(opening) = self.opening.take_if(|o| o.turn == turn) else { return };
        let Some(parcel) = parcel else {
            if opening.document.is_none() {
                self.document.cancel_open();
            }
            let title = format!("{} could not be opened", opening.source.name());
            let lines = vec![format!("{url}: {error}.")];
            return self.card(Card { id: "read", kind: "error", title, lines, ..Card::default() });
        };
        match opening.document {
            Some(mut document) => {
                if self.read_into(&mut document, parcel, &opening.source) {
                    self.go_on(document, &opening.rest, None);
                }
            }
            None => self.take_parcel(parcel, &opening.source),
        }
    }

    /// Forgets a source that is on its way, and the card that asks for it.
    pub(super) fn stop_opening(&mut self) {
        self.stop_opening_quietly();
        self.no_card("ask");
    }

    fn stop_opening_quietly(&mut self) {
        if let Some(opening) = self.opening.take()
            && opening.document.is_none()
        {
            self.document.cancel_open();
        }
    }

    /// A card with what reading found, where that is worth a look.
    pub(super) fn report_card(&self) {
        const MOST: usize = 4;
        let remarks = self.document.remarks();
        let worth: Vec<&String> = remarks.iter().filter(|r| !r.minor).map(|r| &r.text).collect();
        if worth.is_empty() {
            return self.no_card("report");
        }
        let name = self.document.source().map_or("", Source::name);
        let mut lines: Vec<String> = worth.iter().take(MOST).map(|t| (*t).clone()).collect();
        if worth.len() > MOST {
            lines.push(format!("{} more are in the report.", worth.len() - MOST));
        }
        let title = format!("{name}: {} {}", worth.len(), if worth.len() == 1 { "note" } else { "notes" });
        self.card(Card { id: "report", kind: "note", title, lines, ..Card::default() });
    }

    /// Puts the model's materials on the GPU and has its pictures decoded.
    pub(super) fn paint(&mut self) {
        let Some(model) = self.document.model().cloned() else { return };
        if self.painted.as_ref().is_some_and(|(p, _)| Arc::ptr_eq(p, &model)) {
            return;
        }
        self.turn += 1;
        // No textures: always accepted.
        let _ = self.renderer.set_textures(&[]);
        let materials: Vec<_> = model
            .materials
            .iter()
            .map(|m| limn_render::Material { base_color: m.base_color, texture: m.texture })
            .collect();
        self.renderer.set_materials(&materials);
        for (index, image) in model.images.iter().enumerate() {
            let fields = [
                ("index", JsValue::from(index as u32)),
                ("mime", JsValue::from(&image.mime)),
                ("turn", JsValue::from(self.turn)),
            ];
            self.post.bytes("decode", &fields, &image.bytes);
        }
        self.painted = Some((model, self.turn));
    }

    /// A picture came back.
    pub(super) fn take_picture(&mut self, turn: u32, index: u32, bitmap: Option<web_sys::ImageBitmap>) {
        let Some((model, _)) = self.painted.clone().filter(|(_, painted)| *painted == turn) else { return };
        let Some(image) = model.images.get(index as usize) else { return };
        let result = match bitmap {
            Some(bitmap) => self
                .renderer
                .set_texture_external(index as usize, wgpu::ExternalImageSource::ImageBitmap(bitmap))
                .map_err(|e| e.to_string()),
            None => Err("the browser cannot decode it".to_owned()),
        };
        if let Err(error) = result {
            let title = format!("The picture {} is not shown", image.name);
            self.card(Card { id: "picture", kind: "note", title, lines: vec![sentence(&error)], ..Card::default() });
        }
        self.dirty.picture = true;
    }
}

/// The commands of a link's fragment or a document's text; an empty one is the first visit's.
fn commands_of(text: &str) -> Result<Vec<Command>, String> {
    match text.trim() {
        "" | "#" => Document::from_link(FIRST).map_err(|e| e.to_string()),
        t if t.starts_with("version") || t.starts_with("open") => parse_script(t).map_err(|e| e.to_string()),
        t => Document::from_link(t).map_err(|e| e.to_string()),
    }
}
