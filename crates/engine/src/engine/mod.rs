//! The engine: one object that `web/host.js` owns and calls.
//!
//! Every call does what it can at once, marks what became stale ([`Dirty`]), and leaves the rest to `work` and `frame`,
//! which the host calls as long as `has_work` and `wants_frame` say so. A command changes the document at once; `sync`
//! compares what is wanted with what is shown and with what is being made.

mod aim;
mod open;
mod panes;
mod show;
mod work;

use std::sync::Arc;

use glam::Vec2;
use limn_document::camera::Camera;
use limn_document::command::{COMMANDS, Command};
use limn_document::remedy::Remedy;
use limn_document::{CommandError, Document, Outcome};
use limn_formats::parcel::Parcel;
use limn_mesh::{Mesh, Plan, SCHEMES, SHAPES};
use limn_render::{Gpu, Renderer, Screen, Tier};
use wasm_bindgen::prelude::*;

use crate::gestures::{self, Gestures, Viewport};
use crate::kernel::Remote;
use crate::making::{Made, Making, Parts};
use crate::pick::{mark, pick};
use crate::post::{Clock, Post};
use crate::protocol::{Card, CommandInfo, Hello, Message, ModelInfo, Offer, SchemeInfo, Times};
use crate::report::Facts;
use crate::shorthand::{self, Short};
use crate::{controls, keys};

/// The memory that refining may take for each gigabyte that the device has, in bytes; browsers say 8 at most.
const BUDGET_A_GIGABYTE: f64 = 96e6;
/// How long a camera takes from one named view to another, and the picture to make room for a panel: milliseconds.
const TWEEN: f64 = 240.0;

/// What became stale.
#[derive(Clone, Copy, Default)]
struct Dirty {
    /// The picture.
    picture: bool,
    /// The state message.
    state: bool,
    /// The state message, but for the camera alone: it can wait a moment.
    camera: bool,
}

/// Something on its way.
struct Tween<T> {
    from: T,
    to: T,
    start: f64,
}

impl<T> Tween<T> {
    /// How far it is, 0..=1, slow at both ends.
    fn at(&self, now: f64) -> f32 {
        let t = ((now - self.start) / TWEEN).clamp(0.0, 1.0) as f32;
        t * t * (3.0 - 2.0 * t)
    }
}

/// What the facts, parts and cage on the GPU were made of.
struct Known {
    mesh: Arc<Mesh>,
    facts: Facts,
    parts: Arc<Parts>,
}

/// The engine. See the module's text, and [`crate::protocol`] for what it posts.
#[wasm_bindgen]
pub struct Engine {
    post: Post,
    clock: Clock,
    renderer: Renderer,
    screen: Screen,
    document: Document,
    gestures: Gestures,
    /// The free part of the canvas, and the parts of it that pictures side by side have: one at least.
    viewport: Viewport,
    views: Vec<Viewport>,
    pixel_ratio: f32,
    dark: bool,
    calm: bool,
    dirty: Dirty,
    tween: Option<Tween<Camera>>,
    making_room: Option<Tween<Viewport>>,
    opening: Option<open::Opening>,
    /// Counts what was asked of the surroundings: late answers are told by it.
    turn: u32,
    known: Option<Known>,
    making: Option<Making>,
    /// The pane that is being made, or waits for a module.
    pane: usize,
    /// The module with every scheme, once it is loaded, and whether what is to be made waits for it.
    kernel: Option<Remote>,
    wants_kernel: bool,
    shown: Option<Made>,
    /// What is shown in the panes beside the first.
    beside: Vec<Option<Made>>,
    /// Panes that are left alone until the next command, and why.
    skipped: Vec<(Plan, String)>,
    /// The model whose materials and pictures are on the GPU, and the turn in which its pictures are decoded.
    painted: Option<(Arc<limn_formats::Model>, u32)>,
    /// The mesh whose cage is on the GPU.
    caged: Option<Arc<Mesh>>,
    /// A file to write once the level is there.
    export: Option<String>,
    times: Times,
    /// When the work that is going on began, when its progress was last told, and when a state was last posted.
    since: f64,
    told: Option<f64>,
    posted: f64,
}

#[wasm_bindgen]
impl Engine {
    /// Opens a device on the canvas (an `OffscreenCanvas` or an `HTMLCanvasElement`) and says hello. `theme` is `dark` or
    /// `light`, `calm` asks for no motion, `memory` is the device's in gigabytes, `emit` takes the messages.
    #[allow(clippy::too_many_arguments)]
    pub async fn create(
        canvas: JsValue,
        renderer: String,
        width: u32,
        height: u32,
        pixel_ratio: f32,
        insets: Vec<f32>,
        theme: String,
        calm: bool,
        memory: f64,
        emit: js_sys::Function,
    ) -> Result<Engine, JsValue> {
        let post = Post::new(emit);
        let tier = if renderer == "webgpu" { Tier::WebGpu } else { Tier::WebGl2 };
        let target = match canvas.dyn_into::<web_sys::OffscreenCanvas>() {
            Ok(canvas) => wgpu::SurfaceTarget::OffscreenCanvas(canvas),
            Err(canvas) => wgpu::SurfaceTarget::Canvas(canvas.dyn_into::<web_sys::HtmlCanvasElement>()?),
        };
        let instance = Gpu::instance(tier);
        let text = |e: &dyn std::fmt::Display| JsValue::from(e.to_string());
        let surface = instance.create_surface(target).map_err(|e| text(&e))?;
        let gpu = Gpu::new(&instance, Some(&surface), tier).await.map_err(|e| text(&e))?;
        let screen = Screen::new(&gpu, surface, width, height).map_err(|e| text(&e))?;
        let adapter = gpu.describe();
        let renderer = Renderer::new(gpu, screen.format());
        let budget = (memory.clamp(1.0, 8.0) * BUDGET_A_GIGABYTE) as u64;
        let mut engine = Engine {
            clock: Clock::new(),
            renderer,
            screen,
            document: Document::new(budget),
            gestures: Gestures::default(),
            viewport: Viewport::new(Vec2::ONE, [0.0; 4]),
            views: vec![Viewport::new(Vec2::ONE, [0.0; 4])],
            pixel_ratio: 1.0,
            dark: theme == "dark",
            calm,
            dirty: Dirty::default(),
            tween: None,
            making_room: None,
            opening: None,
            turn: 0,
            known: None,
            making: None,
            pane: 0,
            kernel: None,
            wants_kernel: false,
            shown: None,
            beside: Vec::new(),
            skipped: Vec::new(),
            painted: None,
            caged: None,
            export: None,
            times: Times::default(),
            since: 0.0,
            told: None,
            posted: 0.0,
            post,
        };
        engine.measure(width, height, pixel_ratio, &insets);
        engine.post.send(&Hello {
            renderer: if tier == Tier::WebGpu { "webgpu" } else { "webgl2" },
            adapter,
            version: env!("CARGO_PKG_VERSION"),
            schemes: SCHEMES
                .iter()
                .map(|e| &e.info)
                .map(|i| SchemeInfo {
                    id: i.id,
                    name: i.name,
                    group: i.group,
                    summary: i.summary,
                    command: format!("scheme {}", i.id),
                })
                .collect(),
            models: SHAPES.iter().map(|s| ModelInfo { name: s.name, summary: s.summary }).collect(),
            controls: controls::CONTROLS,
            keys: keys::KEYS,
            commands: COMMANDS
                .iter()
                .map(|s| CommandInfo {
                    name: s.name,
                    args: s.usage().split_once(' ').map_or(String::new(), |(_, args)| args.to_owned()),
                    help: s.summary.to_owned(),
                    class: s.class.name(),
                })
                .collect(),
        });
        Ok(engine)
    }

    /// Replays a link's fragment or a document's text; an empty one is a first visit. The parcel is a file that
    /// it may name, read and packed.
    /// `notice` says why the engine was replaced, if it was.
    pub fn replay(&mut self, text: &str, notice: String, parcel: Option<Vec<u8>>) {
        if !notice.is_empty() {
            self.card(Card {
                id: "fault",
                kind: "error",
                title: "Limn had to start again".into(),
                lines: vec![notice],
                ..Card::default()
            });
        }
        self.start(text, parcel.and_then(|bytes| self.unpack(&bytes)));
    }

    /// The name of the file to look for among dropped ones: one that a link or `text` names, or with `again` the present
    /// model's.
    pub fn wanted(&self, text: &str, again: bool) -> Option<String> {
        self.wanted_file(text, again)
    }

    /// The most memory that a model may take, in bytes.
    pub fn budget(&self) -> f64 {
        self.document.budget() as f64
    }

    /// Opens a dropped or chosen file that was read and packed, or with `again` the present model anew: from the parcel if
    /// it came from a file.
    pub fn open(&mut self, parcel: Option<Vec<u8>>, again: bool) {
        self.progress_over();
        let unpacked = parcel.and_then(|bytes| self.unpack(&bytes));
        match unpacked {
            _ if again => self.reload(unpacked),
            Some(parcel) => self.open_parcel(parcel),
            None => {}
        }
        self.dirty.state = true;
    }

    /// Runs a command line, or shorthand. `echo` always answers in the log; `drag` is a setting that may change again at
    /// once, as on a slider.
    pub fn command(&mut self, text: &str, echo: bool, drag: bool) {
        let expanded;
        let text = match shorthand::expand(text, &self.document) {
            Some(Short::Command(command)) => {
                expanded = command;
                &expanded
            }
            Some(Short::Turn(degrees)) => {
                let mut camera = self.aim();
                camera.orbit(Vec2::new(-degrees.x, degrees.y) / 180.0);
                return self.go(camera);
            }
            Some(Short::Zoom(factor)) => {
                let (bounds, aspect) = (self.bounds(), self.document.aspect());
                let mut camera = self.aim();
                camera.dolly(factor, Vec2::ZERO, aspect, &bounds);
                return self.go(camera);
            }
            Some(Short::Mark { what, amount, at }) => match self.mark(what, amount, at) {
                Some(command) => {
                    expanded = command;
                    &expanded
                }
                None => return,
            },
            None => text,
        };
        let camera = self.document.view().camera;
        let result = if drag { self.document.drag(text) } else { self.document.run(text) };
        match result {
            Ok(outcome) => self.carry_out(text, outcome, camera, echo || !drag),
            Err(error) => self.refuse(text, &error),
        }
        self.dirty.state = true;
    }

    /// Takes a frame's pointer and wheel events; see [`crate::gestures`].
    pub fn input(&mut self, batch: &[f32]) {
        let bounds = self.bounds();
        self.finish_tween();
        let held = self.gestures.held();
        let effect = self.gestures.apply(batch, &self.views, &mut self.document.view_mut().camera, &bounds);
        self.dirty.picture |= effect.moved;
        // Released, the camera comes to rest.
        self.dirty.camera |= effect.moved || held && !self.gestures.held();
        let hit = effect.pivot.and_then(|(pane, pointer)| Some((pointer, self.made(pane)?.clone())));
        if let Some((pointer, mut made)) = hit {
            if made.is_away() {
                made.refined = self.coarser(&made);
            }
            let mut camera = self.document.view().camera;
            let ray = camera.ray(pointer, self.document.aspect());
            let hidden = self.hidden_groups();
            let visible = |f: u32| {
                let group = made.parts.group(made.refined.face_source(f));
                !hidden.get(group as usize).copied().unwrap_or(false)
            };
            if let Some(point) = pick(&made.refined, &ray, visible) {
                camera.set_pivot(point);
                self.go(camera);
            }
        }
    }

    /// The canvas has another size (device pixels), or the page covers other parts of it (CSS pixels).
    pub fn resize(&mut self, width: u32, height: u32, pixel_ratio: f32, insets: &[f32]) {
        let before = self.viewport;
        let resized = self.screen.size() != [width, height];
        if resized {
            self.screen.resize(self.renderer.gpu(), width, height);
        }
        self.measure(width, height, pixel_ratio, insets);
        if !resized
            && !self.calm
            && self.shown.is_some()
            && before != self.viewport
            && before.size == self.viewport.size
        {
            let tween = Tween { from: before, to: self.viewport, start: self.clock.now() };
            self.take_viewport(before);
            self.making_room = Some(tween);
        }
        self.dirty.picture = true;
        self.dirty.camera = true;
    }

    /// The page is dark or light now.
    pub fn theme(&mut self, theme: &str) {
        self.dark = theme == "dark";
        self.dirty.picture = true;
    }

    /// Stops what is going on. The document goes back to what is shown.
    pub fn cancel(&mut self) {
        self.stop_opening();
        self.stop_making();
        self.progress_over();
        self.dirty.state = true;
    }

    /// Whether `work` has something to do.
    pub fn has_work(&self) -> bool {
        self.making.as_ref().is_some_and(|m| !m.waits())
    }

    /// Works for about so many milliseconds.
    pub fn work(&mut self, milliseconds: f64) {
        self.advance(self.clock.now() + milliseconds);
    }

    /// Whether `frame` has something to do.
    pub fn wants_frame(&self) -> bool {
        let Dirty { picture, state, camera } = self.dirty;
        picture || state || camera || self.tween.is_some() || self.making_room.is_some()
    }

    /// Draws and posts the state, each if it is stale. True if a model was drawn.
    pub fn frame(&mut self) -> bool {
        self.show_frame()
    }

    /// The surroundings read an address: the file, read and packed, or why not.
    pub fn fetched(&mut self, url: &str, turn: u32, parcel: Option<Vec<u8>>, error: &str) {
        self.progress_over();
        let parcel = parcel.and_then(|bytes| self.unpack(&bytes));
        self.take_download(url, turn, parcel, error);
        self.dirty.state = true;
    }

    /// The surroundings decoded a picture; none if it could not be.
    pub fn decoded(&mut self, turn: u32, index: u32, bitmap: Option<web_sys::ImageBitmap>) {
        self.take_picture(turn, index, bitmap);
    }
}

impl Engine {
    fn unpack(&self, bytes: &[u8]) -> Option<Parcel> {
        let parcel = Parcel::unpack(bytes);
        if let Err(error) = &parcel {
            let title = "The file could not be opened".to_owned();
            let lines = vec![limn_document::words::sentence(&error.to_string())];
            self.card(Card { id: "read", kind: "error", title, lines, ..Card::default() });
        }
        parcel.ok()
    }

    fn card(&self, card: Card) {
        self.post.send(&Message::Card { card });
    }

    fn no_card(&self, id: &'static str) {
        self.card(Card { id, ..Card::default() });
    }

    fn log(&self, command: &str, text: String, ok: bool) {
        self.post.send(&Message::Log { command: command.to_owned(), text, ok, offer: None });
    }

    fn refuse(&self, command: &str, error: &CommandError) {
        let remedy = command.parse().ok().and_then(|parsed| self.document.remedy(&parsed, error));
        let offer = remedy.map(|Remedy { label, commands }| Offer { label, commands });
        let text = limn_document::words::sentence(&error.to_string());
        self.post.send(&Message::Log { command: command.to_owned(), text, ok: false, offer });
    }

    /// The command that marks what lies under a place on the canvas, in CSS pixels; none if nothing of the model does.
    fn mark(&self, what: &str, amount: &str, at: Vec2) -> Option<String> {
        let view = self.views.get(gestures::pane(&self.views, at))?;
        let ray = self.document.view().camera.ray(view.pointer(at), self.document.aspect());
        mark(self.document.polygons()?, &ray, what, amount)
    }

    /// What a command asks of the host.
    fn carry_out(&mut self, text: &str, outcome: Outcome, camera: Camera, log: bool) {
        let mut answer = String::new();
        match outcome {
            Outcome::Nothing => {}
            Outcome::View => {
                let to = self.document.view().camera;
                if to != camera && self.tween.is_none() {
                    self.document.view_mut().camera = camera;
                    self.go(to);
                } else {
                    self.tween = None;
                }
                self.sync();
            }
            Outcome::Refine => {
                self.skipped.clear();
                let (due, panes) = (self.dirty.picture, self.views.len());
                self.sync();
                // What is shown stays until the new level is there: drawing it once more would only hold up the buffers.
                if (self.making.is_some() || self.wants_kernel) && self.views.len() == panes {
                    self.dirty.picture = due;
                }
            }
            Outcome::Model => {
                self.skipped.clear();
                self.tween = None;
                self.sync();
                self.report_card();
            }
            Outcome::Open(source) => self.fetch_source(source),
            Outcome::Export { file } => self.start_export(file),
            Outcome::Info { json } => {
                let shown = self.shown.as_ref().filter(|_| !self.making_first());
                // Of a level whose points are on the GPU the box is known.
                let of_box = self.renderer.surface().map(|s| [s.bounds().min, s.bounds().max]);
                let points = shown.and_then(|m| {
                    if m.is_away() { of_box.as_ref().map(|b| &b[..]) } else { Some(&m.refined.points[..]) }
                });
                answer = self
                    .document
                    .info(points)
                    .map_or(String::new(), |info| if json { info.json() } else { info.text() });
            }
            Outcome::Help(text) => answer = text,
        }
        if log {
            self.log(text, answer.trim_end().to_owned(), true);
        }
    }

    /// Whether a command line opens something, for logs.
    fn is_open(command: &Command) -> bool {
        matches!(command, Command::Open(_))
    }
}
