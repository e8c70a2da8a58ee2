//! SVG text.

use super::view::Point;
use std::fmt::Write;

/// A coordinate to a tenth of a pixel, as short as it gets.
pub(super) fn number(x: f64) -> String {
    let text = format!("{x:.1}");
    let short = text.strip_suffix(".0").unwrap_or(&text);
    if short == "-0" { "0".into() } else { short.into() }
}

/// Text in which nothing is taken for markup; characters that XML cannot hold are left out.
pub(super) fn escaped(text: &str) -> String {
    let allowed = text.chars().filter(|c| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}'));
    allowed.fold(String::new(), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            other => out.push(other),
        }
        out
    })
}

/// Path data of several lines, closed or not.
fn path(lines: &[Vec<Point>], closed: bool) -> String {
    let mut d = String::new();
    for line in lines {
        for (i, p) in line.iter().enumerate() {
            let command = match i {
                0 => "M",
                1 => "L",
                _ => " ",
            };
            let _ = write!(d, "{command}{} {}", number(p[0]), number(p[1]));
        }
        d.push_str(if closed { "Z" } else { "" });
    }
    d
}

/// `<path>` of a class; nothing if there is nothing to draw.
pub(super) fn path_element(class: &str, lines: &[Vec<Point>], closed: bool) -> String {
    if lines.is_empty() { String::new() } else { format!("<path class=\"{class}\" d=\"{}\"/>\n", path(lines, closed)) }
}

/// `<line>` of a class.
pub(super) fn line(class: &str, a: Point, b: Point) -> String {
    let [x1, y1, x2, y2] = [a[0], a[1], b[0], b[1]].map(number);
    format!("<line class=\"{class}\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"/>\n")
}

/// `<text>` of a class; the class decides how it is anchored.
pub(super) fn text(class: &str, at: Point, content: &str) -> String {
    let [x, y] = at.map(number);
    format!("<text class=\"{class}\" x=\"{x}\" y=\"{y}\">{}</text>\n", escaped(content))
}

/// The sign for a centre of mass: a circle in quarters.
pub(super) fn quartered_circle(class: &str, at: Point, radius: f64) -> String {
    let ([x, y], r) = (at.map(|v| format!("{v:.2}")), format!("{radius:.2}"));
    format!(
        "<g class=\"{class}\"><circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/><path d=\"M{x} {y}v-{r}a{r} {r} 0 0 1 {r} {r}zM{x} \
         {y}v{r}a{r} {r} 0 0 1 -{r} -{r}z\"/></g>\n"
    )
}
