//! `<terrain>`: a height field, flat or around a sphere.

use super::super::element::Element;
use super::super::finding::Finding;
use super::super::report::Report;
use super::super::rules::Values;
use super::super::{Geometry, Heights};

/// `None` is reported.
pub(super) fn read(values: &Values, element: &Element, report: &mut Report) -> Option<Geometry> {
    let size: Option<[f64; 3]> = values.numbers("size").and_then(|numbers| numbers.try_into().ok());
    let sphere = (values.number("radius"), values.number("height"));
    let given = |name| element.value(name).is_some();
    let heights = heights(values, element, report);
    match (size, sphere) {
        (Some(size), (None, None)) => Some(Geometry::Terrain { size, heights: heights? }),
        (None, (Some(radius), Some(height))) => Some(Geometry::SphericalTerrain { radius, height, heights: heights? }),
        (None, _) if given("size") => None,
        _ => {
            let message = "<terrain> needs either `size` (flat), or `radius` and `height` (spherical)".to_string();
            report.add(Finding::error("terrain", element.place(report), message, "give one of the two forms"));
            None
        }
    }
}

fn heights(values: &Values, element: &Element, report: &mut Report) -> Option<Heights> {
    let fault = match (values.word("filename"), values.numbers("heights"), values.number("columns")) {
        (Some(filename), None, None) => return Some(Heights::File { filename: filename.into() }),
        (None, Some(numbers), Some(columns)) => {
            let columns = columns as usize;
            if numbers.len() >= 2 * columns && numbers.len().is_multiple_of(columns) {
                return Some(Heights::Written { columns, values: numbers.to_vec() });
            }
            format!("{} heights are not two or more whole rows of {columns}", numbers.len())
        }
        _ if ["heights", "columns"].iter().any(|n| element.value(n).is_some() && values.numbers(n).is_none()) => {
            return None;
        }
        _ => "<terrain> needs either `filename`, or `heights` and `columns`".to_string(),
    };
    let mend = "write heights=\"0 0 0  0 1 0  0 0 0\" columns=\"3\", or filename=\"hills.png\"";
    report.add(Finding::error("terrain", element.place_of("heights", report), fault, mend));
    None
}
