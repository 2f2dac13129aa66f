//! Reading Wavefront OBJ: one pass over the bytes.
//!
//! ```text
//!   v  x y z [w | r g b [a]]    position, display colour (sRGB, 0..1 or 0..255) made linear
//!   vt u [v]                    texture coordinate
//!   f  1 2/5 3//7 -1/-1/-1      corners: position / texture / normal, from 1, negative from the end
//!   o g usemtl mtllib           groups and materials of the faces that follow
//!   t  crease 2/1/0 a b 2.5     tags as OpenSubdiv writes them, vertices from 0
//! ```
//!
//! Source: the Wavefront "Object Files" appendix B1, and what exporters really write. An `o` starts a new object and ends
//! the group; faces with both are named `object/group`. Positive indices may point forward, as some exporters write faces first, so their range is checked
//! at the end. What is not a surface is counted and reported. Cost: about 3 ns a byte and no allocation per line.
//! Limit: 2^32 - 2 positions and corners, and the memory budget.

use std::collections::BTreeMap;

use limn_mesh::{
    Weld,
    soup::{NONE, Soup},
};

use crate::{
    Files, Limits, Model, ReadError, Warning,
    error::{Budget, WarningKind, Warnings},
    model::{linear_to_srgb, model_name, srgb_to_linear},
    mtl::{MaterialTable, library_names},
    scan::{Cursor, NumberError, quote},
};

/// How many corners, and how many statements, may pass between two looks at the memory budget.
const CHECK_EVERY: usize = 1 << 16;

/// Reads an OBJ file. `files` are asked for material files and pictures.
pub(crate) fn read(
    file: &str,
    bytes: &[u8],
    files: &dyn Files,
    limits: &Limits,
) -> Result<(Model, Vec<Warning>), ReadError> {
    check_text(file, bytes)?;
    let mut reader = Reader::new(bytes, Budget::new(limits));
    reader.run()?;
    reader.finish(file, files)
}

/// Whether the first 64 KB have a line with a vertex and no byte that text does not have.
pub(crate) fn looks_like_obj(bytes: &[u8]) -> bool {
    let head = bytes.get(..bytes.len().min(1 << 16)).unwrap_or_default();
    let vertex = |line: &[u8]| {
        let mut cur = Cursor::new(line);
        cur.word() == b"v" && cur.float().is_ok() && cur.float().is_ok() && cur.float().is_ok()
    };
    !head.contains(&0) && head.split(|b| matches!(b, b'\n' | b'\r')).any(vertex)
}

/// The material files that an OBJ file refers to.
pub(crate) fn references(bytes: &[u8]) -> Vec<String> {
    let mut cur = Cursor::new(bytes);
    let mut names = Vec::new();
    while !cur.at_end() {
        if !cur.at_line_end() && cur.word() == b"mtllib" {
            names.extend(library_names(&String::from_utf8_lossy(cur.rest())));
        }
        cur.next_line();
    }
    names
}

/// Refuses what cannot be text.
fn check_text(file: &str, bytes: &[u8]) -> Result<(), ReadError> {
    let not_text = |byte: usize, what| ReadError::NotText { file: file.to_owned(), byte: byte as u64, what };
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(not_text(0, "a UTF-16 mark (save the file as UTF-8)"));
    }
    // `contains` runs many bytes at a time; `position` does not.
    if bytes.contains(&0) {
        let zero = bytes.iter().take_while(|b| **b != 0).count();
        return Err(not_text(zero, "zero"));
    }
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(ReadError::Empty { file: file.to_owned() });
    }
    Ok(())
}

struct Reader<'a> {
    cur: Cursor<'a>,
    budget: Budget,
    soup: Soup,
    /// Colours of `vc` lines, used if the `v` lines have none.
    extra_colors: Vec<[f32; 4]>,
    /// Vertices that have a colour of their own.
    colored: usize,
    /// Whether a colour above 1 was seen: then all are 0..255.
    byte_colors: bool,
    warnings: Warnings,
    /// The largest position index so far and its line.
    highest: (u32, u64),
    /// The largest texture index so far and its line.
    highest_uv: (u32, u64),
    object: &'a [u8],
    group: &'a [u8],
    /// The number of the group of the next face, once known.
    current_group: Option<u32>,
    groups: BTreeMap<(&'a [u8], &'a [u8]), u32>,
    group_names: Vec<String>,
    material: &'a [u8],
    current_material: Option<u32>,
    materials: BTreeMap<&'a [u8], u32>,
    material_names: Vec<&'a [u8]>,
    libraries: Vec<&'a [u8]>,
    /// The first words that are no OBJ keywords.
    unknown: u64,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8], budget: Budget) -> Self {
        Reader {
            cur: Cursor::new(bytes),
            budget,
            soup: Soup { offsets: vec![0], ..Soup::default() },
            extra_colors: Vec::new(),
            colored: 0,
            byte_colors: false,
            warnings: Warnings::default(),
            highest: (0, 0),
            highest_uv: (0, 0),
            object: b"",
            group: b"",
            current_group: None,
            groups: BTreeMap::new(),
            group_names: Vec::new(),
            material: b"",
            current_material: None,
            materials: BTreeMap::new(),
            material_names: Vec::new(),
            libraries: Vec::new(),
            unknown: 0,
        }
    }

    fn run(&mut self) -> Result<(), ReadError> {
        let mut statements = 0usize;
        while !self.cur.at_end() {
            statements += 1;
            if statements.is_multiple_of(CHECK_EVERY) {
                self.check_memory()?;
            }
            if !self.cur.at_line_end() {
                let line = self.cur.line();
                let keyword = self.cur.word();
                self.statement(keyword, line)?;
            }
            self.cur.next_line();
        }
        self.check_memory()
    }

    #[inline]
    fn statement(&mut self, keyword: &'a [u8], line: u64) -> Result<(), ReadError> {
        use WarningKind::*;
        match keyword {
            b"v" => self.vertex(line)?,
            b"f" | b"fo" => self.face(line)?,
            b"vt" => self.texture_coordinate(line),
            b"vn" => self.warnings.line(Normals, line),
            b"g" => {
                self.group = self.cur.rest();
                self.current_group = None;
            }
            b"o" => {
                self.object = self.cur.rest();
                self.group = b"";
                self.current_group = None;
            }
            b"usemtl" => {
                self.material = self.cur.rest();
                self.current_material = None;
            }
            b"mtllib" => {
                let names = self.cur.rest();
                if !self.libraries.contains(&names) && self.libraries.len() < 1000 {
                    self.libraries.push(names);
                }
            }
            b"vc" => {
                if let Some(color) = self.color(line)? {
                    self.extra_colors.push(color);
                }
            }
            b"t" => self.tag(line),
            b"s" => self.warnings.line(SmoothingGroups, line),
            b"l" => self.warnings.line(Lines, line),
            b"p" => self.warnings.line(Points, line),
            b"curv" | b"curv2" | b"surf" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole"
            | b"scrv" | b"sp" | b"end" | b"con" | b"mg" | b"vp" | b"bsp" | b"bzp" | b"cdc" | b"cdp" | b"res"
            | b"ctech" | b"stech" => self.warnings.line(FreeForm, line),
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj" | b"maplib" | b"usemap"
            | b"call" | b"csh" => self.warnings.add(UnknownStatement, 1, || place(keyword, line)),
            _ => {
                self.unknown += 1;
                self.warnings.add(UnknownStatement, 1, || place(keyword, line));
            }
        }
        Ok(())
    }

    /// `v x y z`, and up to four more numbers.
    #[inline]
    fn vertex(&mut self, line: u64) -> Result<(), ReadError> {
        let mut position = [0f32; 3];
        for (i, value) in position.iter_mut().enumerate() {
            *value = self.cur.float().map_err(|e| self.number_error(e, line, i, "x, y and z"))?;
        }
        self.soup.positions.push(position);
        if !self.cur.at_line_end() {
            self.vertex_extras(line)?;
        }
        Ok(())
    }

    /// What follows a position: a weight (one number, or two), or a colour (three, or four).
    fn vertex_extras(&mut self, line: u64) -> Result<(), ReadError> {
        let mut extra = [0f64; 4];
        let mut count = 0;
        for value in &mut extra {
            if self.cur.at_line_end() {
                break;
            }
            *value = self.cur.double().map_err(|e| self.number_error(e, line, 3 + count, "x, y and z"))?;
            count += 1;
        }
        let [r, g, b, a] = extra;
        if count >= 3 {
            let color = self.linear([r, g, b, if count == 4 { a } else { 1.0 }], line);
            // Vertices before the first coloured one are white.
            self.soup.colors.resize(self.soup.positions.len() - 1, [1.0; 4]);
            self.soup.colors.push(color);
            self.colored += 1;
        } else if r != 1.0 {
            self.warnings.line(WarningKind::Weights, line);
        }
        Ok(())
    }

    /// A display colour as a linear one. Values above 1 are kept and settled at the end, when the file's range is known.
    fn linear(&mut self, [r, g, b, a]: [f64; 4], line: u64) -> [f32; 4] {
        if r.min(g).min(b).min(a) < 0.0 {
            self.warnings.line(WarningKind::ColorRange, line);
        }
        self.byte_colors |= r.max(g).max(b) > 1.0;
        let component = |c: f64| srgb_to_linear(c.max(0.0)) as f32;
        [component(r), component(g), component(b), a.max(0.0) as f32]
    }

    /// `vc r g b`: the colour of the vertex with the same number, as some exporters write it.
    fn color(&mut self, line: u64) -> Result<Option<[f32; 4]>, ReadError> {
        let mut rgb = [0f64; 3];
        for (i, value) in rgb.iter_mut().enumerate() {
            *value = self.cur.double().map_err(|e| self.number_error(e, line, i, "r, g and b"))?;
        }
        let [r, g, b] = rgb;
        Ok(Some(self.linear([r, g, b, 1.0], line)))
    }

    /// `vt u [v [w]]`.
    fn texture_coordinate(&mut self, line: u64) {
        let mut uv = [0f32; 2];
        for (i, value) in uv.iter_mut().enumerate() {
            match self.cur.float() {
                Ok(number) => *value = number,
                Err(NumberError::Missing) if i == 1 => (),
                Err(_) => {
                    self.warnings.line(WarningKind::UvNotFinite, line);
                    break;
                }
            }
        }
        self.soup.uvs.push(uv);
    }

    /// `f` and its corners.
    fn face(&mut self, line: u64) -> Result<(), ReadError> {
        let start = self.soup.corners.len();
        let positions = self.soup.positions.len() as i64;
        while !self.cur.at_line_end() {
            let Some(index) = self.cur.integer() else {
                return Err(self.corner_error(line));
            };
            let index = if index < 0 { index + positions } else { index - 1 };
            let Some(position) = u32::try_from(index).ok().filter(|p| *p < NONE) else {
                return Err(self.index_error(line));
            };
            if position >= self.highest.0 {
                self.highest = (position, line);
            }
            let mut uv = NONE;
            if self.cur.eat(b'/') {
                if let Some(index) = self.cur.integer() {
                    uv = self.texture_index(index, line);
                }
                if self.cur.eat(b'/') {
                    self.cur.integer();
                }
            }
            if !self.cur.word_ends() {
                return Err(self.corner_error(line));
            }
            self.soup.corners.push(position);
            if uv != NONE || !self.soup.uv_corners.is_empty() {
                self.soup.uv_corners.resize(self.soup.corners.len() - 1, NONE);
                self.soup.uv_corners.push(uv);
            }
            if self.soup.corners.len().is_multiple_of(CHECK_EVERY) {
                self.check_memory()?;
            }
        }
        if self.soup.corners.len() - start < 3 {
            self.soup.corners.truncate(start);
            self.soup.uv_corners.truncate(start);
            self.warnings.line(WarningKind::FaceTooSmall, line);
            return Ok(());
        }
        let faces_before = self.soup.offsets.len() - 1;
        self.soup.offsets.push(self.soup.corners.len() as u32);
        self.face_group(faces_before);
        self.face_material(faces_before);
        Ok(())
    }

    /// Resolves a texture index; one that cannot be is none.
    #[inline(always)]
    fn texture_index(&mut self, index: i64, line: u64) -> u32 {
        let index = if index < 0 { index + self.soup.uvs.len() as i64 } else { index - 1 };
        match u32::try_from(index) {
            Ok(uv) if uv != NONE => {
                if uv >= self.highest_uv.0 {
                    self.highest_uv = (uv, line);
                }
                uv
            }
            _ => {
                self.warnings.line(WarningKind::UvMissing, line);
                NONE
            }
        }
    }

    /// Gives the face just read its group. Nothing is stored before the first group that has a name.
    #[inline]
    fn face_group(&mut self, faces_before: usize) {
        if self.object.is_empty() && self.group.is_empty() && self.group_names.is_empty() {
            return;
        }
        let group = match self.current_group {
            Some(group) => group,
            None => {
                if self.group_names.is_empty() && faces_before > 0 {
                    self.group_number(b"", b"");
                    self.soup.face_groups.resize(faces_before, 0);
                }
                self.group_number(self.object, self.group)
            }
        };
        self.current_group = Some(group);
        self.soup.face_groups.push(group);
    }

    fn group_number(&mut self, object: &'a [u8], group: &'a [u8]) -> u32 {
        let next = self.group_names.len() as u32;
        let number = *self.groups.entry((object, group)).or_insert(next);
        if number == next {
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
            self.group_names.push(match (object, group) {
                (b"", b"") => "default".to_owned(),
                (b"", name) | (name, b"") => text(name),
                (a, b) if a == b => text(a),
                (a, b) => format!("{}/{}", text(a), text(b)),
            });
        }
        number
    }

    /// Gives the face just read its material. Nothing is stored before the first `usemtl`.
    #[inline]
    fn face_material(&mut self, faces_before: usize) {
        if self.material.is_empty() && self.material_names.is_empty() {
            return;
        }
        let material = match self.current_material {
            Some(material) => material,
            None if self.material.is_empty() => NONE,
            None => {
                let next = self.material_names.len() as u32;
                let number = *self.materials.entry(self.material).or_insert(next);
                if number == next {
                    self.material_names.push(self.material);
                }
                number
            }
        };
        self.current_material = Some(material);
        self.soup.face_materials.resize(faces_before, NONE);
        self.soup.face_materials.push(material);
    }

    /// `t crease` and `t corner`; others are counted. A tag that does not parse is left out.
    fn tag(&mut self, line: u64) {
        let kind = self.cur.word();
        if !matches!(kind, b"crease" | b"corner") {
            self.warnings.add(WarningKind::TagUnknown, 1, || place(kind, line));
            return;
        }
        if self.read_tag(kind == b"crease").is_none() {
            self.warnings.line(WarningKind::TagBroken, line);
        }
    }

    fn read_tag(&mut self, crease: bool) -> Option<()> {
        self.cur.skip_blanks();
        let vertices = self.cur.integer()?;
        let values = if self.cur.eat(b'/') { self.cur.integer()? } else { 0 };
        // The number of strings is of no use.
        self.cur.word();
        let mut ids = Vec::new();
        for _ in 0..vertices {
            self.cur.skip_blanks();
            ids.push(u32::try_from(self.cur.integer()?).ok()?);
        }
        let mut sharpness = Vec::new();
        for _ in 0..values {
            sharpness.push(self.cur.float().ok()?);
        }
        // One value serves all.
        let value = |i: usize| sharpness.get(i).or(sharpness.first()).copied();
        if crease {
            for (i, pair) in ids.windows(2).enumerate() {
                let &[a, b] = pair else { return None };
                self.soup.marks.creases.push(([a, b], value(i)?));
            }
        } else {
            for (i, id) in ids.iter().enumerate() {
                self.soup.marks.corners.push((*id, value(i)?));
            }
        }
        Some(())
    }

    #[cold]
    fn number_error(&self, error: NumberError, line: u64, index: usize, wanted: &str) -> ReadError {
        let word = self.cur.clone().word();
        let problem = match error {
            NumberError::Missing => format!("a vertex needs {wanted}, but only {index} of them are there"),
            NumberError::NotANumber => format!("\"{}\" is not a number", quote(word)),
            NumberError::NotFinite => format!("\"{}\" is not a finite number", quote(word)),
        };
        ReadError::Line { line, problem }
    }

    #[cold]
    fn corner_error(&self, line: u64) -> ReadError {
        let problem = format!("\"{}\" is not a face corner such as 7, 7/2 or 7//3", self.cur.quote());
        ReadError::Line { line, problem }
    }

    #[cold]
    fn index_error(&self, line: u64) -> ReadError {
        let word = self.cur.quote();
        let count = self.soup.positions.len();
        let problem = if word.starts_with('-') {
            format!("face corner \"{word}\" counts back past the first of {count} vertices so far")
        } else if word.split('/').next() == Some("0") {
            format!("face corner \"{word}\" names vertex 0, but vertices count from 1")
        } else {
            format!("face corner \"{word}\" names a vertex that the file does not have")
        };
        ReadError::Line { line, problem }
    }

    /// Compares what is built so far with the budget, and with what 32-bit indices can count.
    fn check_memory(&self) -> Result<(), ReadError> {
        let soup = &self.soup;
        let bytes = soup.positions.len() as u64 * 12
            + (soup.colors.len() + self.extra_colors.len()) as u64 * 16
            + soup.uvs.len() as u64 * 8
            + (soup.corners.len() + soup.uv_corners.len()) as u64 * 4
            + (soup.offsets.len() + soup.face_groups.len() + soup.face_materials.len()) as u64 * 4
            + (self.soup.marks.creases.len() + self.soup.marks.corners.len()) as u64 * 12;
        self.budget.check_total("The model", bytes)?;
        let longest = soup.corners.len().max(soup.positions.len()).max(soup.uvs.len()) as u64;
        if longest + 2 * CHECK_EVERY as u64 > u64::from(u32::MAX) {
            return Err(ReadError::TooBig { what: "The model".into(), need: bytes, limit: u64::from(u32::MAX) * 4 });
        }
        Ok(())
    }

    fn finish(mut self, file: &str, files: &dyn Files) -> Result<(Model, Vec<Warning>), ReadError> {
        let count = self.soup.positions.len();
        if self.soup.face_count() == 0 {
            return Err(ReadError::NoFaces { file: file.to_owned(), found: self.found() });
        }
        if self.highest.0 as usize >= count {
            let problem =
                format!("a face uses vertex {}, but the file has only {count}", u64::from(self.highest.0) + 1);
            return Err(ReadError::Line { line: self.highest.1, problem });
        }
        self.finish_uvs();
        self.finish_colors();
        self.finish_tags();
        let mut table = MaterialTable::new(files, self.warnings, self.budget);
        for names in &self.libraries {
            table.library(names)?;
        }
        let materials = self.material_names.iter().map(|name| table.material(name)).collect::<Result<_, _>>()?;
        let (images, warnings) = table.finish();
        let model = Model {
            name: model_name(file),
            soup: self.soup,
            groups: self.group_names,
            materials,
            images,
            triangulated: false,
            weld: Weld::Off,
        };
        Ok((model, warnings.finish()))
    }

    /// What a file without faces has.
    fn found(&self) -> String {
        let count = self.soup.positions.len();
        let vertices = if count == 1 { "1 vertex".to_owned() } else { format!("{count} vertices") };
        let lines = self.warnings.count(WarningKind::Lines) + self.warnings.count(WarningKind::Points);
        let small = self.warnings.count(WarningKind::FaceTooSmall);
        match (count, self.unknown) {
            (0, 0) => "it has no vertices either".to_owned(),
            (0, unknown) => format!("it has {unknown} lines that are not OBJ statements"),
            _ if small > 0 => format!("it has {vertices}, but no face with three corners"),
            _ if lines > 0 => format!("it has {vertices}, and {lines} lines or points"),
            _ => format!("it has only {vertices}"),
        }
    }

    fn finish_uvs(&mut self) {
        let soup = &mut self.soup;
        let count = soup.uvs.len() as u32;
        if !soup.uv_corners.is_empty() && self.highest_uv.0 >= count {
            let mut missing = 0;
            for uv in soup.uv_corners.iter_mut().filter(|uv| **uv != NONE && **uv >= count) {
                *uv = NONE;
                missing += 1;
            }
            let line = self.highest_uv.1;
            self.warnings.add(WarningKind::UvMissing, missing, || Some(format!("such as on line {line}")));
        }
        if soup.uv_corners.iter().all(|uv| *uv == NONE) {
            soup.uv_corners.clear();
            soup.uvs.clear();
        } else {
            soup.uv_corners.resize(soup.corners.len(), NONE);
        }
    }

    fn finish_colors(&mut self) {
        let count = self.soup.positions.len();
        if self.soup.colors.is_empty() && !self.extra_colors.is_empty() {
            self.soup.colors = std::mem::take(&mut self.extra_colors);
            self.soup.colors.truncate(count);
            self.colored = self.soup.colors.len();
        }
        if self.soup.colors.is_empty() {
            return;
        }
        self.warnings.add(WarningKind::ColorMissing, (count - self.colored) as u64, || None);
        let scale = if self.byte_colors { 1.0 / 255.0 } else { 1.0 };
        for color in &mut self.soup.colors {
            let [r, g, b, a] = color;
            if self.byte_colors {
                for c in [r, g, b] {
                    // Rounding to 1/1024 gives whole numbers back exactly.
                    let written = libm::round(linear_to_srgb(f64::from(*c)) * 1024.0) / 1024.0;
                    *c = srgb_to_linear((written * scale).min(1.0)) as f32;
                }
                *a = if *a > 1.0 { (f64::from(*a) * scale) as f32 } else { *a };
            }
            *a = a.min(1.0);
        }
        self.soup.colors.resize(count, [1.0; 4]);
    }

    fn finish_tags(&mut self) {
        let count = self.soup.positions.len() as u32;
        let before = self.soup.marks.creases.len() + self.soup.marks.corners.len();
        self.soup.marks.creases.retain(|([a, b], _)| *a < count && *b < count && a != b);
        self.soup.marks.corners.retain(|(v, _)| *v < count);
        let gone = before - self.soup.marks.creases.len() - self.soup.marks.corners.len();
        self.warnings.add(WarningKind::TagBroken, gone as u64, || None);
    }
}

/// Where the first statement of a kind stands, with its word.
fn place(word: &[u8], line: u64) -> Option<String> {
    Some(format!("first \"{}\" on line {line}", quote(word)))
}
