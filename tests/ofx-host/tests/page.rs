//! The documentation's page of the matrix names tests that exist.

use std::path::Path;

#[test]
fn the_page_of_the_matrix_names_tests_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap();
    let page = std::fs::read_to_string(root.join("docs/src/contributing/openfx-matrix.md")).unwrap();
    let mut found = 0;
    for line in page.lines().filter(|line| line.starts_with("| ") && line.contains('`')) {
        let last = line.trim_end_matches([' ', '|']).rsplit('|').next().unwrap();
        // Every second piece is between back quotes: `file::test`, or `folder/file.rs::test` for tests elsewhere.
        for name in last.split('`').skip(1).step_by(2) {
            let (file, test) = name.split_once("::").unwrap_or_else(|| panic!("{name}: expected file::test"));
            let path = match file.ends_with(".rs") {
                true => root.join(file),
                false => Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/{file}.rs")),
            };
            let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path:?}: {error}"));
            assert!(text.contains(&format!("fn {test}(")), "{name}: found no such test");
            found += 1;
        }
    }
    assert!(found > 30, "{found}");
}
