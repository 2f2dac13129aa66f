//! limn-files: the page's readers and writers, in a wasm module that is loaded when a file arrives.
//!
//! A visitor who only looks needs no file format, so formats are not part of what a first visit loads. They also work in a
//! thread of their own: reading a large file then neither stops the picture nor leaves its memory behind, and Cancel ends it.
//!
//! ```text
//!   page ── files ──► worker: read ── Parcel as bytes ──► engine
//!   engine ── Export as bytes ──► worker: write ── files ──► page
//! ```
//!
//! Two calls, [`read`] and [`write()`]; their wasm forms take and give byte arrays ([`limn_formats::parcel`]).

use limn_document::Stamp;
use limn_document::export::ExportFormat;
use limn_formats::parcel::{Notice, Parcel, unpack_export};
use limn_formats::{Limits, OutFile, write_glb, write_obj};

/// The endings of files that are models, the most telling first.
const MODELS: [&str; 3] = [".gltf", ".glb", ".obj"];
/// The endings of files that only belong to a model.
const BESIDE: [&str; 8] = [".mtl", ".bin", ".png", ".jpg", ".jpeg", ".webp", ".txt", ".md"];

fn last_part(name: &str) -> String {
    name.rsplit(['/', '\\']).next().unwrap_or(name).to_ascii_lowercase()
}

/// The file that the others belong to: the wanted one if it is among them, else models before others, shallow folders before
/// deep ones, then by name. None for no files.
pub fn main_file(names: &[&str], wanted: Option<&str>) -> Option<usize> {
    if let Some(wanted) = wanted
        && let Some(at) = names.iter().position(|name| last_part(name) == last_part(wanted))
    {
        return Some(at);
    }
    let rank = |name: &str| {
        let name = name.to_ascii_lowercase();
        let model = MODELS.iter().position(|ending| name.ends_with(ending)).unwrap_or(MODELS.len());
        (model, BESIDE.iter().any(|ending| name.ends_with(ending)))
    };
    (0..names.len())
        .min_by_key(|&i| names.get(i).map(|name| (rank(name), name.matches('/').count(), (*name).to_owned())))
}

/// Reads the model among `files`, using at most `budget` bytes for what is built. None for no files.
pub fn read(mut files: Vec<(String, Vec<u8>)>, wanted: Option<&str>, budget: u64) -> Option<Parcel> {
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let at = main_file(&names, wanted)?;
    let (name, bytes) = files.swap_remove(at);
    let Stamp { size, hash } = Stamp::of(&bytes);
    let limits = Limits { bytes: Limits::default().bytes.min(budget) };
    let result = match limn_formats::read(&name, &bytes, &files, &limits) {
        Ok((model, warnings)) => Ok((model, warnings.iter().map(Notice::from).collect())),
        Err(error) => Err(error.to_string()),
    };
    Some(Parcel { name, size, hash, result })
}

/// Writes a packed export as `file`, whose extension says the format.
///
/// # Errors
/// One sentence.
pub fn write(packed: &[u8], file: &str) -> Result<Vec<OutFile>, String> {
    let packed = unpack_export(packed).map_err(|e| e.to_string())?;
    let mut files = match limn_document::export::format(file).map_err(|e| e.to_string())? {
        ExportFormat::Obj => write_obj(&packed.export()).map_err(|e| e.to_string())?,
        ExportFormat::Glb => {
            vec![OutFile { name: file.to_owned(), bytes: write_glb(&packed.export()).map_err(|e| e.to_string())? }]
        }
    };
    if let Some(first) = files.first_mut() {
        // As the person wrote it, capitals of the extension included.
        first.name = file.rsplit(['/', '\\']).next().unwrap_or(file).to_owned();
    }
    Ok(files)
}

/// The calls that JavaScript sees.
#[cfg(target_arch = "wasm32")]
mod calls {
    use js_sys::{Array, Object, Reflect, Uint8Array};
    use wasm_bindgen::prelude::*;

    /// Reads files into a parcel's bytes; undefined for no files.
    #[wasm_bindgen]
    pub fn read(names: Vec<String>, bytes: Vec<Uint8Array>, wanted: Option<String>, budget: f64) -> Option<Vec<u8>> {
        let files = names.into_iter().zip(bytes.iter().map(Uint8Array::to_vec)).collect();
        drop(bytes);
        super::read(files, wanted.as_deref(), budget as u64).map(|parcel| parcel.pack())
    }

    /// Writes an export's bytes as files: an array of `{name, bytes}`. Throws one sentence.
    #[wasm_bindgen]
    pub fn write(packed: Vec<u8>, file: &str) -> Result<Array, JsValue> {
        let files = super::write(&packed, file).map_err(JsValue::from)?;
        drop(packed);
        let out = Array::new();
        for file in files {
            let object = Object::new();
            Reflect::set(&object, &"name".into(), &file.name.into())?;
            Reflect::set(&object, &"bytes".into(), &Uint8Array::from(&file.bytes[..]))?;
            out.push(&object);
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> (String, Vec<u8>) {
        (name.to_owned(), text.as_bytes().to_vec())
    }

    #[test]
    fn the_main_file_is_found() {
        assert_eq!(main_file(&[], None), None);
        assert_eq!(main_file(&["b.png", "a/x.obj", "m.mtl", "z.OBJ"], None), Some(3));
        assert_eq!(main_file(&["a.obj", "b.glb"], None), Some(1));
        assert_eq!(main_file(&["a.obj", "b.glb"], Some("folder/A.obj")), Some(0));
        assert_eq!(main_file(&["readme.txt", "unknown"], None), Some(1));
    }

    #[test]
    fn a_model_and_what_belongs_to_it() {
        let files = vec![
            file("m.mtl", "newmtl red\nKd 1 0 0\n"),
            file("a.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n"),
        ];
        let parcel = read(files.clone(), None, 1 << 20).unwrap();
        assert_eq!((parcel.name.as_str(), parcel.size), ("a.obj", files[1].1.len() as u64));
        assert_eq!(parcel.hash, Stamp::of(&files[1].1).hash);
        let (model, notices) = parcel.result.unwrap();
        assert_eq!((model.materials[0].base_color, notices), ([1.0, 0.0, 0.0, 1.0], Vec::new()));
        assert!(read(vec![file("a.obj", "")], None, 1 << 20).unwrap().result.unwrap_err().contains("empty"));
    }

    #[test]
    fn exports_keep_the_name_that_was_given() {
        let triangle = limn_formats::Export {
            points: &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            faces: limn_formats::ExportFaces::Triangles(&[0, 1, 2]),
            ..Default::default()
        };
        let packed = limn_formats::parcel::pack_export(&triangle);
        let files = write(&packed, "to/Out.OBJ").unwrap();
        assert_eq!(files[0].name, "Out.OBJ");
        assert!(String::from_utf8_lossy(&files[0].bytes).contains("f 1 2 3"));
        assert_eq!(&write(&packed, "a.glb").unwrap()[0].bytes[..4], b"glTF");
        assert!(write(&packed, "a.stl").unwrap_err().contains(".obj or .glb"));
        assert!(write(&packed[..8], "a.glb").is_err());
    }
}
