//! Type names: in one crate, each names one type.

use super::modules::Modules;
use super::source::{Package, group, ident, items, tokens, without_visibility};
use anyhow::Result;
use proc_macro2::{Delimiter, TokenTree};
use std::collections::BTreeMap;

pub fn check(package: &Package) -> Result<Vec<String>> {
    let mut findings = Vec::new();
    for begin in package.crates() {
        let mut places = BTreeMap::<String, Vec<String>>::new();
        for file in Modules::read(&begin)?.files {
            for name in types(&tokens(&file)?) {
                places.entry(name).or_default().push(package.path(&file));
            }
        }
        // One finding for each type too many.
        for (name, files) in places {
            let more = files.iter().skip(1);
            findings.extend(more.map(|file| format!("{name} in {file}, as in {}", files[0])));
        }
    }
    Ok(findings)
}

/// Names of the types that a module and its inline modules define.
fn types(tokens: &[TokenTree]) -> Vec<String> {
    let mut names = Vec::new();
    for item in items(tokens) {
        let item = without_visibility(item);
        match ident(item.first()).as_deref() {
            Some("struct" | "enum" | "trait" | "type" | "union") => {
                names.extend(ident(item.get(1)))
            }
            Some("mod") => {
                let inline = group(item.get(2), Delimiter::Brace);
                names.extend(inline.into_iter().flat_map(|tokens| types(&tokens)));
            }
            _ => {}
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::super::source::parse;
    use super::*;

    #[test]
    fn types_are_found_where_they_are_defined() {
        let text =
            "pub struct A<T>(T); enum B { C } pub(crate) mod m { type D = u8; } trait E { type F; }
                    impl E for B { type F = u8; } fn f() { struct G; }
                    #[cfg(test)] mod tests { struct A; }";
        assert_eq!(types(&parse(text).unwrap()), ["A", "B", "D", "E"]);
    }

    #[test]
    fn a_name_that_is_defined_twice_is_found() {
        let folder = std::env::temp_dir().join(format!("lamplight-names-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("src")).unwrap();
        let write =
            |file: &str, text: &str| std::fs::write(folder.join("src").join(file), text).unwrap();
        write("lib.rs", "mod a; mod b; struct View;");
        write("a.rs", "pub struct View;");
        write("b.rs", "pub enum Ray {}");
        let package = Package { name: "x".into(), folder: folder.clone() };
        assert_eq!(check(&package).unwrap(), ["View in src/a.rs, as in src/lib.rs"]);
        write("a.rs", "pub struct Place;");
        assert!(check(&package).unwrap().is_empty());
        std::fs::remove_dir_all(folder).unwrap();
    }
}
