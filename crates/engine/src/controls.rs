//! The rows of the panel: one table, in which each choice is a command.
//!
//! The page makes its buttons from [`CONTROLS`] and presses the one that [`values`] names. A new row is a line here.

use limn_document::{Command, Document, ViewSet, parameters};
use limn_mesh::{Boundary, Domain, Family, LimitRule, Weld};
use serde::{Serialize, Serializer};

use crate::compare::name;
use crate::protocol::{Parameter, ParameterChoice, Run};
use crate::report::Facts;

/// A row.
#[derive(Debug, Serialize)]
pub struct Control {
    /// Names it in [`values`].
    pub id: &'static str,
    /// `view` or `surface`.
    pub tab: &'static str,
    /// What stands before it.
    pub label: &'static str,
    /// One sentence.
    pub help: &'static str,
    /// `choice`, `switch` (off and on) or `actions` (nothing is chosen).
    pub kind: &'static str,
    /// Its buttons.
    pub choices: &'static [Choice],
}

/// A button.
#[derive(Debug, Serialize)]
pub struct Choice {
    /// As in [`values`].
    pub value: &'static str,
    /// On the button.
    pub label: &'static str,
    /// What it sends.
    pub command: &'static str,
}

const fn choice(value: &'static str, label: &'static str, command: &'static str) -> Choice {
    Choice { value, label, command }
}

macro_rules! switch {
    ($tab:literal, $id:literal, $command:literal, $label:literal, $help:literal) => {
        Control {
            id: $id,
            tab: $tab,
            label: $label,
            help: $help,
            kind: "switch",
            choices: &[choice("off", "Off", concat!($command, "off")), choice("on", "On", concat!($command, "on"))],
        }
    };
}

/// Every row, in the order of the panel.
pub static CONTROLS: &[Control] = &[
    Control {
        id: "shading",
        tab: "view",
        label: "Shading",
        help: "How light falls on the faces: over the edges, or a face at a time",
        kind: "choice",
        choices: &[choice("smooth", "Smooth", "view shading=smooth"), choice("flat", "Flat", "view shading=flat")],
    },
    Control {
        id: "edges",
        tab: "view",
        label: "Edges",
        help: "Polygon edges; by level draws the edges of the level before bold and new ones faint",
        kind: "choice",
        choices: &[
            choice("off", "Off", "view edges=off"),
            choice("on", "All", "view edges=on"),
            choice("bold", "By level", "view edges=bold"),
            choice("only", "Only", "view edges=only"),
        ],
    },
    switch!("view", "cage", "view cage=", "Cage", "The model itself as lines over its surface"),
    switch!("view", "points", "view points=", "Points", "The vertices as dots"),
    switch!("view", "two-sided", "view two-sided=", "Light both sides", "Light the backs of faces like their fronts"),
    switch!("view", "textures", "view textures=", "Textures", "Pictures on the surface, where the file has them"),
    switch!("view", "colors", "view colors=", "Vertex colours", "Colours at the vertices, where the file has them"),
    switch!("view", "kinds", "view kinds=", "Kinds of faces", "Colour faces by what a dual scheme made them from"),
    Control {
        id: "camera",
        tab: "view",
        label: "Look from",
        help: "Where the viewer stands; Fit keeps the direction",
        kind: "actions",
        choices: &[
            choice("home", "Home", "view camera=home"),
            choice("fit", "Fit", "view camera=fit"),
            choice("front", "Front", "view camera=front"),
            choice("back", "Back", "view camera=back"),
            choice("left", "Left", "view camera=left"),
            choice("right", "Right", "view camera=right"),
            choice("top", "Top", "view camera=top"),
            choice("bottom", "Bottom", "view camera=bottom"),
            choice("iso", "Isometric", "view camera=iso"),
        ],
    },
    Control {
        id: "projection",
        tab: "view",
        label: "Projection",
        help: "Perspective, or parallel lines that stay parallel",
        kind: "choice",
        choices: &[
            choice("perspective", "Perspective", "view projection=perspective"),
            choice("orthographic", "Orthographic", "view projection=orthographic"),
        ],
    },
    Control {
        id: "up",
        tab: "view",
        label: "Up axis",
        help: "Which of the model's axes points up",
        kind: "choice",
        choices: &[choice("y", "Y", "view up=y"), choice("z", "Z", "view up=z")],
    },
    Control {
        id: "background",
        tab: "view",
        label: "Background",
        help: "What is behind the model; Clear makes pictures transparent there",
        kind: "choice",
        choices: &[
            choice("theme", "Theme", "view background=theme"),
            choice("light", "Light", "view background=light"),
            choice("dark", "Dark", "view background=dark"),
            choice("ffffff", "White", "view background=ffffff"),
            choice("transparent", "Clear", "view background=transparent"),
        ],
    },
    Control {
        id: "boundary",
        tab: "surface",
        label: "Open rims",
        help: "The rim of an open model is smoothed; its corners can stay or be smoothed too",
        kind: "choice",
        choices: &[
            choice("edge-and-corner", "Sharp corners", "boundary edge-and-corner"),
            choice("edge-only", "Smooth corners", "boundary edge-only"),
            choice("none", "Left out", "boundary none"),
        ],
    },
    switch!(
        "surface",
        "limit",
        "limit ",
        "Limit surface",
        "Vertices where endless refinement takes them, and its light"
    ),
    Control {
        id: "creases",
        tab: "surface",
        label: "Creases",
        help: "Keep edges sharp where faces meet at an angle; the console has `crease` and `corner` for single ones",
        kind: "actions",
        choices: &[
            choice("30", "Over 30°", "crease angle 30 10"),
            choice("60", "Over 60°", "crease angle 60 10"),
            choice("soft", "Over 60°, soft", "crease angle 60 2"),
            choice("none", "None", "crease none"),
        ],
    },
    Control {
        id: "crease-decay",
        tab: "surface",
        label: "Creases soften",
        help: "How semi-sharp creases soften from level to level: by one, or evened out along the crease first",
        kind: "choice",
        choices: &[
            choice("uniform", "Evenly", "crease-decay uniform"),
            choice("chaikin", "Along the crease", "crease-decay chaikin"),
        ],
    },
    Control {
        id: "triangle-rule",
        tab: "surface",
        label: "Triangles",
        help: "What Catmull–Clark makes of triangles: the same as of other polygons, or something smoother",
        kind: "choice",
        choices: &[
            choice("catmull-clark", "As polygons", "triangle-rule catmull-clark"),
            choice("smooth", "Smoother", "triangle-rule smooth"),
        ],
    },
    Control {
        id: "face-varying",
        tab: "surface",
        label: "Texture seams",
        help: "Where texture coordinates stay linear: nowhere, at corners and junctions, along whole seams, or everywhere",
        kind: "choice",
        choices: &[
            choice("none", "Smooth", "face-varying none"),
            choice("corners-only", "Corners", "face-varying corners-only"),
            choice("corners-plus1", "+ junctions", "face-varying corners-plus1"),
            choice("corners-plus2", "+ darts", "face-varying corners-plus2"),
            choice("boundaries", "Seams", "face-varying boundaries"),
            choice("all", "Linear", "face-varying all"),
        ],
    },
    Control {
        id: "weld",
        tab: "surface",
        label: "Join vertices",
        help: "Which vertices of the file are one: those in the same place, those that are nearly, or none",
        kind: "choice",
        choices: &[
            choice("off", "Never", "weld off"),
            choice("exact", "Same place", "weld exact"),
            choice("near", "Nearly", "weld 0.00001"),
        ],
    },
    switch!("surface", "quads", "quads ", "Pair triangles to quads", "Put quads together that were cut into triangles"),
    Control {
        id: "model",
        tab: "surface",
        label: "Model",
        help: "Changes of the model itself",
        kind: "actions",
        choices: &[
            choice("triangulate", "Triangulate", "triangulate"),
            choice("center", "Centre", "center"),
            choice("scale", "Scale to 1", "scale"),
        ],
    },
];

/// What is chosen in each row, by the row's id.
#[derive(Clone, Debug, PartialEq)]
pub struct Values(pub Vec<(&'static str, String)>);

impl Serialize for Values {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(id, value)| (id, value)))
    }
}

/// The chosen value of each row.
pub fn values(document: &Document) -> Values {
    let view = document.view();
    let on = |on: bool| (if on { "on" } else { "off" }).to_owned();
    let mut values: Vec<(&'static str, String)> = [
        ViewSet::Shading(view.shading),
        ViewSet::Edges(view.edges),
        ViewSet::Points(view.points),
        ViewSet::Cage(view.cage),
        ViewSet::TwoSided(view.two_sided),
        ViewSet::Textures(view.textures),
        ViewSet::Colors(view.colors),
        ViewSet::Kinds(view.kinds),
        ViewSet::Background(view.background),
        ViewSet::Up(view.camera.up),
        ViewSet::Projection(view.camera.projection),
    ]
    .iter()
    .map(|set| (set.key(), set.value()))
    .collect();
    if let Some((quads, weld)) = document.reading() {
        values.push(("quads", on(quads)));
        let weld = match weld {
            Weld::Off => "off",
            Weld::Exact => "exact",
            Weld::Relative(_) => "near",
        };
        values.push(("weld", weld.to_owned()));
    }
    if let Some(plan) = document.plan() {
        let rule = match plan.rules.boundary {
            Boundary::None => "none",
            Boundary::EdgeOnly => "edge-only",
            Boundary::EdgeAndCorner => "edge-and-corner",
        };
        values.push(("boundary", rule.to_owned()));
        values.push(("limit", on(plan.limit)));
        let rules = [
            Command::CreaseDecay(plan.rules.decay),
            Command::TriangleRule(plan.rules.triangle),
            Command::FaceVarying(plan.rules.face_varying),
        ];
        values.extend(rules.iter().map(|rule| {
            let word = rule.to_string().split(' ').nth(1).unwrap_or_default().to_owned();
            (rule.name(), word)
        }));
    }
    Values(values)
}

/// The chosen scheme's parameters, each with the commands that set it.
pub fn parameters(document: &Document) -> Vec<Parameter> {
    let Some(plan) = document.plan() else { return Vec::new() };
    let info = &plan.scheme.info;
    let values = plan.params.of(info);
    let row = |(at, param): (usize, &'static limn_mesh::Param)| {
        let value = values.get(at).copied().unwrap_or_default();
        let command = parameters::prefix(&plan, at);
        let (kind, low, high, words) = match &param.domain {
            Domain::Number { low, high, .. } => ("number", *low, *high, &[][..]),
            Domain::Whole { low, high, .. } => ("whole", f64::from(*low), f64::from(*high), &[][..]),
            Domain::Choice(words) => ("choice", 0.0, 0.0, *words),
        };
        let choice = |word: &&'static str| {
            let mut label = (*word).to_owned();
            if let Some(first) = label.get_mut(..1) {
                first.make_ascii_uppercase();
            }
            ParameterChoice { value: word, label, command: format!("{command}{word}") }
        };
        Parameter {
            key: param.key,
            name: param.name,
            summary: param.summary,
            kind,
            low,
            high,
            default: param.domain.default(),
            value,
            text: parameters::text(param, value),
            choices: words.iter().map(choice).collect(),
            command,
        }
    };
    info.params.iter().enumerate().map(row).collect()
}

/// The schemes that take over after the first.
pub fn runs(document: &Document) -> Vec<Run> {
    let Some(plan) = document.plan() else { return Vec::new() };
    let row = |run: &limn_mesh::Run| {
        let before = limn_mesh::Run { from: run.from, ..plan.run(run.from.saturating_sub(1)) };
        Run { from: run.from, name: name(run), leave: parameters::run_command(&before).to_string() }
    };
    plan.later.iter().map(row).collect()
}

/// The rows that make no difference to this model, of which `facts` are. Cost: constant.
pub fn disabled(document: &Document, facts: &Facts) -> Vec<&'static str> {
    let mut rows = Vec::new();
    let (Some(model), Some(mesh)) = (document.model(), document.mesh()) else { return rows };
    if model.images.is_empty() {
        rows.push("textures");
    }
    if mesh.colors.is_empty() {
        rows.push("colors");
    }
    if !document.panes().iter().any(|p| p.plan.level > 0 && p.plan.scheme.info.family == Family::Dual) {
        rows.push("kinds");
    }
    if facts.stats.boundary_loops == 0 {
        rows.push("boundary");
    }
    if document.plan().is_some_and(|p| p.scheme.limit == LimitRule::Itself) {
        rows.push("limit");
    }
    if !document.has_semi_sharp() {
        rows.push("crease-decay");
    }
    if mesh.uv.is_none() {
        rows.push("face-varying");
    }
    let paired = document.reading().is_some_and(|(quads, _)| quads);
    if !paired && !facts.triangles {
        rows.push("quads");
    }
    let catmull_clark = document.plan().is_some_and(|p| p.scheme.info.id == "catmull-clark");
    if !(catmull_clark && facts.triangles) {
        rows.push("triangle-rule");
    }
    rows
}

#[cfg(test)]
mod tests;
