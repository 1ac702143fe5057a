//! `match` on a bool: its arms are `true` and `false`, and `if` reads better.

use super::source::{Package, group, ident, is, tokens};
use anyhow::Result;
use proc_macro2::{Delimiter, TokenTree};

pub fn check(package: &Package) -> Result<Vec<String>> {
    let mut findings = Vec::new();
    for file in package.files()? {
        let mut lines = Vec::new();
        find(&tokens(&file)?, &mut lines);
        findings.extend(lines.iter().map(|line| format!("{}:{line}", package.path(&file))));
    }
    Ok(findings)
}

/// Collects the lines of such expressions.
fn find(tokens: &[TokenTree], lines: &mut Vec<usize>) {
    for (at, token) in tokens.iter().enumerate() {
        if ident(Some(token)).as_deref() == Some("match") {
            let body = tokens[at..].iter().find_map(|t| group(Some(t), Delimiter::Brace));
            if body.is_some_and(|body| has_bool_arm(&body)) {
                lines.push(token.span().start().line);
            }
        }
        if let TokenTree::Group(group) = token {
            find(&group.stream().into_iter().collect::<Vec<_>>(), lines);
        }
    }
}

/// Returns true if `true` or `false` is the whole pattern of an arm.
fn has_bool_arm(body: &[TokenTree]) -> bool {
    (0..body.len()).any(|at| {
        let is_bool = matches!(ident(body.get(at)).as_deref(), Some("true" | "false"));
        let begins = at == 0
            || is(body.get(at - 1), ',')
            || group(body.get(at - 1), Delimiter::Brace).is_some();
        is_bool && begins && is(body.get(at + 1), '=') && is(body.get(at + 2), '>')
    })
}

#[cfg(test)]
mod tests {
    use super::super::source::parse;
    use super::*;

    fn lines(text: &str) -> Vec<usize> {
        let mut lines = Vec::new();
        find(&parse(text).unwrap(), &mut lines);
        lines
    }

    #[test]
    fn a_match_on_a_bool_is_found() {
        assert_eq!(lines("fn f(b: bool) -> u8 {\n match b { true => 1, false => 2 } }"), [2]);
        assert_eq!(lines("let x = match a < b {\n _ if c => {}\n false => 2, _ => 1 };"), [1]);
    }

    #[test]
    fn other_matches_are_not() {
        assert!(lines("match (a, b) { (true, false) => 1, _ => 2 }").is_empty());
        assert!(lines("match a { Some(true) => true, _ => false }").is_empty());
        assert!(lines("if a { true } else { false }").is_empty());
    }
}
