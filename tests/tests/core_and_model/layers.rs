//! The layers that each crate draws at the top of its `lib.rs`, held to the imports of its sources.
//!
//! A drawing is the first text block of the crate's documentation. Each of its lines begins with the modules of one layer,
//! separated by commas; the words after two spaces say their purpose. A module may import those of its own line and of
//! the lines below it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const CRATES: [&str; 9] = [
    "core",
    "crazyflie",
    "firmware",
    "host-sim/campaign",
    "host-sim/design",
    "host-sim/plan",
    "host-sim/identify",
    "host-sim/simulation",
    "host-sim/cli",
];

/// Each module that is drawn, with its line, counted from the top.
fn drawn(lib: &str) -> BTreeMap<String, usize> {
    let block = lib.lines().map_while(|line| line.strip_prefix("//!")).skip_while(|line| line.trim() != "```text");
    let lines = block.skip(1).take_while(|line| line.trim() != "```");
    let mut modules = BTreeMap::new();
    for (number, line) in lines.enumerate() {
        let names = line.trim().split("  ").next().unwrap_or_default();
        for name in names.split(", ").filter(|name| !name.contains(' ')) {
            modules.insert(name.to_owned(), number);
        }
    }
    modules
}

/// The modules that `lib.rs` declares, but for those that nobody imports.
fn declared(lib: &str) -> Vec<String> {
    let names = lib.lines().filter_map(|line| {
        let rest = line.strip_prefix("pub mod ").or_else(|| line.strip_prefix("mod "))?;
        rest.strip_suffix(';').map(str::to_owned)
    });
    names.filter(|name| !["panic", "defmt_formats"].contains(&name.as_str())).collect()
}

fn sources(path: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(path).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The modules that a source imports from its own crate, those of its tests left out.
fn imported(text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let paths = lines.flat_map(|line| line.split("crate::").skip(1));
    paths.map(|path| path.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()).collect()
}

#[test]
fn imports_only_go_down() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut wrong = Vec::new();
    for name in CRATES {
        let src = root.join(name).join("src");
        let lib = fs::read_to_string(src.join("lib.rs")).unwrap();
        let drawn = drawn(&lib);
        assert!(drawn.len() > 1, "{name}: no drawing");
        for module in declared(&lib) {
            if !drawn.contains_key(&module) {
                wrong.push(format!("{name}: module `{module}` is not drawn"));
            }
        }
        let mut files = Vec::new();
        sources(&src, &mut files);
        for file in files {
            let inner = file.strip_prefix(&src).unwrap();
            let first = inner.iter().next().unwrap().to_string_lossy().replace(".rs", "");
            let Some(own) = drawn.get(&first).filter(|_| !inner.ends_with("tests.rs")) else { continue };
            for import in imported(&fs::read_to_string(&file).unwrap()) {
                // A name that is drawn nowhere is an item that `lib.rs` declares itself.
                if drawn.get(&import).is_some_and(|line| line < own) {
                    wrong.push(format!("{name}/src/{}: imports `{import}` from above", inner.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_drawing_is_read_by_its_lines() {
    let lib = "//! Words.\n//!\n//! ```text\n//! top       words above\n//!   a, b    words below\n//! ```\nmod a;\n";
    let expected = [("top", 0), ("a", 1), ("b", 1)].map(|(name, line)| (name.to_owned(), line));
    assert_eq!(drawn(lib), BTreeMap::from(expected));
    assert_eq!(
        imported("use crate::a::X;\n// crate::b\nlet y = crate::c(1);\n#[cfg(test)]\nuse crate::d;"),
        ["a", "c"]
    );
}
