//! Work-precision diagrams: CPU time against error, a curve for each rung.

use super::measure::{Curve, Measured, Run};
use super::report::milliseconds;
use super::rung::{ITERATED_STEP, Ladder};
use super::style::{Area, GRID, INK, cross, legend, line, look, mark, page, power, text};
use plotters::prelude::*;
use std::ops::Range;

/// Of a panel, pixels.
const PANEL: (u32, u32) = (390, 360);
/// Width of the legend, pixels.
const LEGEND: u32 = 210;
/// Height of the headline of a row, pixels.
const HEAD: u32 = 30;
/// Errors below this share of the size of the motion are rounding, and shown at this edge.
const LEAST: f64 = 1e-16;

/// An axis goes beyond its decades by this factor, so that rounding does not take the ticks at its ends.
const EDGE: f64 = 1.001;

/// One of the two errors.
type Error = fn(&Run) -> f64;
const ERRORS: [(&str, Error); 2] = [("RMS error", |r| r.rms), ("greatest error", |r| r.max)];

/// SVG text of a case.
///
/// # Errors
/// What the drawing library says.
pub fn diagram(m: &Measured) -> Result<String, String> {
    let rows: Vec<(Ladder, Vec<&Curve>)> = [Ladder::Steps, Ladder::Iterations]
        .into_iter()
        .map(|ladder| {
            (
                ladder,
                m.curves
                    .iter()
                    .filter(|c| (c.ladder == Ladder::Iterations) == (ladder == Ladder::Iterations))
                    .collect(),
            )
        })
        .filter(|(_, curves): &(Ladder, Vec<&Curve>)| !curves.is_empty())
        .collect();
    let height = HEAD + PANEL.1;
    page((2 * PANEL.0 + LEGEND, height * rows.len().max(1) as u32), |area| {
        for (i, (ladder, curves)) in rows.iter().enumerate() {
            row(area, (m, *ladder), curves, i as u32 * height)?;
        }
        Ok(())
    })
}

/// Two panels and a legend, from this height (pixels) on.
fn row(area: &Area, (m, ladder): (&Measured, Ladder), curves: &[&Curve], top: u32) -> Result<(), String> {
    let spread = |ladder: Ladder| {
        let steps = curves.iter().filter(|c| c.ladder == ladder).flat_map(|c| &c.runs).map(|r| r.point.step());
        let (low, high) = steps.fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        format!("steps of {} … {}, upwards", milliseconds(high), milliseconds(low))
    };
    let head = match ladder {
        Ladder::Iterations => {
            let counts = curves.iter().flat_map(|c| &c.runs).map(|r| r.point.iterations);
            let (low, high) = counts.fold((u32::MAX, 0), |(l, h), n| (l.min(n), h.max(n)));
            format!("{}: {low} … {high} solver iterations at {}", m.case.name, milliseconds(ITERATED_STEP))
        }
        _ => {
            let chosen = curves.iter().filter(|c| c.ladder == Ladder::Accuracy).flat_map(|c| &c.runs);
            let accuracies: Vec<f64> = chosen.map(|r| r.point.accuracy).collect();
            let ends = accuracies.first().zip(accuracies.last());
            let told = ends.map_or(String::new(), |(a, b)| format!("; accuracies of {a:e} … {b:e}"));
            format!("{}: {}{told}", m.case.name, spread(Ladder::Steps))
        }
    };
    text(area, &head, (14, top as i32 + 18), (16, false))?;
    let (low, high) = (costs(curves), m.case.size);
    for (i, error) in ERRORS.iter().enumerate() {
        let left = i as u32 * PANEL.0;
        let range = errors(curves, error.1, high);
        panel(area, (left, top + HEAD), (m.case.unit, error), (curves, range, low.clone()))?;
    }
    let entries: Vec<_> = curves.iter().map(|c| (c.label.as_str(), look(&c.label, c.peer))).collect();
    let (x, y) = (2 * PANEL.0 as i32 + 14, (top + HEAD) as i32 + 24);
    legend(area, (x, y), &entries)?;
    if curves.iter().flat_map(|c| &c.runs).any(|r| r.diverged) {
        let y = y + 22 * entries.len() as i32 + 8;
        cross(area, (x + 14, y), look("", false))?;
        text(area, "diverged", (x + 36, y), (13, false))?;
    }
    Ok(())
}

fn panel(
    root: &Area,
    (left, top): (u32, u32),
    (unit, (name, error)): (&str, &(&str, Error)),
    (curves, x, y): (&[&Curve], Range<f64>, Range<f64>),
) -> Result<(), String> {
    let told = |e: DrawingAreaErrorKind<_>| e.to_string();
    let part = root.clone().shrink((left, top), PANEL);
    let mut chart = ChartBuilder::on(&part)
        .margin(8)
        .margin_right(16)
        .x_label_area_size(44)
        .y_label_area_size(62)
        .build_cartesian_2d(x.clone().log_scale(), y.log_scale())
        .map_err(told)?;
    let (small, big) = (("sans-serif", 12).into_font().color(&INK), ("sans-serif", 13).into_font().color(&INK));
    chart
        .configure_mesh()
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(INK)
        .label_style(small)
        .axis_desc_style(big)
        .x_desc(format!("{name}, {unit}"))
        .y_desc("CPU s per simulated s")
        .x_label_formatter(&|x| power(*x))
        .y_label_formatter(&|y| power(*y))
        .draw()
        .map_err(told)?;
    for curve in curves {
        let look = look(&curve.label, curve.peer);
        let place = |r: &&Run| chart.backend_coord(&(error(r).clamp(x.start, x.end), r.cpu));
        let (beyond, shown): (Vec<&Run>, Vec<&Run>) = curve.runs.iter().partition(|r| r.diverged);
        let points: Vec<(i32, i32)> = shown.iter().map(place).collect();
        line(root, &points, look)?;
        points.iter().try_for_each(|p| mark(root, *p, look))?;
        beyond.iter().try_for_each(|r| cross(root, chart.backend_coord(&(x.end, r.cpu)), look))?;
    }
    Ok(())
}

/// Whole decades around the errors of what has not diverged; the right end is where things diverge, at least.
fn errors(curves: &[&Curve], error: Error, size: f64) -> Range<f64> {
    let shown = curves.iter().flat_map(|c| &c.runs).filter(|r| !r.diverged).map(error).filter(|e| *e > 0.0);
    let least = shown.fold(size, f64::min).max(LEAST * size);
    decades(least, size)
}

fn costs(curves: &[&Curve]) -> Range<f64> {
    let all = || curves.iter().flat_map(|c| &c.runs).map(|r| r.cpu);
    decades(all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max))
}

/// Whole decades, one at least.
pub(super) fn decades(low: f64, high: f64) -> Range<f64> {
    let (low, high) = (low.log10().floor(), high.log10().ceil());
    if low.is_finite() && high.is_finite() {
        EDGE.recip() * 10f64.powf(low)..EDGE * 10f64.powf(high.max(low + 1.0))
    } else {
        0.1..1.0
    }
}
