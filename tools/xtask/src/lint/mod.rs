//! `cargo xtask lint`: rules of this project's source that Clippy does not have.
//!
//! Findings that were there before a rule are counted in `lint-baseline.txt`, by rule and package. A
//! count may only shrink: more findings are an error, and so are fewer until the file is written again.

mod bools;
mod circles;
mod modules;
mod names;
mod openings;
mod source;

use crate::process::root;
use anyhow::{Context, Result, bail, ensure};
use source::Package;
pub use source::packages;
use std::collections::BTreeMap;
use std::fs;

/// The counts, relative to the root.
const BASELINE: &str = "tools/xtask/lint-baseline.txt";
const HEADER: &str = "\
# Findings that are left, by rule and package; they may only become fewer.
# Written by `cargo xtask lint --baseline`.
";

type Check = fn(&Package) -> Result<Vec<String>>;

/// Every rule, and what it asks for.
const RULES: [(&str, &str, Check); 4] = [
    ("bools", "`if` instead of `match` on a bool", bools::check),
    ("circles", "no circle of imports between the files of a crate", circles::check),
    ("names", "no type name twice in a crate", names::check),
    ("openings", "a doc comment begins with a noun phrase or a verb", openings::check),
];

/// A rule and a package.
type Key = (String, String);
/// Numbers of findings, zeros left out.
type Counts = BTreeMap<Key, usize>;

/// Checks every package. With `write`, writes the counts if none has grown; with `list`, prints every
/// finding.
pub fn run(write: bool, list: bool) -> Result<()> {
    let mut counts = Counts::new();
    let mut findings = BTreeMap::new();
    for package in packages(root())? {
        for (rule, _, check) in RULES {
            let found = check(&package).with_context(|| package.name.clone())?;
            if !found.is_empty() {
                let key = (rule.to_owned(), package.name.clone());
                counts.insert(key.clone(), found.len());
                findings.insert(key, found);
            }
        }
    }
    let path = root().join(BASELINE);
    let old = parse(&fs::read_to_string(&path).with_context(|| BASELINE.to_owned())?)?;
    let (grown, shrunk) = compare(&old, &counts);
    for key in if list { counts.keys().collect() } else { grown.iter().collect::<Vec<_>>() } {
        let (_, asked, _) = RULES.iter().find(|rule| rule.0 == key.0).context("a rule")?;
        println!("{} in {}: {asked}", key.0, key.1);
        findings[key].iter().for_each(|finding| println!("  {finding}"));
    }
    ensure!(
        grown.is_empty(),
        "findings above: more than the {} that {BASELINE} allows",
        grown.iter().map(|key| old.get(key).unwrap_or(&0)).sum::<usize>()
    );
    if write {
        fs::write(&path, print(&counts))?;
    } else if !shrunk.is_empty() {
        let shrunk: Vec<_> =
            shrunk.iter().map(|(rule, package)| format!("{rule} {package}")).collect();
        bail!(
            "{BASELINE} is not up to date: run `cargo xtask lint --baseline`. Fewer findings: {}",
            shrunk.join(", ")
        );
    }
    println!("{} findings are left, in {BASELINE}", counts.values().sum::<usize>());
    Ok(())
}

/// Keys whose count has grown, and those whose count has shrunk.
fn compare(old: &Counts, new: &Counts) -> (Vec<Key>, Vec<Key>) {
    let count = |counts: &Counts, key| counts.get(key).copied().unwrap_or(0);
    let grown = new.keys().filter(|key| count(new, key) > count(old, key)).cloned().collect();
    let shrunk = old.keys().filter(|key| count(new, key) < count(old, key)).cloned().collect();
    (grown, shrunk)
}

fn parse(text: &str) -> Result<Counts> {
    let mut counts = Counts::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let [rule, package, count] = line.split_whitespace().collect::<Vec<_>>()[..] else {
            bail!("{BASELINE}: `{line}` is no rule, package and count");
        };
        counts.insert((rule.to_owned(), package.to_owned()), count.parse()?);
    }
    Ok(counts)
}

fn print(counts: &Counts) -> String {
    let lines = counts.iter().map(|((rule, package), count)| format!("{rule} {package} {count}\n"));
    HEADER.to_owned() + &lines.collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(entries: &[(&str, usize)]) -> Counts {
        entries.iter().map(|&(name, count)| (("r".into(), name.into()), count)).collect()
    }

    #[test]
    fn counts_may_only_shrink_and_must_be_written_then() {
        let old = counts(&[("a", 2), ("b", 1)]);
        assert_eq!(compare(&old, &old), (vec![], vec![]));
        let key = |name: &str| vec![("r".to_owned(), name.to_owned())];
        assert_eq!(compare(&old, &counts(&[("a", 3), ("b", 1)])), (key("a"), vec![]));
        assert_eq!(compare(&old, &counts(&[("a", 2), ("b", 1), ("c", 1)])), (key("c"), vec![]));
        assert_eq!(compare(&old, &counts(&[("a", 2)])), (vec![], key("b")));
    }

    #[test]
    fn counts_survive_their_file() {
        let old = counts(&[("a", 2), ("b", 1)]);
        assert_eq!(parse(&print(&old)).unwrap(), old);
        assert!(parse("openings three").is_err());
    }
}
