//! Makes the linker see an edited `memory.x`, which cargo does not watch by itself.

fn main() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    println!("cargo:rerun-if-changed={root}/memory.x");
    println!("cargo:rustc-link-search={root}");
}
