//! Where a file name of a URDF leads: paths, `file://`, `package://`.

use super::MeshFault;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The search paths of the environment, as ROS sets them.
#[derive(Clone, Debug, Default)]
pub struct SearchPaths {
    /// `ROS_PACKAGE_PATH`: packages, and folders of packages.
    pub ros_package_path: OsString,
    /// `AMENT_PREFIX_PATH`: install prefixes; packages are in `share/`.
    pub ament_prefix_path: OsString,
}

impl SearchPaths {
    /// Of this process. The only place in this room that reads the environment.
    pub fn of_environment() -> Self {
        let variable = |name| std::env::var_os(name).unwrap_or_default();
        Self { ros_package_path: variable("ROS_PACKAGE_PATH"), ament_prefix_path: variable("AMENT_PREFIX_PATH") }
    }
}

/// Where file names lead.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    /// Of the URDF.
    pub(super) folder: PathBuf,
    /// Names and folders told by the user.
    pub(super) packages: Vec<(String, PathBuf)>,
    pub(super) paths: SearchPaths,
}

impl Places {
    /// The file that is meant.
    pub(super) fn find(&self, filename: &str) -> Result<PathBuf, MeshFault> {
        let address = |reason: &str| MeshFault::Address { filename: filename.into(), reason: reason.into() };
        let Some((scheme, rest)) = scheme(filename) else {
            return first_file(filename, vec![self.folder.join(filename)]);
        };
        match scheme.to_ascii_lowercase().as_str() {
            "package" => self.in_package(filename, rest),
            "file" => {
                let path = rest.strip_prefix("localhost").unwrap_or(rest);
                if !path.starts_with('/') {
                    return Err(address("after file:// the path starts with a slash (file:///home/…)"));
                }
                let path = percent_decoded(path).ok_or_else(|| address("a % is not followed by two hex digits"))?;
                first_file(filename, vec![path])
            }
            "model" => Err(address("model:// is Gazebo's; write package://NAME/… or a path relative to this file")),
            _ => Err(address("only files of this computer are read: package://NAME/…, file:///… or a path")),
        }
    }

    fn in_package(&self, filename: &str, rest: &str) -> Result<PathBuf, MeshFault> {
        let (package, inside) = rest.split_once('/').unwrap_or((rest, ""));
        let folders = self.folders_of(package);
        if package.is_empty() || folders.is_empty() {
            let looked = self.looked_for(package);
            return Err(MeshFault::UnknownPackage { filename: filename.into(), package: package.into(), looked });
        }
        let inside = inside.trim_start_matches('/');
        first_file(filename, folders.into_iter().map(|folder| folder.join(inside)).collect())
    }

    /// Folders of a package: as told; in `ROS_PACKAGE_PATH`; in `AMENT_PREFIX_PATH`; a folder above the URDF that has the
    /// package's name, or whose package.xml has. If the user tells one, no other is looked at.
    fn folders_of(&self, package: &str) -> Vec<PathBuf> {
        let told = self.packages.iter().filter(|(name, _)| name == package).map(|(_, folder)| folder.clone());
        let told: Vec<PathBuf> = told.collect();
        if !told.is_empty() {
            return told;
        }
        let mut folders = Vec::new();
        for entry in entries(&self.paths.ros_package_path) {
            folders.extend(is_package(&entry, package).then(|| entry.clone()));
            folders.extend(held(&entry, package));
        }
        for prefix in entries(&self.paths.ament_prefix_path) {
            folders.extend(Some(prefix.join("share").join(package)).filter(|share| share.is_dir()));
        }
        folders.extend(self.above().into_iter().filter(|folder| is_package(folder, package)));
        folders.dedup();
        folders
    }

    /// The folder of the URDF and those above it, as the path is written and as its links resolve.
    fn above(&self) -> Vec<PathBuf> {
        let written =
            std::path::absolute(if self.folder.as_os_str().is_empty() { Path::new(".") } else { &self.folder });
        let real = self.folder.canonicalize();
        [written, real]
            .into_iter()
            .flatten()
            .flat_map(|f| f.ancestors().map(Path::to_path_buf).collect::<Vec<_>>())
            .collect()
    }

    fn looked_for(&self, package: &str) -> String {
        let shown = |name: &str, value: &OsString| match value.is_empty() {
            true => format!("{name} (not set)"),
            false => format!("{name} ({})", value.display()),
        };
        let paths = &self.paths;
        let ros = shown("ROS_PACKAGE_PATH", &paths.ros_package_path);
        let ament = shown("AMENT_PREFIX_PATH", &paths.ament_prefix_path);
        let folder = self.above().into_iter().next().unwrap_or_else(|| self.folder.clone());
        format!("in {ros}, in {ament}, and for a folder \"{package}\" above {}", folder.display())
    }
}

/// "NAME" and what follows "NAME://".
fn scheme(filename: &str) -> Option<(&str, &str)> {
    let (scheme, rest) = filename.split_once("://")?;
    scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c)).then_some((scheme, rest))
}

fn first_file(filename: &str, places: Vec<PathBuf>) -> Result<PathBuf, MeshFault> {
    if let Some(file) = places.iter().find(|place| place.is_file()) {
        return Ok(file.clone());
    }
    let shown = |place: &PathBuf| std::path::absolute(place).unwrap_or_else(|_| place.clone()).display().to_string();
    let listed: Vec<String> = places.iter().map(shown).collect();
    Err(MeshFault::NotFound(format!("{filename} is no file that is there: looked for {}", listed.join(", "))))
}

fn entries(list: &OsString) -> Vec<PathBuf> {
    std::env::split_paths(list).filter(|entry| !entry.as_os_str().is_empty()).collect()
}

/// By its package.xml, or, where there is none, by its own name.
fn is_package(folder: &Path, name: &str) -> bool {
    match package_name(folder) {
        Some(written) => written == name,
        None => folder.file_name().is_some_and(|own| own == name) && folder.is_dir(),
    }
}

/// The folders right below `entry` that are the package; the one with its name first.
fn held(entry: &Path, name: &str) -> Vec<PathBuf> {
    let named = Some(entry.join(name)).filter(|folder| is_package(folder, name));
    let others = std::fs::read_dir(entry).into_iter().flatten().flatten().map(|e| e.path());
    let mut others: Vec<PathBuf> = others
        .filter(|f| named.as_ref() != Some(f) && package_name(f).is_some_and(|written| written == name))
        .collect();
    others.sort();
    named.into_iter().chain(others).collect()
}

/// `<name>` in a folder's package.xml.
fn package_name(folder: &Path) -> Option<String> {
    let manifest = folder.join("package.xml");
    let small = manifest.metadata().ok().filter(|m| m.is_file() && m.len() < 1 << 20);
    small?;
    let text = std::fs::read_to_string(manifest).ok()?;
    let document = roxmltree::Document::parse(&text).ok()?;
    let name = document.root_element().children().find(|c| c.tag_name().name() == "name")?;
    Some(name.text()?.trim().to_owned())
}

/// A path with `%20` and the like as the bytes that they stand for.
fn percent_decoded(path: &str) -> Option<PathBuf> {
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        if byte == b'%' {
            let digits = std::str::from_utf8(after.get(..2)?).ok().filter(|d| !d.starts_with('+'))?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &after[2..];
        } else {
            bytes.push(byte);
            rest = after;
        }
    }
    String::from_utf8(bytes).ok().filter(|path| !path.contains('\0')).map(PathBuf::from)
}
