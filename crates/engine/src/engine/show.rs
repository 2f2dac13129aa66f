//! What goes out: frames, the state message, and files.

use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3};
use limn_document::Source;
use limn_document::camera::{Bounds, UpAxis};
use limn_document::export::ExportError;
use limn_document::view::{Background, Edges, Shading};
use limn_render::{Camera, Frame, Style};
use wasm_bindgen::JsValue;

use super::Engine;
use super::open::Opening;
use crate::gestures::Viewport;
use crate::making::Made;
use crate::protocol::{Count, ExportChoice, ModelState, Remark, Shown, State};
use crate::{compare, controls, report};
use limn_document::words::sentence;

/// The page's grounds, top and bottom, as web/base.css has them.
const DARK: [[f32; 3]; 2] = [[0.118, 0.129, 0.149], [0.067, 0.071, 0.082]];
const LIGHT: [[f32; 3]; 2] = [[0.973, 0.969, 0.957], [0.894, 0.886, 0.867]];
/// Faces made from a face, an edge, a vertex: three of Okabe and Ito's colours for all eyes, as web/compare.css has them.
const DARK_KINDS: [[f32; 3]; 3] = [[0.949, 0.722, 0.294], [0.424, 0.722, 0.933], [0.184, 0.659, 0.510]];
const LIGHT_KINDS: [[f32; 3]; 3] = [[0.910, 0.639, 0.090], [0.180, 0.525, 0.784], [0.039, 0.478, 0.361]];
/// State messages that tell of the camera alone are at least so many milliseconds apart.
const CAMERA_PAUSE: f64 = 200.0;

impl Engine {
    pub(super) fn show_frame(&mut self) -> bool {
        let now = self.clock.now();
        if let Some(room) = &self.making_room {
            let (t, from, to) = (room.at(now), room.from, room.to);
            self.take_viewport(from.blend(&to, t));
            self.dirty.picture = true;
            if t >= 1.0 {
                self.making_room = None;
                self.dirty.state = true;
            }
        }
        if let Some(tween) = &self.tween {
            let t = tween.at(now);
            let camera = tween.from.blend(&tween.to, t);
            self.document.view_mut().camera = camera;
            self.dirty.picture = true;
            if t >= 1.0 {
                self.finish_tween();
                self.dirty.state = true;
            }
        }
        let camera_due = self.dirty.camera && now - self.posted > CAMERA_PAUSE && self.tween.is_none();
        if camera_due && !self.gestures.held() {
            // At rest the camera is what a link says of it, so that whoever follows the link sees the same pixels.
            let camera = &mut self.document.view_mut().camera;
            let rounded = camera.quantised();
            self.dirty.picture |= rounded != *camera;
            *camera = rounded;
        }
        // The camera is the document's; while another model is being made ready for it, the last picture stays.
        let other = match (&self.painted, self.document.model()) {
            (Some((painted, _)), Some(model)) => !Arc::ptr_eq(painted, model),
            _ => true,
        };
        let waiting = (self.making.is_some() || self.wants_kernel) && other;
        let mut drawn = false;
        if std::mem::take(&mut self.dirty.picture) && !waiting {
            drawn = self.draw() && self.shown.is_some();
            if let Some(first) = self.renderer.gpu().take_errors().first() {
                self.trouble(first);
            }
        }
        if self.dirty.state || camera_due {
            self.dirty.state = false;
            self.dirty.camera &= !camera_due;
            self.posted = now;
            let state = self.state();
            self.post.send(&state);
        }
        drawn
    }

    fn draw(&mut self) -> bool {
        let start = self.clock.now();
        let Some(frame) = self.screen.acquire(self.renderer.gpu()) else { return false };
        let hidden = self.hidden_groups();
        let pictures: Vec<Frame<'_>> =
            self.views.iter().enumerate().map(|(i, view)| self.picture(i, view, &hidden)).collect();
        let part = |i| compare::clip(&self.views, i, self.pixel_ratio, frame.size);
        let frames: Vec<_> = pictures.iter().enumerate().map(|(i, picture)| (picture, part(i))).collect();
        let result = self.renderer.draw_panes(&frame.view, frame.size, &frames);
        self.screen.present(self.renderer.gpu(), frame);
        self.times.draw = self.clock.now() - start;
        match result {
            Ok(()) => true,
            Err(limn_render::Error::Lost(why)) => {
                let message = format!("the graphics device was lost ({why})");
                self.post.send(&crate::protocol::Message::Fault { message, kind: "trap" });
                false
            }
            Err(error) => {
                self.trouble(&error.to_string());
                false
            }
        }
    }

    /// Which of the model's groups are not drawn, by number.
    pub(super) fn hidden_groups(&self) -> Vec<bool> {
        let view = self.document.view();
        let groups = self.document.model().map_or(&[][..], |m| &m.groups);
        if view.hidden.is_empty() { Vec::new() } else { groups.iter().map(|g| view.hides(g)).collect() }
    }

    /// Camera and style of the present view, for what is shown in a pane that has this part of the canvas.
    fn picture<'a>(&self, pane: usize, viewport: &Viewport, hidden_groups: &'a [bool]) -> Frame<'a> {
        let view = self.document.view();
        let mut style = if self.dark { Style::dark() } else { Style::light() };
        let ground = |[top, bottom]: [[f32; 3]; 2]| limn_render::Background::Gradient(top, bottom);
        style.background = match view.background {
            Background::Theme => ground(if self.dark { DARK } else { LIGHT }),
            Background::Dark => ground(DARK),
            Background::Light => ground(LIGHT),
            Background::Color(rgb) => limn_render::Background::Solid(rgb.map(|c| f32::from(c) / 255.0)),
            Background::Transparent => limn_render::Background::Transparent,
        };
        style.shading = match view.shading {
            Shading::Smooth => limn_render::Shading::Smooth,
            Shading::Flat => limn_render::Shading::Flat,
        };
        style.edges = match view.edges {
            Edges::Off => limn_render::Edges::Off,
            Edges::On => limn_render::Edges::On,
            Edges::Bold => limn_render::Edges::Bold,
            Edges::Only => limn_render::Edges::Wire,
        };
        style.points = view.points;
        style.cage = view.cage;
        style.two_sided = view.two_sided;
        style.textures = view.textures;
        style.colors = view.colors;
        style.kinds = view.kinds.then_some(if self.dark { DARK_KINDS } else { LIGHT_KINDS });
        // The near and far planes hold what is shown: the surface, and the cage around it.
        let mut bounds = self.document.bounds();
        if let Some(surface) =
            self.renderer.surface_in(pane).map(limn_render::Surface::bounds).filter(|b| !b.is_empty())
        {
            bounds = Bounds::new(bounds.min.min(Vec3::from(surface.min)), bounds.max.max(Vec3::from(surface.max)));
        }
        let camera = &view.camera;
        let (near, far) = camera.clip_range(&bounds);
        let (scale, offset) = viewport.to_canvas();
        let proj = shift(scale, offset) * camera.projection_matrix(viewport.aspect(), near, far);
        let up = match camera.up {
            UpAxis::Y => Vec3::Y,
            UpAxis::Z => Vec3::Z,
        };
        Frame { camera: Camera { view: camera.view(), proj, up }, style, pixel_ratio: self.pixel_ratio, hidden_groups }
    }

    /// Counts of what is shown in a pane, and the bytes that it takes here and on the GPU.
    fn count(&self, pane: usize) -> Count {
        let Some(made) = self.made(pane) else { return Count::default() };
        let c = made.refined.counts;
        let gpu = self.renderer.surface_in(pane).map_or(0, limn_render::Surface::bytes);
        Count { vertices: c.vertices, edges: c.edges, faces: c.faces, bytes: made.bytes() + gpu }
    }

    /// The whole view model.
    fn state(&self) -> State {
        let document = &self.document;
        let plan = document.plan();
        let source = document.source();
        let facts = self.known.as_ref().map(|k| &k.facts);
        let model = source.zip(facts).map(|(source, facts)| ModelState {
            name: source.name().to_owned(),
            summary: facts.summary(),
            builtin: matches!(source, Source::Builtin(_)),
            reload: match source {
                Source::Builtin(_) => "",
                Source::File { .. } => "file",
                Source::Url(_) => "url",
            },
            facts: facts.rows(document),
        });
        let shown = self.shown.as_ref().map_or_else(Shown::default, |made| Shown {
            count: self.count(0),
            level: made.plan.level,
            scheme: made.plan.scheme.info.id,
        });
        let panes = document.panes();
        let about = |i: usize| {
            let plan = panes.get(i).map(|p| &p.plan);
            let why = self.skipped.iter().find(|s| Some(&s.0) == plan).map(|s| s.1.clone());
            (self.count(i), why)
        };
        let stem = document.model().map_or("model", |m| m.name.as_str());
        let stem = plan.as_ref().filter(|p| p.level > 0).map_or(stem.to_owned(), |p| format!("{stem}-{}", p.level));
        let file = |ending: &str| format!("export {}", limn_document::words::quote(&format!("{stem}.{ending}")));
        let (undo, redo) = document.undo_steps();
        let lines = document.commands().into_iter().filter(Engine::is_open).map(|c| c.to_string());
        State {
            model,
            scheme: plan.as_ref().map_or("", |p| p.scheme.info.id),
            params: controls::parameters(document),
            runs: controls::runs(document),
            fairings: plan.iter().flat_map(|p| p.fairings.iter().map(|f| [f.at, f.iterations])).collect(),
            level: plan.as_ref().map_or(0, |p| p.level),
            levels: report::ruler(document),
            shown,
            times: self.times,
            busy: self.making.is_some()
                || self.wants_kernel
                || self.told.is_some()
                || self.tween.is_some()
                || self.making_room.is_some()
                || self.opening.as_ref().is_some_and(Opening::comes),
            compare: compare::compare(document, &panes, &self.views, about),
            values: controls::values(document),
            disabled: facts.map(|f| controls::disabled(document, f)).unwrap_or_default(),
            groups: facts.map(|f| f.groups(document)).unwrap_or_default(),
            report: document
                .remarks()
                .into_iter()
                .map(|r| Remark { text: r.text, kind: if r.minor { "note" } else { "warning" } })
                .collect(),
            exports: vec![
                ExportChoice { label: "OBJ", help: "Polygons of this level, in full precision", command: file("obj") },
                ExportChoice { label: "GLB", help: "glTF for programs that draw", command: file("glb") },
                ExportChoice { label: "PNG", help: "A picture of this view", command: file("png") },
            ],
            undo: undo.map(str::to_owned),
            redo: redo.map(str::to_owned),
            text: document.text(),
            origin: lines.collect(),
            link: document.link(),
            link_note: match source {
                Some(Source::File { .. }) => {
                    format!(
                        "Link copied. It names {} but does not hold it: whoever opens it is asked for the file",
                        source.map_or("", Source::name)
                    )
                }
                _ => String::new(),
            },
        }
    }

    /// Writes a file now, or when the level that is being made is there.
    pub(super) fn start_export(&mut self, file: String) {
        let away = self.shown.as_ref().is_some_and(Made::is_away) && !is_picture(&file);
        if self.making_first() || away {
            self.export = Some(file);
            self.sync();
        } else {
            self.write(&file);
        }
    }

    pub(super) fn write(&mut self, file: &str) {
        if is_picture(file) {
            return self.write_picture(file);
        }
        let Some(made) = &self.shown else { return };
        match self.document.export_packed(&made.refined, file) {
            Ok(packed) => self.post.bytes("write", &[("name", JsValue::from(file))], &packed),
            Err(error) => {
                let why = match error {
                    // The document knows nothing of pictures.
                    ExportError::Format { .. } => {
                        format!("`{file}` does not say in which format to write; end it in .obj, .glb or .png.")
                    }
                    _ => sentence(&error.to_string()),
                };
                self.log(&format!("export {file}"), why, false);
            }
        }
    }

    fn write_picture(&mut self, file: &str) {
        self.finish_tween();
        let hidden = self.hidden_groups();
        let picture = self.picture(0, &self.viewport, &hidden);
        let [width, height] = self.screen.size();
        match self.renderer.image(&picture, width, height) {
            Ok(pixels) => {
                let (post, name) = (self.post.clone(), file.to_owned());
                wasm_bindgen_futures::spawn_local(async move {
                    match pixels.await {
                        Ok(pixels) => {
                            let fields = [
                                ("name", JsValue::from(&name)),
                                ("width", JsValue::from(width)),
                                ("height", JsValue::from(height)),
                            ];
                            post.bytes("png", &fields, &pixels);
                        }
                        Err(error) => post.send(&crate::protocol::Message::Log {
                            command: format!("export {name}"),
                            text: sentence(&error.to_string()),
                            ok: false,
                            offer: None,
                        }),
                    }
                });
            }
            Err(error) => self.trouble(&error.to_string()),
        }
    }
}

/// Takes clip coordinates of the free part of the canvas to those of all of it.
fn shift(scale: Vec2, offset: Vec2) -> Mat4 {
    Mat4::from_translation(offset.extend(0.0)) * Mat4::from_scale(scale.extend(1.0))
}

fn is_picture(file: &str) -> bool {
    file.rsplit_once('.').is_some_and(|(_, e)| e.eq_ignore_ascii_case("png"))
}
