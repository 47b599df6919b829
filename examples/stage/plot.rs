//! Draws a simple plot of curves as PNG.

use image::{Rgb, RgbImage};
use std::path::Path;

const SIZE: (u32, u32) = (960, 640);
/// Left, top, right and bottom of the frame, pixels.
const FRAME: [i32; 4] = [110, 40, 930, 570];
/// Size of a dot of a letter, pixels.
const DOT: i32 = 3;
const INK: Rgb<u8> = Rgb([40, 42, 46]);
const GRID: Rgb<u8> = Rgb([218, 221, 225]);

/// A plot of curves over a common range.
pub struct Plot {
    /// Start, end and grid step of each axis.
    pub x: [f32; 3],
    pub y: [f32; 3],
    /// Units, written at the axes.
    pub units: [&'static str; 2],
    picture: RgbImage,
}

impl Plot {
    pub fn new(x: [f32; 3], y: [f32; 3], units: [&'static str; 2]) -> Self {
        let picture = RgbImage::from_pixel(SIZE.0, SIZE.1, Rgb([250, 250, 248]));
        let mut plot = Self {
            x,
            y,
            units,
            picture,
        };
        plot.grid();
        plot
    }

    fn at(&self, (x, y): (f32, f32)) -> (i32, i32) {
        let share = |v: f32, [from, to, _]: [f32; 3]| (v - from) / (to - from);
        let [left, top, right, bottom] = FRAME.map(|edge| edge as f32);
        (
            (left + (right - left) * share(x, self.x)).round() as i32,
            (bottom - (bottom - top) * share(y, self.y)).round() as i32,
        )
    }

    fn grid(&mut self) {
        let steps = |[from, to, step]: [f32; 3]| {
            let count = ((to - from) / step).round() as i32;
            (0..=count).map(move |i| from + step * i as f32)
        };
        for x in steps(self.x) {
            let paint = if x.abs() < 1e-6 { INK } else { GRID };
            self.curve(&[(x, self.y[0]), (x, self.y[1])], paint);
            let (at, _) = self.at((x, 0.0));
            self.write(&number(x), at, FRAME[3] + 18, 0.5);
        }
        for y in steps(self.y) {
            let paint = if y.abs() < 1e-6 { INK } else { GRID };
            self.curve(&[(self.x[0], y), (self.x[1], y)], paint);
            let (_, at) = self.at((0.0, y));
            self.write(&number(y), FRAME[0] - 12, at - 2 * DOT, 1.0);
        }
        let [x, y] = self.units;
        self.write(x, FRAME[2], FRAME[3] + 45, 1.0);
        self.write(y, FRAME[0], FRAME[1] - 30, 0.5);
    }

    /// Draws a line through points.
    pub fn curve(&mut self, points: &[(f32, f32)], paint: Rgb<u8>) {
        for ends in points.windows(2) {
            let (from, to) = (self.at(ends[0]), self.at(ends[1]));
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            let count = dx.abs().max(dy.abs()).max(1);
            for i in 0..=count {
                self.square(from.0 + dx * i / count, from.1 + dy * i / count, 1, paint);
            }
        }
    }

    /// Draws a mark at each point.
    pub fn marks(&mut self, points: &[(f32, f32)], paint: Rgb<u8>) {
        for point in points {
            let (x, y) = self.at(*point);
            self.square(x - 2, y - 2, 5, paint);
        }
    }

    fn square(&mut self, x: i32, y: i32, size: i32, paint: Rgb<u8>) {
        for (x, y) in (x..x + size).flat_map(|x| (y..y + size).map(move |y| (x, y))) {
            if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y))
                && let Some(pixel) = self.picture.get_pixel_mut_checked(x, y)
            {
                *pixel = paint;
            }
        }
    }

    /// Writes text with this share of its width left of x.
    fn write(&mut self, text: &str, x: i32, y: i32, share: f32) {
        let width: i32 = text.chars().map(|letter| glyph(letter).0 + 1).sum();
        let mut x = x - (share * (DOT * width) as f32) as i32;
        for letter in text.chars() {
            let (width, rows) = glyph(letter);
            for (row, bits) in rows.into_iter().enumerate() {
                for column in (0..width).filter(|column| bits >> (width - 1 - column) & 1 == 1) {
                    self.square(x + DOT * column, y + DOT * row as i32, DOT, INK);
                }
            }
            x += DOT * (width + 1);
        }
    }

    pub fn save(&self, path: &Path) -> Result<(), String> {
        self.picture.save(path).map_err(|e| e.to_string())
    }
}

fn number(value: f32) -> String {
    let rounded = (100.0 * value).round() / 100.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// Returns width and rows of a letter, in dots. Letters that no plot has needed are blank.
fn glyph(letter: char) -> (i32, [u8; 5]) {
    match letter {
        '0' => (3, [7, 5, 5, 5, 7]),
        '1' => (3, [2, 6, 2, 2, 7]),
        '2' => (3, [7, 1, 7, 4, 7]),
        '3' => (3, [7, 1, 7, 1, 7]),
        '4' => (3, [5, 5, 7, 1, 1]),
        '5' => (3, [7, 4, 7, 1, 7]),
        '6' => (3, [7, 4, 7, 5, 7]),
        '7' => (3, [7, 1, 1, 2, 2]),
        '8' => (3, [7, 5, 7, 5, 7]),
        '9' => (3, [7, 5, 7, 1, 7]),
        '-' => (3, [0, 0, 7, 0, 0]),
        '.' => (1, [0, 0, 0, 0, 1]),
        '/' => (5, [1, 2, 4, 8, 16]),
        'N' => (5, [17, 25, 21, 19, 17]),
        'm' => (5, [0, 26, 21, 21, 21]),
        's' => (3, [0, 3, 6, 1, 6]),
        _ => (3, [0; 5]),
    }
}
