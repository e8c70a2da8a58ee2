//! Height fields from pictures and tables.

use super::support::Folder;
use realnoid::shape::{HeightGrid, MeshFault};

fn heights(name: &str, content: impl AsRef<[u8]>) -> Result<HeightGrid, MeshFault> {
    Folder::with(name, content).meshes().heights(name).map(|grid| (*grid).clone())
}

fn picture(size: [u32; 2], kind: (png::ColorType, png::BitDepth), data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(kind.0);
    encoder.set_depth(kind.1);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}

const GREY: (png::ColorType, png::BitDepth) = (png::ColorType::Grayscale, png::BitDepth::Eight);

#[test]
fn greys_of_8_and_16_bits() {
    let grid = heights("h.png", picture([3, 2], GREY, &[0, 51, 255, 102, 153, 204])).unwrap();
    assert_eq!(grid, HeightGrid { columns: 3, values: vec![0.0, 0.2, 1.0, 0.4, 0.6, 0.8] });
    let data: Vec<u8> = [0_u16, 13107, 65535, 1].iter().flat_map(|v| v.to_be_bytes()).collect();
    let grid = heights("h.png", picture([2, 2], (png::ColorType::Grayscale, png::BitDepth::Sixteen), &data)).unwrap();
    assert_eq!(grid.values, [0.0, 0.2, 1.0, 1.0 / 65535.0]);
}

#[test]
fn colours_count_by_luminance_and_greys_stay_greys() {
    let data = [[51; 3], [255, 0, 0], [0, 255, 0], [0, 0, 255]].concat();
    let grid = heights("h.png", picture([2, 2], (png::ColorType::Rgb, png::BitDepth::Eight), &data)).unwrap();
    assert_eq!(grid.values[0], 0.2);
    assert!((grid.values[1..].iter().sum::<f64>() - 1.0).abs() < 1e-15, "the weights of Rec. 709 make 1");
    assert!(grid.values[2] > grid.values[1] && grid.values[1] > grid.values[3], "green, red, blue");
}

#[test]
fn one_bit_and_transparency() {
    let one = (png::ColorType::Grayscale, png::BitDepth::One);
    assert_eq!(
        heights("h.png", picture([2, 2], one, &[0b0100_0000, 0b1000_0000])).unwrap().values,
        [0.0, 1.0, 1.0, 0.0]
    );
    let alpha = (png::ColorType::GrayscaleAlpha, png::BitDepth::Eight);
    assert_eq!(
        heights("h.png", picture([2, 2], alpha, &[51, 0, 0, 9, 255, 255, 0, 0])).unwrap().values,
        [0.2, 0.0, 1.0, 0.0]
    );
}

#[test]
fn tables_with_any_separator() {
    let grid = HeightGrid { columns: 2, values: vec![0.0, 0.5, -1.0, 1e-3, 2.0, 3.0] };
    for text in ["0 .5\n-1 1e-3\n2 3\n", "0,0.5\r\n-1,0.001\r\n2,3", "# a field\n0;0.5\n\n-1;\t1e-3 # low\n2;3\n"] {
        assert_eq!(heights("h.csv", text).unwrap(), grid, "{text}");
    }
}

#[test]
fn bad_fields_are_refused() {
    for (content, why) in [
        ("1 2\n3 4 5\n", "line 2: a row of 3 values, after rows of 2"),
        ("1 2\n3 x\n", "line 2: \"x\" is not a number"),
        ("1 2\n3 NaN\n", "line 2: NaN is no height"),
        ("1 2 3\n", "1 rows of 3 values"),
        ("1\n2\n", "2 rows of 1 values"),
        ("", "0 rows"),
    ] {
        let fault = heights("h.txt", content).unwrap_err().to_string();
        assert!(fault.contains(why) && fault.contains("h.txt"), "{fault}");
    }
}

#[test]
fn damaged_pictures_are_refused() {
    let whole = picture([64, 64], GREY, &[7; 64 * 64]);
    for end in [8, 20, 40, whole.len() - 20] {
        assert!(matches!(heights("h.png", &whole[..end]), Err(MeshFault::Unreadable { .. })), "{end}");
    }
    let mut huge = whole.clone();
    huge[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    assert!(heights("h.png", huge).is_err(), "2147483647 × 2147483647 points are not room that is asked for");
}
