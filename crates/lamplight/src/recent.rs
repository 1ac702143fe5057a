//! A bounded store of what was read from files, which the windows of a world share.

use crate::Result;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Something that takes memory.
pub(crate) trait Bytes {
    /// Bytes that it takes, about.
    fn bytes(&self) -> u64;
}

/// A store of values that are each read from a file when they are first needed. If they become too many, those go that
/// were not used for longest. One that is larger than all room is kept alone.
#[derive(Debug)]
pub(crate) struct RecentlyUsed<T> {
    most: u64,
    held: Mutex<Held<T>>,
}

#[derive(Debug)]
struct Held<T> {
    entries: HashMap<PathBuf, Kept<T>>,
    bytes: u64,
    /// The number of uses so far.
    uses: u64,
}

#[derive(Debug)]
struct Kept<T> {
    value: Arc<T>,
    last_use: u64,
}

impl<T: Bytes> RecentlyUsed<T> {
    /// Creates an empty store with room for this many bytes.
    pub fn new(most: u64) -> Self {
        Self { most, held: Mutex::new(Held { entries: HashMap::new(), bytes: 0, uses: 0 }) }
    }

    /// Returns what is kept of a file.
    pub fn find(&self, path: &Path) -> Option<Arc<T>> {
        let mut held = self.held();
        held.uses += 1;
        let uses = held.uses;
        let entry = held.entries.get_mut(path)?;
        entry.last_use = uses;
        Some(entry.value.clone())
    }

    /// Returns what is kept of a file, or what `read` makes of it.
    pub fn find_or(&self, path: &Path, read: impl FnOnce() -> Result<T>) -> Result<Arc<T>> {
        if let Some(found) = self.find(path) {
            return Ok(found);
        }
        // Without the lock: other threads may read other files meanwhile.
        let value = Arc::new(read()?);
        self.held().keep(path, &value, self.most);
        Ok(value)
    }

    fn held(&self) -> MutexGuard<'_, Held<T>> {
        // Nothing panics while it is held half-changed.
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Bytes> Held<T> {
    fn keep(&mut self, path: &Path, value: &Arc<T>, most: u64) {
        let bytes = value.bytes();
        while self.bytes + bytes > most {
            let oldest = self.entries.iter().min_by_key(|(_, entry)| entry.last_use);
            let Some(path) = oldest.map(|(path, _)| path.clone()) else { break };
            self.bytes -= self.entries.remove(&path).map_or(0, |entry| entry.value.bytes());
        }
        let entry = Kept { value: value.clone(), last_use: self.uses };
        let before = self.entries.insert(path.to_owned(), entry);
        self.bytes += bytes;
        self.bytes -= before.map_or(0, |entry| entry.value.bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Bytes for u64 {
        fn bytes(&self) -> u64 {
            *self
        }
    }

    #[test]
    fn the_least_recently_used_go() {
        let store = RecentlyUsed::new(32);
        let names = || {
            let mut names: Vec<_> = store.held().entries.keys().cloned().collect();
            names.sort();
            names
        };
        for name in ["a", "b", "a", "c"] {
            assert_eq!(*store.find_or(Path::new(name), || Ok(16)).unwrap(), 16);
        }
        assert_eq!((names(), store.held().bytes), (vec!["a".into(), "c".into()], 32));
        // What is kept is not read again; what is too large is kept alone.
        store.find_or(Path::new("a"), || panic!("read again")).unwrap();
        store.find_or(Path::new("d"), || Ok(100)).unwrap();
        assert_eq!((names(), store.held().bytes), (vec!["d".into()], 100));
    }
}
