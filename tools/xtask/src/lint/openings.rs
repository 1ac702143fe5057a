//! Beginnings of doc comments: "What a plan takes for granted" makes the reader wait for the noun.

use super::source::Package;
use anyhow::Result;
use std::fs;

/// Beginnings that are refused.
const REFUSED: [&str; 11] = [
    "What",
    "Whether",
    "How",
    "Where",
    "Who",
    "Whoever",
    "By what",
    "The same",
    "Of",
    "In so many",
    "To be",
];

pub fn check(package: &Package) -> Result<Vec<String>> {
    let mut findings = Vec::new();
    for file in package.files()? {
        let text = fs::read_to_string(&file)?;
        let found = find(&text);
        findings.extend(
            found.map(|(line, opening)| format!("{}:{line}: {opening} …", package.path(&file))),
        );
    }
    Ok(findings)
}

/// Lines and beginnings of the comments that begin so.
fn find(text: &str) -> impl Iterator<Item = (usize, &'static str)> {
    let mut inside = false;
    text.lines().enumerate().filter_map(move |(at, line)| {
        let line = line.trim_start();
        let doc = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        let is_first = !inside;
        inside = doc.is_some();
        Some((at + 1, refused(doc.filter(|_| is_first)?)?))
    })
}

fn refused(doc: &str) -> Option<&'static str> {
    REFUSED.into_iter().find(|refused| {
        let rest = doc.trim_start().strip_prefix(refused);
        rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_refused_beginning_is_found() {
        for opening in REFUSED {
            let text = format!("\nmod a;\n    /// {opening} it is.\n    fn f() {{}}\n");
            assert_eq!(find(&text).collect::<Vec<_>>(), [(3, opening)]);
            let text = format!("//! {opening}: it is.\n");
            assert_eq!(find(&text).collect::<Vec<_>>(), [(1, opening)]);
        }
    }

    #[test]
    fn other_words_and_later_lines_are_not() {
        for text in [
            "/// Offers light.",
            "/// Whatsoever.",
            "/// The cells.\n/// What follows.",
            "// What a comment says.",
            "/// The sum.\n///\n/// Where it is 0.",
        ] {
            assert_eq!(find(text).next(), None, "{text}");
        }
    }
}
