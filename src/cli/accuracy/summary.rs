//! One picture of all cases: what each rung costs to come within a level.

use super::advice::{LEVELS, cheapest, plain};
use super::measure::Measured;
use super::plot::decades;
use super::style::{Area, GRID, INK, legend, look, mark, page, power, text};
use plotters::prelude::*;
use std::ops::Range;

/// Width of the names of cases, of a panel, and of the legend, pixels.
const WIDTHS: (u32, u32, u32) = (150, 330, 210);
/// Height of a case, pixels.
const ROW: u32 = 34;
/// Above and below the cases, pixels.
const EDGES: (u32, u32) = (40, 56);

/// SVG text.
///
/// # Errors
/// What the drawing library says.
pub fn summary(all: &[Measured]) -> Result<String, String> {
    let labels = labels(all);
    let levels = &LEVELS[..2];
    let found = |level: &f64, m: &Measured| -> Vec<(usize, f64)> {
        let one = |(i, (label, _)): (usize, &(String, bool))| {
            let cost = cheapest(m.curves.iter().filter(|c| c.label == *label), *level)?.1.cpu;
            Some((i, cost))
        };
        labels.iter().enumerate().filter_map(one).collect()
    };
    let marks: Vec<Vec<Vec<(usize, f64)>>> =
        levels.iter().map(|level| all.iter().map(|m| found(level, m)).collect()).collect();
    let costs = || marks.iter().flatten().flatten().map(|(_, cost)| *cost);
    let range = decades(costs().fold(f64::INFINITY, f64::min), costs().fold(0.0, f64::max));
    let rows = (all.len().max(labels.len()) as u32).max(1);
    let size = (WIDTHS.0 + levels.len() as u32 * WIDTHS.1 + WIDTHS.2, EDGES.0 + rows * ROW + EDGES.1);
    let looks: Vec<_> = labels.iter().map(|(label, peer)| (label.as_str(), look(label, *peer))).collect();
    page(size, |area| {
        for (i, m) in all.iter().enumerate() {
            let y = EDGES.0 + ROW * i as u32 + ROW / 2;
            text(area, m.case.name, (WIDTHS.0 as i32 - 10, y as i32), (13, true))?;
        }
        for (i, level) in levels.iter().enumerate() {
            let left = WIDTHS.0 + i as u32 * WIDTHS.1;
            let head = format!("to come within {} m or rad", plain(*level));
            text(area, &head, (left as i32 + 8, EDGES.0 as i32 / 2), (15, false))?;
            let marks: Vec<Vec<_>> =
                marks[i].iter().map(|row| row.iter().map(|(n, cost)| (looks[*n].1, *cost)).collect()).collect();
            panel(area, left, &marks, range.clone())?;
        }
        let x = WIDTHS.0 + levels.len() as u32 * WIDTHS.1 + 14;
        legend(area, (x as i32, EDGES.0 as i32 + 14), &looks)
    })
}

/// Every curve that a case has, in the order of first appearance; true for other programs.
fn labels(all: &[Measured]) -> Vec<(String, bool)> {
    let mut labels: Vec<(String, bool)> = vec![];
    for curve in all.iter().flat_map(|m| &m.curves) {
        if labels.iter().all(|(label, _)| *label != curve.label) {
            labels.push((curve.label.clone(), curve.peer));
        }
    }
    labels.sort_by_key(|(_, peer)| *peer);
    labels
}

fn panel(root: &Area, left: u32, rows: &[Vec<(super::style::Look, f64)>], x: Range<f64>) -> Result<(), String> {
    let told = |e: DrawingAreaErrorKind<_>| e.to_string();
    let height = ROW * rows.len() as u32;
    let part = root.clone().shrink((left, EDGES.0), (WIDTHS.1, height + EDGES.1));
    let mut chart = ChartBuilder::on(&part)
        .margin_right(26)
        .margin_bottom(8)
        .x_label_area_size(EDGES.1 - 8)
        .build_cartesian_2d(x.clone().log_scale(), (rows.len() as f64)..0.0)
        .map_err(told)?;
    chart
        .configure_mesh()
        .disable_y_axis()
        .y_labels(rows.len() + 1)
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(INK)
        .label_style(("sans-serif", 12).into_font().color(&INK))
        .axis_desc_style(("sans-serif", 13).into_font().color(&INK))
        .x_desc("CPU s per simulated s")
        .x_label_formatter(&|x| power(*x))
        .draw()
        .map_err(told)?;
    for (i, row) in rows.iter().enumerate() {
        for (look, cost) in row {
            mark(root, chart.backend_coord(&(*cost, i as f64 + 0.5)), *look)?;
        }
    }
    Ok(())
}
