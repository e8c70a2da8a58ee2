//! COLLADA (.dae): the triangles of what the scene instantiates, in metres.
//!
//! Own extraction over `roxmltree`: `mesh-loader` 0.1 scales corners by the file's unit but not the translations of its
//! nodes. What `<up_axis>` says is left aside, as RViz, MoveIt and Pinocchio do (docs/decisions/0011-mesh-files.md).

mod faces;
mod nodes;

use super::fault::Inside;
use super::text::short;
use crate::shape::TriMesh;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;

/// Elements and texts of one file; each takes memory beyond its bytes.
const MOST_ELEMENTS: u32 = 4_000_000;

/// Is it certain from the bytes alone that this is a COLLADA file?
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(4000)]);
    head.contains("<COLLADA") || head.contains(":COLLADA")
}

/// The mesh in a COLLADA file, in metres.
pub(super) fn read(bytes: &[u8]) -> Result<TriMesh, Inside> {
    // Only names may be in another encoding than ASCII.
    let text = String::from_utf8_lossy(bytes);
    let options = ParsingOptions { nodes_limit: MOST_ELEMENTS, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options).map_err(|fault| match fault {
        roxmltree::Error::NodesLimitReached => Inside::TooLarge(format!("more than {MOST_ELEMENTS} elements")),
        other => Inside::At(format!("line {}", other.pos().row), format!("it is not well-formed XML: {other}")),
    })?;
    if document.root_element().tag_name().name() != "COLLADA" {
        let name = document.root_element().tag_name().name();
        return Err(Inside::At("line 1".into(), format!("<{}> is no COLLADA file", short(name))));
    }
    nodes::mesh(&Dae::new(&document))
}

/// The document and its elements by id.
struct Dae<'a> {
    document: &'a Document<'a>,
    by_id: HashMap<&'a str, Node<'a, 'a>>,
}

impl<'a> Dae<'a> {
    fn new(document: &'a Document<'a>) -> Self {
        let mut by_id = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                by_id.entry(id).or_insert(node);
            }
        }
        Self { document, by_id }
    }

    fn root(&self) -> Node<'a, 'a> {
        self.document.root_element()
    }

    /// What an attribute of the form "#id" leads to.
    fn target(&self, node: Node<'a, 'a>, attribute: &str) -> Result<Node<'a, 'a>, Inside> {
        let url = node.attribute(attribute).unwrap_or("");
        let id = url.strip_prefix('#').unwrap_or(url);
        let target = self.by_id.get(id).copied();
        target.ok_or_else(|| self.fault(node, format!("{attribute}=\"{}\" leads nowhere in this file", short(url))))
    }

    fn fault(&self, node: Node, reason: impl std::fmt::Display) -> Inside {
        let line = self.document.text_pos_at(node.range().start).row;
        Inside::At(format!("line {line}"), format!("<{}>: {reason}", node.tag_name().name()))
    }

    fn numbers(&self, node: Node) -> Result<Vec<f64>, Inside> {
        let number =
            |word: &str| word.parse().map_err(|_| self.fault(node, format!("\"{}\" is not a number", short(word))));
        words(node).map(number).collect()
    }
}

/// The words of an element's text.
fn words<'a>(node: Node<'a, 'a>) -> impl Iterator<Item = &'a str> {
    node.children().filter(Node::is_text).filter_map(|t| t.text()).flat_map(str::split_ascii_whitespace)
}

/// The first child element of a name.
fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|c| c.tag_name().name() == name)
}
