//! What curves look like, the same in all diagrams, and how their parts are drawn.

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// Of all diagrams.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Half the size of a marker, pixels.
const HALF: i32 = 5;
/// Length of a dash and of a gap, pixels.
pub(super) const DASH: u32 = 5;
/// Of what is neither curve nor text.
pub(super) const GRID: RGBColor = RGBColor(221, 221, 221);
/// Of text.
pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
/// Of other programs' curves, which are dashed.
const PEER: RGBColor = RGBColor(102, 102, 102);

/// Viewers in the dark turn background and ink over, and lighten what would be too dark there.
const DARK: &str = "<style>@media (prefers-color-scheme: dark){[fill=\"#FFFFFF\"]{fill:#0d1117}[stroke=\"#FFFFFF\"]{stroke:#0d1117}\
[fill=\"#222222\"]{fill:#e6edf3}[stroke=\"#222222\"]{stroke:#8b949e}[stroke=\"#DDDDDD\"]{stroke:#30363d}\
[fill=\"#666666\"]{fill:#b0b7bf}[stroke=\"#666666\"]{stroke:#b0b7bf}[fill=\"#0072B2\"]{fill:#4aa3e0}[stroke=\"#0072B2\"]{stroke:#4aa3e0}}\
</style>";

/// The outline of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Marker {
    Circle,
    Square,
    Up,
    Down,
    Diamond,
    Plus,
    Star,
}

/// Of a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub color: RGBColor,
    pub marker: Marker,
    /// Dashed, with hollow markers.
    pub peer: bool,
}

/// Okabe and Ito's colours, which nearly everybody can tell apart, and a marker for each, so that colour is not needed.
const LOOKS: [(&str, RGBColor, Marker); 10] = [
    ("rbx implicit_midpoint", RGBColor(0, 114, 178), Marker::Circle),
    ("rbx semi_implicit_euler", RGBColor(86, 180, 233), Marker::Square),
    ("rbx rk4", RGBColor(0, 158, 115), Marker::Up),
    ("rbx extrapolation", RGBColor(213, 94, 0), Marker::Diamond),
    ("rapier", RGBColor(204, 121, 167), Marker::Down),
    ("bullet", RGBColor(230, 159, 0), Marker::Plus),
    ("physx", RGBColor(150, 120, 90), Marker::Star),
    ("MuJoCo Euler", PEER, Marker::Square),
    ("MuJoCo implicitfast", PEER, Marker::Circle),
    ("MuJoCo RK4", PEER, Marker::Up),
];

/// Of the curve with this label.
pub(super) fn look(label: &str, peer: bool) -> Look {
    let known = LOOKS.iter().find(|(name, ..)| *name == label);
    let (color, marker) = known.map_or((PEER, Marker::Star), |(_, color, marker)| (*color, *marker));
    Look { color, marker, peer }
}

/// A marker at a pixel.
pub(super) fn mark(area: &Area, (x, y): (i32, i32), look: Look) -> Result<(), String> {
    let line = look.color.stroke_width(2);
    let outline = |points: &[(i32, i32)]| {
        let points: Vec<(i32, i32)> = points.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
        if look.peer {
            let closed: Vec<(i32, i32)> = points.iter().chain(points.first()).copied().collect();
            area.draw(&Polygon::new(points, WHITE.filled())).and_then(|()| area.draw(&PathElement::new(closed, line)))
        } else {
            area.draw(&Polygon::new(points, look.color.filled()))
        }
    };
    let stroke = |dx: i32, dy: i32| area.draw(&PathElement::new([(x - dx, y - dy), (x + dx, y + dy)], line));
    let h = HALF;
    let drawn = match look.marker {
        Marker::Circle if look.peer => {
            area.draw(&Circle::new((x, y), h, WHITE.filled())).and_then(|()| area.draw(&Circle::new((x, y), h, line)))
        }
        Marker::Circle => area.draw(&Circle::new((x, y), h, look.color.filled())),
        Marker::Square => outline(&[(-h + 1, -h + 1), (h - 1, -h + 1), (h - 1, h - 1), (-h + 1, h - 1)]),
        Marker::Up => outline(&[(0, -h - 1), (h, h - 1), (-h, h - 1)]),
        Marker::Down => outline(&[(0, h + 1), (h, -h + 1), (-h, -h + 1)]),
        Marker::Diamond => outline(&[(0, -h - 1), (h + 1, 0), (0, h + 1), (-h - 1, 0)]),
        Marker::Plus => stroke(h, 0).and_then(|()| stroke(0, h)),
        Marker::Star => stroke(h, 0).and_then(|()| stroke(h / 2, h)).and_then(|()| stroke(-h / 2, h)),
    };
    drawn.map_err(|e| e.to_string())
}

/// A cross for what is not on the scale.
pub(super) fn cross(area: &Area, (x, y): (i32, i32), look: Look) -> Result<(), String> {
    let h = HALF - 1;
    for (dx, dy) in [(h, h), (h, -h)] {
        let line = PathElement::new([(x - dx, y - dy), (x + dx, y + dy)], look.color.stroke_width(1));
        area.draw(&line).map_err(|e| e.to_string())?;
    }
    Ok(())
}

/// A line through pixels, dashed for other programs.
pub(super) fn line(area: &Area, points: &[(i32, i32)], look: Look) -> Result<(), String> {
    let style = look.color.stroke_width(if look.peer { 1 } else { 2 });
    let drawn = if look.peer {
        area.draw(&DashedPathElement::new(points.to_vec(), DASH, DASH, style))
    } else {
        area.draw(&PathElement::new(points.to_vec(), style))
    };
    drawn.map_err(|e| e.to_string())
}

/// Text from a pixel on, or ending there.
pub(super) fn text(area: &Area, words: &str, (x, y): (i32, i32), (size, right): (u32, bool)) -> Result<(), String> {
    use plotters::style::text_anchor::{HPos, Pos, VPos};
    let anchor = Pos::new(if right { HPos::Right } else { HPos::Left }, VPos::Center);
    let style = TextStyle::from(("sans-serif", size).into_font()).color(&INK).pos(anchor);
    area.draw(&Text::new(words.to_owned(), (x, y), style)).map_err(|e| e.to_string())
}

/// Line by line: marker, line and name.
pub(super) fn legend(area: &Area, (x, y): (i32, i32), entries: &[(&str, Look)]) -> Result<(), String> {
    for (i, (name, look)) in entries.iter().enumerate() {
        let y = y + 22 * i as i32;
        line(area, &[(x, y), (x + 28, y)], *look)?;
        mark(area, (x + 14, y), *look)?;
        text(area, name, (x + 36, y), (13, false))?;
    }
    Ok(())
}

/// `10⁻³` for a power of ten, nothing for what lies between.
pub(super) fn power(x: f64) -> String {
    let exponent = x.log10();
    if (exponent - exponent.round()).abs() > 1e-6 {
        return String::new();
    }
    let raised = |c: char| match c {
        '-' => '⁻',
        digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit.to_digit(10).unwrap_or(0) as usize],
    };
    let exponent = format!("{}", exponent.round() as i32);
    format!("10{}", exponent.chars().map(raised).collect::<String>())
}

/// Draws on a white page of this size, pixels, and gives the SVG text, which turns dark where the reader's screen is.
pub(super) fn page(size: (u32, u32), draw: impl FnOnce(&Area) -> Result<(), String>) -> Result<String, String> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        area.fill(&WHITE).map_err(|e| e.to_string())?;
        draw(&area)?;
        area.present().map_err(|e| e.to_string())?;
    }
    let after = svg.find("<svg").and_then(|start| svg[start..].find('>').map(|end| start + end + 1));
    svg.insert_str(after.ok_or("the drawing library made no SVG")?, DARK);
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_have_raised_exponents() {
        assert_eq!([1e-12, 1.0, 1e3].map(power), ["10⁻¹²", "10⁰", "10³"]);
        assert_eq!(power(2e-3), "");
    }

    #[test]
    fn no_two_curves_look_alike() {
        for (i, (name, color, marker)) in LOOKS.iter().enumerate() {
            let twin = |(other, c, m): &(&str, RGBColor, Marker)| other == name || (c == color && m == marker);
            assert!(!LOOKS[i + 1..].iter().any(twin), "{name}");
        }
    }
}
