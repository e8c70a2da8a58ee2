//! Whether the folder of a bag file is the bag's own, and so a bag to rosbag2.

use super::{Format, RecordError};
use serde::Deserialize;
use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

const METADATA: &str = "metadata.yaml";

/// What the folder of a file is to the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// New, empty, or left by an earlier bag of the same name: gets a metadata.yaml.
    OwnFolder {
        /// Where that goes.
        metadata: PathBuf,
    },
    /// Holds other things too: the file stands for itself.
    Shared,
}

impl Place {
    /// Looks at the folder of `file`; makes it (not its parents) if there is none.
    ///
    /// # Errors
    /// [`RecordError`]: the folder can be neither read nor made, or `file` is one of several files of a bag.
    pub fn prepare(file: &Path) -> Result<Self, RecordError> {
        let folder = match file.parent() {
            Some(parent) if parent != Path::new("") => parent,
            _ => Path::new("."),
        };
        let failed = |cause| RecordError::write(folder, cause);
        if !folder.exists() {
            std::fs::create_dir(folder).map_err(failed)?;
        }
        if Format::of(file)? == Format::Csv {
            return Ok(Self::Shared);
        }
        let metadata = folder.join(METADATA);
        let described = described_files(&metadata);
        let name = file.file_name().unwrap_or_default();
        if described.iter().any(|f| OsStr::new(f) == name) {
            let alone = described.len() == 1;
            return if alone { Ok(Self::OwnFolder { metadata }) } else { Err(RecordError::PartOfBag(file.to_owned())) };
        }
        let mut others = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            others.extend(Some(entry.map_err(failed)?.file_name()).filter(|n| n != name));
        }
        Ok(if others.is_empty() { Self::OwnFolder { metadata } } else { Self::Shared })
    }

    /// Removes the metadata.yaml of an earlier bag, which would be wrong if this run were cut short.
    ///
    /// # Errors
    /// What the file system says.
    pub fn forget_earlier_bag(&self) -> io::Result<()> {
        match self {
            Self::OwnFolder { metadata } if metadata.exists() => std::fs::remove_file(metadata),
            _ => Ok(()),
        }
    }
}

#[derive(Deserialize)]
struct Document {
    rosbag2_bagfile_information: Information,
}

#[derive(Deserialize)]
struct Information {
    relative_file_paths: Vec<String>,
}

/// The files that a metadata.yaml calls its own; none if it does not exist or is something else.
fn described_files(metadata: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(metadata).unwrap_or_default();
    let document = serde_saphyr::from_str::<Document>(&text);
    document.map_or_else(|_| Vec::new(), |d| d.rosbag2_bagfile_information.relative_file_paths)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn own(folder: &Path) -> Place {
        Place::OwnFolder { metadata: folder.join(METADATA) }
    }

    #[test]
    fn a_new_or_empty_folder_is_the_bags_own() {
        let dir = tempfile::tempdir().unwrap();
        let (new, bag) = (dir.path().join("run"), dir.path().join("run/run.mcap"));
        assert_eq!(Place::prepare(&bag).unwrap(), own(&new));
        assert!(new.is_dir());
        assert_eq!(Place::prepare(&bag).unwrap(), own(&new));
        assert!(matches!(Place::prepare(&dir.path().join("a/b/run.mcap")), Err(RecordError::Write { .. })));
    }

    #[test]
    fn a_folder_with_other_things_is_left_alone() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("notes.txt"), "").unwrap();
        assert_eq!(Place::prepare(&dir.path().join("run.mcap")).unwrap(), Place::Shared);
    }

    #[test]
    fn an_earlier_bag_is_replaced_but_not_a_part_of_one() {
        let dir = tempfile::tempdir().unwrap();
        let bag = dir.path().join("run.mcap");
        let describe = |files: &str| {
            let text = format!("rosbag2_bagfile_information:\n  version: 9\n  relative_file_paths: [{files}]\n");
            fs::write(dir.path().join(METADATA), text).unwrap();
        };
        fs::write(dir.path().join("notes.txt"), "").unwrap();
        describe("run.mcap");
        assert_eq!(Place::prepare(&bag).unwrap(), own(dir.path()));
        describe("other.mcap");
        assert_eq!(Place::prepare(&bag).unwrap(), Place::Shared);
        describe("run.mcap, run_1.mcap");
        assert!(matches!(Place::prepare(&bag), Err(RecordError::PartOfBag(_))));
    }
}
