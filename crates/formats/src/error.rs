//! What can go wrong on the way in and out: errors that stop, and warnings that do not.
//!
//! An error is one sentence that says what and where. A warning counts how often one thing happened and keeps the first
//! places, so a file with a million unused normals gives one line.

use std::fmt;

/// Why a file could not be read. Each message is one sentence for the person who dropped the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// The file has no bytes, or only blanks.
    #[error("{file} is empty.")]
    Empty {
        /// The file's name.
        file: String,
    },
    /// Neither content nor extension is known.
    #[error("{file} is in no format that Limn reads: it reads OBJ (.obj), glTF (.gltf) and binary glTF (.glb).")]
    UnknownFormat {
        /// The file's name.
        file: String,
    },
    /// A text format with bytes that no text has.
    #[error("{file} is not text: byte {byte} is {what}.")]
    NotText {
        /// The file's name.
        file: String,
        /// 0-based position.
        byte: u64,
        /// What stands there.
        what: &'static str,
    },
    /// A statement of a text format.
    #[error("Line {line}: {problem}.")]
    Line {
        /// 1-based line number.
        line: u64,
        /// The problem, without a full stop.
        problem: String,
    },
    /// JSON that does not parse.
    #[error("{file} is not valid JSON at line {line}, column {column}: {problem}.")]
    Json {
        /// The file's name.
        file: String,
        /// 1-based line number within the JSON text.
        line: u64,
        /// 1-based column.
        column: u64,
        /// What the parser says.
        problem: String,
    },
    /// The container around a binary glTF.
    #[error("{file} is a damaged GLB file: {problem}.")]
    Container {
        /// The file's name.
        file: String,
        /// The problem, with its byte.
        problem: String,
    },
    /// An element of a glTF file.
    #[error("{place}: {problem}.")]
    Element {
        /// Where, as a path into the JSON: `accessors[3]`.
        place: String,
        /// The problem, without a full stop.
        problem: String,
    },
    /// Another version of a format.
    #[error("{file} is glTF {version}; Limn reads glTF 2: convert it with a current exporter.")]
    Version {
        /// The file's name.
        file: String,
        /// The version that the file states.
        version: String,
    },
    /// An extension that the file requires.
    #[error("The file requires the glTF extension {name}, which Limn does not read: {advice}.")]
    Extension {
        /// The extension.
        name: String,
        /// What to do.
        advice: &'static str,
    },
    /// A file next to the model without which it cannot be read.
    #[error("The file {missing} is missing ({needed_by} needs it): open it together with the model.")]
    MissingFile {
        /// The file that was asked for.
        missing: String,
        /// What refers to it.
        needed_by: String,
    },
    /// Nothing to show.
    #[error("{file} has no faces: {found}.")]
    NoFaces {
        /// The file's name.
        file: String,
        /// What there was instead.
        found: String,
    },
    /// More than the memory budget allows.
    #[error("{what} would need {} of memory, more than the limit of {}.", Bytes(*.need), Bytes(*.limit))]
    TooBig {
        /// What is too big.
        what: String,
        /// Bytes needed, at least.
        need: u64,
        /// Bytes allowed.
        limit: u64,
    },
}

/// Bytes for people: `1.5 GB`.
struct Bytes(u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (unit, name) = match self.0 {
            0..1_000_000 => (1_000, "kB"),
            1_000_000..1_000_000_000 => (1_000_000, "MB"),
            _ => (1_000_000_000, "GB"),
        };
        // One decimal, rounded up, in integers.
        let tenths = (u128::from(self.0) * 10).div_ceil(unit);
        if tenths % 10 == 0 {
            write!(f, "{} {name}", tenths / 10)
        } else {
            write!(f, "{}.{} {name}", tenths / 10, tenths % 10)
        }
    }
}

/// The memory that reading may use for what it builds (positions, faces, decoded buffers, pictures), in bytes.
///
/// The bytes of the files themselves are not counted. The default is 1 GB, which leaves a browser's 4 GB of address space
/// room for topology and refinement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes.
    pub bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { bytes: 1_000_000_000 }
    }
}

/// A count of bytes against a limit.
pub(crate) struct Budget {
    used: u64,
    limit: u64,
}

impl Budget {
    pub fn new(limits: &Limits) -> Self {
        Budget { used: 0, limit: limits.bytes }
    }

    /// Reserves `count` things of `size` bytes each, before they are built.
    pub fn spend(&mut self, what: &str, count: u64, size: u64) -> Result<(), ReadError> {
        self.used = self.used.saturating_add(count.saturating_mul(size));
        self.check(what, self.used)
    }

    /// Checks a total that the caller keeps, on top of what is reserved.
    pub fn check_total(&self, what: &str, bytes: u64) -> Result<(), ReadError> {
        self.check(what, self.used.saturating_add(bytes))
    }

    fn check(&self, what: &str, need: u64) -> Result<(), ReadError> {
        if need <= self.limit {
            return Ok(());
        }
        Err(ReadError::TooBig { what: what.to_owned(), need, limit: self.limit })
    }
}

macro_rules! warning_kinds {
    ($($(#[doc = $doc:literal])* $kind:ident = $one:literal, $many:literal, $rest:literal;)*) => {
        /// What a file holds that was not used, or was read otherwise than written.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum WarningKind { $($(#[doc = $doc])* $kind,)* }

        impl WarningKind {
            /// Singular, plural, and what follows "is" or "are".
            fn words(self) -> [&'static str; 3] {
                match self { $(WarningKind::$kind => [$one, $many, $rest],)* }
            }
        }
    };
}

warning_kinds! {
    /// OBJ `vn`, glTF `NORMAL`.
    Normals = "normal", "normals", "not used because Limn computes its own";
    /// OBJ `s`.
    SmoothingGroups = "smoothing group statement", "smoothing group statements", "not used";
    /// OBJ `l`.
    Lines = "line element", "line elements", "not used";
    /// OBJ `p`.
    Points = "point element", "point elements", "not used";
    /// OBJ `curv`, `surf` and their kin.
    FreeForm = "free-form curve or surface statement", "free-form curve and surface statements", "not used";
    /// A keyword that the format does not have.
    UnknownStatement = "statement", "statements", "not understood and skipped";
    /// A face with one or two corners.
    FaceTooSmall = "face with fewer than three corners", "faces with fewer than three corners", "left out";
    /// A corner names a texture coordinate that is not there.
    UvMissing = "corner with a texture coordinate that the file does not have", "corners with a texture coordinate that the file does not have", "read without one";
    /// Texture coordinates that are NaN or infinite.
    UvNotFinite = "texture coordinate that is not a finite number", "texture coordinates that are not finite numbers", "read as 0";
    /// Some vertices have a colour, others none.
    ColorMissing = "vertex without a colour in a coloured file", "vertices without a colour in a coloured file", "read as white";
    /// Colours that are NaN, infinite or negative.
    ColorRange = "vertex colour out of range", "vertex colours out of range", "clamped";
    /// OBJ rational weight `w`.
    Weights = "vertex weight (w)", "vertex weights (w)", "not used";
    /// A tag other than crease and corner.
    TagUnknown = "tag other than crease and corner", "tags other than crease and corner", "not used";
    /// A crease or corner that names a vertex that is not there, or does not parse.
    TagBroken = "crease or corner tag that does not fit the file", "crease and corner tags that do not fit the file", "left out";
    /// An `mtllib` that was not among the files.
    MaterialFileMissing = "material file", "material files", "missing, so its materials show plain";
    /// A `usemtl` name that no MTL file defines.
    MaterialUndefined = "material name", "material names", "not defined and shown plain";
    /// MTL values other than base colour, opacity and base-colour picture; glTF material properties likewise.
    MaterialSettings = "material setting other than base colour", "material settings other than base colour", "not used";
    /// A line of an MTL file that does not parse.
    MaterialBroken = "material value that is not a number", "material values that are not numbers", "skipped";
    /// A picture that was not among the files.
    TextureMissing = "picture", "pictures", "missing, so its surface shows without it";
    /// A picture whose bytes are none of PNG, JPEG, WebP, GIF, BMP and AVIF.
    TextureFormat = "picture in a format that browsers do not show", "pictures in a format that browsers do not show", "left out";
    /// Offset, scale and other options of a picture.
    TextureOptions = "picture option (offset, scale and the like)", "picture options (offset, scale and the like)", "not used";
    /// A glTF primitive of points or lines.
    PointOrLinePrimitives = "primitive of points or lines", "primitives of points or lines", "not used";
    /// A glTF primitive without positions.
    NoPositions = "primitive without positions", "primitives without positions", "left out";
    /// Indices left over in a triangle list.
    LeftoverIndices = "primitive with leftover indices that make no triangle", "primitives with leftover indices that make no triangle", "cut to whole triangles";
    /// glTF skins.
    Skins = "skin", "skins", "not used: the model is shown in its bind pose";
    /// glTF morph targets.
    MorphTargets = "morph target", "morph targets", "not used";
    /// glTF animations.
    Animations = "animation", "animations", "not used";
    /// glTF cameras.
    Cameras = "camera", "cameras", "not used";
    /// glTF lights.
    Lights = "light", "lights", "not used";
    /// Optional glTF extensions that Limn does not know.
    Extensions = "optional extension", "optional extensions", "not used";
    /// Vertex attributes such as tangents and second texture coordinates.
    Attributes = "vertex attribute other than position, colour and first texture coordinate", "vertex attributes other than position, colour and first texture coordinate", "not used";
    /// A vertex attribute that breaks the rules and is not needed for the shape.
    AttributeBroken = "vertex attribute that breaks the rules of glTF", "vertex attributes that break the rules of glTF", "left out";
    /// Meshes that no node of the scene shows.
    OtherScenes = "mesh outside the scene that is shown", "meshes outside the scene that is shown", "not used";
    /// A polygon encoding whose triangles do not form polygons.
    PolygonEncoding = "primitive with a broken polygon encoding", "primitives with a broken polygon encoding", "read as triangles";
}

/// One thing that happened while reading, and how often. `Display` gives one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What happened.
    pub kind: WarningKind,
    /// How often, at least 1.
    pub count: u64,
    /// The first place, or the names concerned: `first on line 7`, `wood.png, stone.png`.
    pub place: Option<String>,
}

impl Warning {
    /// Whether this is found in almost every file and changes nothing that people expect: pages may fold such warnings.
    pub fn is_minor(&self) -> bool {
        use WarningKind::*;
        matches!(self.kind, Normals | SmoothingGroups | MaterialSettings | Attributes)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [one, many, rest] = self.kind.words();
        let (noun, verb) = if self.count == 1 { (one, "is") } else { (many, "are") };
        write!(f, "{} {noun}", self.count)?;
        if let Some(place) = &self.place {
            write!(f, " ({place})")?;
        }
        write!(f, " {verb} {rest}.")
    }
}

/// A name from a file, fit for a message: at most 80 characters, control characters as `?`.
pub(crate) fn short(name: &str) -> String {
    let mut out: String = name.chars().take(80).map(|c| if c.is_control() { '?' } else { c }).collect();
    if out.len() < name.len() {
        out.push('\u{2026}');
    }
    out
}

/// Collects warnings, one per kind.
#[derive(Default)]
pub(crate) struct Warnings(Vec<(Warning, usize)>);

impl Warnings {
    /// Counts `count` more of a kind; `place` is asked for at the first.
    pub fn add(&mut self, kind: WarningKind, count: u64, place: impl FnOnce() -> Option<String>) {
        if count == 0 {
            return;
        }
        match self.0.iter_mut().find(|(w, _)| w.kind == kind) {
            Some((w, _)) => w.count += count,
            None => self.0.push((Warning { kind, count, place: place() }, 1)),
        }
    }

    /// Counts one more of a kind on a line.
    pub fn line(&mut self, kind: WarningKind, line: u64) {
        self.add(kind, 1, || Some(format!("first on line {line}")));
    }

    /// Counts one more of a kind with a name; the first five are listed. The caller gives each name once.
    pub fn name(&mut self, kind: WarningKind, name: &str) {
        let name = &short(name);
        match self.0.iter_mut().find(|(w, _)| w.kind == kind) {
            Some((w, names)) => {
                w.count += 1;
                *names += 1;
                let place = w.place.get_or_insert_default();
                match *names {
                    ..=5 => {
                        place.push_str(", ");
                        place.push_str(name);
                    }
                    6 => place.push_str(", \u{2026}"),
                    _ => (),
                }
            }
            None => self.0.push((Warning { kind, count: 1, place: Some(name.to_owned()) }, 1)),
        }
    }

    /// How often a kind has been counted.
    pub fn count(&self, kind: WarningKind) -> u64 {
        self.0.iter().find(|(w, _)| w.kind == kind).map_or(0, |(w, _)| w.count)
    }

    /// The warnings, in the order of [`WarningKind`], minor ones last.
    pub fn finish(self) -> Vec<Warning> {
        // One of each kind at most: inserting is quick, and a fraction of a general sort's code.
        let mut list: Vec<Warning> = Vec::new();
        for (warning, _) in self.0 {
            let key = |w: &Warning| (w.is_minor(), w.kind);
            let at = list.iter().take_while(|w| key(w) < key(&warning)).count();
            list.insert(at, warning);
        }
        list
    }
}
