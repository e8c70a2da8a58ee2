//! Why a file gives no mesh.

/// Why a file gives no mesh, or no heights. Every message names the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// No such file; the message lists every place that was looked at.
    #[error("{0}")]
    NotFound(String),
    /// `package://NAME/…` with a NAME that nothing leads to.
    #[error("package \"{package}\" of {filename} is not known: it was looked for {looked}")]
    UnknownPackage {
        /// As written.
        filename: String,
        /// NAME.
        package: String,
        /// Where, for people.
        looked: String,
    },
    /// An address that is no file of this computer.
    #[error("{filename} is an address that is not read: {reason}")]
    Address {
        /// As written.
        filename: String,
        /// Why, and what is read instead.
        reason: String,
    },
    /// Neither its name nor its first bytes tell what it is.
    #[error("{path} is in no format that is read ({extension}): write STL, OBJ or DAE (COLLADA)")]
    UnknownFormat {
        /// The file.
        path: String,
        /// Its extension, for people.
        extension: String,
    },
    /// More than is read.
    #[error("{path} is too large: {what}")]
    TooLarge {
        /// The file.
        path: String,
        /// What there is, and the limit.
        what: String,
    },
    /// Something that its format does not allow.
    #[error("{path}, {at}: {reason}")]
    Unreadable {
        /// The file.
        path: String,
        /// The line or byte, for people.
        at: String,
        /// What is wrong.
        reason: String,
    },
    /// A corner that is no place.
    #[error("{path}: vertex {vertex} is ({}, {}, {}), which is no place{}", place[0], place[1], place[2], reach(place))]
    NoPlace {
        /// The file.
        path: String,
        /// Which one, counted from 1 in the order of the file.
        vertex: usize,
        /// Its coordinates, m.
        place: [f64; 3],
    },
    /// Heights that make no surface.
    #[error("{0}")]
    Terrain(String),
    /// Nothing to see.
    #[error("{path} holds no triangles")]
    NoTriangles {
        /// The file.
        path: String,
    },
}

/// Coordinates beyond this, m, are not read: their fifth powers, which moments of inertia are made of, must stay finite.
pub(super) const FARTHEST: f64 = 1e15;

fn reach(place: &[f64; 3]) -> String {
    let far = place.iter().all(|x| x.is_finite());
    if far { format!(" within {FARTHEST:e} m") } else { String::new() }
}

/// A fault inside a file, before the file has its name.
pub(super) enum Inside {
    At(String, String),
    NoPlace(usize, [f64; 3]),
    TooLarge(String),
    Empty,
}

impl Inside {
    pub(super) fn line(line: usize, reason: impl Into<String>) -> Self {
        Self::At(format!("line {line}"), reason.into())
    }

    pub(super) fn byte(byte: usize, reason: impl Into<String>) -> Self {
        Self::At(format!("byte {byte}"), reason.into())
    }

    /// With the name of the file.
    pub(super) fn of(self, path: String) -> MeshFault {
        match self {
            Self::At(at, reason) => MeshFault::Unreadable { path, at, reason },
            Self::NoPlace(vertex, place) => MeshFault::NoPlace { path, vertex, place },
            Self::TooLarge(what) => MeshFault::TooLarge { path, what },
            Self::Empty => MeshFault::NoTriangles { path },
        }
    }
}
