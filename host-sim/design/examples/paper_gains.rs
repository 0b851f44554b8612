//! Prints the source of the core's gain tables: `cargo run --example paper_gains > core/src/gains/paper.rs`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    print!("{}", quatrack_design::design::codegen::paper_tables()?);
    Ok(())
}
