//! The glossary's column "in the code": each name in it occurs in the sources.

use crate::lint::packages;
use crate::process::root;
use std::fs;
use std::path::PathBuf;

/// Names in backticks in the last column of the table of terms that do not occur in `code`.
fn unknown(glossary: &str, code: &str) -> Vec<String> {
    let column = |row: &str| {
        row.trim_end().strip_suffix('|')?.rsplit_once("| ").map(|(_, last)| last.to_owned())
    };
    let table = glossary.split("| term |").nth(1).unwrap_or_default();
    let rows = table.lines().take_while(|row| !row.is_empty()).filter_map(column);
    let named =
        rows.flat_map(|cell| cell.split('`').skip(1).step_by(2).map(names).collect::<Vec<_>>());
    named.flatten().filter(|name| !occurs(name, code)).collect()
}

/// The identifiers and paths in a piece of code: `color` and `intensity` of `color × intensity`.
fn names(code: &str) -> Vec<String> {
    let words = code.split(|c: char| !is_part(c) && c != ':' && c != '.');
    words.filter(|word| word.starts_with(char::is_alphabetic)).map(str::to_owned).collect()
}

/// Returns true if a name stands alone somewhere in the code.
fn occurs(name: &str, code: &str) -> bool {
    code.match_indices(name).any(|(at, _)| {
        !code[..at].ends_with(is_part) && !code[at + name.len()..].starts_with(is_part)
    })
}

fn is_part(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Every line of Rust and WGSL that packages are built from, without comments. This package is left out:
/// its tests contain the words that they reject.
fn code() -> String {
    let mut code = String::new();
    for package in packages(root()).unwrap().iter().filter(|package| package.name != "xtask") {
        let mut folders: Vec<PathBuf> =
            ["src", "shaders"].map(|name| package.folder.join(name)).into();
        while let Some(folder) = folders.pop() {
            for path in
                fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path())
            {
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "rs" || e == "wgsl") {
                    let text = fs::read_to_string(&path).unwrap();
                    let lines =
                        text.lines().map(|line| line.split("//").next().unwrap_or_default());
                    lines.for_each(|line| code.extend([line, "\n"]));
                }
            }
        }
    }
    code
}

#[test]
fn the_glossary_names_what_the_code_has() {
    let glossary = fs::read_to_string(root().join("docs/glossary.md")).unwrap();
    let code = code();
    let missing = unknown(&glossary, &code);
    assert!(missing.is_empty(), "docs/glossary.md names what no source has: {missing:?}");
    let invented = glossary.replace("`optical_depth`", "`optical_dearth`");
    assert_eq!(unknown(&invented, &code), ["optical_dearth"]);
}

#[test]
fn invented_words_are_found() {
    let table = |cell: &str| {
        format!("a\n\n| term | in the code |\n| --- | --- |\n| light | {cell} |\n\n`b`\n")
    };
    let code = "use stages::distance; let (color, intensity) = settings.temporal.reject; Bounces::Count(0)";
    for known in [
        "`color × intensity` of",
        "`stages::distance`",
        "`temporal.reject`",
        "`Bounces::Count(0)`",
        "–",
    ] {
        assert!(unknown(&table(known), code).is_empty(), "{known}");
    }
    for (cell, found) in [
        ("`color × glow`", "glow"),
        ("`intensity`, `intens`", "intens"),
        ("`distance::stages`", "distance::stages"),
        ("`Count`, `Bounces::Frames`", "Bounces::Frames"),
    ] {
        assert_eq!(unknown(&table(cell), code), [found]);
    }
}
