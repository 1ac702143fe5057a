//! Packages, their files, and the tokens of these.

use anyhow::{Context, Result, anyhow};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::fs;
use std::path::{Path, PathBuf};

/// Folders whose folders are packages.
const FLOORS: [&str; 3] = ["crates", "demos", "tools"];

/// A package.
pub struct Package {
    pub name: String,
    pub folder: PathBuf,
}

/// Every package of the workspace.
pub fn packages(root: &Path) -> Result<Vec<Package>> {
    let mut packages = Vec::new();
    for floor in FLOORS {
        for entry in fs::read_dir(root.join(floor))? {
            let folder = entry?.path();
            if folder.join("Cargo.toml").exists() {
                let name = folder.file_name().context("a folder has a name")?;
                packages.push(Package { name: name.to_string_lossy().into_owned(), folder });
            }
        }
    }
    packages.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(packages)
}

impl Package {
    /// The files that its crates begin with: the library, the program.
    pub fn crates(&self) -> Vec<PathBuf> {
        let files = ["src/lib.rs", "src/main.rs"].map(|file| self.folder.join(file));
        files.into_iter().filter(|file| file.exists()).collect()
    }

    /// Every Rust file: sources, tests, examples.
    pub fn files(&self) -> Result<Vec<PathBuf>> {
        let mut files = Vec::new();
        let mut folders: Vec<_> =
            ["src", "tests", "examples", "benches"].map(|name| self.folder.join(name)).into();
        folders.retain(|folder| folder.exists());
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder)? {
                let path = entry?.path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "rs") {
                    files.push(path);
                }
            }
        }
        files.sort();
        Ok(files)
    }

    /// The path of a file in the package, with slashes.
    pub fn path(&self, file: &Path) -> String {
        let path = file.strip_prefix(&self.folder).unwrap_or(file);
        path.components()
            .map(|part| part.as_os_str().to_string_lossy())
            .collect::<Vec<_>>()
            .join("/")
    }
}

/// The tokens of a file.
pub fn tokens(file: &Path) -> Result<Vec<TokenTree>> {
    let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
    parse(&text).with_context(|| file.display().to_string())
}

pub fn parse(text: &str) -> Result<Vec<TokenTree>> {
    let stream: TokenStream = text.parse().map_err(|error| anyhow!("{error}"))?;
    Ok(stream.into_iter().collect())
}

/// The identifier that a token is.
pub fn ident(token: Option<&TokenTree>) -> Option<String> {
    match token {
        Some(TokenTree::Ident(ident)) => Some(ident.to_string()),
        _ => None,
    }
}

/// The tokens in a group of one kind.
pub fn group(token: Option<&TokenTree>, delimiter: Delimiter) -> Option<Vec<TokenTree>> {
    match token {
        Some(TokenTree::Group(group)) if group.delimiter() == delimiter => {
            Some(group.stream().into_iter().collect())
        }
        _ => None,
    }
}

/// Returns true if a token is this character of punctuation.
pub fn is(token: Option<&TokenTree>, character: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == character)
}

/// The items of a module, without attributes and without what is only compiled for tests.
pub fn items(tokens: &[TokenTree]) -> Vec<&[TokenTree]> {
    let mut items = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let mut for_tests = false;
        while is(tokens.get(at), '#') {
            at += 1 + usize::from(is(tokens.get(at + 1), '!'));
            let attribute = group(tokens.get(at), Delimiter::Bracket).unwrap_or_default();
            for_tests |= is_for_tests(&attribute);
            at += 1;
        }
        let end = at + length(&tokens[at..]);
        if !for_tests && at < end {
            items.push(&tokens[at..end]);
        }
        at = end;
    }
    items
}

/// Returns true for `test`, `cfg(test)` and `cfg(all(test, …))`.
fn is_for_tests(attribute: &[TokenTree]) -> bool {
    match ident(attribute.first()).as_deref() {
        Some("test") => true,
        Some("cfg" | "all") => group(attribute.get(1), Delimiter::Parenthesis)
            .is_some_and(|condition| is_for_tests(&condition)),
        _ => false,
    }
}

/// The number of tokens of the first item: to a semicolon or the end of a block.
fn length(tokens: &[TokenTree]) -> usize {
    // The braces of these are no block.
    let is_statement = tokens
        .iter()
        .take(3)
        .any(|token| matches!(ident(Some(token)).as_deref(), Some("use" | "static" | "type")));
    let end = tokens.iter().position(|token| {
        is(Some(token), ';') || (!is_statement && group(Some(token), Delimiter::Brace).is_some())
    });
    end.map_or(tokens.len(), |end| end + 1)
}

/// An item after its visibility.
pub fn without_visibility(item: &[TokenTree]) -> &[TokenTree] {
    if ident(item.first()).as_deref() != Some("pub") {
        return item;
    }
    let restricted = group(item.get(1), Delimiter::Parenthesis).is_some();
    &item[1 + usize::from(restricted)..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_for_tests_are_left_out() {
        let text = "//! Doc.\n use a::{b}; #[cfg(test)] mod tests { fn f() {} } #[test] fn g() {} \
                    pub(crate) fn h() {} #[cfg(all(test, unix))] use c::d; struct S; \
                    #[cfg(not(test))] struct T { x: u8 }";
        let tokens = parse(text).unwrap();
        let first: Vec<_> = items(&tokens)
            .into_iter()
            .map(|item| ident(without_visibility(item).first()).unwrap())
            .collect();
        assert_eq!(first, ["use", "fn", "struct", "struct"]);
    }
}
