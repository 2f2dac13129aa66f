//! Material files (MTL) and the pictures they name.
//!
//! Of a material, Limn shows the base colour: `Kd` (a display colour, made linear here), the opacity `d` or `Tr` = 1 - d,
//! and the picture `map_Kd`. Everything else is counted. As in other readers, the picture is multiplied by `Kd`, except
//! that a black `Kd` beside a picture counts as white, since the picture would not be seen otherwise.
//!
//! Source: the Wavefront "MTL material format" appendix. Names with blanks are common though the format has no way to
//! quote them: a list of material files is split only after words that end in `.mtl`.

use std::collections::BTreeMap;

use crate::{
    Files, Image, Material, ReadError,
    error::{Budget, WarningKind, Warnings},
    files::{find, image_type},
    model::srgb_to_linear,
    scan::{Cursor, quote},
};

/// One `newmtl`, pictures not looked up yet.
#[derive(Default)]
struct Entry {
    color: Option<[f32; 3]>,
    opacity: Option<f32>,
    transparency: Option<f32>,
    picture: Option<String>,
}

/// All materials of a model's libraries; gives out [`Material`]s and collects their pictures.
pub(crate) struct MaterialTable<'f> {
    files: &'f dyn Files,
    warnings: Warnings,
    budget: Budget,
    entries: BTreeMap<Vec<u8>, Entry>,
    images: Vec<Image>,
    /// Image numbers by the reference in the MTL; `None` if there is no such file.
    pictures: BTreeMap<String, Option<u32>>,
    /// Libraries that were not found, so that each is named once.
    missing: Vec<String>,
}

impl<'f> MaterialTable<'f> {
    pub fn new(files: &'f dyn Files, warnings: Warnings, budget: Budget) -> Self {
        MaterialTable {
            files,
            warnings,
            budget,
            entries: BTreeMap::new(),
            images: Vec::new(),
            pictures: BTreeMap::new(),
            missing: Vec::new(),
        }
    }

    /// Reads the libraries of one `mtllib` line. Of two materials with one name the first counts.
    pub fn library(&mut self, names: &[u8]) -> Result<(), ReadError> {
        for name in library_names(&String::from_utf8_lossy(names)) {
            match find(self.files, &name) {
                Some((_, bytes)) => self.read(bytes)?,
                None if self.missing.contains(&name) => (),
                None => {
                    self.warnings.name(WarningKind::MaterialFileMissing, &name);
                    self.missing.push(name);
                }
            }
        }
        Ok(())
    }

    fn read(&mut self, bytes: &[u8]) -> Result<(), ReadError> {
        self.budget.spend("The material file", bytes.len() as u64, 2)?;
        let mut cur = Cursor::new(bytes);
        let mut name: Option<Vec<u8>> = None;
        let mut entry = Entry::default();
        while !cur.at_end() {
            if !cur.at_line_end() {
                let line = cur.line();
                let keyword = cur.word();
                if keyword == b"newmtl" {
                    if let Some(name) = name.replace(cur.rest().to_vec()) {
                        self.entries.entry(name).or_insert(std::mem::take(&mut entry));
                    }
                } else {
                    self.setting(&mut cur, keyword, line, &mut entry);
                }
            }
            cur.next_line();
        }
        if let Some(name) = name {
            self.entries.entry(name).or_insert(entry);
        }
        Ok(())
    }

    fn setting(&mut self, cur: &mut Cursor<'_>, keyword: &[u8], line: u64, entry: &mut Entry) {
        let mut number = |cur: &mut Cursor<'_>| {
            let value = cur.double().ok();
            if value.is_none() {
                let place = || Some(format!("first on line {line} of the material file"));
                self.warnings.add(WarningKind::MaterialBroken, 1, place);
            }
            value
        };
        match keyword {
            b"Kd" => {
                let Some(r) = number(cur) else { return };
                // One value alone is a grey.
                let (g, b) = if cur.at_line_end() { (Some(r), Some(r)) } else { (number(cur), number(cur)) };
                if let (Some(g), Some(b)) = (g, b) {
                    entry.color = Some([r, g, b].map(|c| srgb_to_linear(c.clamp(0.0, 1.0)) as f32));
                }
            }
            b"d" => {
                let mut ahead = cur.clone();
                if ahead.word() == b"-halo" {
                    *cur = ahead;
                }
                entry.opacity = number(cur).map(|d| d as f32).or(entry.opacity);
            }
            b"Tr" => entry.transparency = number(cur).map(|t| t as f32).or(entry.transparency),
            b"map_Kd" => {
                if let Some((picture, options)) = picture_name(cur) {
                    self.warnings.add(WarningKind::TextureOptions, options, || None);
                    entry.picture = Some(picture);
                }
            }
            other => {
                let place = || Some(format!("such as {}", quote(other)));
                self.warnings.add(WarningKind::MaterialSettings, 1, place);
            }
        }
    }

    /// The material of a `usemtl` name; a plain one if no library has it.
    pub fn material(&mut self, name: &[u8]) -> Result<Material, ReadError> {
        let mut material = Material { name: String::from_utf8_lossy(name).into_owned(), ..Material::default() };
        let Some(entry) = self.entries.get(name) else {
            self.warnings.name(WarningKind::MaterialUndefined, &material.name);
            return Ok(material);
        };
        let opacity = entry.opacity.or(entry.transparency.map(|t| 1.0 - t)).unwrap_or(1.0).clamp(0.0, 1.0);
        let color = entry.color;
        if let Some(reference) = entry.picture.clone() {
            material.texture = self.picture(&reference)?;
        }
        let [r, g, b] = match color {
            Some([0.0, 0.0, 0.0]) if material.texture.is_some() => [1.0; 3],
            Some(color) => color,
            None => [1.0; 3],
        };
        material.base_color = [r, g, b, opacity];
        Ok(material)
    }

    fn picture(&mut self, reference: &str) -> Result<Option<u32>, ReadError> {
        if let Some(known) = self.pictures.get(reference) {
            return Ok(*known);
        }
        let mut number = None;
        match find(self.files, reference) {
            None => self.warnings.name(WarningKind::TextureMissing, reference),
            Some((name, bytes)) => match image_type(bytes) {
                None => self.warnings.name(WarningKind::TextureFormat, &name),
                Some(mime) => match self.images.iter().position(|i| i.name == name) {
                    Some(same) => number = Some(same as u32),
                    None => {
                        self.budget.spend("A picture", bytes.len() as u64, 1)?;
                        number = Some(self.images.len() as u32);
                        self.images.push(Image { name, mime: mime.to_owned(), bytes: bytes.to_vec() });
                    }
                },
            },
        }
        self.pictures.insert(reference.to_owned(), number);
        Ok(number)
    }

    /// The pictures, and the warnings handed in with those added.
    pub fn finish(self) -> (Vec<Image>, Warnings) {
        (self.images, self.warnings)
    }
}

/// Splits `a.mtl my other.mtl` into names: each ends with a word in `.mtl`. Without any such word the whole is one name.
pub(crate) fn library_names(list: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut name = String::new();
    // A backslash before a blank is how some exporters keep a name together.
    for word in list.replace("\\ ", " ").split(' ') {
        if !(name.is_empty() && word.is_empty()) {
            if !name.is_empty() {
                name.push(' ');
            }
            name.push_str(word);
        }
        if word.to_ascii_lowercase().ends_with(".mtl") {
            names.push(std::mem::take(&mut name));
        }
    }
    let rest = name.trim();
    if !rest.is_empty() {
        names.push(rest.to_owned());
    }
    names
}

/// The pictures that a material file refers to.
pub(crate) fn pictures(bytes: &[u8]) -> Vec<String> {
    let mut cur = Cursor::new(bytes);
    let mut names = Vec::new();
    while !cur.at_end() {
        if !cur.at_line_end() && cur.word() == b"map_Kd" {
            names.extend(picture_name(&mut cur).map(|(name, _)| name));
        }
        cur.next_line();
    }
    names
}

/// The file name of a picture statement, and how many options stand before it.
fn picture_name(cur: &mut Cursor<'_>) -> Option<(String, u64)> {
    let mut options = 0;
    loop {
        let mut ahead = cur.clone();
        let arguments = match ahead.word() {
            b"-o" | b"-s" | b"-t" => 3,
            b"-mm" => 2,
            b"-blendu" | b"-blendv" | b"-boost" | b"-bm" | b"-cc" | b"-clamp" | b"-imfchan" | b"-texres" | b"-type"
            | b"-colorspace" => 1,
            _ => break,
        };
        options += 1;
        for i in 0..arguments {
            // Offset, scale and turbulence have one to three numbers.
            let before = ahead.clone();
            if arguments == 3 {
                if ahead.float().is_err() && i > 0 {
                    ahead = before;
                    break;
                }
            } else {
                ahead.word();
            }
        }
        *cur = ahead;
    }
    let name = String::from_utf8_lossy(cur.rest()).into_owned();
    (!name.is_empty()).then_some((name, options))
}
