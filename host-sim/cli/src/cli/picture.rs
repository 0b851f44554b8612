//! An SVG document in; the picture, as the name of its file asks for it, or both as SVG and as PNG, out.

use std::ops::Deref;
use std::path::Path;
use std::str::FromStr;

use super::output::File;
use super::{Failure, output};
use crate::figures;

/// A picture to write: a name that ends in .svg or .png, or one without an ending, `-` or a pipe, for SVG.
#[derive(Clone, Debug)]
pub(crate) struct Picture(File);

impl FromStr for Picture {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match Path::new(name).extension() {
            Some(end) if !(end.eq_ignore_ascii_case("svg") || end.eq_ignore_ascii_case("png")) => {
                Err("a picture ends in .svg or .png".to_owned())
            }
            _ => Ok(Self(File::of(name.into())?)),
        }
    }
}

impl Deref for Picture {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

/// Writes a document as SVG, or drawn as PNG where its name ends so.
pub(crate) fn write(path: &Path, svg: &str) -> Result<(), Failure> {
    if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("png")) {
        return output::write(path, &figures::png(svg).map_err(Failure::verdict)?);
    }
    output::write(path, svg.as_bytes())
}

/// Writes a document to a folder, as NAME.svg and NAME.png, and says so.
pub(crate) fn write_both(dir: &Path, name: &str, svg: &str) -> Result<(), Failure> {
    let [vector, pixels] = ["svg", "png"].map(|end| dir.join(format!("{name}.{end}")));
    write(&vector, svg)?;
    write(&pixels, svg)?;
    output::print(&format!("wrote {} and {}\n", vector.display(), pixels.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_says_which_picture_it_is() {
        for name in ["a.svg", "a.PNG", "a", "/dev/stdout"] {
            assert!(Picture::from_str(name).is_ok(), "{name}");
        }
        assert_eq!(Picture::from_str("a.pdf").unwrap_err(), "a picture ends in .svg or .png");
        let dir = tempfile::tempdir().unwrap();
        let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4"/>"#;
        for (name, begins) in [("a.svg", &b"<svg"[..]), ("a.png", b"\x89PNG"), ("b.PNG", b"\x89PNG")] {
            let path = dir.path().join(name);
            write(&path, svg).unwrap();
            assert!(std::fs::read(&path).unwrap().starts_with(begins), "{name}");
        }
        // Words are drawn where a document names no face.
        let words =
            |text: &str| svg.replace("/>", &format!(" font-family=\"sans-serif\"><text y=\"4\">{text}</text></svg>"));
        assert_ne!(figures::png(&words("lag")).unwrap(), figures::png(&words("")).unwrap());
    }
}
