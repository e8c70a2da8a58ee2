//! What a run leaves on disk: rows of comma-separated values, or a bag of ROS 2 messages.

mod bag;
mod contacts;
mod csv;
mod definitions;
mod folder;
mod live;
pub mod messages;
mod metadata;
mod reader;
mod recover;
mod sample;
mod samples;
mod schema;
pub mod story;

pub use bag::{Bag, CDR_LITTLE_ENDIAN, to_cdr};
pub use contacts::ContactWriter;
pub use csv::CsvWriter;
pub use live::{Item, Report, Session};
pub use metadata::Topic;
pub use reader::{BagReader, Stored, file_in};
pub use recover::{Recovered, recover};
pub use sample::Sample;
pub use samples::BagWriter;
pub use schema::MessageType;

use crate::model::Model;
use folder::Place;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// Why a record could not be made.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The ending names no format.
    #[error("{}: must end in .csv or .mcap", .0.display())]
    Ending(PathBuf),
    /// The file belongs to a bag of several files: replacing one of them would spoil it.
    #[error(
        "{} is one of several files of the bag that metadata.yaml beside it describes; choose another name or folder",
        .0.display()
    )]
    PartOfBag(PathBuf),
    /// The file system refused.
    #[error("cannot write '{}': {cause}", path.display())]
    Write {
        /// File or folder.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
}

impl RecordError {
    fn write(path: &Path, cause: io::Error) -> Self {
        Self::Write { path: path.to_owned(), cause }
    }
}

/// Formats of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values.
    Csv,
    /// A bag: MCAP with ROS 2 messages.
    Mcap,
}

impl Format {
    /// By the ending of the file name.
    ///
    /// # Errors
    /// [`RecordError::Ending`] if it is neither `.csv` nor `.mcap`.
    pub fn of(path: &Path) -> Result<Self, RecordError> {
        match path.extension().and_then(|e| e.to_str()) {
            Some("csv") => Ok(Self::Csv),
            Some("mcap") => Ok(Self::Mcap),
            _ => Err(RecordError::Ending(path.to_owned())),
        }
    }
}

/// Writes samples to a file whose ending chooses the format.
pub struct Recorder {
    path: PathBuf,
    place: Place,
    writer: Writer,
}

enum Writer {
    Csv(CsvWriter<File>),
    Bag(Box<BagWriter<BufWriter<File>>>),
}

impl Recorder {
    /// Opens the file; makes its folder (not the folder's parents) if there is none.
    ///
    /// # Errors
    /// [`RecordError`], with the path.
    pub fn create(path: &Path, model: &Model) -> Result<Self, RecordError> {
        let failed = |cause| RecordError::write(path, cause);
        let format = Format::of(path)?;
        let place = Place::prepare(path)?;
        let file = File::create(path).map_err(failed)?;
        place.forget_earlier_bag().map_err(failed)?;
        let writer = match format {
            Format::Csv => Writer::Csv(CsvWriter::new(file, model).map_err(failed)?),
            Format::Mcap => Writer::Bag(Box::new(BagWriter::new(BufWriter::new(file), model).map_err(failed)?)),
        };
        Ok(Self { path: path.to_owned(), place, writer })
    }

    /// Writes one sample.
    ///
    /// # Errors
    /// [`RecordError::Write`].
    pub fn write(&mut self, sample: &Sample) -> Result<(), RecordError> {
        let result = match &mut self.writer {
            Writer::Csv(csv) => csv.row(sample),
            Writer::Bag(bag) => bag.write(sample),
        };
        result.map_err(|cause| RecordError::write(&self.path, cause))
    }

    /// Completes the file and, where the folder is the bag's own, writes `metadata.yaml`. Returns the files written.
    ///
    /// # Errors
    /// [`RecordError::Write`].
    pub fn finish(self) -> Result<Vec<PathBuf>, RecordError> {
        let mut written = vec![self.path.clone()];
        match self.writer {
            Writer::Csv(csv) => csv.finish().map_err(|e| RecordError::write(&self.path, e))?,
            Writer::Bag(bag) => {
                let contents = bag.finish().map_err(|e| RecordError::write(&self.path, e))?;
                if let Place::OwnFolder { metadata } = self.place {
                    let text = metadata::yaml(&contents, &self.path).map_err(|e| RecordError::write(&metadata, e))?;
                    std::fs::write(&metadata, text).map_err(|e| RecordError::write(&metadata, e))?;
                    written.push(metadata);
                }
            }
        }
        Ok(written)
    }
}
