//! How the model is shown: everything that changes the picture and not the model.
//!
//! A [`View`] is plain data. One command, `view key=value ...`, sets any of it, and [`View::settings`] gives back the
//! shortest such command: only what differs from the default. That text is what links and scripts hold, so
//! [`ViewSet`]'s parser and printer are inverse to each other (a test holds them to it). The camera is part of the view; its
//! numbers are rounded in the text, see [`Camera::quantised`].
//!
//! Views are not undone: a person who turned the model after an edit means to undo the edit, not the turn.

use std::fmt;

use crate::camera::{Bounds, Camera, DEFAULT_FOV, FOV_RANGE, Projection, Standard, UpAxis, wrap_degrees};
use crate::numbers::{single, text_single};

/// How light falls on the faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// Normals run smoothly over the edges.
    #[default]
    Smooth,
    /// Each face has its own normal.
    Flat,
}

/// Which polygon edges are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Edges {
    /// None.
    #[default]
    Off,
    /// All, equally.
    On,
    /// All; those that lie on the level before are bold, new ones faint.
    Bold,
    /// All, and no faces: wireframe.
    Only,
}

/// What is behind the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// As the page's theme has it.
    #[default]
    Theme,
    /// The light theme's.
    Light,
    /// The dark theme's.
    Dark,
    /// A colour of its own: sRGB, 8 bits each.
    Color([u8; 3]),
    /// Nothing: pictures of the view are transparent there.
    Transparent,
}

/// Where a view command puts the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraSet {
    /// A named direction, framed.
    Standard(Standard),
    /// The present direction, framed.
    Fit,
    /// All of it, in model units and degrees.
    Pose {
        /// The turn about the up axis, degrees in (-180, 180].
        yaw: f32,
        /// The angle above the horizon, degrees in -90..=90.
        pitch: f32,
        /// From the target to the eye, more than 0.
        distance: f32,
        /// The point looked at.
        target: [f32; 3],
    },
}

/// One `key=value` of a view command.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewSet {
    /// `shading=smooth|flat`
    Shading(Shading),
    /// `edges=off|on|bold|only`
    Edges(Edges),
    /// `points=on|off`: the vertices as dots.
    Points(bool),
    /// `cage=on|off`: the level 0 mesh as an overlay.
    Cage(bool),
    /// `two-sided=on|off`: back faces are lit like front faces; off shows them plain.
    TwoSided(bool),
    /// `textures=on|off`: base-colour textures.
    Textures(bool),
    /// `colors=on|off`: vertex colours.
    Colors(bool),
    /// `kinds=on|off`: faces coloured by what they were made from.
    Kinds(bool),
    /// `background=theme|light|dark|transparent|RRGGBB`
    Background(Background),
    /// `hide=NAME,NAME`: the groups that are not drawn; none shows all again.
    Hide(Vec<String>),
    /// `up=y|z`
    Up(UpAxis),
    /// `projection=perspective|orthographic`
    Projection(Projection),
    /// `fov=DEGREES` across the shorter side of the viewport.
    Fov(f32),
    /// `camera=home|front|back|left|right|top|bottom|iso|fit|YAW,PITCH,DISTANCE,X,Y,Z`
    Camera(CameraSet),
}

/// A key of the view command, for help and completion.
#[derive(Clone, Copy, Debug)]
pub struct ViewKey {
    /// What stands before the `=`.
    pub name: &'static str,
    /// The words that may stand behind it; empty if it takes numbers or names only.
    pub words: &'static [&'static str],
    /// What else may stand behind it; empty if nothing.
    pub free: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
}

const SWITCH: &[&str] = &["on", "off"];

/// Every key of the view command, in the order in which it is written.
pub static VIEW_KEYS: &[ViewKey] = &[
    ViewKey { name: "shading", words: &["smooth", "flat"], free: "", summary: "how light falls on the faces" },
    ViewKey {
        name: "edges",
        words: &["off", "on", "bold", "only"],
        free: "",
        summary: "polygon edges; bold tells the parent's from new ones, only is wireframe",
    },
    ViewKey { name: "points", words: SWITCH, free: "", summary: "vertices as dots" },
    ViewKey { name: "cage", words: SWITCH, free: "", summary: "the level 0 mesh as an overlay" },
    ViewKey { name: "two-sided", words: SWITCH, free: "", summary: "light back faces like front faces" },
    ViewKey { name: "textures", words: SWITCH, free: "", summary: "base-colour textures" },
    ViewKey { name: "colors", words: SWITCH, free: "", summary: "vertex colours" },
    ViewKey { name: "kinds", words: SWITCH, free: "", summary: "colours by what a dual scheme made a face from" },
    ViewKey {
        name: "background",
        words: &["theme", "light", "dark", "transparent"],
        free: "RRGGBB",
        summary: "what is behind the model",
    },
    ViewKey {
        name: "hide",
        words: &[],
        free: "GROUP,GROUP",
        summary: "the groups that are not drawn; nothing after = shows all",
    },
    ViewKey { name: "up", words: &["y", "z"], free: "", summary: "the axis that points up" },
    ViewKey {
        name: "projection",
        words: &["perspective", "orthographic"],
        free: "",
        summary: "how depth becomes size",
    },
    ViewKey { name: "fov", words: &[], free: "DEGREES", summary: "field of view across the shorter side, 5 to 120" },
    ViewKey {
        name: "camera",
        words: &["home", "front", "back", "left", "right", "top", "bottom", "iso", "fit"],
        free: "YAW,PITCH,DISTANCE,X,Y,Z",
        summary: "where the viewer stands; fit keeps the direction",
    },
];

impl ViewKey {
    /// What may stand behind the `=`, as help writes it: `on|off`.
    pub fn values(&self) -> String {
        let mut text = self.words.join("|");
        if !self.free.is_empty() {
            if !text.is_empty() {
                text.push('|');
            }
            text.push_str(self.free);
        }
        text
    }
}

fn switch(value: &str) -> Option<bool> {
    match value {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

impl ViewSet {
    /// Reads `value` for `key`. `None` if there is no such key or it does not take this value; [`VIEW_KEYS`] says what it
    /// takes.
    pub fn parse(key: &str, value: &str) -> Option<ViewSet> {
        Some(match key {
            "shading" => ViewSet::Shading(match value {
                "smooth" => Shading::Smooth,
                "flat" => Shading::Flat,
                _ => return None,
            }),
            "edges" => ViewSet::Edges(match value {
                "off" => Edges::Off,
                "on" => Edges::On,
                "bold" => Edges::Bold,
                "only" => Edges::Only,
                _ => return None,
            }),
            "points" => ViewSet::Points(switch(value)?),
            "cage" => ViewSet::Cage(switch(value)?),
            "two-sided" => ViewSet::TwoSided(switch(value)?),
            "textures" => ViewSet::Textures(switch(value)?),
            "colors" => ViewSet::Colors(switch(value)?),
            "kinds" => ViewSet::Kinds(switch(value)?),
            "background" => ViewSet::Background(match value {
                "theme" => Background::Theme,
                "light" => Background::Light,
                "dark" => Background::Dark,
                "transparent" => Background::Transparent,
                hex => Background::Color(parse_hex(hex)?),
            }),
            "hide" => ViewSet::Hide(parse_names(value)?),
            "up" => ViewSet::Up(match value {
                "y" => UpAxis::Y,
                "z" => UpAxis::Z,
                _ => return None,
            }),
            "projection" => ViewSet::Projection(match value {
                "perspective" => Projection::Perspective,
                "orthographic" => Projection::Orthographic,
                _ => return None,
            }),
            "fov" => ViewSet::Fov(single(value).filter(|v| (FOV_RANGE.0..=FOV_RANGE.1).contains(v))?),
            "camera" => ViewSet::Camera(parse_camera(value)?),
            _ => return None,
        })
    }

    /// The key that it sets.
    pub fn key(&self) -> &'static str {
        match self {
            ViewSet::Shading(_) => "shading",
            ViewSet::Edges(_) => "edges",
            ViewSet::Points(_) => "points",
            ViewSet::Cage(_) => "cage",
            ViewSet::TwoSided(_) => "two-sided",
            ViewSet::Textures(_) => "textures",
            ViewSet::Colors(_) => "colors",
            ViewSet::Kinds(_) => "kinds",
            ViewSet::Background(_) => "background",
            ViewSet::Hide(_) => "hide",
            ViewSet::Up(_) => "up",
            ViewSet::Projection(_) => "projection",
            ViewSet::Fov(_) => "fov",
            ViewSet::Camera(_) => "camera",
        }
    }

    /// The value as commands write it.
    pub fn value(&self) -> String {
        match self {
            ViewSet::Shading(Shading::Smooth) => "smooth".into(),
            ViewSet::Shading(Shading::Flat) => "flat".into(),
            ViewSet::Edges(edges) => match edges {
                Edges::Off => "off".into(),
                Edges::On => "on".into(),
                Edges::Bold => "bold".into(),
                Edges::Only => "only".into(),
            },
            ViewSet::Points(on)
            | ViewSet::Cage(on)
            | ViewSet::TwoSided(on)
            | ViewSet::Textures(on)
            | ViewSet::Colors(on)
            | ViewSet::Kinds(on) => on_off(*on).into(),
            ViewSet::Background(background) => match background {
                Background::Theme => "theme".into(),
                Background::Light => "light".into(),
                Background::Dark => "dark".into(),
                Background::Transparent => "transparent".into(),
                Background::Color([r, g, b]) => format!("{r:02x}{g:02x}{b:02x}"),
            },
            // A lone empty name would read as no name at all; twice it is once again.
            ViewSet::Hide(names) if *names == [""] => ",".into(),
            ViewSet::Hide(names) => names.iter().map(|n| escape_name(n)).collect::<Vec<_>>().join(","),
            ViewSet::Up(UpAxis::Y) => "y".into(),
            ViewSet::Up(UpAxis::Z) => "z".into(),
            ViewSet::Projection(Projection::Perspective) => "perspective".into(),
            ViewSet::Projection(Projection::Orthographic) => "orthographic".into(),
            ViewSet::Fov(fov) => text_single(*fov),
            ViewSet::Camera(CameraSet::Standard(standard)) => standard.name().into(),
            ViewSet::Camera(CameraSet::Fit) => "fit".into(),
            ViewSet::Camera(CameraSet::Pose { yaw, pitch, distance, target: [x, y, z] }) => {
                [yaw, pitch, distance, x, y, z].map(|v| text_single(*v)).join(",")
            }
        }
    }
}

impl fmt::Display for ViewSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key(), self.value())
    }
}

/// Six hexadecimal digits, or three, with or without a `#`.
fn parse_hex(text: &str) -> Option<[u8; 3]> {
    let digits: Vec<u8> = text
        .strip_prefix('#')
        .unwrap_or(text)
        .chars()
        .map(|c| c.to_digit(16).map(|d| d as u8))
        .collect::<Option<_>>()?;
    match *digits {
        [r, g, b] => Some([r * 17, g * 17, b * 17]),
        [a, b, c, d, e, f] => Some([a * 16 + b, c * 16 + d, e * 16 + f]),
        _ => None,
    }
}

fn parse_camera(value: &str) -> Option<CameraSet> {
    if value == "fit" {
        return Some(CameraSet::Fit);
    }
    if let Some(standard) = Standard::from_name(value) {
        return Some(CameraSet::Standard(standard));
    }
    let numbers: Vec<f32> = value.split(',').map(single).collect::<Option<_>>()?;
    match *numbers {
        [yaw, pitch, distance, x, y, z] if distance > 0.0 && (-90.0..=90.0).contains(&pitch) => {
            Some(CameraSet::Pose { yaw: wrap_degrees(yaw), pitch, distance, target: [x, y, z] })
        }
        _ => None,
    }
}

/// Group names between commas. `%` and two hexadecimal digits stand for a byte, so that any name can be written; each byte
/// pair must be well formed and the whole must be UTF-8.
fn parse_names(value: &str) -> Option<Vec<String>> {
    if value.is_empty() {
        return Some(Vec::new());
    }
    let mut names = Vec::new();
    for name in value.split(',') {
        insert_name(&mut names, crate::link::unescape(name, false)?);
    }
    Some(names)
}

/// Puts a name among sorted ones, unless it is there.
pub fn insert_name(names: &mut Vec<String>, name: String) {
    if let Err(at) = names.binary_search(&name) {
        names.insert(at, name);
    }
}

/// A group name such that commas and `%` in it neither end nor change it; [`parse_names`] reads it back.
fn escape_name(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for c in name.chars() {
        match c {
            ',' => text.push_str("%2C"),
            '%' => text.push_str("%25"),
            c => text.push(c),
        }
    }
    text
}

/// Everything that changes the picture and not the model.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Where the viewer stands, with projection and up axis.
    pub camera: Camera,
    /// How light falls on the faces.
    pub shading: Shading,
    /// Which polygon edges are drawn.
    pub edges: Edges,
    /// Vertices as dots.
    pub points: bool,
    /// The level 0 mesh as an overlay.
    pub cage: bool,
    /// Back faces are lit like front faces.
    pub two_sided: bool,
    /// Base-colour textures, where the model has them.
    pub textures: bool,
    /// Vertex colours, where the model has them.
    pub colors: bool,
    /// Faces coloured by what a dual scheme made them from.
    pub kinds: bool,
    /// What is behind the model.
    pub background: Background,
    /// The names of the groups that are not drawn, sorted, each once.
    pub hidden: Vec<String>,
}

impl Default for View {
    fn default() -> Self {
        View {
            camera: Camera::default(),
            shading: Shading::Smooth,
            edges: Edges::Off,
            points: false,
            cage: false,
            two_sided: true,
            textures: true,
            colors: true,
            kinds: false,
            background: Background::Theme,
            hidden: Vec::new(),
        }
    }
}

impl View {
    /// Changes one thing. `bounds` is the box of what is shown and `aspect` the viewport's width / height: named cameras
    /// frame it.
    pub fn set(&mut self, set: &ViewSet, bounds: &Bounds, aspect: f32) {
        match set {
            ViewSet::Shading(v) => self.shading = *v,
            ViewSet::Edges(v) => self.edges = *v,
            ViewSet::Points(v) => self.points = *v,
            ViewSet::Cage(v) => self.cage = *v,
            ViewSet::TwoSided(v) => self.two_sided = *v,
            ViewSet::Textures(v) => self.textures = *v,
            ViewSet::Colors(v) => self.colors = *v,
            ViewSet::Kinds(v) => self.kinds = *v,
            ViewSet::Background(v) => self.background = *v,
            ViewSet::Hide(names) => self.hidden.clone_from(names),
            ViewSet::Up(v) => {
                self.camera.up = *v;
                self.camera.refresh(bounds, aspect);
            }
            ViewSet::Projection(v) => {
                self.camera.projection = *v;
                self.camera.refresh(bounds, aspect);
            }
            ViewSet::Fov(v) => {
                self.camera.fov = *v;
                self.camera.refresh(bounds, aspect);
            }
            ViewSet::Camera(CameraSet::Standard(v)) => self.camera.set_standard(*v, bounds, aspect),
            ViewSet::Camera(CameraSet::Fit) => self.camera.frame(bounds, aspect),
            ViewSet::Camera(CameraSet::Pose { yaw, pitch, distance, target }) => {
                let camera = &mut self.camera;
                (camera.yaw, camera.pitch, camera.distance) = (*yaw, *pitch, *distance);
                camera.target = (*target).into();
                camera.standard = None;
            }
        }
    }

    /// The fewest settings that turn a default view into this one, the camera rounded as [`Camera::quantised`] has it.
    pub fn settings(&self) -> Vec<ViewSet> {
        let plain = View::default();
        let mut sets = Vec::new();
        let mut add = |differs: bool, set: ViewSet| {
            if differs {
                sets.push(set);
            }
        };
        add(self.shading != plain.shading, ViewSet::Shading(self.shading));
        add(self.edges != plain.edges, ViewSet::Edges(self.edges));
        add(self.points != plain.points, ViewSet::Points(self.points));
        add(self.cage != plain.cage, ViewSet::Cage(self.cage));
        add(self.two_sided != plain.two_sided, ViewSet::TwoSided(self.two_sided));
        add(self.textures != plain.textures, ViewSet::Textures(self.textures));
        add(self.colors != plain.colors, ViewSet::Colors(self.colors));
        add(self.kinds != plain.kinds, ViewSet::Kinds(self.kinds));
        add(self.background != plain.background, ViewSet::Background(self.background));
        add(!self.hidden.is_empty(), ViewSet::Hide(self.hidden.clone()));
        let camera = self.camera.quantised();
        add(camera.up != plain.camera.up, ViewSet::Up(camera.up));
        add(camera.projection != plain.camera.projection, ViewSet::Projection(camera.projection));
        add(camera.fov != DEFAULT_FOV, ViewSet::Fov(camera.fov));
        match camera.standard {
            Some(standard) => add(standard != Standard::Home, ViewSet::Camera(CameraSet::Standard(standard))),
            None => add(
                true,
                ViewSet::Camera(CameraSet::Pose {
                    yaw: camera.yaw,
                    pitch: camera.pitch,
                    distance: camera.distance,
                    target: camera.target.to_array(),
                }),
            ),
        }
        sets
    }

    /// Whether the group with this name is not drawn. Cost: a binary search.
    pub fn hides(&self, group: &str) -> bool {
        self.hidden.binary_search_by(|name| name.as_str().cmp(group)).is_ok()
    }
}
