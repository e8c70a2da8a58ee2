//! The page: title, views, scale, list and key.

use super::contour::{Contour, contour};
use super::labels::labels;
use super::marks::{WHOLE, drawn, drawn_whole, marks, whole};
use super::parts::{Part, extent, parts};
use super::svg::{escaped, line, number, path_element, text};
use super::view::{FRONT, Point, RIGHT, Side, View};
use super::{Drawing, legend};
use crate::shape::Bounds;

/// Pixels.
const MARGIN: f64 = 36.0;
const GAP: f64 = 56.0;
const TOP: f64 = 104.0;
const TALLEST: f64 = 760.0;
const WIDEST: f64 = 1000.0;

const STYLE: &str = "\
text{font-family:system-ui,-apple-system,'Segoe UI','Helvetica Neue',Arial,'DejaVu Sans',sans-serif;font-size:11.5px;fill:#2b3440}
.h{font-size:22px;font-weight:600}.s{font-size:13.5px;fill:#5b6673}.v{font-size:12.5px;fill:#5b6673;text-anchor:middle}
.l{text-anchor:start}.r{text-anchor:end}.m{text-anchor:middle}
.n{font-size:10.5px;text-anchor:middle;stroke:#fff;stroke-width:2.6px;stroke-linejoin:round;paint-order:stroke}
.f{fill:#a9bccf;fill-opacity:.34;stroke:#51657b;stroke-width:.8px;stroke-linejoin:round}
.e{fill:none;stroke:#51657b;stroke-width:.7px;stroke-linecap:round;stroke-linejoin:round;stroke-opacity:.85}
.b{fill:none;stroke:#51657b;stroke-width:.5px;stroke-opacity:.22}
.g{stroke:#8b96a3;stroke-width:1.2px}.plumb{stroke:#c8741a;stroke-width:1px;stroke-dasharray:5 4}
.a1,.a2,.a3{stroke-width:1.5px;stroke-linecap:round}.a1{stroke:#d3302f}.a2{stroke:#2c9a42}.a3{stroke:#2c62d2}
.com circle{fill:#fff;stroke:#17202b;stroke-width:.9px}.com path{fill:#17202b}
.whole circle{fill:#fff;stroke:#b3600c;stroke-width:1.8px}.whole path{fill:#e08a2b}";

/// SVG text.
pub(super) fn page(drawing: &Drawing) -> String {
    let (parts, missing) = parts(drawing);
    let (marks, whole) = (marks(drawing), whole(drawing));
    let extent = extent(&parts, marks.iter().map(|m| m.center));
    let views = views(&extent);
    let mut body = String::new();
    for view in &views {
        body += &heading(view);
        body += &robot(&parts, view);
        body += &drawn(&marks, view);
        let mut signs = vec![];
        if whole.mass > 0.0 {
            body += &drawn_whole(&whole.center, view, extent.min.z);
            signs.push((view.at(&whole.center), WHOLE));
        }
        body += &labels(&marks, &signs, view);
    }
    let right = views.iter().map(|v| v.corner[0] + v.size()[0]).fold(0.0, f64::max) + GAP;
    let bottom = views.iter().map(|v| v.corner[1]).fold(0.0, f64::max);
    body += &ground(&views, bottom);
    body += &scale_bar([MARGIN, bottom + 34.0], views[0].scale);
    let (list, below) = legend::list(&marks, [right, TOP]);
    let (key, end) = legend::key(&marks, &missing, [right, below + 18.0]);
    let size = [right + legend::COLUMN * legend::columns(marks.len()) as f64 + MARGIN, end.max(bottom + 64.0) + 12.0];
    let words = format!(
        "{} in {} links with mass, {:.2} m high; every axis at zero",
        legend::kilograms(whole.mass),
        marks.len(),
        extent.max.z - extent.min.z
    );
    framed(drawing.title, &words, size, &(body + &list + &key))
}

/// Both views beside each other at one scale.
fn views(extent: &Bounds) -> Vec<View<'static>> {
    let sides: [&'static Side; 2] = [&FRONT, &RIGHT];
    let sizes = sides.map(|side| side.size(extent));
    let width: f64 = sizes.iter().map(|s| s[0]).sum();
    let height = sizes.iter().map(|s| s[1]).fold(0.0, f64::max);
    let room = WIDEST - GAP * (sides.len() - 1) as f64;
    let scale = (TALLEST / height).min(room / width);
    // A single point takes any scale.
    let scale = if scale.is_finite() && scale > 0.0 { scale } else { 100.0 };
    let mut x = MARGIN;
    let place = |(side, size): (&'static Side, [f64; 2])| {
        let corner = [x, TOP + 12.0 + height * scale];
        x += size[0].max(70.0 / scale) * scale + GAP;
        View { side, corner, scale, extent: *extent }
    };
    sides.into_iter().zip(sizes).map(place).collect()
}

fn heading(view: &View) -> String {
    let middle = view.corner[0] + view.size()[0] / 2.0;
    text("v", [middle, TOP - 10.0], &format!("{} ({} →, {} ↑)", view.side.title, view.side.axes[0], view.side.axes[1]))
}

/// All shapes, the far ones first.
fn robot(parts: &[Part], view: &View) -> String {
    let mut contours: Vec<Contour> = parts.iter().map(|part| contour(part, view)).collect();
    contours.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    let element = |c: &Contour| {
        path_element("b", &c.hidden, false) + &path_element("f", &c.outline, true) + &path_element("e", &c.edges, false)
    };
    contours.iter().map(element).collect()
}

fn ground(views: &[View], y: f64) -> String {
    views.iter().map(|v| line("g", [v.corner[0] - 14.0, y], [v.corner[0] + v.size()[0] + 14.0, y])).collect()
}

/// 1, 2 or 5 times a power of ten, about 120 pixels long.
fn scale_bar([x, y]: Point, scale: f64) -> String {
    let power = 10.0_f64.powf((120.0 / scale).log10().floor());
    let metres = [5.0, 2.0, 1.0].iter().map(|n| n * power).find(|m| m * scale <= 120.0).unwrap_or(power);
    let end = x + metres * scale;
    let words = if metres >= 1.0 { format!("{metres} m") } else { format!("{} mm", (metres * 1e6).round() / 1e3) };
    let ticks: String = [x, end].iter().map(|x| line("g", [*x, y - 4.0], [*x, y + 4.0])).collect();
    line("g", [x, y], [end, y]) + &ticks + &text("l", [end + 8.0, y + 4.0], &words)
}

fn framed(title: &str, words: &str, size: [f64; 2], body: &str) -> String {
    let [width, height] = size.map(number);
    let head = text("h", [MARGIN, 40.0], title) + &text("s", [MARGIN, 62.0], words);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{}</title>\n<style>{STYLE}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{head}{body}</svg>\n",
        escaped(title)
    )
}
