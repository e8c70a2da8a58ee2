//! Which files were read, so that a bag can hold them, and texts of a bag in place of files. Per thread.

use crate::shape::Meshes;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Texts by absolute path.
pub type Texts = BTreeMap<PathBuf, String>;

/// What has been read.
#[derive(Clone, Debug, Default)]
pub struct Heard {
    /// Text files.
    pub texts: Texts,
    /// Mesh and height files, by absolute path.
    pub meshes: BTreeSet<PathBuf>,
}

thread_local! {
    static READ: RefCell<Option<Heard>> = const { RefCell::new(None) };
    static INSTEAD: RefCell<Texts> = const { RefCell::new(BTreeMap::new()) };
}

/// What `load` does, and the files that it has read.
pub fn listening<T>(load: impl FnOnce() -> T) -> (T, Heard) {
    READ.set(Some(Heard::default()));
    let result = load();
    (result, READ.take().unwrap_or_default())
}

/// What `load` does when these texts stand for files.
pub fn standing_in<T>(texts: Texts, load: impl FnOnce() -> T) -> T {
    INSTEAD.set(texts);
    let result = load();
    INSTEAD.set(Texts::new());
    result
}

/// A file was read.
pub(super) fn remember(path: &Path, text: &str) {
    READ.with_borrow_mut(|read| {
        if let Some(heard) = read {
            heard.texts.insert(absolute(path), text.to_owned());
        }
    });
}

/// Mesh files were read.
pub(super) fn remember_files(meshes: &Meshes) {
    READ.with_borrow_mut(|read| {
        if let Some(heard) = read {
            heard.meshes.extend(meshes.files().iter().map(|f| absolute(f)));
        }
    });
}

/// The text that stands for a file.
pub(super) fn instead_of(path: &Path) -> Option<String> {
    INSTEAD.with_borrow(|texts| if texts.is_empty() { None } else { texts.get(&absolute(path)).cloned() })
}

/// From the root of the file system.
pub(super) fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
