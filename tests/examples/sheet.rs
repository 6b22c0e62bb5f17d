//! Contact sheet (scratch).
fn main() -> anyhow::Result<()> {
    let t = std::time::Instant::now();
    let folder = std::path::Path::new("target/sample");
    rototoon_tests::sample::write(folder)?;
    eprintln!("{:?}", t.elapsed());
    Ok(())
}
