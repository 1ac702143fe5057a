//! Circles of imports between the files of a crate: none of them can be read alone.
//!
//! A name counts as imported from the file that defines it, whichever module passes it on.

use super::modules::Modules;
use super::source::Package;
use anyhow::Result;
use std::collections::BTreeSet;

pub fn check(package: &Package) -> Result<Vec<String>> {
    let mut findings = Vec::new();
    for begin in package.crates() {
        let modules = Modules::read(&begin)?;
        let imports = modules.imports();
        let name = |file: usize| package.path(&modules.files[file]);
        // One finding for each file in a circle: breaking any circle takes some away.
        for (file, back) in circles(&imports).into_iter().enumerate().filter(|(_, b)| !b.is_empty())
        {
            let back: Vec<_> = back.into_iter().map(name).collect();
            findings.push(format!("{} imports from {}", name(file), back.join(", ")));
        }
    }
    Ok(findings)
}

/// For each node of a graph, those of its arrows that lead back to it.
fn circles(arrows: &[BTreeSet<usize>]) -> Vec<BTreeSet<usize>> {
    let reached: Vec<BTreeSet<usize>> = (0..arrows.len())
        .map(|begin| {
            let mut reached = BTreeSet::new();
            let mut next = vec![begin];
            while let Some(node) = next.pop() {
                next.extend(arrows[node].iter().filter(|to| reached.insert(**to)));
            }
            reached
        })
        .collect();
    let leads_back = |from: usize, to: usize| reached[to].contains(&from);
    arrows
        .iter()
        .enumerate()
        .map(|(from, to)| to.iter().copied().filter(|to| leads_back(from, *to)).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::path::PathBuf;

    /// A crate in a folder of its own, gone when this is.
    struct Crate(PathBuf);

    impl Crate {
        fn new(name: &str, files: &[(&str, &str)]) -> Self {
            let folder =
                std::env::temp_dir().join(format!("lamplight-{name}-{}", std::process::id()));
            for (file, text) in files {
                let path = folder.join("src").join(file);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, text).unwrap();
            }
            Self(folder)
        }

        fn check(&self) -> Vec<String> {
            check(&Package { name: "x".into(), folder: self.0.clone() }).unwrap()
        }
    }

    impl Drop for Crate {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_circle_is_found_through_imports_and_paths() {
        let files = [
            ("lib.rs", "mod a; mod b; mod c; pub use b::B;"),
            ("a.rs", "use crate::B; pub struct A(B);"),
            ("b.rs", "pub struct B; fn f() { crate::c::f(); }"),
            ("c/mod.rs", "mod d; pub use d::*;"),
            ("c/d.rs", "use super::super::a; pub fn f() { let _: a::A; }"),
        ];
        let asked = [
            "src/a.rs imports from src/b.rs",
            "src/b.rs imports from src/c/d.rs",
            "src/c/d.rs imports from src/a.rs",
        ];
        assert_eq!(Crate::new("circle", &files).check(), asked);
    }

    #[test]
    fn a_child_that_imports_from_the_parent_that_calls_it_is_a_circle() {
        let files = [
            ("lib.rs", "mod a; const N: u8 = 1; fn f() { a::g(); }"),
            ("a.rs", "use super::N; pub fn g() -> u8 { N }"),
        ];
        let asked = ["src/lib.rs imports from src/a.rs", "src/a.rs imports from src/lib.rs"];
        assert_eq!(Crate::new("child", &files).check(), asked);
    }

    #[test]
    fn what_is_passed_on_and_what_is_for_tests_is_no_circle() {
        let files = [
            ("lib.rs", "mod a; mod b; pub use a::A; pub use b::B;"),
            ("a.rs", "pub struct A; #[cfg(test)] mod tests { use crate::B; }"),
            ("b.rs", "use crate::A; use other::other; fn f() { other::f(); } pub struct B(A);"),
        ];
        assert!(Crate::new("none", &files).check().is_empty());
    }
}
