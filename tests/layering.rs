//! The room rule: a room may use only rooms above it in `src/lib.rs`.
#![allow(clippy::unwrap_used)] // a test may panic

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

fn rooms() -> Vec<String> {
    let lib = fs::read_to_string("src/lib.rs").unwrap();
    lib.lines().filter_map(|l| l.strip_prefix("pub mod ")?.strip_suffix(';').map(String::from)).collect()
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![];
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// Names of rooms that a text uses as `crate::ROOM`, comments left out.
fn used(text: &str) -> Vec<String> {
    let code: String = text.lines().map(|l| l.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
    let mut names = vec![];
    for part in code.split("crate::").skip(1) {
        let grouped = part.starts_with('{');
        let end = part.find(if grouped { '}' } else { ';' }).unwrap_or(part.len());
        for item in part[..end].trim_start_matches('{').split(if grouped { ',' } else { ';' }) {
            let name: String = item.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            names.push(name);
        }
    }
    names
}

fn violations(rooms: &[String], files: &BTreeMap<String, Vec<(PathBuf, String)>>) -> Vec<String> {
    let mut found = vec![];
    for (rank, room) in rooms.iter().enumerate() {
        for (path, text) in &files[room] {
            for name in used(text) {
                if rooms.iter().position(|r| *r == name).is_some_and(|other| other > rank) {
                    found.push(format!("{}: room '{room}' uses room '{name}', which is below it", path.display()));
                }
            }
        }
    }
    found
}

fn files(rooms: &[String]) -> BTreeMap<String, Vec<(PathBuf, String)>> {
    let read = |room: &String| {
        let paths = sources(&Path::new("src").join(room));
        paths.into_iter().map(|p| (p.clone(), fs::read_to_string(p).unwrap())).collect()
    };
    rooms.iter().map(|r| (r.clone(), read(r))).collect()
}

#[test]
fn rooms_use_only_rooms_above_them() {
    let rooms = rooms();
    assert!(rooms.len() >= 10, "the rooms are listed in src/lib.rs");
    let found = violations(&rooms, &files(&rooms));
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The rule can fail: a text that breaks it is seen, in both ways of writing it.
#[test]
fn a_breach_is_seen() {
    let rooms = rooms();
    for text in ["use crate::world::World;", "use crate::{math::Vec3, world::World};"] {
        let mut all = files(&rooms);
        all.get_mut("math").unwrap().push((PathBuf::from("made_up.rs"), text.into()));
        assert_eq!(violations(&rooms, &all).len(), 1);
    }
}

/// Only the ros room knows ros2-client, only the ros room and the program wait for the wall clock, and of the physics
/// rooms only the part that reads mesh files touches a file.
#[test]
fn ros_stays_in_its_room() {
    let rooms = rooms();
    for (room, texts) in files(&rooms) {
        for (path, text) in texts {
            let shown = path.display();
            assert!(room == "ros" || !text.contains("ros2_client"), "{shown} uses ros2-client");
            let physics = !["ros", "cli", "record", "monitor"].contains(&room.as_str());
            assert!(!(physics && text.contains("std::time")), "{shown} uses the wall clock");
            let reads_meshes = path.starts_with("src/shape/meshes");
            assert!(!(physics && !reads_meshes && text.contains("std::fs")), "{shown} uses files");
        }
    }
}
