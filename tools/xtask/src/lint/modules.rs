//! The modules of a crate, and what their paths lead to: as much of Rust's name resolution as imports
//! between files need.

use super::source::{group, ident, is, items, tokens, without_visibility};
use anyhow::{Context, Result};
use proc_macro2::{Delimiter, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Modules and the paths followed from them: imports in a circle are followed once.
type Seen = BTreeSet<(usize, Vec<String>)>;

/// Names of a path that is given up: `use a::a` from another crate grows by one each time.
const LONGEST: usize = 16;

/// A crate: its modules, the root first.
pub struct Modules {
    modules: Vec<Module>,
    pub files: Vec<PathBuf>,
}

/// A module, in a file of its own or inline.
#[derive(Default)]
struct Module {
    parent: usize,
    file: usize,
    children: BTreeMap<String, usize>,
    definitions: BTreeSet<String>,
    imports: Vec<Import>,
    /// Paths in its items.
    paths: Vec<Vec<String>>,
}

/// A leaf of a `use`.
#[derive(Clone, Debug, PartialEq)]
struct Import {
    /// The name that it has here; `*` for all names.
    name: String,
    path: Vec<String>,
    /// Visible outside of the module: what passes a name on does not depend on it.
    is_public: bool,
}

impl Modules {
    /// Reads a crate from its first file. Modules that are only compiled for tests are left out.
    pub fn read(root: &Path) -> Result<Self> {
        let mut modules = Self { modules: Vec::new(), files: vec![root.to_owned()] };
        let folder = root.parent().context("a file has a folder")?;
        modules.add(0, 0, &tokens(root)?, folder)?;
        Ok(modules)
    }

    /// Adds a module whose children lie in a folder.
    fn add(
        &mut self,
        parent: usize,
        file: usize,
        tree: &[TokenTree],
        folder: &Path,
    ) -> Result<usize> {
        let this = self.modules.len();
        self.modules.push(Module { parent, file, ..Module::default() });
        for item in items(tree) {
            let bare = without_visibility(item);
            let keyword = ident(bare.first()).unwrap_or_default();
            let name = ident(bare.get(1)).unwrap_or_default();
            if keyword == "mod" {
                let folder = folder.join(&name);
                let child = if let Some(inline) = group(bare.get(2), Delimiter::Brace) {
                    self.add(this, file, &inline, &folder)?
                } else {
                    let path = Some(folder.with_extension("rs")).filter(|path| path.exists());
                    let path = path.unwrap_or_else(|| folder.join("mod.rs"));
                    let tree = tokens(&path)?;
                    self.files.push(path);
                    self.add(this, self.files.len() - 1, &tree, &folder)?
                };
                self.modules[this].children.insert(name, child);
            } else if keyword == "use" {
                let mut imports = Vec::new();
                leaves(&bare[1..], &[], &mut imports);
                for import in &mut imports {
                    import.is_public = bare.len() < item.len();
                }
                self.modules[this].imports.append(&mut imports);
            } else {
                self.modules[this].definitions.extend(definition(bare));
                paths(bare, &mut self.modules[this].paths);
            }
        }
        Ok(this)
    }

    /// For each file, the other files of the crate that it imports from.
    pub fn imports(&self) -> Vec<BTreeSet<usize>> {
        let mut edges = vec![BTreeSet::new(); self.files.len()];
        for (at, module) in self.modules.iter().enumerate() {
            let imported = module.imports.iter().filter(|import| !import.is_public);
            for path in imported.map(|import| &import.path).chain(&module.paths) {
                let target = self
                    .resolve(at, path, &mut Seen::new())
                    .map(|target| self.modules[target].file);
                edges[module.file].extend(target.filter(|target| *target != module.file));
            }
        }
        edges
    }

    /// The module that a path leads to, or whose item it names; none if that is outside of the crate.
    fn resolve(&self, from: usize, path: &[String], seen: &mut Seen) -> Option<usize> {
        let (mut at, mut rest) = match path.first()?.as_str() {
            "crate" => (0, &path[1..]),
            "self" => (from, &path[1..]),
            "super" => (self.modules[from].parent, &path[1..]),
            _ => return self.follow(from, path, seen),
        };
        while rest.first().is_some_and(|name| name == "super") {
            (at, rest) = (self.modules[at].parent, &rest[1..]);
        }
        if rest.is_empty() || rest[0] == "*" {
            return Some(at);
        }
        // What a macro defines is not seen: it is the module's own.
        self.follow(at, rest, seen).or(Some(at))
    }

    /// Follows names from inside a module.
    fn follow(&self, at: usize, path: &[String], seen: &mut Seen) -> Option<usize> {
        if path.len() > LONGEST || !seen.insert((at, path.to_vec())) {
            return None;
        }
        let module = &self.modules[at];
        let (name, rest) = path.split_first()?;
        if let Some(child) = module.children.get(name) {
            let is_end = rest.is_empty() || rest[0] == "*";
            return if is_end {
                Some(*child)
            } else {
                self.follow(*child, rest, seen).or(Some(*child))
            };
        }
        if module.definitions.contains(name) {
            return Some(at);
        }
        if let Some(import) = module.imports.iter().find(|import| import.name == *name) {
            return self.resolve(at, &[&import.path, rest].concat(), seen);
        }
        module.imports.iter().filter(|import| import.name == "*").find_map(|import| {
            let all = self.resolve(at, &import.path, seen)?;
            (all != at).then(|| self.follow(all, path, seen))?
        })
    }
}

/// The name that an item defines.
fn definition(item: &[TokenTree]) -> Option<String> {
    let at = item.iter().position(|token| {
        matches!(
            ident(Some(token)).as_deref(),
            Some("struct" | "enum" | "union" | "trait" | "type" | "fn" | "static" | "macro_rules")
        )
    });
    let is_const = ident(item.first()).as_deref() == Some("const");
    if ident(item.first()).as_deref() == Some("impl") {
        return None;
    }
    let at = if is_const && ident(item.get(1)).as_deref() != Some("fn") { 0 } else { at? };
    item[at + 1..].iter().find_map(|token| ident(Some(token)))
}

/// The leaves of a `use` tree, after `before`.
fn leaves(tree: &[TokenTree], before: &[String], imports: &mut Vec<Import>) {
    for branch in tree.split(|token| is(Some(token), ',') || is(Some(token), ';')) {
        let mut path = before.to_vec();
        let mut name = None;
        let mut tokens = branch.iter();
        while let Some(token) = tokens.next() {
            match token {
                TokenTree::Ident(word) if *word == "as" => name = ident(tokens.next()),
                TokenTree::Ident(word) => path.push(word.to_string()),
                TokenTree::Punct(mark) if mark.as_char() == '*' => path.push("*".to_owned()),
                TokenTree::Group(group) => {
                    let inner: Vec<_> = group.stream().into_iter().collect();
                    leaves(&inner, &path, imports);
                    path.clear();
                }
                _ => {}
            }
        }
        // `a::{self}` is `a`.
        if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        if let Some(last) = path.last() {
            let name = name.unwrap_or_else(|| last.clone());
            imports.push(Import { name, path, is_public: false });
        }
    }
}

/// Collects paths of two names and more, and those of inner `use`s.
fn paths(tokens: &[TokenTree], found: &mut Vec<Vec<String>>) {
    let mut at = 0;
    while at < tokens.len() {
        match &tokens[at] {
            TokenTree::Ident(word) if *word == "use" => {
                let length = tokens[at..].iter().position(|token| is(Some(token), ';'));
                let end = at + length.unwrap_or(tokens.len() - at);
                let mut imports = Vec::new();
                leaves(&tokens[at + 1..end], &[], &mut imports);
                found.extend(imports.into_iter().map(|import| import.path));
                at = end;
            }
            TokenTree::Ident(word) => {
                let mut path = vec![word.to_string()];
                while is(tokens.get(at + 1), ':') && is(tokens.get(at + 2), ':') {
                    let Some(name) = ident(tokens.get(at + 3)) else { break };
                    path.push(name);
                    at += 3;
                }
                if path.len() > 1 {
                    found.push(path);
                }
                at += 1;
            }
            TokenTree::Group(group) => {
                paths(&group.stream().into_iter().collect::<Vec<_>>(), found);
                at += 1;
            }
            _ => at += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::source::parse;
    use super::*;

    #[test]
    fn every_leaf_of_a_use_is_an_import() {
        let mut imports = Vec::new();
        leaves(&parse("crate::a::{self, B as C, d::*};").unwrap(), &[], &mut imports);
        let found: Vec<_> =
            imports.iter().map(|import| (import.name.as_str(), import.path.join("::"))).collect();
        let asked = [("a", "crate::a"), ("C", "crate::a::B"), ("*", "crate::a::d::*")];
        assert_eq!(found, asked.map(|(name, path)| (name, path.to_owned())));
    }

    #[test]
    fn items_define_their_names() {
        for (text, name) in [
            ("const fn f() {}", Some("f")),
            ("const N: usize = 1;", Some("N")),
            ("unsafe extern \"C\" fn g() {}", Some("g")),
            ("struct S<T>(T);", Some("S")),
            ("macro_rules! m { () => {} }", Some("m")),
            ("impl S { fn f() {} }", None),
        ] {
            assert_eq!(definition(&parse(text).unwrap()).as_deref(), name, "{text}");
        }
    }
}
