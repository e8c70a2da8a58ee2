//! Height fields: pictures in shades of grey, and numbers in lines.

use super::fault::Inside;
use super::text::{lines, number};
use std::io::Cursor;

/// Values of a height field: rows of `columns` values, as `Heights` orders them.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightGrid {
    /// Values per row, at least 2.
    pub columns: usize,
    /// Row after row; at least 2 rows. Of a picture: black 0, white 1.
    pub values: Vec<f64>,
}

/// More values are not read.
const MOST_VALUES: usize = 1 << 24;

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

pub(super) fn is_picture(bytes: &[u8]) -> bool {
    bytes.starts_with(PNG)
}

/// The heights in a PNG picture. Colours count by their luminance as Rec. 709 weighs the values that the file holds, so
/// that a grey written as a colour is the same grey; transparency is left aside.
pub(super) fn picture(bytes: &[u8]) -> Result<HeightGrid, Inside> {
    let bad = |fault: png::DecodingError| Inside::At("the picture".into(), fault.to_string());
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let size = decoder.read_header_info().map_err(bad)?.size();
    let count = (size.0 as usize).saturating_mul(size.1 as usize);
    if count > MOST_VALUES {
        return Err(Inside::TooLarge(format!("{} × {} values; {MOST_VALUES} are read", size.0, size.1)));
    }
    let mut reader = decoder.read_info().map_err(bad)?;
    let room = reader.output_buffer_size().unwrap_or(0);
    let mut data = vec![0; room];
    let frame = reader.next_frame(&mut data).map_err(bad)?;
    let (channels, wide) = (frame.color_type.samples(), frame.bit_depth == png::BitDepth::Sixteen);
    let sample = |s: &[u8]| -> f64 {
        if wide { f64::from(u16::from_be_bytes([s[0], s[1]])) / 65535.0 } else { f64::from(s[0]) / 255.0 }
    };
    let width = if wide { 2 } else { 1 };
    let value = |pixel: &[u8]| match channels {
        1 | 2 => sample(pixel),
        _ => luminance([0, 1, 2].map(|i| sample(&pixel[i * width..]))),
    };
    let pixels = data.get(..frame.buffer_size()).unwrap_or(&[]).chunks_exact(channels * width);
    grid(frame.width as usize, pixels.map(value).collect())
}

/// A grey is left as it is, to the last bit.
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    if r == g && g == b { r } else { 0.2126 * r + 0.7152 * g + 0.0722 * b }
}

/// Numbers in lines, with spaces, tabs, commas or semicolons between them; `#` starts a comment.
pub(super) fn table(bytes: &[u8]) -> Result<HeightGrid, Inside> {
    let mut columns = 0;
    let mut values = Vec::new();
    for (n, line) in lines(bytes) {
        let before = values.len();
        let written = line.split('#').next().unwrap_or("");
        for word in written.split([' ', '\t', ',', ';', '\r']).filter(|w| !w.is_empty()) {
            let value = number(n, Some(word))?;
            if !value.is_finite() {
                return Err(Inside::line(n, format!("{value} is no height")));
            }
            values.push(value);
        }
        let row = values.len() - before;
        if columns == 0 {
            columns = row;
        }
        if row != 0 && row != columns {
            return Err(Inside::line(n, format!("a row of {row} values, after rows of {columns}")));
        }
        if values.len() > MOST_VALUES {
            return Err(Inside::TooLarge(format!("more than {MOST_VALUES} values")));
        }
    }
    grid(columns, values)
}

fn grid(columns: usize, values: Vec<f64>) -> Result<HeightGrid, Inside> {
    let rows = values.len().checked_div(columns).unwrap_or(0);
    if columns < 2 || rows < 2 {
        let reason = format!("{rows} rows of {columns} values make no field: at least 2 rows of 2 are needed");
        return Err(Inside::At("the whole file".into(), reason));
    }
    Ok(HeightGrid { columns, values })
}
