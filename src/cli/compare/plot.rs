//! The differences over time as a picture, with logarithmic axes.

use super::Contest;
use super::difference::{MEASURES, exists};
use super::rows::Row;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

/// Of a panel, pixels.
const SIZE: (u32, u32) = (900, 300);
/// Width of what is right of the panels, pixels.
const LEGEND: u32 = 140;
/// Length of the lines in it, pixels.
const LEGEND_LINE: i32 = 18;
/// Points of a line at most: what is between them is told by the greatest of it.
const POINTS: usize = 900;
/// Decades that a panel shows at most, downwards from its greatest value.
const DECADES: i32 = 14;
/// Okabe and Ito's colours, which nearly everybody can tell apart.
const COLORS: [RGBColor; 6] = [
    RGBColor(120, 120, 120),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Of a run; the first row is the reference's.
type Value = Box<dyn Fn(&Row, &Row) -> f64>;

/// One panel: what is above it, and what it shows.
struct Panel {
    title: String,
    value: Value,
    /// It has the bound of `--within`.
    bounded: bool,
}

/// SVG text.
///
/// # Errors
/// What the drawing library says.
pub(super) fn picture(c: &Contest) -> Result<String, String> {
    let panels = panels(c);
    let mut text = String::new();
    {
        let size = (SIZE.0, SIZE.1 * panels.len() as u32);
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        area.fill(&WHITE).map_err(|e| e.to_string())?;
        for (panel, part) in panels.iter().zip(area.split_evenly((panels.len(), 1))) {
            draw(c, panel, &part)?;
        }
        area.present().map_err(|e| e.to_string())?;
    }
    Ok(text)
}

fn panels(c: &Contest) -> Vec<Panel> {
    let measured = MEASURES.iter().enumerate().filter(|(i, _)| exists(&c.model, &c.links, *i));
    let mut panels: Vec<Panel> = measured
        .map(|(i, m)| Panel {
            title: format!("{}: greatest difference from the reference, {}", m.name, m.unit),
            value: Box::new(move |_, row| row.differences[i]),
            bounded: true,
        })
        .collect();
    panels.push(Panel {
        title: "energy: difference from the reference, J".into(),
        value: Box::new(|reference, row| (row.energy - reference.energy).abs()),
        bounded: false,
    });
    if c.floats {
        let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        panels.push(Panel {
            title: "momentum of what floats: difference from the reference, N·s".into(),
            value: Box::new(move |reference, row| apart(reference.momentum, row.momentum)),
            bounded: false,
        });
        panels.push(Panel {
            title: "angular momentum of what floats: difference from the reference, N·m·s".into(),
            value: Box::new(move |reference, row| apart(reference.angular, row.angular)),
            bounded: false,
        });
    }
    panels
}

/// Name, and points of a line; nothing where a logarithmic axis cannot show it.
type Line<'a> = (&'a str, Vec<Option<(f64, f64)>>);

fn lines<'a>(c: &'a Contest, panel: &Panel) -> Vec<Line<'a>> {
    let chunk = c.rows.times.len().div_ceil(POINTS).max(1);
    let line = |run: usize| {
        let values = c.rows.rows.iter().map(|rows| (panel.value)(&rows[0], &rows[run]));
        let all: Vec<(f64, f64)> = c.rows.times.iter().copied().zip(values).collect();
        (c.rows.names[run].as_str(), all.chunks(chunk).map(greatest).collect())
    };
    (1..c.rows.names.len()).map(line).collect()
}

fn greatest(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let shown = points.iter().copied().filter(|p| p.1.is_finite() && p.1 > 0.0);
    shown.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Whole decades around all values.
fn decades(lines: &[Line], bound: Option<f64>) -> Range<f64> {
    let values = || lines.iter().flat_map(|(_, points)| points.iter().flatten().map(|p| p.1)).chain(bound);
    let top = values().fold(f64::MIN_POSITIVE, f64::max).log10().ceil() as i32;
    let low = values().fold(f64::INFINITY, f64::min).log10().floor();
    let (low, top) = if low.is_finite() { (low as i32, top) } else { (-1, 0) };
    let low = low.max(top - DECADES).min(top - 1);
    10f64.powi(low)..10f64.powi(top)
}

fn draw(c: &Contest, panel: &Panel, area: &Area) -> Result<(), String> {
    let told = |e: DrawingAreaErrorKind<_>| e.to_string();
    let lines = lines(c, panel);
    let bound = panel.bounded.then_some(c.within);
    let (heights, end) = (decades(&lines, bound), c.time().max(f64::MIN_POSITIVE));
    let floor = heights.start;
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, ("sans-serif", 16))
        .margin(12)
        .margin_right(LEGEND)
        .x_label_area_size(36)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..end, heights.log_scale())
        .map_err(told)?;
    let mut mesh = chart.configure_mesh();
    mesh.x_desc("time, s").y_labels(8).max_light_lines(1).y_label_formatter(&|y| format!("{y:.0e}"));
    mesh.light_line_style(WHITE).draw().map_err(told)?;
    if let Some(bound) = bound {
        let line = DashedLineSeries::new([(0.0, bound), (end, bound)], 4, 4, BLACK.stroke_width(1));
        chart.draw_series(line).map_err(told)?;
        entry(area, (0, 4), &format!("within {bound}"), BLACK.stroke_width(1))?;
    }
    for (i, ((name, points), color)) in lines.into_iter().zip(COLORS.iter().cycle()).enumerate() {
        let seen = |p: &Option<(f64, f64)>| p.is_some_and(|(_, y)| y >= floor);
        for part in points.chunk_by(|a, b| seen(a) == seen(b)).filter(|part| part.iter().all(seen)) {
            let shown = part.iter().copied().flatten();
            chart.draw_series(LineSeries::new(shown, color.stroke_width(2))).map_err(told)?;
        }
        entry(area, (i as i32 + 1, LEGEND_LINE), name, color.stroke_width(2))?;
    }
    Ok(())
}

/// A line of the legend, right of the panel; `dash`: length of its dashes, pixels.
fn entry(area: &Area, (line, dash): (i32, i32), name: &str, style: ShapeStyle) -> Result<(), String> {
    let (x, y) = ((SIZE.0 - LEGEND) as i32 + 10, 50 + 18 * line);
    for from in (x..x + LEGEND_LINE).step_by(2 * dash as usize) {
        area.draw(&PathElement::new([(from, y), (from + dash, y)], style)).map_err(|e| e.to_string())?;
    }
    area.draw(&Text::new(name.to_owned(), (x + LEGEND_LINE + 6, y - 5), ("sans-serif", 12))).map_err(|e| e.to_string())
}
